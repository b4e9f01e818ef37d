//! Adds up path lengths and the bounding box of the path.

use crate::moves::{Arc, Move, MoveKind};
use crate::space::{Axis, Flat, Position};

/// Path lengths, mm. A rapid counts as its chord.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lengths {
    /// Rapids.
    pub rapid: f64,
    /// Straight cuts.
    pub feed: f64,
    /// Clockwise cuts.
    pub clockwise: f64,
    /// Counter-clockwise cuts.
    pub counter_clockwise: f64,
    /// Taps.
    pub tap: f64,
    /// Threads.
    pub thread: f64,
}

/// The bounding box of a path in work coordinates, mm, or degrees for rotary axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Least X, Y, Z.
    pub least: [f64; 3],
    /// Greatest X, Y, Z.
    pub greatest: [f64; 3],
    /// Least and greatest position of the fourth and the fifth axis.
    pub further: [(f64, f64); 2],
}

impl Bounds {
    /// Extends a bounding box by a move.
    pub(crate) fn reach(bounds: &mut Option<Self>, made: &Move) {
        let further = |point: &Position| Axis::FURTHER.map(|axis| point.get(axis).mm());
        let (begin, end) = (further(&made.from), further(&made.to));
        let mut take = |point: [f64; 3]| {
            let bounds = bounds.get_or_insert(Self {
                least: point,
                greatest: point,
                further: begin.map(|at| (at, at)),
            });
            for ((least, greatest), at) in bounds.further.iter_mut().zip(end) {
                *least = least.min(at);
                *greatest = greatest.max(at);
            }
            for (axis, value) in point.into_iter().enumerate() {
                bounds.least[axis] = bounds.least[axis].min(value);
                bounds.greatest[axis] = bounds.greatest[axis].max(value);
            }
        };
        take(made.from.mm());
        take(made.to.mm());
        let (Some(Arc { plane, center }), Some(sweep)) = (made.arc, made.sweep()) else {
            return;
        };
        let begin = made.from.flat(plane) - center;
        for way in [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)] {
            let turn = begin.sweep(Flat::new(way.0, way.1), made.kind == MoveKind::Clockwise);
            if turn < sweep {
                take(made.at(turn / sweep));
            }
        }
    }
}
