//! The chuck with its jaws, and the guard above it.

use core::f32::consts::{PI, TAU};

use glam::{Mat4, vec3};

use super::palette::{ACCENT, BENCH_GREEN, BLACK, HOLDER_STEEL, JAW_STEEL, PANE, TURNED_STEEL};
use crate::description::{LatheDimensions, LatheKind};
use crate::mesh::SceneMesh;

/// Distance of the guard from the chuck, mm.
const GUARD_GAP_MM: f32 = 22.0;

/// Adds the body of a three-jaw chuck with its front at x = 0.
pub fn add_body(mesh: &mut SceneMesh, dimensions: &LatheDimensions) {
    let (radius, length) = (dimensions.chuck_diameter * 0.5, dimensions.chuck_length);
    let edge = (radius * 0.035).clamp(1.0, 5.0);
    let groove = length * 0.55;
    let bore = radius * 0.24;
    mesh.material = TURNED_STEEL;
    mesh.add_revolve(
        &[
            (-length - 26.0, 0.0),
            (-length - 26.0, radius * 0.62),
            (-length, radius * 0.66),
            (-length, radius - edge),
            (-length + edge, radius),
            (-groove - 3.0, radius),
            (-groove - 1.5, radius - 2.0),
            (-groove, radius),
            (-edge, radius),
            (0.0, radius - edge),
            (0.0, bore + 2.0),
            (-2.0, bore),
            (-length * 0.7, bore),
            (-length * 0.7, 0.0),
        ],
        88,
    );
    for jaw in 0..3 {
        let turn = Mat4::from_rotation_x(jaw as f32 * TAU / 3.0);
        mesh.within(turn, |mesh| {
            let half = radius * 0.115;
            mesh.material = HOLDER_STEEL;
            mesh.step_mm = 12.0;
            mesh.add_box(
                vec3(-4.0, bore + 3.0, -half),
                vec3(0.5, radius - edge, half),
                0.4,
            );
        });
        // Sockets of the chuck key, and screws of the front.
        let between = Mat4::from_rotation_x((jaw as f32 + 0.5) * TAU / 3.0);
        mesh.within(between, |mesh| {
            mesh.material = BLACK;
            let size = radius * 0.075;
            let socket = [
                (-3.0, 0.0),
                (-3.0, size),
                (0.8, size),
                (0.8, size * 0.55),
                (-2.5, size * 0.5),
                (-2.5, 0.0),
            ];
            mesh.add_upright(vec3(-length * 0.30, radius, 0.0), &socket, 20);
            let screw = radius * 0.05;
            let head = [
                (0.0, screw),
                (0.7, screw),
                (0.7, screw * 0.6),
                (0.2, screw * 0.55),
                (0.2, 0.0),
            ];
            mesh.within(
                Mat4::from_translation(vec3(0.0, radius * 0.72, 0.0)),
                |mesh| {
                    mesh.add_revolve(&head, 16);
                },
            );
        });
    }
}

/// Adds a jaw with two steps to the mesh. Its gripping face is at y = 0, its front at x = the jaw
/// length.
pub fn add_jaw(mesh: &mut SceneMesh, dimensions: &LatheDimensions) {
    let (length, height) = (dimensions.jaw_length, dimensions.jaw_height);
    let half = (dimensions.chuck_diameter * 0.055).max(3.0);
    mesh.material = JAW_STEEL;
    mesh.step_mm = 12.0;
    let steps = [
        (0.4, 0.0),
        (length - 1.0, 0.0),
        (length, 1.0),
        (length, height * 0.42),
        (length * 0.68, height * 0.42),
        (length * 0.68, height * 0.74),
        (length * 0.38, height * 0.74),
        (length * 0.38, height),
        (0.4, height),
    ];
    mesh.add_prism(&steps, -half, half);
    mesh.material = BLACK;
    let screw = (half * 0.5).min(height * 0.12);
    for (x, y) in [(length * 0.68, 0.58), (length * 0.38, 0.87)] {
        let head = [
            (0.0, screw),
            (0.5, screw),
            (0.5, screw * 0.6),
            (-1.5, screw * 0.55),
            (-1.5, 0.0),
        ];
        mesh.within(Mat4::from_translation(vec3(x, height * y, 0.0)), |mesh| {
            mesh.add_revolve(&head, 16);
        });
    }
}

fn guard_radius(dimensions: &LatheDimensions) -> f32 {
    dimensions.chuck_diameter * 0.5 + GUARD_GAP_MM
}

/// Returns the points (z, y) of an arc about the spindle axis, from the back over the top to the
/// front.
fn guard_arc(radius: f32) -> Vec<(f32, f32)> {
    (0..=20)
        .map(|at| {
            let angle = -0.25 + (PI * 0.78 + 0.25) * at as f32 / 20.0;
            (-radius * angle.cos(), radius * angle.sin())
        })
        .collect()
}

/// Returns the outline of a bent sheet of metal along the arc of the chuck guard.
fn guard_sheet(radius: f32, thickness: f32) -> Vec<(f32, f32)> {
    let mut outline = guard_arc(radius);
    let mut inner = guard_arc(radius - thickness);
    inner.reverse();
    outline.extend(inner);
    outline
}

/// Adds the curved bars of the chuck guard.
pub fn add_guard_frame(mesh: &mut SceneMesh, kind: LatheKind, dimensions: &LatheDimensions) {
    let radius = guard_radius(dimensions);
    mesh.material = match kind {
        LatheKind::Bench => BENCH_GREEN,
        LatheKind::FlatBed | LatheKind::SlantBed => ACCENT,
    };
    mesh.add_side_prism(
        &guard_sheet(radius + 2.0, 7.0),
        -dimensions.chuck_length - 8.0,
        -dimensions.chuck_length + 8.0,
    );
    mesh.add_side_prism(&guard_sheet(radius + 1.0, 4.0), 2.0, 9.0);
    mesh.material = BLACK;
    let end = guard_arc(radius).last().copied().unwrap_or_default();
    mesh.add_box(
        vec3(-dimensions.chuck_length - 8.0, end.1 - 5.0, end.0 - 4.0),
        vec3(9.0, end.1 + 5.0, end.0 + 8.0),
        2.0,
    );
}

/// Adds the transparent pane of the chuck guard.
pub fn add_guard_pane(mesh: &mut SceneMesh, dimensions: &LatheDimensions) {
    let radius = guard_radius(dimensions);
    let arc = guard_arc(radius);
    mesh.material = PANE;
    let (left, right) = (-dimensions.chuck_length + 8.0, 3.0);
    for ends in arc.windows(2) {
        let corner = |x: f32, at: (f32, f32)| vec3(x, at.1, at.0);
        let normal = |at: (f32, f32)| vec3(0.0, at.1, at.0);
        let first = mesh.add_vertex(corner(left, ends[0]), normal(ends[0]));
        mesh.add_vertex(corner(right, ends[0]), normal(ends[0]));
        mesh.add_vertex(corner(right, ends[1]), normal(ends[1]));
        mesh.add_vertex(corner(left, ends[1]), normal(ends[1]));
        mesh.add_triangle([first, first + 1, first + 2]);
        mesh.add_triangle([first, first + 2, first + 3]);
    }
}
