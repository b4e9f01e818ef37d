//! What comes out: one move after the other.

use gsk_core::command::Source;
use gsk_core::units::Feed;

use crate::axes::{Axes, Further};
use crate::space::{Axis, Flat, Plane, Position};

/// What is done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MoveKind {
    /// At the rapid rates of the axes.
    Rapid,
    /// A cut, straight.
    Feed,
    /// A cut, clockwise seen against the axis across its plane.
    Clockwise,
    /// The other way round.
    CounterClockwise,
    /// A tap, in or out: the spindle leads it.
    Tap,
    /// A thread by G33: the spindle leads it.
    Thread,
    /// The slides stand for a time.
    Dwell,
}

impl MoveKind {
    /// Its name where moves are written.
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

/// The circle of a round cut; a move of the third axis makes a helix of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc {
    /// Where it lies.
    pub plane: Plane,
    /// Centre, in the coordinates of the move.
    pub center: Flat,
}

/// A move as it was made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Move {
    /// The block it belongs to.
    pub source: Source,
    /// What is done.
    pub kind: MoveKind,
    /// Start, of the tip of the tool (with G41, G42 of its centre), in work coordinates.
    pub from: Position,
    /// End.
    pub to: Position,
    /// Which axes there are.
    pub axes: Axes,
    /// Machine coordinates of the work zero.
    pub zero: Position,
    /// Of a round cut.
    pub arc: Option<Arc>,
    /// Of a rapid in which each axis goes by itself (012.7 = 0): the parts of its time after
    /// which X, Y and Z have arrived.
    pub arrivals: Option<[f64; 3]>,
    /// Of a cut.
    pub feed: Option<Feed>,
    /// Seconds since the start.
    pub start_s: f64,
    /// Seconds it takes.
    pub duration_s: f64,
    /// The tool in the spindle.
    pub tool: u16,
}

impl Move {
    /// The turn of a round cut, rad: more than none.
    pub fn sweep(&self) -> Option<f64> {
        let Arc { plane, center } = self.arc?;
        let (from, to) = (self.from.flat(plane) - center, self.to.flat(plane) - center);
        let sweep = from.sweep(to, self.kind == MoveKind::Clockwise);
        let chord = (to - from).length();
        // Back at its start it has gone round.
        Some(if chord < 1e-6 || sweep < 1e-12 {
            core::f64::consts::TAU
        } else {
            sweep
        })
    }

    /// Length of its path along X, Y and Z, mm; a rapid counts as its chord.
    pub fn length(&self) -> f64 {
        let (Some(Arc { plane, center }), Some(sweep)) = (self.arc, self.sweep()) else {
            return self.from.distance(&self.to);
        };
        let from = (self.from.flat(plane) - center).length();
        let to = (self.to.flat(plane) - center).length();
        let across = plane.across();
        let rise = (self.to.get(across) - self.from.get(across)).mm();
        let round = sweep * (from + to) / 2.0;
        libm::sqrt(round * round + rise * rise)
    }

    /// Its ways along all axes at once, a degree as a millimetre: what the feed is of.
    pub(crate) fn way(&self) -> f64 {
        let way = self.to - self.from;
        let squares = Axis::FURTHER
            .map(|axis| way.get(axis).mm())
            .map(|it| it * it);
        let further: f64 = squares.iter().sum();
        let length = self.length();
        if further == 0.0 {
            length
        } else {
            libm::sqrt(length * length + further)
        }
    }

    /// Its way along the axis that goes farthest, mm.
    pub(crate) fn longest(&self) -> f64 {
        let way = (self.to - self.from).0;
        way.into_iter().map(|it| it.abs().mm()).fold(0.0, f64::max)
    }

    /// Where the further axes of the machine begin and end, mm or degrees.
    pub fn further(&self) -> impl Iterator<Item = (Further, f64, f64)> + use<> {
        let (from, to) = (self.from, self.to);
        let all = self.axes.all_further();
        all.map(move |(axis, it)| (it, from.get(axis).mm(), to.get(axis).mm()))
    }

    /// The point at a part of its path, mm; 0 is the start, 1 the end.
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
        let (Some(Arc { plane, center }), Some(sweep)) = (self.arc, self.sweep()) else {
            return point;
        };
        let begin = self.from.flat(plane) - center;
        let end = (self.to.flat(plane) - center).length();
        let turned = match self.kind {
            MoveKind::Clockwise => -sweep * part,
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
