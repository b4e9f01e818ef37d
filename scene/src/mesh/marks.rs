//! Rings around the axis where something has collided, as lines.

use core::f32::consts::TAU;

use glam::{Vec3, vec3};

/// Greatest number of collision marks that are drawn.
pub const MAX_MARKS: usize = 100;
/// Number of straight sides of the ring that marks a collision.
pub const MARK_SIDES: u32 = 48;
/// Distance between the two rings of a collision mark, mm.
const MARK_WIDTH_MM: f32 = 0.8;
/// Distance of a ring above the surface of the part, mm.
const MARK_LIFT_MM: f32 = 0.4;
/// Colour of a mark as sRGB bytes, with an unused byte.
pub const MARK_COLOR: [u8; 4] = [255, 60, 50, 255];

/// Returns the rings of all collision marks as closed lines.
pub fn mark_rings(marks: &[[f32; 2]]) -> Vec<[Vec3; MARK_SIDES as usize]> {
    let drawable = marks.iter().filter(|it| it.iter().all(|it| it.is_finite()));
    let rings = drawable.take(MAX_MARKS).flat_map(|&[x, radius]| {
        let radius = radius.max(0.5) + MARK_LIFT_MM;
        [-MARK_WIDTH_MM, 0.0, MARK_WIDTH_MM].map(|shift| {
            core::array::from_fn(|side| {
                let angle = side as f32 / MARK_SIDES as f32 * TAU;
                vec3(x + shift, angle.cos() * radius, angle.sin() * radius)
            })
        })
    });
    rings.collect()
}
