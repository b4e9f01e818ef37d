//! Adds up path lengths and the bounding box of the path.

use crate::path::moves::{MillArc, MillMove, MillMoveKind};
use crate::space::{MillAxis, MillPosition, PlanePoint};

/// Path lengths of a program by kind of move, mm. A rapid counts as its chord.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MillPathLengths {
    /// Length of all rapids, mm.
    pub rapid: f64,
    /// Length of all straight cuts, mm.
    pub feed: f64,
    /// Length of all clockwise arcs, mm.
    pub clockwise: f64,
    /// Length of all counter-clockwise arcs, mm.
    pub counter_clockwise: f64,
    /// Length of all taps, in and out, mm.
    pub tap: f64,
    /// Length of all threads, mm.
    pub thread: f64,
}

/// The bounding box of a path in work coordinates, mm, or degrees for rotary axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MillBounds {
    /// Least X, Y and Z of the path, mm.
    pub least: [f64; 3],
    /// Greatest X, Y and Z of the path, mm.
    pub greatest: [f64; 3],
    /// Least and greatest position of the fourth and the fifth axis, mm or degrees.
    pub further: [(f64, f64); 2],
}

impl MillBounds {
    /// Extends the bounding box by a move, or creates it if it is `None`.
    pub(crate) fn extend(bounds: &mut Option<Self>, executed: &MillMove) {
        let further = |point: &MillPosition| MillAxis::FURTHER.map(|axis| point.get(axis).mm());
        let (begin, end) = (further(&executed.from), further(&executed.to));
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
        take(executed.from.mm());
        take(executed.to.mm());
        let (Some(MillArc { plane, center }), Some(sweep)) = (executed.arc, executed.sweep())
        else {
            return;
        };
        let begin = executed.from.flat(plane) - center;
        for direction in [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)] {
            let turn = begin.sweep(
                PlanePoint::new(direction.0, direction.1),
                executed.kind == MillMoveKind::Clockwise,
            );
            if turn < sweep {
                take(executed.at(turn / sweep));
            }
        }
    }
}
