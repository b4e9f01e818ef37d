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
use crate::interpreter::context::exact::{Exact, PER_MM, scaled, to_units};
use crate::interpreter::profile::{Profile, Shape, Step, bad_start};
use crate::units::{Axis, Point};

/// Half units of [`Exact`] in a millimetre.
const PER_MM_HALF: i64 = 2 * PER_MM;

/// How far an arc may turn back before it counts as a reversal, mm: the least increment, to
/// which its end points are rounded.
const ROUNDING: f64 = 0.001;

/// A point in the plane of the cut, in half units of [`Exact`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Flat {
    pub(crate) depth: i64,
    pub(crate) along: i64,
}

/// Which axis is the depth of a roughing cycle and which is along the cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum View {
    /// G71: levels in X, cuts along Z.
    Turning,
    /// G72: levels in Z, cuts along X.
    Facing,
}

impl View {
    /// The axis of the levels.
    pub(crate) const fn depth_axis(self) -> Axis {
        match self {
            Self::Turning => Axis::X,
            Self::Facing => Axis::Z,
        }
    }

    pub(crate) const fn flat(self, point: Exact) -> Flat {
        let (x, z) = (point.x, point.z.saturating_mul(2));
        match self {
            Self::Turning => Flat { depth: x, along: z },
            Self::Facing => Flat { depth: z, along: x },
        }
    }

    pub(crate) const fn exact(self, point: Flat) -> Exact {
        match self {
            Self::Turning => Exact::new(point.depth, point.along / 2),
            Self::Facing => Exact::new(point.along, point.depth / 2),
        }
    }

    /// The least increment along the cut in half units: Z 0.001 mm, X 0.001 mm of diameter.
    const fn grid(self) -> i64 {
        match self {
            Self::Turning => PER_MM_HALF / 1000,
            Self::Facing => PER_MM / 1000,
        }
    }

    /// Depth and position along the cut of a centre, in half units.
    fn center(self, center: Point) -> (f64, f64) {
        let (x, z) = (center.x * PER_MM_HALF as f64, center.z * PER_MM_HALF as f64);
        match self {
            Self::Turning => (x, z),
            Self::Facing => (z, x),
        }
    }
}

/// Directions of a cut as signs, 1 or -1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Signs {
    /// From A to B, along the depth.
    pub(crate) depth: i64,
    /// From B to C, along the cut.
    pub(crate) along: i64,
}

impl Signs {
    /// The directions of a profile. From B on each of its steps must go back in depth and on
    /// along the cut, without reversal.
    ///
    /// # Errors
    /// 065 for a step that does not.
    pub(crate) fn of(view: View, profile: &Profile) -> Result<Self, Alarm> {
        let (a, b, c) = (
            view.flat(profile.start),
            view.flat(profile.begin()),
            view.flat(profile.end()),
        );
        let signs = Self {
            depth: (b.depth - a.depth).signum(),
            along: (c.along - b.along).signum(),
        };
        if signs.depth == 0 {
            return Err(bad_start(say::profile_begin_stands()));
        }
        if signs.along == 0 {
            return Err(bad_start(say::profile_end_at_begin()));
        }
        let mut from = profile.begin();
        for step in &profile.steps {
            if let Some(fault) = signs.broken_by(view, from, step) {
                return Err(bad_start(say::profile_not_monotonous(step.line, fault)));
            }
            from = step.to;
        }
        Ok(signs)
    }

    fn broken_by(self, view: View, from: Exact, step: &Step) -> Option<Message> {
        let (start, end) = (view.flat(from), view.flat(step.to));
        if (end.along - start.along).signum() == -self.along {
            return Some(say::profile_turns_back());
        }
        if (end.depth - start.depth).signum() == self.depth {
            return Some(say::profile_goes_deeper());
        }
        match step.shape {
            Shape::Arc { center, clockwise } if !one_way(from, step.to, center, clockwise) => {
                Some(say::profile_arc_turns_back())
            }
            _ => None,
        }
    }
}

/// Whether an arc keeps its direction in both axes, that is, stays within a quadrant.
fn one_way(from: Exact, to: Exact, center: Point, clockwise: bool) -> bool {
    let (start, end) = (from.point() - center, to.point() - center);
    let cross = start.z * end.x - start.x * end.z;
    let turned = if clockwise { -cross } else { cross };
    if turned <= 0.0 {
        // Half a turn or more.
        return false;
    }
    let radius = start.length();
    // An arc passes the extreme of one axis where the other coordinate changes its sign.
    let passes = |a: f64, b: f64, reach_a: f64, reach_b: f64| {
        a * b < 0.0 && radius - reach_a.abs().max(reach_b.abs()) > ROUNDING
    };
    !passes(start.x, end.x, start.z, end.z) && !passes(start.z, end.z, start.x, end.x)
}

/// The end of the cut of a level, along the cut: the first point of the contour at or beyond
/// the level, seen in the direction of the cut. If the level is beyond the contour, it is the
/// end of the contour. All values are in half units.
pub(crate) fn end_of_cut(
    view: View,
    signs: Signs,
    begin: Exact,
    steps: &[Step],
    level: i64,
) -> i64 {
    let beyond = |depth: i64| (level - depth).signum() != -signs.depth;
    let mut from = begin;
    for step in steps {
        let (start, end) = (view.flat(from), view.flat(step.to));
        if beyond(end.depth) {
            if beyond(start.depth) {
                return start.along;
            }
            let along = match step.shape {
                Shape::Arc { center, .. } => on_arc(view, start, end, center, level),
                Shape::Straight { .. } | Shape::Dwell { .. } => on_line(start, end, level),
            };
            return on_grid(along, view.grid(), start.along, end.along);
        }
        from = step.to;
    }
    view.flat(from).along
}

fn on_line(start: Flat, end: Flat, level: i64) -> i64 {
    start.along
        + scaled(
            end.along - start.along,
            level - start.depth,
            end.depth - start.depth,
        )
}

/// The point of an arc without reversal at a level.
fn on_arc(view: View, start: Flat, end: Flat, center: Point, level: i64) -> i64 {
    let (depth, along) = view.center(center);
    let (a, b) = (start.depth as f64 - depth, start.along as f64 - along);
    let rise = level as f64 - depth;
    let half_chord = (a * a + b * b - rise * rise).max(0.0).sqrt();
    let (low, high) = (start.along.min(end.along), start.along.max(end.along));
    let outside = |value: i64| (low - value).max(value - high).max(0);
    let (one, other) = (to_units(along + half_chord), to_units(along - half_chord));
    if outside(one) <= outside(other) {
        one
    } else {
        other
    }
}

/// Rounds to the least increment, within the step.
fn on_grid(value: i64, grid: i64, one: i64, other: i64) -> i64 {
    let rounded = scaled(value, 1, grid).saturating_mul(grid);
    rounded.clamp(one.min(other), one.max(other))
}
