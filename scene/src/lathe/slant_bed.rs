//! The slant bed lathe: inclined bed, headstock wall, cabinet and sliding door.

use glam::{Mat4, vec3};

use super::control_panel::add_control_panel;
use super::flat_bed::add_spindle_nose;
use super::floor_y;
use super::palette::{ACCENT, BLACK, BRIGHT_STEEL, DARK, GROUND_STEEL, LAMP, LIGHT, PANE, SHEET};
use super::tower::add_tower;
use crate::description::{LatheDimensions, LatheKind};
use crate::mesh::SceneMesh;
use crate::placement::tool_side;

/// Positions of the walls and of the door of the cabinet, mm.
struct Cabinet {
    scale: f32,
    /// Position of the cabinet wall at the headstock; then that of the wall at the far end, mm.
    head: f32,
    right: f32,
    /// Heights of the lower and upper edge of the door opening, mm.
    sill: f32,
    lintel: f32,
    front: f32,
    back: f32,
}

impl Cabinet {
    fn new(dimensions: &LatheDimensions) -> Self {
        let scale = dimensions.centre_height / 190.0;
        Self {
            scale,
            head: -dimensions.chuck_length - 26.0,
            right: dimensions.bed_length + 60.0 * scale,
            sill: -dimensions.centre_height * 1.16,
            lintel: dimensions.centre_height * 1.78,
            front: 290.0 * scale,
            back: -440.0 * scale,
        }
    }
}

/// Adds the stationary parts of a slant bed lathe to the mesh.
pub fn add_fixed(mesh: &mut SceneMesh, dimensions: &LatheDimensions) {
    let cabinet = Cabinet::new(dimensions);
    let floor = floor_y(LatheKind::SlantBed, dimensions);
    add_bed(mesh, dimensions, &cabinet);
    add_walls(mesh, &cabinet, floor);
    add_front(mesh, &cabinet, floor);
    add_spindle_nose(mesh, dimensions);
    add_tower(mesh, LatheKind::SlantBed, dimensions);
    add_control_panel(mesh, LatheKind::SlantBed, dimensions);
}

fn add_bed(mesh: &mut SceneMesh, dimensions: &LatheDimensions, cabinet: &Cabinet) {
    let (scale, head, right) = (cabinet.scale, cabinet.head, dimensions.bed_length + 30.0);
    mesh.step_mm = 44.0;
    mesh.within(tool_side(LatheKind::SlantBed), |mesh| {
        mesh.material = LIGHT;
        mesh.add_box(
            vec3(head, 176.0 * scale, -30.0 * scale),
            vec3(right, 300.0 * scale, 430.0 * scale),
            8.0,
        );
        mesh.material = GROUND_STEEL;
        mesh.step_mm = 32.0;
        for z in [30.0, 300.0] {
            mesh.add_box(
                vec3(head, 158.0 * scale, z * scale),
                vec3(right, 178.0 * scale, (z + 46.0) * scale),
                2.5,
            );
        }
        mesh.material = BRIGHT_STEEL;
        let screw = Mat4::from_translation(vec3(0.0, 160.0 * scale, 190.0 * scale));
        let radius = 13.0 * scale;
        mesh.within(screw, |mesh| {
            mesh.add_revolve(
                &[(head, 0.0), (head, radius), (right, radius), (right, 0.0)],
                24,
            );
        });
    });
    // The way of the tailstock, below the axis.
    mesh.material = DARK;
    mesh.step_mm = 50.0;
    let top = -dimensions.centre_height * 0.86;
    mesh.add_box(
        vec3(head, cabinet.sill - 30.0 * scale, -190.0 * scale),
        vec3(right, top - 12.0 * scale, 90.0 * scale),
        6.0,
    );
    mesh.material = GROUND_STEEL;
    for z in [-70.0, 40.0] {
        mesh.add_box(
            vec3(head, top - 14.0 * scale, z * scale),
            vec3(right, top - 1.0, (z + 34.0) * scale),
            2.0,
        );
    }
}

fn add_walls(mesh: &mut SceneMesh, cabinet: &Cabinet, floor: f32) {
    let Cabinet {
        scale,
        head,
        right,
        sill,
        lintel,
        front,
        back,
    } = *cabinet;
    mesh.step_mm = 55.0;
    mesh.material = SHEET;
    mesh.add_box(
        vec3(head - 8.0, sill - 60.0 * scale, back),
        vec3(right, lintel, back + 8.0),
        3.0,
    );
    mesh.add_box(
        vec3(head - 8.0, sill - 60.0 * scale, back),
        vec3(head, lintel, front - 10.0),
        3.0,
    );
    mesh.add_box(
        vec3(right - 8.0, sill - 60.0 * scale, back),
        vec3(right, lintel, front - 120.0 * scale),
        3.0,
    );
    // The headstock's housing outside the work area.
    mesh.material = LIGHT;
    mesh.add_box(
        vec3(head - 360.0 * scale, sill - 10.0, back),
        vec3(head - 6.0, lintel + 20.0 * scale, front + 6.0 * scale),
        18.0 * scale,
    );
    mesh.material = ACCENT;
    mesh.add_box(
        vec3(head - 362.0 * scale, sill + 20.0 * scale, front - 10.0),
        vec3(head - 4.0, sill + 44.0 * scale, front + 9.0 * scale),
        3.0,
    );
    mesh.material = LAMP;
    mesh.add_box(
        vec3(
            head + 90.0 * scale,
            lintel - 30.0 * scale,
            back + 40.0 * scale,
        ),
        vec3(
            right - 90.0 * scale,
            lintel - 14.0 * scale,
            back + 66.0 * scale,
        ),
        4.0,
    );
    mesh.material = LIGHT;
    mesh.add_box(
        vec3(head - 10.0, lintel, back),
        vec3(right + 6.0, lintel + 26.0 * scale, back + 190.0 * scale),
        8.0,
    );
    mesh.material = BLACK;
    mesh.add_box(
        vec3(head - 340.0 * scale, floor, back + 20.0),
        vec3(right - 10.0, floor + 40.0 * scale, front - 30.0),
        4.0,
    );
}

fn add_front(mesh: &mut SceneMesh, cabinet: &Cabinet, floor: f32) {
    let Cabinet {
        scale,
        head,
        right,
        sill,
        lintel,
        front,
        back,
    } = *cabinet;
    mesh.step_mm = 60.0;
    mesh.material = DARK;
    mesh.add_box(
        vec3(head - 358.0 * scale, floor + 40.0 * scale, back),
        vec3(right + 4.0, sill - 8.0, front),
        12.0 * scale,
    );
    mesh.material = BRIGHT_STEEL;
    for y in [sill - 14.0 * scale, lintel + 6.0 * scale] {
        mesh.add_box(
            vec3(head - 4.0, y, front - 18.0),
            vec3(right + 120.0 * scale, y + 7.0, front - 8.0),
            2.0,
        );
    }
    // A sloping pan leads the chips down.
    mesh.material = SHEET;
    let pan = [
        (60.0 * scale, sill - 40.0 * scale),
        (front - 14.0, sill - 8.0),
        (front - 14.0, sill - 2.0),
        (60.0 * scale, sill - 30.0 * scale),
    ];
    mesh.add_side_prism(&pan, head, right - 8.0);
}

/// Returns the left and right end of the closed door along the spindle axis, mm.
fn door_span(dimensions: &LatheDimensions, cabinet: &Cabinet) -> (f32, f32) {
    (
        cabinet.head + 4.0,
        cabinet.head + 0.80 * (dimensions.bed_length - cabinet.head),
    )
}

/// Adds the frame of the closed door to the mesh.
pub fn add_door(mesh: &mut SceneMesh, dimensions: &LatheDimensions) {
    let cabinet = Cabinet::new(dimensions);
    let Cabinet {
        scale,
        sill,
        lintel,
        front,
        ..
    } = cabinet;
    let (left, right) = door_span(dimensions, &cabinet);
    let (near, far) = (front - 6.0, front + 8.0 * scale);
    let rail = 22.0 * scale;
    mesh.material = LIGHT;
    mesh.step_mm = 50.0;
    mesh.add_box(
        vec3(left, sill - 10.0, near),
        vec3(right, sill - 10.0 + rail * 1.6, far),
        5.0 * scale,
    );
    mesh.add_box(
        vec3(left, lintel - rail, near),
        vec3(right, lintel + 6.0, far),
        5.0 * scale,
    );
    mesh.add_box(
        vec3(left, sill, near),
        vec3(left + rail, lintel, far),
        5.0 * scale,
    );
    mesh.add_box(
        vec3(right - rail, sill, near),
        vec3(right, lintel, far),
        5.0 * scale,
    );
    mesh.material = BLACK;
    let grip = vec3(left + rail * 0.5, 0.0, far);
    mesh.add_tube(
        &[
            grip + vec3(0.0, -70.0 * scale, 0.0),
            grip + vec3(0.0, -64.0 * scale, 24.0 * scale),
            grip + vec3(0.0, 64.0 * scale, 24.0 * scale),
            grip + vec3(0.0, 70.0 * scale, 0.0),
        ],
        6.5 * scale,
        14,
    );
}

/// Adds the transparent pane of the closed door to the mesh.
pub fn add_pane(mesh: &mut SceneMesh, dimensions: &LatheDimensions) {
    let cabinet = Cabinet::new(dimensions);
    let (left, right) = door_span(dimensions, &cabinet);
    let Cabinet {
        sill,
        lintel,
        front,
        ..
    } = cabinet;
    mesh.material = PANE;
    mesh.step_mm = 120.0;
    mesh.add_plate(
        vec3(left, sill, front),
        vec3(right - left, 0.0, 0.0),
        vec3(0.0, lintel - sill, 0.0),
    );
}
