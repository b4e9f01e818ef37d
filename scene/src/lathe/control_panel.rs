//! The operator panel that stands on a lathe: screen, keys, emergency stop, override switch.

use glam::{Mat4, vec3};

use super::palette::{BLACK, SCREEN};
use crate::description::{LatheDimensions, LatheKind};
use crate::mesh::{SceneMaterial, SceneMesh};
use crate::placement::hand_wheels::{operator_panel, panel_depth};

/// Adds the operator panel without its hand wheel: screen, keys, lamps.
pub fn add_control_panel(mesh: &mut SceneMesh, kind: LatheKind, dimensions: &LatheDimensions) {
    let Some((corner, size)) = operator_panel(kind, dimensions) else {
        return;
    };
    let scale = dimensions.centre_height / 190.0;
    let front = panel_depth(dimensions);
    mesh.within(Mat4::from_translation(corner), |mesh| {
        mesh.step_mm = 60.0;
        add_case(mesh, size, front, scale);
        add_keys(mesh, size, front);
        add_switches(mesh, size, front, scale);
    });
}

/// Adds case and screen; `front` is the plane of the keys.
fn add_case(mesh: &mut SceneMesh, [width, height]: [f32; 2], front: f32, scale: f32) {
    mesh.material = BLACK;
    mesh.add_box(
        vec3(0.0, -height, -4.0),
        vec3(width, 0.0, front),
        5.0 * scale,
    );
    mesh.material = SCREEN;
    mesh.add_box(
        vec3(width * 0.06, -height * 0.46, front - 2.0),
        vec3(width * 0.56, -height * 0.08, front + 1.0),
        0.6,
    );
}

/// Adds the block of letter keys and the two rows of machine keys.
fn add_keys(mesh: &mut SceneMesh, [width, height]: [f32; 2], front: f32) {
    for row in 0..5 {
        for column in 0..5 {
            mesh.material = SceneMaterial::paint(196, 198, 194);
            let x = width * (0.61 + column as f32 * 0.07);
            let y = -height * (0.09 + row as f32 * 0.078);
            let size = width * 0.055;
            mesh.add_box(
                vec3(x, y - size, front - 1.0),
                vec3(x + size, y, front + 3.0),
                1.2,
            );
        }
    }
    for column in 0..9 {
        mesh.material = match column {
            7 => SceneMaterial::paint(48, 150, 76).glowing(40),
            8 => SceneMaterial::paint(196, 44, 36).glowing(20),
            _ => SceneMaterial::paint(168, 172, 172),
        };
        let x = width * (0.07 + column as f32 * 0.098);
        let size = width * 0.07;
        for y in [-height * 0.56, -height * 0.66] {
            mesh.add_box(
                vec3(x, y - size, front - 1.0),
                vec3(x + size, y, front + 3.0),
                1.4,
            );
        }
    }
}

/// Adds emergency stop and override switch.
fn add_switches(mesh: &mut SceneMesh, [width, height]: [f32; 2], front: f32, scale: f32) {
    let button = 17.0 * scale;
    mesh.material = SceneMaterial::paint(230, 190, 40);
    mesh.add_facing(
        vec3(width * 0.16, -height * 0.86, front),
        &[
            (-1.0, button * 1.3),
            (1.5, button * 1.3),
            (1.5, button * 0.8),
        ],
        32,
    );
    mesh.material = SceneMaterial::paint(200, 30, 26).glowing(30);
    mesh.add_facing(
        vec3(width * 0.16, -height * 0.86, front),
        &[
            (1.0, button * 0.7),
            (9.0 * scale, button * 0.7),
            (10.0 * scale, button),
            (18.0 * scale, button),
            (22.0 * scale, button * 0.7),
            (22.0 * scale, 0.0),
        ],
        32,
    );
    mesh.material = SceneMaterial::steel(150, 70);
    mesh.add_facing(
        vec3(width * 0.42, -height * 0.86, front),
        &[
            (-1.0, button),
            (12.0 * scale, button * 0.9),
            (13.0 * scale, 0.0),
        ],
        24,
    );
}
