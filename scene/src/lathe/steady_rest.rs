//! The steady rest: a ring on the bed, and the jaws that support the part.

use glam::{Mat4, vec3};

use super::palette::{ACCENT, BENCH_GREEN, BLACK, BRIGHT_STEEL, BRONZE, DARK};
use crate::description::{LatheDimensions, LatheKind};
use crate::mesh::SceneMesh;
use crate::placement::{steady_jaw_turn, steady_ring, tool_scale};

/// Half the width of the ring along the axis, mm.
const HALF_WIDTH_MM: f32 = 15.0;
/// Length of the bronze tip of a jaw, mm.
const TIP_MM: f32 = 14.0;

/// Adds ring and foot of the steady rest at its distance from the chuck; nothing without a steady
/// rest.
pub fn add_body(mesh: &mut SceneMesh, kind: LatheKind, dimensions: &LatheDimensions) {
    let Some(x) = dimensions.steady_rest else {
        return;
    };
    let (scale, height) = (tool_scale(dimensions), dimensions.centre_height);
    let (inner, outer) = steady_ring(dimensions);
    let half = HALF_WIDTH_MM * scale;
    mesh.step_mm = 30.0;
    mesh.material = match kind {
        LatheKind::Bench => BENCH_GREEN,
        LatheKind::FlatBed | LatheKind::SlantBed => ACCENT,
    };
    let edge = 3.0 * scale;
    let ring = [
        (-half, inner),
        (-half, outer - edge),
        (-half + edge, outer),
        (half - edge, outer),
        (half, outer - edge),
        (half, inner),
        (-half, inner),
    ];
    mesh.within(Mat4::from_translation(vec3(x, 0.0, 0.0)), |mesh| {
        mesh.add_revolve(&ring, 72);
        let bed = match kind {
            LatheKind::SlantBed => -height * 0.86,
            LatheKind::FlatBed | LatheKind::Bench => -height + 8.0 * scale,
        };
        mesh.add_box(
            vec3(-half * 0.9, bed + 10.0 * scale, -inner * 0.62),
            vec3(half * 0.9, -inner * 0.86, inner * 0.62),
            4.0 * scale,
        );
        mesh.material = DARK;
        mesh.add_box(
            vec3(-half * 2.0, bed, -inner * 1.05),
            vec3(half * 2.0, bed + 16.0 * scale, inner * 1.05),
            4.0 * scale,
        );
        // The hinge of the upper half, and the guides of the jaws.
        mesh.material = BLACK;
        mesh.add_box(
            vec3(-half * 1.2, -8.0 * scale, -outer - 10.0 * scale),
            vec3(half * 1.2, 8.0 * scale, -outer + 4.0 * scale),
            3.0,
        );
        for jaw in 0..3 {
            mesh.within(steady_jaw_turn(jaw), |mesh| {
                mesh.add_box(
                    vec3(-half * 1.1, inner - 6.0 * scale, -13.0 * scale),
                    vec3(half * 1.1, outer + 12.0 * scale, 13.0 * scale),
                    3.0,
                );
            });
        }
    });
}

/// Adds a jaw that points up, with its tip at the origin.
pub fn add_jaw(mesh: &mut SceneMesh, dimensions: &LatheDimensions) {
    if dimensions.steady_rest.is_none() {
        return;
    }
    let (scale, (_, outer)) = (tool_scale(dimensions), steady_ring(dimensions));
    let radius = 7.0 * scale;
    mesh.step_mm = 20.0;
    mesh.material = BRONZE;
    mesh.add_upright(
        vec3(0.0, 0.0, 0.0),
        &[
            (0.0, 0.0),
            (0.0, radius * 0.8),
            (TIP_MM * scale, radius),
            (TIP_MM * scale, 0.0),
        ],
        20,
    );
    mesh.material = BRIGHT_STEEL;
    mesh.add_upright(
        vec3(0.0, TIP_MM * scale, 0.0),
        &[
            (0.0, radius),
            (outer, radius),
            (outer, radius * 1.7),
            (outer + 12.0 * scale, radius * 1.7),
            (outer + 12.0 * scale, 0.0),
        ],
        20,
    );
}
