//! The geometry of roughing: the contour in the plane of depth and cutting direction.
//!
//! ```text
//!   G71: depth = X, along = Z         depth ^  C______
//!   G72: depth = Z, along = X               |         \
//!                                     level |---------<·····  the first point at
//!   both in half millionths of a mm,        |         (        or beyond the level
//!   X as a radius: one scale                |          B      seen from A
//!                                           +-----------> along
//! ```

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

use crate::alarm::Alarm;
use crate::interpreter::exact::{ExactPoint, UNITS_PER_MM, round_to_units, scale_rounded};
use crate::interpreter::profile::{Profile, ProfileSegment, StepShape, start_alarm};
use crate::units::{Axis, Point};

/// Number of half units of [`ExactPoint`] in a millimetre.
const HALF_UNITS_PER_MM: i64 = 2 * UNITS_PER_MM;

/// Greatest distance that an arc may turn back without counting as a reversal, mm: the least
/// increment, to which the end points of the arc are rounded.
const ARC_TOLERANCE_MM: f64 = 0.001;

/// A point by depth and position along the cut, in half units of [`ExactPoint`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ContourPoint {
    pub(crate) depth: i64,
    pub(crate) along: i64,
}

/// The plane of a roughing cycle: in which axis it feeds (depth of cut), and along which axis it
/// cuts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum CutPlane {
    /// G71: feeds in along X and cuts along Z.
    Turning,
    /// G72: feeds in along Z and cuts along X.
    Facing,
}

impl CutPlane {
    /// The axis in which the cycle feeds in from level to level.
    pub(crate) const fn depth_axis(self) -> Axis {
        match self {
            Self::Turning => Axis::X,
            Self::Facing => Axis::Z,
        }
    }

    pub(crate) const fn to_plane(self, point: ExactPoint) -> ContourPoint {
        let (x, z) = (point.x, point.z.saturating_mul(2));
        match self {
            Self::Turning => ContourPoint { depth: x, along: z },
            Self::Facing => ContourPoint { depth: z, along: x },
        }
    }

    pub(crate) const fn to_exact(self, point: ContourPoint) -> ExactPoint {
        match self {
            Self::Turning => ExactPoint::new(point.depth, point.along / 2),
            Self::Facing => ExactPoint::new(point.along, point.depth / 2),
        }
    }

    /// The least increment along the cut, in half units of [`ExactPoint`]: 0.001 mm in Z,
    /// 0.001 mm of the diameter in X.
    const fn least_increment(self) -> i64 {
        match self {
            Self::Turning => HALF_UNITS_PER_MM / 1000,
            Self::Facing => UNITS_PER_MM / 1000,
        }
    }

    /// Converts a centre (mm, X as a radius) to its depth and its position along the cut, in
    /// half units of [`ExactPoint`].
    fn center_in_plane(self, center: Point) -> (f64, f64) {
        let (x, z) = (
            center.x * HALF_UNITS_PER_MM as f64,
            center.z * HALF_UNITS_PER_MM as f64,
        );
        match self {
            Self::Turning => (x, z),
            Self::Facing => (z, x),
        }
    }
}

/// Directions of a cut as signs, 1 or -1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct CutDirections {
    /// Direction of the depth, from the start A to the beginning B of the contour, 1 or -1.
    pub(crate) depth: i64,
    /// Direction of the cut, from the beginning B to the end C of the contour, 1 or -1.
    pub(crate) along: i64,
}

impl CutDirections {
    /// Finds the directions of a profile. From B on each step must go towards A in depth and
    /// towards C along the cut, without reversal.
    ///
    /// # Errors
    /// 065 for a step in another direction, and for a contour without depth or length.
    pub(crate) fn from_profile(plane: CutPlane, profile: &Profile) -> Result<Self, Alarm> {
        let (a, b, c) = (
            plane.to_plane(profile.start),
            plane.to_plane(profile.begin_point()),
            plane.to_plane(profile.end_point()),
        );
        let directions = Self {
            depth: (b.depth - a.depth).signum(),
            along: (c.along - b.along).signum(),
        };
        if directions.depth == 0 {
            return Err(start_alarm(say::profile_begin_stands()));
        }
        if directions.along == 0 {
            return Err(start_alarm(say::profile_end_at_begin()));
        }
        let mut from = profile.begin_point();
        for step in &profile.steps {
            if let Some(fault) = directions.find_violation(plane, from, step) {
                return Err(start_alarm(say::profile_not_monotonous(step.line, fault)));
            }
            from = step.to;
        }
        Ok(directions)
    }

    fn find_violation(
        self,
        plane: CutPlane,
        from: ExactPoint,
        step: &ProfileSegment,
    ) -> Option<Message> {
        let (start, end) = (plane.to_plane(from), plane.to_plane(step.to));
        if (end.along - start.along).signum() == -self.along {
            return Some(say::profile_turns_back());
        }
        if (end.depth - start.depth).signum() == self.depth {
            return Some(say::profile_goes_deeper());
        }
        match step.shape {
            StepShape::Arc { center, clockwise }
                if !is_one_way(from, step.to, center, clockwise) =>
            {
                Some(say::profile_arc_turns_back())
            }
            _ => None,
        }
    }
}

/// Whether an arc keeps its direction in both axes, that is, is within a quadrant.
fn is_one_way(from: ExactPoint, to: ExactPoint, center: Point, clockwise: bool) -> bool {
    let (start, end) = (from.to_point() - center, to.to_point() - center);
    let cross = start.z * end.x - start.x * end.z;
    let turn = if clockwise { -cross } else { cross };
    if turn <= 0.0 {
        // Half a turn or more.
        return false;
    }
    let radius = start.length();
    // An arc passes the extreme of one axis where the other coordinate changes its sign.
    let passes_extreme = |a: f64, b: f64, reach_a: f64, reach_b: f64| {
        a * b < 0.0 && radius - reach_a.abs().max(reach_b.abs()) > ARC_TOLERANCE_MM
    };
    !passes_extreme(start.x, end.x, start.z, end.z)
        && !passes_extreme(start.z, end.z, start.x, end.x)
}

/// Finds where the cut at the depth `level` ends, as a position along the cut: at the first
/// point of the contour at or beyond the level, or else at the end of the contour. All values
/// are in half units of [`ExactPoint`].
pub(crate) fn find_cut_end(
    plane: CutPlane,
    directions: CutDirections,
    begin: ExactPoint,
    steps: &[ProfileSegment],
    level: i64,
) -> i64 {
    let is_beyond = |depth: i64| (level - depth).signum() != -directions.depth;
    let mut from = begin;
    for step in steps {
        let (start, end) = (plane.to_plane(from), plane.to_plane(step.to));
        if is_beyond(end.depth) {
            if is_beyond(start.depth) {
                return start.along;
            }
            let along = match step.shape {
                StepShape::Arc { center, .. } => intersect_arc(plane, start, end, center, level),
                StepShape::Straight { .. } | StepShape::Dwell { .. } => {
                    intersect_line(start, end, level)
                }
            };
            return round_to_increment(along, plane.least_increment(), start.along, end.along);
        }
        from = step.to;
    }
    plane.to_plane(from).along
}

fn intersect_line(start: ContourPoint, end: ContourPoint, level: i64) -> i64 {
    start.along
        + scale_rounded(
            end.along - start.along,
            level - start.depth,
            end.depth - start.depth,
        )
}

/// Finds where an arc without reversal reaches the depth `level`, as a position along the cut.
fn intersect_arc(
    plane: CutPlane,
    start: ContourPoint,
    end: ContourPoint,
    center: Point,
    level: i64,
) -> i64 {
    let (depth, along) = plane.center_in_plane(center);
    let (a, b) = (start.depth as f64 - depth, start.along as f64 - along);
    let rise = level as f64 - depth;
    let half_chord = (a * a + b * b - rise * rise).max(0.0).sqrt();
    let (low, high) = (start.along.min(end.along), start.along.max(end.along));
    let distance_outside = |value: i64| (low - value).max(value - high).max(0);
    let (upper, lower) = (
        round_to_units(along + half_chord),
        round_to_units(along - half_chord),
    );
    if distance_outside(upper) <= distance_outside(lower) {
        upper
    } else {
        lower
    }
}

/// Rounds to the least increment `increment`, but not beyond `begin` and `end` of the step.
fn round_to_increment(value: i64, increment: i64, begin: i64, end: i64) -> i64 {
    let rounded = scale_rounded(value, 1, increment).saturating_mul(increment);
    rounded.clamp(begin.min(end), begin.max(end))
}
