//! The direction of view of a solid, and its parallel projection to the picture: equal lengths
//! along a direction stay equal.
//!
//! A position in space is Z, X and Y of the lathe, in this order: Y is at right angles to
//! the plane in which the tools move, and points to the viewer.
//!
//! ```text
//!   rear tool post               front tool post
//!        X                            Y
//!        |                            |
//!        +---Z                        +---Z
//!       /                            /
//!      Y                            X
//! ```

use glam::{Mat3, Vec2, Vec3};

/// A direction from which the lathe is seen, as two angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewDirection {
    /// Whether the lathe has a rear tool post. X then points up, otherwise towards the viewer.
    pub rear: bool,
    /// Angle about the vertical, degrees; negative angles bring the end of +Z nearer.
    pub yaw_deg: f32,
    /// Angle about the horizontal of the picture, degrees; positive angles look down.
    pub pitch_deg: f32,
}

impl ViewDirection {
    /// Greatest yaw to either side, degrees. Up to it the plane of the tools is never seen
    /// edge-on.
    const MAX_YAW_DEG: f32 = 70.0;
    /// Least and greatest pitch with a rear tool post, degrees.
    const REAR_PITCH_DEG: (f32, f32) = (-35.0, 70.0);
    /// Least and greatest pitch with a front tool post, degrees.
    const FRONT_PITCH_DEG: (f32, f32) = (15.0, 90.0);

    /// Looks straight onto the plane of the tools: shows the half section as drawn.
    pub const fn flat(rear: bool) -> Self {
        Self {
            rear,
            yaw_deg: 0.0,
            pitch_deg: if rear { 0.0 } else { 90.0 },
        }
    }

    /// Looks from the front and above: shows both faces of the cut-out quarter, and the face
    /// of the part.
    pub const fn oblique(rear: bool) -> Self {
        Self {
            rear,
            yaw_deg: -30.0,
            pitch_deg: if rear { 24.0 } else { 42.0 },
        }
    }

    /// Returns the view turned by two angles, degrees, within the limits.
    #[must_use]
    pub const fn turn_by(self, yaw: f32, pitch: f32) -> Self {
        let (low, high) = if self.rear {
            Self::REAR_PITCH_DEG
        } else {
            Self::FRONT_PITCH_DEG
        };
        Self {
            yaw_deg: (self.yaw_deg + yaw).clamp(-Self::MAX_YAW_DEG, Self::MAX_YAW_DEG),
            pitch_deg: (self.pitch_deg + pitch).clamp(low, high),
            ..self
        }
    }

    /// Returns the matrix that maps the directions Z, X, Y to right, up, near.
    pub(super) fn matrix(self) -> Mat3 {
        let (yaw, pitch) = (self.yaw_deg.to_radians(), self.pitch_deg.to_radians());
        let (side, along) = (libm::sinf(yaw), libm::cosf(yaw));
        let (rise, level) = (libm::sinf(pitch), libm::cosf(pitch));
        let right = Vec3::new(along, side * rise, -side * level);
        let up = Vec3::new(0.0, level, rise);
        let near = Vec3::new(side, -along * rise, along * level);
        let (x, y) = if self.rear { (up, near) } else { (near, up) };
        Mat3::from_cols(right, x, y)
    }

    /// Displacements to the right and downwards in the picture, in its mm, of a travel of 1 mm
    /// along Z, and of one along X.
    pub fn axes(self) -> [(f32, f32); 2] {
        let matrix = self.matrix();
        [matrix.x_axis, matrix.y_axis].map(|axis| (axis.x, -axis.y))
    }
}

/// A view of the lathe: direction, middle and scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolidView {
    /// The direction from which the lathe is seen.
    pub direction: ViewDirection,
    /// Z and X in the middle of the picture, mm.
    pub centre: (f32, f32),
    /// Scale of the view, pixels per millimetre.
    pub pixels_per_mm: f32,
}

/// Projects positions of the lathe to a picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Projection {
    pub matrix: Mat3,
    /// Scale of the projection, pixels (or samples) per millimetre.
    pub scale: f32,
    /// Whether the picture is mirrored, because the lathe has a front tool post.
    pub mirrored: bool,
    centre: Vec3,
    middle: Vec2,
}

impl Projection {
    pub(super) fn new(view: &SolidView, (width, height): (usize, usize), samples: usize) -> Self {
        let matrix = view.direction.matrix();
        Self {
            matrix,
            scale: view.pixels_per_mm * samples as f32,
            mirrored: !view.direction.rear,
            centre: Vec3::new(view.centre.0, view.centre.1, 0.0),
            middle: Vec2::new(width as f32, height as f32) / 2.0,
        }
    }

    /// Projects a position, mm, to the picture: right, down and near, pixels.
    pub(super) fn project(&self, at: Vec3) -> Vec3 {
        let seen = self.matrix * (at - self.centre) * self.scale;
        Vec3::new(self.middle.x + seen.x, self.middle.y - seen.y, seen.z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_on_it_is_the_half_section() {
        let near = |(a, b): (f32, f32), c: f32, d: f32| (a - c).abs() + (b - d).abs() < 1e-6;
        let [z, x] = ViewDirection::flat(true).axes();
        assert!(near(z, 1.0, 0.0) && near(x, 0.0, -1.0), "{z:?} {x:?}");
        let [z, x] = ViewDirection::flat(false).axes();
        assert!(near(z, 1.0, 0.0) && near(x, 0.0, 1.0), "{z:?} {x:?}");
    }

    #[test]
    fn the_plane_of_the_tools_is_never_seen_from_its_edge() {
        for rear in [true, false] {
            for yaw in [-500.0, 0.0, 500.0] {
                for pitch in [-500.0, 0.0, 500.0] {
                    let [z, x] = ViewDirection::oblique(rear).turn_by(yaw, pitch).axes();
                    assert!((z.0 * x.1 - z.1 * x.0).abs() > 0.08);
                }
            }
        }
    }
}
