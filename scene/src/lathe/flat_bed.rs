//! The flat bed lathe: bed, headstock, base, splash wall.

use glam::{Mat4, vec3};

use super::control_panel::add_control_panel;
use super::floor_y;
use super::palette::{ACCENT, BLACK, DARK, GROUND_STEEL, LAMP, LIGHT, SHEET, TURNED_STEEL};
use super::tower::add_tower;
use crate::description::{LatheDimensions, LatheKind};
use crate::mesh::SceneMesh;

/// Adds the stationary parts of a flat bed lathe to the mesh.
pub fn add_fixed(mesh: &mut SceneMesh, dimensions: &LatheDimensions) {
    let scale = dimensions.centre_height / 190.0;
    let head = -dimensions.chuck_length - 26.0;
    add_base(mesh, dimensions, head, scale);
    add_bed(mesh, dimensions, head, scale);
    add_headstock(mesh, dimensions, head, scale);
    add_spindle_nose(mesh, dimensions);
    add_wall(mesh, dimensions, head, scale);
    add_tower(mesh, LatheKind::FlatBed, dimensions);
}

fn add_base(mesh: &mut SceneMesh, dimensions: &LatheDimensions, head: f32, scale: f32) {
    let (floor, height) = (
        floor_y(LatheKind::FlatBed, dimensions),
        dimensions.centre_height,
    );
    let (left, right) = (head - 330.0 * scale, dimensions.bed_length + 30.0 * scale);
    let tray = -height - 200.0 * scale;
    mesh.step_mm = 60.0;
    mesh.material = BLACK;
    mesh.add_box(
        vec3(left + 25.0, floor, -175.0 * scale),
        vec3(right - 25.0, floor + 40.0 * scale, 165.0 * scale),
        4.0,
    );
    mesh.material = DARK;
    mesh.add_box(
        vec3(left, floor + 40.0 * scale, -195.0 * scale),
        vec3(right, tray - 12.0, 190.0 * scale),
        10.0,
    );
    mesh.material = ACCENT;
    mesh.add_box(
        vec3(left + 2.0, tray - 62.0 * scale, 186.0 * scale),
        vec3(right - 2.0, tray - 40.0 * scale, 194.0 * scale),
        3.0,
    );
    // The chip tray.
    mesh.material = SHEET;
    let (near, far) = (255.0 * scale, -255.0 * scale);
    mesh.add_box(
        vec3(head - 20.0, tray - 10.0, far),
        vec3(right + 12.0, tray, near),
        2.0,
    );
    mesh.add_box(
        vec3(head - 20.0, tray, near - 6.0),
        vec3(right + 12.0, tray + 46.0 * scale, near),
        2.0,
    );
    mesh.add_box(
        vec3(right + 4.0, tray, far),
        vec3(right + 12.0, tray + 46.0 * scale, near),
        2.0,
    );
}

fn add_bed(mesh: &mut SceneMesh, dimensions: &LatheDimensions, head: f32, scale: f32) {
    let (top, right) = (-dimensions.centre_height, dimensions.bed_length);
    let foot = top - 190.0 * scale;
    mesh.step_mm = 44.0;
    mesh.material = LIGHT;
    for (near, far) in [(70.0, 128.0), (-128.0, -70.0)] {
        mesh.add_box(
            vec3(head - 20.0, foot, near * scale),
            vec3(right, top - 12.0 * scale, far * scale),
            7.0 * scale,
        );
    }
    let pitch = 150.0 * scale;
    let mut x = head;
    while x < right {
        mesh.add_box(
            vec3(x, foot, -72.0 * scale),
            vec3(x + 34.0 * scale, top - 30.0 * scale, 72.0 * scale),
            5.0 * scale,
        );
        x += pitch;
    }
    mesh.material = GROUND_STEEL;
    mesh.step_mm = 30.0;
    for z in [-100.0, 100.0] {
        let way: Vec<(f32, f32)> = [
            (-30.0, -14.0),
            (30.0, -14.0),
            (30.0, -4.0),
            (14.0, 10.0),
            (-14.0, 10.0),
            (-30.0, -4.0),
        ]
        .iter()
        .map(|&(side, up)| ((z + side) * scale, top + up * scale))
        .collect();
        mesh.add_side_prism(&way, head, right);
    }
    // Lead screw and feed rod in front of the bed.
    mesh.material = TURNED_STEEL;
    for (y, radius, is_screw) in [(-62.0, 12.0, true), (-108.0, 8.5, false)] {
        let frame = Mat4::from_translation(vec3(0.0, top + y * scale, 158.0 * scale));
        let radius = radius * scale;
        let mut outline = vec![(head, 0.0), (head, radius)];
        if is_screw {
            let pitch = 11.0 * scale;
            let mut x = head + 6.0;
            while x + pitch < right - 30.0 {
                outline.extend([
                    (x, radius),
                    (x + pitch * 0.3, radius * 0.8),
                    (x + pitch * 0.6, radius * 0.8),
                    (x + pitch * 0.9, radius),
                ]);
                x += pitch;
            }
        }
        outline.extend([(right - 12.0, radius), (right - 12.0, 0.0)]);
        mesh.within(frame, |mesh| {
            mesh.add_revolve(&outline, if is_screw { 12 } else { 20 });
        });
    }
    mesh.material = DARK;
    mesh.add_box(
        vec3(right - 30.0, top - 135.0 * scale, 126.0 * scale),
        vec3(right, top - 30.0 * scale, 182.0 * scale),
        6.0,
    );
}

fn add_headstock(mesh: &mut SceneMesh, dimensions: &LatheDimensions, head: f32, scale: f32) {
    let height = dimensions.centre_height;
    let left = head - 320.0 * scale;
    let top = height * 0.96;
    mesh.step_mm = 40.0;
    mesh.material = LIGHT;
    let (near, far) = (168.0 * scale, -168.0 * scale);
    mesh.add_box(
        vec3(left, -height - 150.0 * scale, far),
        vec3(head, top, near),
        16.0 * scale,
    );
    mesh.material = ACCENT;
    mesh.add_box(
        vec3(left + 5.0, top - 4.0, far + 6.0),
        vec3(head - 5.0, top + 10.0 * scale, near - 6.0),
        5.0 * scale,
    );
    mesh.add_box(
        vec3(left + 4.0, -height * 0.62, near - 4.0),
        vec3(head - 4.0, -height * 0.52, near + 3.0),
        2.0,
    );
    mesh.material = DARK;
    mesh.add_box(
        vec3(left - 4.0, -height - 152.0 * scale, far + 4.0),
        vec3(head - 14.0, -height * 0.66, near + 4.0),
        10.0 * scale,
    );
    add_control_panel(mesh, LatheKind::FlatBed, dimensions);
}

/// Adds the spindle nose between headstock and chuck.
pub fn add_spindle_nose(mesh: &mut SceneMesh, dimensions: &LatheDimensions) {
    let (radius, length) = (dimensions.chuck_diameter * 0.5, dimensions.chuck_length);
    mesh.material = TURNED_STEEL;
    let back = -length - 27.0;
    mesh.add_revolve(
        &[
            (back - 8.0, radius * 0.9),
            (back + 4.0, radius * 0.9),
            (back + 7.0, radius * 0.86),
            (back + 7.0, radius * 0.6),
            (-length - 4.0, radius * 0.6),
        ],
        64,
    );
}

fn add_wall(mesh: &mut SceneMesh, dimensions: &LatheDimensions, head: f32, scale: f32) {
    let height = dimensions.centre_height;
    let right = dimensions.bed_length + 42.0 * scale;
    let (foot, top) = (-height - 200.0 * scale, height * 1.55);
    let back = -262.0 * scale;
    mesh.step_mm = 55.0;
    mesh.material = SHEET;
    mesh.add_box(
        vec3(head - 10.0, foot, back),
        vec3(right, top, back + 8.0),
        3.0,
    );
    mesh.material = LIGHT;
    mesh.add_box(
        vec3(head - 14.0, top - 6.0, back - 2.0),
        vec3(right + 4.0, top + 16.0 * scale, back + 96.0 * scale),
        6.0,
    );
    mesh.add_box(
        vec3(right - 6.0, foot, back),
        vec3(right + 4.0, top, back + 60.0 * scale),
        4.0,
    );
    mesh.material = LAMP;
    mesh.add_box(
        vec3(
            head + 120.0 * scale,
            top - 14.0 * scale,
            back + 50.0 * scale,
        ),
        vec3(right - 90.0 * scale, top - 4.0, back + 74.0 * scale),
        4.0,
    );
    // Ribs of the sheet.
    mesh.material = SHEET;
    let mut x = head + 160.0 * scale;
    while x < right - 60.0 {
        mesh.add_box(
            vec3(x, foot, back + 6.0),
            vec3(x + 9.0 * scale, top - 8.0, back + 13.0),
            2.5,
        );
        x += 190.0 * scale;
    }
}
