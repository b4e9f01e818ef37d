//! The path of the tool, kept for the graphic page: pieces that are only ever
//! appended, so that a copy for another thread shares almost everything.

use std::sync::Arc;

use gsk_core::units::Point;
use serde::{Deserialize, Serialize};

/// Pieces kept at most; beyond it the oldest thousand goes.
pub const MOST_PIECES: usize = 64 * CHUNK;

/// Pieces of one shared chunk.
const CHUNK: usize = 1024;

/// How far a straight piece may pass beside the points it stands for, mm.
const TOLERANCE: f64 = 0.001;

/// One straight piece of the path, in work coordinates (X as a radius, mm).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Piece {
    /// Where it begins.
    pub from: Point,
    /// Where it ends.
    pub to: Point,
    /// Whether it was a rapid move.
    pub rapid: bool,
}

/// The path of the tool.
///
/// The motion of one tick after another is joined to straight pieces as long as
/// they stay within a thousandth of a millimetre of every point.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Trace {
    full: Vec<Arc<Vec<Piece>>>,
    last: Vec<Piece>,
    open: Option<Open>,
}

/// The piece that still grows, and the directions it may yet take.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Open {
    piece: Piece,
    reach: f64,
    /// Directions in which every point so far is within the tolerance: from the
    /// first, turning left, to the second.
    cone: Option<(Point, Point)>,
}

impl Trace {
    /// An empty path.
    pub fn new() -> Self {
        Self::default()
    }

    /// Appends a straight motion.
    pub fn push(&mut self, from: Point, to: Point, rapid: bool) {
        if let Some(open) = &mut self.open {
            if open.extend(from, to, rapid) {
                return;
            }
            let piece = open.piece;
            self.close(piece);
        }
        self.open = Some(Open::new(from, to, rapid));
    }

    /// Stores a finished piece.
    fn close(&mut self, piece: Piece) {
        self.last.push(piece);
        if self.last.len() < CHUNK {
            return;
        }
        self.full.push(Arc::new(core::mem::take(&mut self.last)));
        if self.full.len() * CHUNK > MOST_PIECES - CHUNK {
            self.full.remove(0);
        }
    }

    /// Forgets the whole path.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// Whether nothing was drawn.
    pub const fn is_empty(&self) -> bool {
        self.open.is_none()
    }

    /// How many pieces there are.
    pub fn len(&self) -> usize {
        self.full.len() * CHUNK + self.last.len() + usize::from(self.open.is_some())
    }

    /// All pieces in the order of execution.
    pub fn pieces(&self) -> impl Iterator<Item = &Piece> {
        let open = self.open.as_ref().map(|open| &open.piece);
        let full = self.full.iter().flat_map(|chunk| chunk.iter());
        full.chain(&self.last).chain(open)
    }
}

impl Open {
    fn new(from: Point, to: Point, rapid: bool) -> Self {
        let mut open = Self {
            piece: Piece { from, to, rapid },
            reach: 0.0,
            cone: None,
        };
        open.narrow(to - from);
        open
    }

    /// Takes one more motion in, if the piece stays straight.
    fn extend(&mut self, from: Point, to: Point, rapid: bool) -> bool {
        if rapid != self.piece.rapid || from != self.piece.to {
            return false;
        }
        let arm = to - self.piece.from;
        if arm.length() < self.reach {
            return false;
        }
        if let Some((right, left)) = self.cone
            && (cross(right, arm) < 0.0 || cross(arm, left) < 0.0 || dot(right, arm) < 0.0)
        {
            return false;
        }
        self.piece.to = to;
        self.narrow(arm);
        true
    }

    /// Keeps only the directions that pass close enough to a point.
    fn narrow(&mut self, arm: Point) {
        let length = arm.length();
        self.reach = length;
        if length <= TOLERANCE {
            return;
        }
        let side = Point::new(-arm.z, arm.x) * (TOLERANCE / length);
        // (x, z) turned left as `cross` counts it.
        let (mut right, mut left) = (arm - side, arm + side);
        if let Some((old_right, old_left)) = self.cone {
            if cross(old_right, right) < 0.0 {
                right = old_right;
            }
            if cross(left, old_left) < 0.0 {
                left = old_left;
            }
        }
        self.cone = Some((right, left));
    }
}

fn cross(a: Point, b: Point) -> f64 {
    a.x * b.z - a.z * b.x
}

fn dot(a: Point, b: Point) -> f64 {
    a.x * b.x + a.z * b.z
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_of_one_straight_move_become_one_piece() {
        let mut trace = Trace::new();
        let at = |i: u32| Point::new(40.0 - 0.01 * f64::from(i), 100.0 - 0.03 * f64::from(i));
        for i in 0..1000 {
            trace.push(at(i), at(i + 1), false);
        }
        assert_eq!(trace.len(), 1);
        let piece = trace.pieces().next().unwrap();
        assert_eq!((piece.from, piece.to), (at(0), at(1000)));
    }

    #[test]
    fn a_turn_back_and_a_change_of_kind_begin_new_pieces() {
        let mut trace = Trace::new();
        let points = [0.0, 1.0, 2.0, 1.0].map(|z| Point::new(0.0, z));
        trace.push(points[0], points[1], true);
        trace.push(points[1], points[2], true);
        trace.push(points[2], points[3], true);
        trace.push(points[3], points[0], false);
        assert_eq!(trace.len(), 3);
    }

    #[test]
    fn a_circle_stays_within_the_tolerance() {
        let mut trace = Trace::new();
        let at = |i: u32| {
            let angle = f64::from(i) / 10_000.0 * core::f64::consts::TAU;
            Point::new(20.0 * angle.cos(), 20.0 * angle.sin())
        };
        for i in 0..10_000 {
            trace.push(at(i), at(i + 1), false);
        }
        assert!(trace.len() < 600, "{} pieces", trace.len());
        for piece in trace.pieces() {
            let middle = (piece.from + piece.to) * 0.5;
            assert!((middle.length() - 20.0).abs() < 1.5 * TOLERANCE);
        }
    }

    #[test]
    fn the_number_of_pieces_is_bounded_and_the_newest_stay() {
        let mut trace = Trace::new();
        let at = |i: usize| Point::new(if i.is_multiple_of(2) { 0.0 } else { 1.0 }, i as f64);
        let count = MOST_PIECES + 5000;
        for i in 0..count {
            trace.push(at(i), at(i + 1), false);
        }
        assert!(trace.len() <= MOST_PIECES);
        assert_eq!(trace.pieces().last().unwrap().to, at(count));
        assert_eq!(trace.pieces().count(), trace.len());
    }

    #[test]
    fn a_copy_shares_the_full_chunks() {
        let mut trace = Trace::new();
        for i in 0..3000_u32 {
            let at = |i: u32| Point::new(f64::from(i % 2), f64::from(i));
            trace.push(at(i), at(i + 1), false);
        }
        let copy = trace.clone();
        assert!(Arc::ptr_eq(&trace.full[0], &copy.full[0]));
        assert_eq!(trace, copy);
    }

    #[test]
    fn clearing_leaves_nothing() {
        let mut trace = Trace::new();
        trace.push(Point::default(), Point::new(1.0, 0.0), true);
        trace.clear();
        assert!(trace.is_empty());
        assert_eq!(trace.pieces().count(), 0);
    }
}
