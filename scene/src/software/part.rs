//! The revolved part as triangles.

use glam::{Mat4, Vec2, Vec3, vec3, vec4};

use super::visibility::SurfaceCorner;
use crate::part::outline::PartOutline;

/// Half the width of the chalk mark on the uncut surface, turns.
const MARK_TURNS: f32 = 1.5 / 64.0;

/// Returns the triangles of the revolved outline of a part. `sweep`: start and extent of the
/// angles, radians; `model`: rotation of the spindle.
pub fn triangles(
    part: &PartOutline,
    sides: u32,
    [start, extent]: [f32; 2],
    model: Mat4,
) -> impl Iterator<Item = [SurfaceCorner; 3]> {
    let ring: Vec<(f32, Vec2)> = (0..=sides)
        .map(|side| {
            let share = side as f32 / sides.max(1) as f32;
            (share, Vec2::from_angle(start + share * extent))
        })
        .collect();
    let [cut, skin] = part.material().colors();
    let metal = part.material().metal();
    let skin_finish = vec4(0.55, 0.75 * metal, 0.0, 0.0);
    let cut_finish = vec4(0.44 - 0.20 * metal, metal, 1.0, 0.0);
    part.edges().iter().flat_map(move |edge| {
        let corners: Vec<[SurfaceCorner; 2]> = ring
            .iter()
            .map(|&(share, direction)| {
                let turned = |at: Vec2| vec3(at.x, at.y * direction.x, at.y * direction.y);
                let is_mark = !(MARK_TURNS..=1.0 - MARK_TURNS / 3.0).contains(&share);
                let (color, finish) = match (edge.is_skin, is_mark) {
                    (true, true) => (Vec3::splat(0.78).extend(0.88), skin_finish),
                    (true, false) => (skin.extend(0.88), skin_finish),
                    (false, _) => (cut.extend(0.95), cut_finish),
                };
                [0, 1].map(|end| SurfaceCorner {
                    position: model.transform_point3(turned(edge.ends[end])),
                    normal: model.transform_vector3(turned(edge.normals[end])),
                    color,
                    finish,
                })
            })
            .collect();
        let quads = corners.windows(2).flat_map(|pair| {
            let ([a, b], [c, d]) = (pair[0], pair[1]);
            [[a, c, b], [b, c, d]]
        });
        quads.collect::<Vec<_>>()
    })
}
