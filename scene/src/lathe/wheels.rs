//! Hand wheels, each about the x axis, which points to the one who turns it.

use core::f32::consts::TAU;

use glam::{Mat4, vec3};

use super::palette::{BLACK, BRIGHT_STEEL, DARK};
use crate::description::{LatheDimensions, LatheKind};
use crate::mesh::{SceneMaterial, SceneMesh};
use crate::placement::tool_scale;

/// Adds the hand wheel on the apron.
pub fn add_carriage_wheel(mesh: &mut SceneMesh, kind: LatheKind, dimensions: &LatheDimensions) {
    let radius = match kind {
        LatheKind::Bench => 52.0,
        LatheKind::FlatBed | LatheKind::SlantBed => 58.0,
    };
    let wide = dimensions.centre_height / 190.0;
    add_hand_wheel(mesh, radius * wide, tool_scale(dimensions));
}

/// Adds the hand wheel of the cross slide.
pub fn add_cross_wheel(mesh: &mut SceneMesh, dimensions: &LatheDimensions) {
    let wide = dimensions.centre_height / 190.0;
    add_hand_wheel(mesh, 36.0 * wide, tool_scale(dimensions));
}

/// Adds the hand wheel of the tailstock.
pub fn add_tailstock_wheel(mesh: &mut SceneMesh, dimensions: &LatheDimensions) {
    let scale = tool_scale(dimensions);
    add_hand_wheel(mesh, 66.0 * scale, scale);
}

/// Adds the electronic hand wheel of the operator panel.
pub fn add_panel_wheel(mesh: &mut SceneMesh, dimensions: &LatheDimensions) {
    let scale = dimensions.centre_height / 190.0;
    let button = 17.0 * scale;
    mesh.material = SceneMaterial::steel(150, 70);
    mesh.add_revolve(
        &[
            (-1.0, button * 1.9),
            (8.0 * scale, button * 1.9),
            (10.0 * scale, button * 1.8),
            (10.0 * scale, 0.0),
        ],
        44,
    );
    mesh.material = BLACK;
    let knob = Mat4::from_translation(vec3(9.0 * scale, button * 0.6, -button));
    mesh.within(knob, |mesh| {
        mesh.add_revolve(
            &[
                (0.0, button * 0.36),
                (16.0 * scale, button * 0.4),
                (18.0 * scale, 0.0),
            ],
            20,
        );
    });
}

/// Adds a hand wheel about the x axis, on the side of positive x.
fn add_hand_wheel(mesh: &mut SceneMesh, radius: f32, scale: f32) {
    mesh.material = BRIGHT_STEEL;
    let middle = 26.0 * scale;
    mesh.add_rim(middle, radius, 6.5 * scale, 44);
    let hub = 15.0 * scale;
    mesh.add_revolve(
        &[
            (-1.0, 0.0),
            (-1.0, hub),
            (middle + 8.0 * scale, hub),
            (middle + 11.0 * scale, hub * 0.7),
            (middle + 11.0 * scale, 0.0),
        ],
        32,
    );
    for spoke in 0..3 {
        mesh.within(
            Mat4::from_rotation_x(spoke as f32 * TAU / 3.0 + 0.4),
            |mesh| {
                mesh.add_box(
                    vec3(middle - 4.0 * scale, 0.0, -5.0 * scale),
                    vec3(middle + 4.0 * scale, radius, 5.0 * scale),
                    2.0,
                );
            },
        );
    }
    let handle = Mat4::from_translation(vec3(middle, radius * 0.55, radius * 0.83));
    mesh.material = DARK;
    mesh.within(handle, |mesh| {
        let grip = 7.0 * scale;
        mesh.add_revolve(
            &[
                (0.0, 0.0),
                (0.0, grip * 0.7),
                (24.0 * scale, grip),
                (44.0 * scale, grip * 0.8),
                (47.0 * scale, 0.0),
            ],
            20,
        );
    });
}
