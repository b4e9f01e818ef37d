//! Settings of compensation C that differ between controls: start-up type, angles, increments.

use crate::units::{Point, round};

/// Cosine of one degree.
pub(super) const COS_1_DEGREE: f64 = 0.999_847_695_156_391_3;

/// How the compensation starts and is cancelled at an outer corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StartUpType {
    /// One vector, perpendicular to the compensated move beside the start-up or the cancel.
    A,
    /// A vector perpendicular to the start-up or the cancel itself, then around the corner.
    B,
}

/// Settings of compensation C. The default is that of the lathe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompensationSettings {
    /// How the compensation starts and is cancelled.
    pub(super) start_up: StartUpType,
    /// Sine of the greatest angle between two lines that count as one direction.
    straight_sine: f64,
    /// Cosine of the angle between two directions of travel below which they count as opposite.
    pub(super) reversal_cosine: f64,
    /// Least increments of `x` and `z` of a point in a millimetre.
    pub(super) increments_per_mm: Point,
}

impl Default for CompensationSettings {
    fn default() -> Self {
        Self {
            start_up: StartUpType::B,
            straight_sine: 0.0,
            reversal_cosine: -COS_1_DEGREE,
            // A diameter X has increments of 0.001 mm, its radius of half of that.
            increments_per_mm: Point {
                x: 2000.0,
                z: 1000.0,
            },
        }
    }
}

impl CompensationSettings {
    /// Creates settings in which two lines count as one direction, and two moves as opposite, if
    /// their angle differs by up to `degrees` from 0 and from 180.
    #[must_use]
    pub fn with_angle(start_up: StartUpType, degrees: f64, increments_per_mm: Point) -> Self {
        let angle = degrees.to_radians();
        Self {
            start_up,
            straight_sine: libm::sin(angle),
            reversal_cosine: -libm::cos(angle),
            increments_per_mm,
        }
    }

    /// Rounds a point to the least increment.
    pub(super) fn round(&self, point: Point) -> Point {
        let per_mm = self.increments_per_mm;
        Point::new(
            round(point.x * per_mm.x) / per_mm.x,
            round(point.z * per_mm.z) / per_mm.z,
        )
    }

    /// Whether the unit vectors of travel `exit` and `entry` of two lines count as one direction.
    pub(super) fn is_straight(&self, exit: Point, entry: Point) -> bool {
        let sine = self.straight_sine;
        sine > 0.0 && exit.dot(entry) > 0.0 && exit.cross(entry).abs() <= sine
    }
}
