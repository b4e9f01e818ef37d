//! The signal tower with its lamps.

use glam::{Vec3, vec3};

use super::palette::{BLACK, BRIGHT_STEEL};
use crate::description::{LatheDimensions, LatheKind, TowerLamp};
use crate::mesh::{SceneMaterial, SceneMesh};

/// Height of the foot of the signal tower, mm.
const FOOT_MM: f32 = 70.0;
const LEVEL_MM: f32 = 36.0;
const LAMP_MM: f32 = 31.0;
/// Radius of a lit lamp relative to the dark lamp, which it covers.
const LIT_SHARE: f32 = 1.02;

/// Returns the position of the signal tower's foot in the scene.
fn tower_base(kind: LatheKind, dimensions: &LatheDimensions) -> Vec3 {
    let (height, scale) = (dimensions.centre_height, dimensions.centre_height / 190.0);
    let head = -dimensions.chuck_length - 26.0;
    match kind {
        LatheKind::FlatBed => vec3(head - 250.0 * scale, height * 1.02, -80.0 * scale),
        LatheKind::SlantBed => vec3(
            head - 40.0 * scale,
            height * 1.78 + 28.0 * scale,
            120.0 * scale,
        ),
        // On the cover of the belt.
        LatheKind::Bench => vec3(
            head - 240.0 * scale,
            dimensions.chuck_diameter * 0.837 - 2.0,
            -40.0 * scale,
        ),
    }
}

/// Returns the colours of a dark and of a lit lamp as sRGB bytes.
const fn lamp_colors(lamp: TowerLamp) -> [[u8; 3]; 2] {
    match lamp {
        TowerLamp::Green => [[28, 84, 46], [96, 255, 140]],
        TowerLamp::Yellow => [[118, 88, 22], [255, 214, 70]],
        TowerLamp::Red => [[104, 26, 22], [255, 84, 66]],
    }
}

/// Adds the signal tower with dark lamps.
pub fn add_tower(mesh: &mut SceneMesh, kind: LatheKind, dimensions: &LatheDimensions) {
    let (base, scale) = (
        tower_base(kind, dimensions),
        dimensions.centre_height / 190.0,
    );
    let size = 15.0 * scale;
    mesh.material = BRIGHT_STEEL;
    mesh.add_upright(
        base,
        &[(0.0, size * 0.4), (FOOT_MM * scale, size * 0.4)],
        16,
    );
    for (level, lamp) in TowerLamp::ALL.into_iter().enumerate() {
        let [red, green, blue] = lamp_colors(lamp)[0];
        mesh.material = SceneMaterial::paint(red, green, blue);
        add_lamp_glass(mesh, base, level, scale, 1.0);
        mesh.material = BLACK;
        let top = (FOOT_MM + level as f32 * LEVEL_MM + LAMP_MM) * scale;
        mesh.add_upright(
            base + Vec3::Y * top,
            &[
                (0.0, size * 1.06),
                (5.0 * scale, size * 1.06),
                (5.0 * scale, 0.0),
            ],
            28,
        );
    }
}

/// Adds the glass of a lit lamp, which covers the dark lamp.
pub fn add_lit_lamp(
    mesh: &mut SceneMesh,
    kind: LatheKind,
    dimensions: &LatheDimensions,
    lamp: TowerLamp,
) {
    let [red, green, blue] = lamp_colors(lamp)[1];
    mesh.material = SceneMaterial::paint(red, green, blue).glowing(255);
    let base = tower_base(kind, dimensions);
    let scale = dimensions.centre_height / 190.0;
    add_lamp_glass(mesh, base, lamp as usize, scale, LIT_SHARE);
}

fn add_lamp_glass(mesh: &mut SceneMesh, base: Vec3, level: usize, scale: f32, share: f32) {
    let size = 15.0 * scale * share;
    let low = (FOOT_MM + level as f32 * LEVEL_MM) * scale;
    mesh.add_upright(
        base + Vec3::Y * low,
        &[
            (0.0, 0.0),
            (0.0, size),
            (LAMP_MM * scale, size),
            (LAMP_MM * scale, 0.0),
        ],
        28,
    );
}
