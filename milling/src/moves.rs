//! Defines the moves that the preview produces.

use gsk_core::command::SourcePosition;
use gsk_core::units::Feed;

use crate::axes::{Axes, FurtherAxis};
use crate::space::{MillAxis, MillPosition, Plane, PlanePoint};

/// The kind of a move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MillMoveKind {
    /// At the rapid rates of the axes.
    Rapid,
    /// A straight cut.
    Feed,
    /// A clockwise cut, seen against the axis across its plane.
    Clockwise,
    /// A counter-clockwise cut.
    CounterClockwise,
    /// A tap in or out, synchronised with the spindle.
    Tap,
    /// A thread by G33, synchronised with the spindle.
    Thread,
    /// A dwell without motion.
    Dwell,
}

impl MillMoveKind {
    /// Returns the name of the kind in listings of moves.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Rapid => "rapid",
            Self::Feed => "feed",
            Self::Clockwise => "cw",
            Self::CounterClockwise => "ccw",
            Self::Tap => "tap",
            Self::Thread => "thread",
            Self::Dwell => "dwell",
        }
    }
}

/// The circle of an arc. If the third axis moves too, the path is a helix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MillArc {
    /// The plane of the circle.
    pub plane: Plane,
    /// Centre, in the coordinates of the move.
    pub center: PlanePoint,
}

/// A move of the preview.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MillMove {
    /// The block that caused it.
    pub source: SourcePosition,
    /// The kind.
    pub kind: MillMoveKind,
    /// Start of the tool tip in work coordinates. With G41 and G42, of the cutter centre.
    pub from: MillPosition,
    /// End.
    pub to: MillPosition,
    /// The fourth and fifth axis of the machine.
    pub axes: Axes,
    /// Machine coordinates of the work zero.
    pub zero: MillPosition,
    /// The circle, if it is an arc.
    pub arc: Option<MillArc>,
    /// Shares of the duration after which X, Y and Z arrive. Set for a rapid whose axes arrive
    /// separately (012.7 = 0).
    pub arrivals: Option<[f64; 3]>,
    /// The feed, if it is a cut.
    pub feed: Option<Feed>,
    /// Start since the start of the program, s.
    pub start_s: f64,
    /// Duration, s.
    pub duration_s: f64,
    /// The tool in the spindle.
    pub tool: u16,
}

impl MillMove {
    /// Returns the angle of an arc, rad, greater than 0.
    pub fn sweep(&self) -> Option<f64> {
        let MillArc { plane, center } = self.arc?;
        let (from, to) = (self.from.flat(plane) - center, self.to.flat(plane) - center);
        let sweep = from.sweep(to, self.kind == MillMoveKind::Clockwise);
        let chord = (to - from).length();
        // An arc that ends at its start is a full circle.
        Some(if chord < 1e-6 || sweep < 1e-12 {
            core::f64::consts::TAU
        } else {
            sweep
        })
    }

    /// Returns the length of the path along X, Y and Z, mm. A rapid counts as its chord.
    pub fn length(&self) -> f64 {
        let (Some(MillArc { plane, center }), Some(sweep)) = (self.arc, self.sweep()) else {
            return self.from.distance(&self.to);
        };
        let from = (self.from.flat(plane) - center).length();
        let to = (self.to.flat(plane) - center).length();
        let across = plane.across();
        let rise = (self.to.get(across) - self.from.get(across)).mm();
        let round = sweep * (from + to) / 2.0;
        libm::sqrt(round * round + rise * rise)
    }

    /// Returns the length of the path along all axes, to which the feed applies. A degree
    /// counts as a millimetre.
    pub(crate) fn path_length(&self) -> f64 {
        let distance = self.to - self.from;
        let squares = MillAxis::FURTHER
            .map(|axis| distance.get(axis).mm())
            .map(|it| it * it);
        let further: f64 = squares.iter().sum();
        let length = self.length();
        if further == 0.0 {
            length
        } else {
            libm::sqrt(length * length + further)
        }
    }

    /// Returns the longest distance along one axis, mm.
    pub(crate) fn longest_distance(&self) -> f64 {
        let distance = (self.to - self.from).0;
        distance
            .into_iter()
            .map(|it| it.abs().mm())
            .fold(0.0, f64::max)
    }

    /// Returns each fourth or fifth axis with its start and end, mm or degrees.
    pub fn further(&self) -> impl Iterator<Item = (FurtherAxis, f64, f64)> + use<> {
        let (from, to) = (self.from, self.to);
        let all = self.axes.all_further();
        all.map(move |(axis, it)| (it, from.get(axis).mm(), to.get(axis).mm()))
    }

    /// Returns the point at a fraction of the path, mm: 0 is the start, 1 the end.
    pub fn at(&self, part: f64) -> [f64; 3] {
        let (from, to) = (self.from.mm(), self.to.mm());
        let arrivals = self.arrivals.unwrap_or([1.0; 3]);
        let mut point: [f64; 3] = core::array::from_fn(|axis| {
            let done = if part < arrivals[axis] {
                part / arrivals[axis]
            } else {
                1.0
            };
            from[axis] + (to[axis] - from[axis]) * done
        });
        let (Some(MillArc { plane, center }), Some(sweep)) = (self.arc, self.sweep()) else {
            return point;
        };
        let begin = self.from.flat(plane) - center;
        let end = (self.to.flat(plane) - center).length();
        let turned = match self.kind {
            MillMoveKind::Clockwise => -sweep * part,
            _ => sweep * part,
        };
        let radius = begin.length() + (end - begin.length()) * part;
        let angle = libm::atan2(begin.second, begin.first) + turned;
        let [first, second, _] = plane.axes();
        point[first as usize] = center.first + radius * libm::cos(angle);
        point[second as usize] = center.second + radius * libm::sin(angle);
        point
    }
}
