//! The slides: carriage and cross slide of lathes with a tool post, carriage and turret slide
//! of a slant bed, and the jet of coolant.

use core::f32::consts::PI;

use glam::{Mat4, Vec3, vec3};

use super::palette::{
    ACCENT, BENCH_GREEN, BLACK, COOLANT, DARK, GROUND_STEEL, HOSE, LIGHT, TURNED_STEEL,
};
use crate::description::{LatheDimensions, LatheKind};
use crate::mesh::SceneMesh;
use crate::placement::hand_wheels::{apron_front, apron_span};
use crate::placement::{carrier_radius, tool_scale};

/// Adds the carriage below a tool post whose axis is at x = 0.
pub fn add_carriage(mesh: &mut SceneMesh, kind: LatheKind, dimensions: &LatheDimensions) {
    let (height, scale) = (dimensions.centre_height, tool_scale(dimensions));
    let wide = dimensions.centre_height / 190.0;
    let (left, right) = (-95.0 * scale, 125.0 * scale);
    let is_bench = kind == LatheKind::Bench;
    let reach = if is_bench { 108.0 } else { 152.0 } * wide;
    let (foot, top) = apron_span(kind, dimensions);
    mesh.step_mm = 36.0;
    mesh.material = if is_bench { BENCH_GREEN } else { LIGHT };
    mesh.add_box(
        vec3(left, -height + 11.0 * wide, -reach),
        vec3(right, top, reach),
        7.0 * scale,
    );
    // The apron.
    let front = apron_front(kind, dimensions);
    let back = if is_bench { 118.0 } else { 176.0 } * wide;
    mesh.material = if is_bench { BENCH_GREEN } else { ACCENT };
    mesh.add_box(
        vec3(left + 12.0, foot, back),
        vec3(right - 12.0, top - 6.0, front),
        9.0 * scale,
    );
    mesh.material = GROUND_STEEL;
    mesh.add_box(
        vec3(-60.0 * scale, top - 1.0, -reach * 0.96),
        vec3(60.0 * scale, top + 14.0 * scale, reach * 1.08),
        2.0,
    );
    mesh.material = DARK;
    mesh.add_box(
        vec3(left + 2.0, -height + 8.0 * wide, -reach * 0.7),
        vec3(left - 8.0, -height + 30.0 * scale, reach * 0.7),
        2.0,
    );
}

/// Adds the cross slide below a tool post whose axis is at the origin.
pub fn add_cross_slide(mesh: &mut SceneMesh, kind: LatheKind, dimensions: &LatheDimensions) {
    let (height, scale) = (dimensions.centre_height, tool_scale(dimensions));
    let wide = dimensions.centre_height / 190.0;
    let half = carrier_radius(kind, dimensions);
    let (low, top) = (-height + 55.0 * scale, -height + 88.0 * scale);
    let far = 118.0 * wide;
    mesh.step_mm = 30.0;
    mesh.material = GROUND_STEEL;
    mesh.add_box(
        vec3(-64.0 * scale, low, -half - 36.0 * scale),
        vec3(64.0 * scale, top, far),
        4.0,
    );
    mesh.material = if kind == LatheKind::Bench {
        BENCH_GREEN
    } else {
        LIGHT
    };
    mesh.add_box(
        vec3(-58.0 * scale, low - 4.0, far),
        vec3(58.0 * scale, top + 8.0 * scale, far + 66.0 * scale),
        9.0 * scale,
    );
    // The column of the post.
    let shank = (26.0 * scale).max(21.0);
    let under = -shank - 22.0 * scale;
    mesh.material = GROUND_STEEL;
    mesh.add_upright(
        vec3(0.0, top, 0.0),
        &[
            (-1.0, half * 1.16),
            ((under - top) * 0.35, half * 1.16),
            ((under - top) * 0.35 + 4.0, half * 1.08),
            (under - top - 6.0, half * 0.90),
            (under - top + 1.0, half * 0.90),
        ],
        56,
    );
    add_hose(
        mesh,
        // At the side of the tailstock: the operator sees the tool beside the hose.
        vec3(90.0 * scale, top, -0.2 * half),
        vec3(-half + 26.0 * scale, 60.0 * scale, -half - 8.0 * scale),
        scale,
    );
}

/// Adds an articulated coolant hose from `foot` to `nozzle`.
fn add_hose(mesh: &mut SceneMesh, foot: Vec3, nozzle: Vec3, scale: f32) {
    let high = nozzle.y.max(foot.y) + 60.0 * scale;
    let control = [
        foot,
        vec3(foot.x * 1.3, high, foot.z),
        vec3(nozzle.x, high + 20.0 * scale, nozzle.z + 40.0 * scale),
        nozzle,
    ];
    let at = |t: f32| {
        let s = 1.0 - t;
        control[0] * (s * s * s)
            + control[1] * (3.0 * s * s * t)
            + control[2] * (3.0 * s * t * t)
            + control[3] * (t * t * t)
    };
    let links = 26;
    for link in 0..links {
        let (from, to) = (link as f32 / links as f32, (link + 1) as f32 / links as f32);
        mesh.material = if link + 1 == links { BLACK } else { HOSE };
        let radius = if link % 2 == 0 { 7.6 } else { 6.4 } * scale;
        mesh.add_tube(&[at(from), at((from + to) * 0.5), at(to)], radius, 10);
    }
}

/// Adds the carriage of a slant bed, in the tilted frame of the tools, below a turret whose centre
/// is at x = 0.
pub fn add_slant_carriage(mesh: &mut SceneMesh, dimensions: &LatheDimensions) {
    let (scale, wide) = (tool_scale(dimensions), dimensions.centre_height / 190.0);
    mesh.step_mm = 36.0;
    mesh.material = DARK;
    mesh.add_box(
        vec3(40.0 * scale, 128.0 * wide, 10.0 * wide),
        vec3(300.0 * scale, 160.0 * wide, 390.0 * wide),
        7.0,
    );
    mesh.material = GROUND_STEEL;
    for x in [66.0, 240.0] {
        mesh.add_box(
            vec3(x * scale, 118.0 * wide, 16.0 * wide),
            vec3((x + 34.0) * scale, 130.0 * wide, 384.0 * wide),
            2.0,
        );
    }
}

/// Adds the slide that carries the turret, in the tilted frame of the tools.
pub fn add_turret_slide(mesh: &mut SceneMesh, dimensions: &LatheDimensions) {
    let (scale, wide) = (tool_scale(dimensions), dimensions.centre_height / 190.0);
    let radius = carrier_radius(LatheKind::SlantBed, dimensions);
    let face = 58.0 * scale;
    mesh.step_mm = 32.0;
    mesh.material = LIGHT;
    mesh.add_box(
        vec3(face + 14.0, -radius * 0.72, -radius * 0.62),
        vec3(face + 190.0 * scale, 116.0 * wide, radius * 0.9),
        10.0 * scale,
    );
    mesh.material = TURNED_STEEL;
    mesh.add_revolve(
        &[(face - 1.0, radius * 0.66), (face + 15.0, radius * 0.66)],
        56,
    );
    mesh.material = ACCENT;
    mesh.add_box(
        vec3(face + 40.0 * scale, -radius * 0.74 - 2.0, -radius * 0.5),
        vec3(face + 160.0 * scale, -radius * 0.70, radius * 0.7),
        2.0,
    );
    mesh.material = BLACK;
    let motor = 42.0 * scale;
    mesh.within(
        Mat4::from_translation(vec3(face + 190.0 * scale, 0.0, 0.0)),
        |mesh| {
            mesh.add_revolve(
                &[
                    (-1.0, motor),
                    (64.0 * scale, motor),
                    (70.0 * scale, motor * 0.9),
                    (70.0 * scale, 0.0),
                ],
                36,
            );
        },
    );
    // The coolant pipe passes the turret on the operator's side.
    mesh.material = HOSE;
    let front = -radius * 0.5;
    let pipe = [
        vec3(face + 20.0, front, -radius * 0.55),
        vec3(face + 20.0, front, -radius - 18.0 * scale),
        vec3(face + 4.0, front, -radius - 30.0 * scale),
        vec3(24.0 * scale, front, -radius - 34.0 * scale),
    ];
    mesh.add_tube(&pipe, 5.5 * scale, 12);
}

/// Adds three coolant jets that meet at the tool tip, in the tilted frame of the tools.
pub fn add_jet(mesh: &mut SceneMesh, kind: LatheKind, dimensions: &LatheDimensions) {
    let scale = tool_scale(dimensions);
    // On a slant bed the rake face is away from the operator, the pipe on his side.
    let side = if kind == LatheKind::SlantBed {
        -1.0
    } else {
        1.0
    };
    mesh.material = COOLANT;
    for jet in [-1.0, 0.0, 1.0] {
        let from = vec3(26.0 + jet * 2.0, 92.0 * side, 44.0) * scale;
        let line: Vec<Vec3> = (0..14)
            .map(|at| {
                let t = at as f32 / 13.0;
                let mut point = from.lerp(vec3(jet * 3.5, 2.0 * side, -2.0), t);
                point.y += 15.0 * side * scale * (t * PI).sin();
                point
            })
            .collect();
        mesh.add_tube(&line, 1.9 * scale.max(0.7), 8);
    }
}
