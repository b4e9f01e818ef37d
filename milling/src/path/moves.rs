//! Defines the moves that the preview produces.

use gsk_core::command::SourcePosition;
use gsk_core::units::Feed;

use crate::axes::{Axes, FurtherAxis};
use crate::space::{MillAxis, MillPosition, Plane, PlanePoint};

/// The kind of a previewed move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MillMoveKind {
    /// A move at the rapid rates of the axes.
    Rapid,
    /// A straight cut.
    Feed,
    /// A clockwise cut, seen against the axis across its plane.
    Clockwise,
    /// A counter-clockwise cut, seen against the axis across its plane.
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

/// The circle of an arc move. If the third axis moves too, the path is a helix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MillArc {
    /// The plane in which the circle is.
    pub plane: Plane,
    /// Centre of the circle, in the coordinates of the move, mm.
    pub center: PlanePoint,
}

/// A move or dwell in the preview of a mill program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MillMove {
    /// Position of the block that caused the move.
    pub source: SourcePosition,
    /// Whether the move is a rapid, a cut, a tap, a thread or a dwell.
    pub kind: MillMoveKind,
    /// Start of the tool tip in work coordinates. With G41 and G42, of the cutter centre.
    pub from: MillPosition,
    /// End of the tool tip in work coordinates. With G41 and G42, of the cutter centre.
    pub to: MillPosition,
    /// The fourth and fifth axis of the machine, which give `from` and `to` their meaning.
    pub axes: Axes,
    /// Machine coordinates of the work zero in force.
    pub zero: MillPosition,
    /// The circle of a clockwise or counter-clockwise cut; `None` for other moves.
    pub arc: Option<MillArc>,
    /// Fractions of the duration after which X, Y and Z arrive, for a rapid whose axes arrive
    /// separately (012.7 = 0); otherwise `None`.
    pub arrivals: Option<[f64; 3]>,
    /// The feed of a cut; `None` for other moves.
    pub feed: Option<Feed>,
    /// Time at which the move starts, s since the start of the program.
    pub start_s: f64,
    /// Duration of the move, s.
    pub duration_s: f64,
    /// Number of the tool in the spindle.
    pub tool: u16,
}

impl MillMove {
    /// Returns the angle that an arc turns through, rad, greater than 0; `None` if the move is
    /// no arc.
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

    /// Returns the length of the move along X, Y and Z, mm. A rapid counts as its chord.
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

    /// Returns the length of the move along all axes, to which the feed applies, mm. A degree
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

    /// Returns the longest distance that the move covers along one axis, mm or degrees.
    pub(crate) fn longest_distance(&self) -> f64 {
        let distance = (self.to - self.from).0;
        distance
            .into_iter()
            .map(|it| it.abs().mm())
            .fold(0.0, f64::max)
    }

    /// Returns each fourth or fifth axis of the machine with its start and end, mm or degrees.
    pub fn further(&self) -> impl Iterator<Item = (FurtherAxis, f64, f64)> + use<> {
        let (from, to) = (self.from, self.to);
        let all = self.axes.all_further();
        all.map(move |(axis, it)| (it, from.get(axis).mm(), to.get(axis).mm()))
    }

    /// Returns X, Y and Z, mm, at a fraction of the move: 0 is the start, 1 the end.
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
