//! The bench lathe: a narrow bed on feet, a small headstock with a belt cover, a work bench.

use core::f32::consts::PI;

use glam::{Mat4, vec3};

use super::flat_bed::add_spindle_nose;
use super::floor_y;
use super::palette::{
    BENCH_GREEN, BENCH_TOP, BLACK, BRIGHT_STEEL, DARK, GROUND_STEEL, LIGHT, SHEET, TURNED_STEEL,
};
use super::tower::add_tower;
use crate::description::{LatheDimensions, LatheKind};
use crate::mesh::{SceneMaterial, SceneMesh};

/// Adds the stationary parts of a bench lathe to the mesh.
pub fn add_fixed(mesh: &mut SceneMesh, dimensions: &LatheDimensions) {
    let scale = dimensions.centre_height / 190.0;
    let head = -dimensions.chuck_length - 26.0;
    let right = dimensions.bed_length + 30.0 * scale;
    let left = head - 300.0 * scale;
    let floor = floor_y(LatheKind::Bench, dimensions);
    // The bench.
    mesh.material = BENCH_TOP;
    mesh.step_mm = 60.0;
    mesh.add_box(
        vec3(left - 220.0 * scale, floor - 46.0 * scale, -420.0 * scale),
        vec3(right + 240.0 * scale, floor, 400.0 * scale),
        5.0,
    );
    mesh.material = DARK;
    for x in [left - 160.0 * scale, right + 120.0 * scale] {
        for z in [-360.0, 290.0] {
            mesh.add_box(
                vec3(x, floor - 640.0 * scale, z * scale),
                vec3(x + 60.0 * scale, floor - 46.0 * scale, (z + 60.0) * scale),
                4.0,
            );
        }
    }
    // Tray and feet.
    mesh.material = SHEET;
    mesh.add_box(
        vec3(left, floor, -200.0 * scale),
        vec3(right, floor + 12.0 * scale, 215.0 * scale),
        4.0,
    );
    mesh.add_box(
        vec3(left, floor, 208.0 * scale),
        vec3(right, floor + 34.0 * scale, 216.0 * scale),
        3.0,
    );
    mesh.add_box(
        vec3(left, floor, -206.0 * scale),
        vec3(right, floor + 320.0 * scale, -200.0 * scale),
        3.0,
    );
    add_bed(mesh, dimensions, head, scale);
    add_headstock(mesh, dimensions, head, scale);
    add_spindle_nose(mesh, dimensions);
    add_tower(mesh, LatheKind::Bench, dimensions);
}

fn add_bed(mesh: &mut SceneMesh, dimensions: &LatheDimensions, head: f32, scale: f32) {
    let (top, right) = (-dimensions.centre_height, dimensions.bed_length);
    let floor = floor_y(LatheKind::Bench, dimensions);
    mesh.step_mm = 40.0;
    mesh.material = BENCH_GREEN;
    let section: Vec<(f32, f32)> = [
        (-78.0, -12.0),
        (-78.0, -34.0),
        (-46.0, -62.0),
        (-46.0, -104.0),
        (46.0, -104.0),
        (46.0, -62.0),
        (78.0, -34.0),
        (78.0, -12.0),
    ]
    .iter()
    .map(|&(z, y)| (z * scale, top + y * scale))
    .collect();
    mesh.add_side_prism(&section, head - 10.0, right);
    for x in [head - 150.0 * scale, right - 130.0 * scale] {
        mesh.add_box(
            vec3(x, floor, -110.0 * scale),
            vec3(x + 130.0 * scale, top - 90.0 * scale, 110.0 * scale),
            12.0 * scale,
        );
    }
    mesh.material = GROUND_STEEL;
    mesh.step_mm = 30.0;
    for z in [-60.0, 60.0] {
        let way: Vec<(f32, f32)> = [
            (-20.0, -14.0),
            (20.0, -14.0),
            (20.0, 0.0),
            (10.0, 9.0),
            (-10.0, 9.0),
            (-20.0, 0.0),
        ]
        .iter()
        .map(|&(side, up)| ((z + side) * scale, top + up * scale))
        .collect();
        mesh.add_side_prism(&way, head, right);
    }
    mesh.material = TURNED_STEEL;
    let frame = Mat4::from_translation(vec3(0.0, top - 52.0 * scale, 104.0 * scale));
    let radius = 11.0 * scale;
    let mut outline = vec![(head, 0.0), (head, radius)];
    let mut x = head + 5.0;
    while x < right - 30.0 {
        outline.extend([
            (x, radius),
            (x + 4.0 * scale, radius * 0.78),
            (x + 8.0 * scale, radius),
        ]);
        x += 9.0 * scale;
    }
    outline.extend([(right - 6.0, radius), (right - 6.0, 0.0)]);
    mesh.within(frame, |mesh| mesh.add_revolve(&outline, 12));
    mesh.material = BENCH_GREEN;
    for x in [head - 4.0, right - 26.0] {
        mesh.add_box(
            vec3(x, top - 80.0 * scale, 40.0 * scale),
            vec3(x + 26.0, top - 26.0 * scale, 122.0 * scale),
            4.0,
        );
    }
}

fn add_headstock(mesh: &mut SceneMesh, dimensions: &LatheDimensions, head: f32, scale: f32) {
    let (height, left) = (dimensions.centre_height, head - 190.0 * scale);
    let half = dimensions.chuck_diameter * 0.62;
    mesh.step_mm = 32.0;
    mesh.material = BENCH_GREEN;
    let mut section = vec![
        (-half, -height - 60.0 * scale),
        (half, -height - 60.0 * scale),
    ];
    section.extend((0..=10).map(|at| {
        let (sine, cosine) = (at as f32 / 10.0 * PI).sin_cos();
        (half * cosine, half * 0.35 + half * 0.75 * sine)
    }));
    mesh.add_side_prism(&section, left, head);
    // The cover of the belt, at the left.
    mesh.material = LIGHT;
    mesh.add_box(
        vec3(left - 100.0 * scale, -height * 1.2, -half * 1.35),
        vec3(left - 4.0, half * 1.35, half * 1.2),
        26.0 * scale,
    );
    mesh.material = BLACK;
    for slat in 0..6 {
        let y = half * (0.9 - slat as f32 * 0.22);
        mesh.add_box(
            vec3(left - 80.0 * scale, y, half * 1.2 - 1.0),
            vec3(left - 26.0 * scale, y + half * 0.09, half * 1.2 + 1.5),
            0.6,
        );
    }
    // Switch box with two buttons and the emergency stop.
    let front = half + 0.5;
    mesh.add_box(
        vec3(left + 26.0 * scale, -height * 0.55, front - 12.0),
        vec3(head - 26.0 * scale, half * 0.10, front + 14.0 * scale),
        5.0,
    );
    let face = front + 14.0 * scale;
    let middle = (left + head) * 0.5;
    let size = 15.0 * scale;
    for (shift, y, color) in [
        (-34.0, -0.10, [48, 150, 76]),
        (34.0, -0.10, [206, 206, 202]),
        (0.0, -0.36, [204, 36, 30]),
    ] {
        mesh.material = SceneMaterial::paint(color[0], color[1], color[2]).glowing(24);
        mesh.add_facing(
            vec3(middle + shift * scale, height * y, face),
            &[
                (-1.0, size),
                (9.0 * scale, size),
                (12.0 * scale, size * 0.8),
                (12.0 * scale, 0.0),
            ],
            28,
        );
    }
    // The gear lever.
    mesh.material = BRIGHT_STEEL;
    let base = vec3(middle, half * 0.62, half * 0.92);
    mesh.add_tube(
        &[
            base,
            base + vec3(24.0, 26.0, 34.0) * scale,
            base + vec3(40.0, 34.0, 62.0) * scale,
        ],
        5.0 * scale,
        14,
    );
    mesh.material = BLACK;
    mesh.add_upright(
        base + vec3(40.0, 22.0, 62.0) * scale,
        &[
            (0.0, 0.0),
            (2.0, 9.0 * scale),
            (18.0 * scale, 11.0 * scale),
            (24.0 * scale, 6.0 * scale),
            (24.0 * scale, 0.0),
        ],
        20,
    );
}
