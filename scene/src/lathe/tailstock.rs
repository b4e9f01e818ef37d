//! The tailstock: body and quill.

use glam::{Mat4, vec3};

use super::palette::{ACCENT, BENCH_GREEN, BRIGHT_STEEL, DARK, LIGHT, TURNED_STEEL};
use crate::description::{LatheDimensions, LatheKind};
use crate::mesh::SceneMesh;
use crate::placement::hand_wheels::tailstock_length;
use crate::placement::tool_scale;

/// Default diameter of the quill, as a fraction of the centre height.
const USUAL_QUILL_SHARE: f32 = 0.30;

/// Adds the body of the tailstock with its front at x = 0.
pub fn add_body(mesh: &mut SceneMesh, kind: LatheKind, dimensions: &LatheDimensions) {
    let (height, scale) = (dimensions.centre_height, tool_scale(dimensions));
    let (length, half) = (tailstock_length(dimensions), 58.0 * scale);
    let paint = if kind == LatheKind::Bench {
        BENCH_GREEN
    } else {
        LIGHT
    };
    mesh.step_mm = 26.0;
    mesh.material = paint;
    let foot = -height * 0.70;
    let shape = [
        (-1.25, foot),
        (1.25, foot),
        (1.12, -0.30 * height),
        (0.92, 0.16 * height),
        (0.55, 0.27 * height),
        (0.0, 0.30 * height),
        (-0.55, 0.27 * height),
        (-0.92, 0.16 * height),
        (-1.12, -0.30 * height),
    ];
    let shape: Vec<(f32, f32)> = shape.iter().map(|&(z, y)| (z * half, y)).collect();
    mesh.add_side_prism(&shape, 0.0, length);
    mesh.material = if kind == LatheKind::Bench {
        DARK
    } else {
        ACCENT
    };
    let base = match kind {
        LatheKind::SlantBed => vec3(-12.0, -height * 0.86, -half * 2.1),
        LatheKind::FlatBed | LatheKind::Bench => vec3(-12.0, -height + 8.0 * scale, -half * 1.9),
    };
    mesh.add_box(
        base,
        vec3(length + 6.0, foot + 2.0, half * 1.9),
        6.0 * scale,
    );
    mesh.material = TURNED_STEEL;
    let ring = 40.0 * scale;
    mesh.add_revolve(
        &[
            (-10.0 * scale, 0.0),
            (-10.0 * scale, ring - 3.0),
            (-7.0 * scale, ring),
            (1.0, ring),
        ],
        48,
    );
    if kind == LatheKind::SlantBed {
        return;
    }
    // The clamping lever of the quill.
    mesh.material = BRIGHT_STEEL;
    let frame = Mat4::from_translation(vec3(length * 0.4, 0.22 * height, half * 0.3))
        * Mat4::from_rotation_x(0.5);
    mesh.within(frame, |mesh| {
        let handle = 8.0 * scale;
        mesh.add_upright(
            vec3(0.0, 0.0, 0.0),
            &[
                (0.0, handle),
                (52.0 * scale, handle * 0.7),
                (54.0 * scale, handle * 1.2),
                (74.0 * scale, handle * 1.3),
                (78.0 * scale, 0.0),
            ],
            22,
        );
    });
}

/// Adds quill and centre, with the point of the centre at x = 0.
pub fn add_quill(mesh: &mut SceneMesh, dimensions: &LatheDimensions, diameter: Option<f32>) {
    let usual = dimensions.centre_height * USUAL_QUILL_SHARE;
    let radius = diameter
        .filter(|it| it.is_finite())
        .unwrap_or(usual)
        .clamp(6.0, 300.0)
        * 0.5;
    let cone = radius * 0.62 * 1.732;
    let length = 240.0 * tool_scale(dimensions);
    mesh.material = TURNED_STEEL;
    mesh.add_revolve(
        &[
            (0.0, 0.0),
            (cone, radius * 0.62),
            (cone + 14.0, radius * 0.62),
            (cone + 14.0, radius * 0.80),
            (cone + 17.0, radius * 0.80),
            (cone + 17.0, radius - 1.5),
            (cone + 18.5, radius),
            (cone + length, radius),
            (cone + length, 0.0),
        ],
        48,
    );
}
