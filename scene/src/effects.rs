//! What happens beside the motion of the axes: chips, the damage of a crash, the turn of the
//! tool carrier.

use glam::{Mat4, Vec2, Vec3, vec2, vec3};

use crate::description::{LatheDescription, LatheDimensions, LatheKind, MountedTool};
use crate::placement::tool_side;

/// Part of an insert's size that breaks off in a crash, 0 to 1.
const BROKEN_SHARE: f32 = 0.36;
/// Distance by which a crash pulls the bar out of the jaws, mm.
const SLIP_MM: f32 = 4.0;
/// Greatest angle by which a crash bends the bar, radians.
const MAX_BEND: f32 = 0.2;

/// Returns the matrix that bends the bar after a crash: it pivots in the jaws, away from the tool.
pub fn bar_bend(lathe: &LatheDescription) -> Mat4 {
    let bend = lathe.effects.bar_bend;
    if bend == 0.0 || !bend.is_finite() {
        return Mat4::IDENTITY;
    }
    let pivot = vec3(lathe.dimensions.sanitized().jaw_length, 0.0, 0.0);
    let side = tool_side(lathe.kind);
    side * Mat4::from_translation(pivot + Vec3::X * SLIP_MM)
        * Mat4::from_rotation_y(bend.clamp(-MAX_BEND, MAX_BEND))
        * Mat4::from_translation(-pivot)
        * side.inverse()
}

/// Returns the height of the tray into which chips fall, relative to the spindle axis, mm.
pub fn tray_y(kind: LatheKind, dimensions: &LatheDimensions) -> f32 {
    let below = match kind {
        LatheKind::FlatBed => 2.05,
        LatheKind::SlantBed => 1.1,
        LatheKind::Bench => 1.7,
    };
    -dimensions.sanitized().centre_height * below
}

/// Returns a tool whose insert has lost its corner in a crash. A drill has no insert and does not
/// change.
#[must_use]
pub fn break_insert(tool: &MountedTool) -> MountedTool {
    MountedTool {
        insert: tool.insert.iter().map(|it| break_corner(it)).collect(),
        ..tool.clone()
    }
}

/// Cuts the corner at the tip off a polygon, with a jagged edge.
fn break_corner(polygon: &[[f32; 2]]) -> Vec<[f32; 2]> {
    let points: Vec<Vec2> = polygon.iter().map(|it| vec2(it[0], it[1])).collect();
    let sum: Vec2 = points.iter().sum();
    let inward = sum.normalize_or(Vec2::Y);
    let depth = points.iter().map(|it| it.dot(inward)).fold(0.0, f32::max);
    let limit = depth * BROKEN_SHARE;
    let mut kept = Vec::new();
    for (a, b) in points.iter().zip(points.iter().cycle().skip(1)) {
        let (at_a, at_b) = (a.dot(inward) - limit, b.dot(inward) - limit);
        if at_a >= 0.0 {
            kept.push(a.to_array());
        }
        if (at_a < 0.0) != (at_b < 0.0) {
            kept.push(a.lerp(*b, at_a / (at_a - at_b)).to_array());
            if at_b < 0.0 {
                // The fracture is deepest beside its middle.
                let notch = inward * (limit * 1.5) + inward.perp() * (depth * 0.06);
                kept.push(notch.to_array());
            }
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::MountedToolForm;

    #[test]
    fn a_broken_insert_has_no_corner_at_the_tip() {
        let tool = MountedTool {
            form: MountedToolForm::Shank,
            insert: vec![vec![[0.0, 0.0], [12.0, 1.0], [13.0, 13.0], [1.0, 12.0]]],
            holder: vec![vec![[1.0, 5.0], [21.0, 5.0], [21.0, 60.0]]],
        };
        let broken = break_insert(&tool);
        assert_eq!(broken.holder, tool.holder);
        let least = |tool: &MountedTool| {
            let far = tool.insert[0].iter().map(|it| it[0] + it[1]);
            far.fold(f32::MAX, f32::min)
        };
        assert!(least(&tool) == 0.0 && least(&broken) > 5.0, "{broken:?}");
        assert_eq!(broken.insert[0].len(), 6);
    }

    #[test]
    fn a_struck_bar_gives_way_from_the_tool_and_stays_in_the_jaws() {
        for kind in [LatheKind::FlatBed, LatheKind::SlantBed] {
            let mut lathe = LatheDescription {
                kind,
                ..LatheDescription::default()
            };
            assert_eq!(bar_bend(&lathe), Mat4::IDENTITY);
            lathe.effects.bar_bend = 0.05;
            let side = tool_side(kind).transform_vector3(Vec3::Z);
            let jaws = lathe.dimensions.jaw_length;
            let moved = |x: f32| {
                let at = vec3(x, 0.0, 0.0);
                bar_bend(&lathe).transform_point3(at) - at
            };
            assert!(moved(jaws).length() < SLIP_MM + 1e-3);
            assert!(moved(jaws + 100.0).dot(side) < -4.0, "{kind:?}");
        }
    }
}
