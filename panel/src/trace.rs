//! Stores the tool path of the graphic page. Segments are only appended, so that a copy for
//! another thread shares most of them.

use std::collections::VecDeque;
use std::sync::Arc;

use gsk_core::command::Frame;
use gsk_core::units::Point;
use serde::{Deserialize, Serialize};

/// Greatest number of segments of a path. Beyond it the oldest 128 are removed.
pub const MAX_SEGMENTS: usize = 512 * CHUNK;

/// Number of segments in a chunk. Copies of a path share full chunks; each has a copy of the
/// last one, which is small for that reason.
const CHUNK: usize = 128;

/// Greatest number of ticks of motion that are kept as pending on a pulse board. It is more
/// than the board's lookahead, except in a thread pass that the board cuts autonomously.
const MAX_PENDING_TICKS: usize = 2048;

/// Ticks that are kept after the board has executed them, because a stop is reported up to 250
/// ms later.
const STOP_REPORT_DELAY_TICKS: u64 = 500;

/// Greatest distance of a straight segment from the points it joins, mm.
const TOLERANCE: f64 = 0.001;

/// A straight segment of the tool path, in work coordinates (X as a radius, mm).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PathSegment {
    /// Point at which the segment starts, work coordinates.
    pub from: Point,
    /// Point at which the segment ends, work coordinates.
    pub to: Point,
    /// Whether the tool moved at rapid traverse.
    pub rapid: bool,
}

/// The tool path that the graphic page draws.
///
/// Motion of successive ticks is joined into straight segments, within 0.001 mm of every
/// point.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PathTrace {
    full: Vec<Arc<Vec<PathSegment>>>,
    last: Vec<PathSegment>,
    open: Option<GrowingSegment>,
    /// Motion that a pulse board may not have executed yet, one entry a tick.
    ahead: VecDeque<PendingMotion>,
    /// The last tick whose motion the board has reported as executed.
    made: u64,
}

/// The motion of one tick that a pulse board may still cancel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PendingMotion {
    /// The tick (ms since the emulator was created) of the motion.
    pub tick: u64,
    /// The coordinate frame in which the motion was commanded.
    pub frame: Frame,
    /// The motion of one tick, in work coordinates.
    pub piece: PathSegment,
}

/// The last segment of the path, which can still grow straight.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct GrowingSegment {
    piece: PathSegment,
    reach: f64,
    /// Directions within the tolerance of every point up to now: from the first, turning left,
    /// to the second. `None` while all directions are.
    cone: Option<(Point, Point)>,
}

impl PathTrace {
    /// Creates a path without segments.
    pub fn new() -> Self {
        Self::default()
    }

    /// Appends a straight motion in work coordinates (X as a radius, mm); joins it with the
    /// last segment if they are in line.
    pub fn push(&mut self, from: Point, to: Point, rapid: bool) {
        if let Some(open) = &mut self.open {
            if open.extend(from, to, rapid) {
                return;
            }
            let piece = open.piece;
            self.store_segment(piece);
        }
        self.open = Some(GrowingSegment::new(from, to, rapid));
    }

    /// Appends the motion of a tick that a pulse board has not executed yet.
    pub(crate) fn push_pending(&mut self, ahead: PendingMotion) {
        self.ahead.push_back(ahead);
        if self.ahead.len() > MAX_PENDING_TICKS {
            self.confirm_next();
        }
    }

    /// Records that the board has executed all motion up to tick `made`. Motion that a late
    /// stop report can still cancel remains pending.
    pub fn confirm_until(&mut self, made: u64) {
        self.made = made;
        let sure = made.saturating_sub(STOP_REPORT_DELAY_TICKS);
        while self.ahead.front().is_some_and(|ahead| ahead.tick <= sure) {
            self.confirm_next();
        }
    }

    fn confirm_next(&mut self) {
        if let Some(PendingMotion { piece, .. }) = self.ahead.pop_front() {
            self.push(piece.from, piece.to, piece.rapid);
        }
    }

    /// Ends the path where the board has stopped (machine coordinates, mm), at the pass
    /// nearest to the time of the stop. Drops the motion after it. Returns `false` if there
    /// was no pending motion.
    pub fn end_at_stop(&mut self, board_position: Point) -> bool {
        let off =
            |ahead: &PendingMotion| ahead.piece.distance(ahead.frame.to_program(board_position));
        let Some(nearest) = self.ahead.iter().map(off).min_by(f64::total_cmp) else {
            return false;
        };
        let passes = self.ahead.iter().map(|ahead| (ahead.tick, off(ahead)));
        let last = passes
            .filter(|(_, off)| *off <= nearest + TOLERANCE)
            .map(|(tick, _)| tick)
            .min_by_key(|tick| tick.abs_diff(self.made));
        while let Some(ahead) = self.ahead.pop_front() {
            let PathSegment { from, to, rapid } = ahead.piece;
            if Some(ahead.tick) == last {
                self.push(from, ahead.frame.to_program(board_position), rapid);
                break;
            }
            self.push(from, to, rapid);
        }
        self.ahead.clear();
        true
    }

    /// Stores a segment that no longer grows. Removes the oldest if there are too many.
    fn store_segment(&mut self, piece: PathSegment) {
        self.last.push(piece);
        if self.last.len() < CHUNK {
            return;
        }
        self.full.push(Arc::new(core::mem::take(&mut self.last)));
        // A path that an earlier version has stored has longer chunks.
        while self.stored_len() > MAX_SEGMENTS - CHUNK {
            self.full.remove(0);
        }
    }

    fn stored_len(&self) -> usize {
        let full: usize = self.full.iter().map(|chunk| chunk.len()).sum();
        full + self.last.len()
    }

    /// Removes all segments of the path.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// Returns whether the path has no segments.
    pub fn is_empty(&self) -> bool {
        self.open.is_none() && self.ahead.is_empty()
    }

    /// Returns the number of segments, including pending ones.
    pub fn len(&self) -> usize {
        self.stored_len() + usize::from(self.open.is_some()) + self.ahead.len()
    }

    /// Returns all segments in the order of execution, pending ones last.
    pub fn segments(&self) -> impl Iterator<Item = &PathSegment> {
        let open = self.open.as_ref().map(|open| &open.piece);
        let full = self.full.iter().flat_map(|chunk| chunk.iter());
        let ahead = self.ahead.iter().map(|ahead| &ahead.piece);
        full.chain(&self.last).chain(open).chain(ahead)
    }
}

impl PathSegment {
    /// Returns the distance of a point from the segment, mm.
    fn distance(&self, point: Point) -> f64 {
        let (along, arm) = (self.to - self.from, point - self.from);
        let length = along.dot(along);
        let share = match length > 0.0 {
            true => (along.dot(arm) / length).clamp(0.0, 1.0),
            false => 0.0,
        };
        (arm - along * share).length()
    }
}

impl GrowingSegment {
    fn new(from: Point, to: Point, rapid: bool) -> Self {
        let mut open = Self {
            piece: PathSegment { from, to, rapid },
            reach: 0.0,
            cone: None,
        };
        open.narrow(to - from);
        open
    }

    /// Extends the segment by a motion, if the motion continues straight. Returns whether it
    /// did.
    fn extend(&mut self, from: Point, to: Point, rapid: bool) -> bool {
        if rapid != self.piece.rapid || from != self.piece.to {
            return false;
        }
        let arm = to - self.piece.from;
        if arm.length() < self.reach {
            return false;
        }
        if let Some((right, left)) = self.cone
            && (arm.cross(right) < 0.0 || left.cross(arm) < 0.0 || right.dot(arm) < 0.0)
        {
            return false;
        }
        self.piece.to = to;
        self.narrow(arm);
        true
    }

    /// Keeps only the directions in which the segment passes close enough to a point.
    fn narrow(&mut self, arm: Point) {
        let length = arm.length();
        self.reach = length;
        if length <= TOLERANCE {
            return;
        }
        let side = Point::new(-arm.z, arm.x) * (TOLERANCE / length);
        // (x, z) turned left in the sense of `cross`.
        let (mut right, mut left) = (arm - side, arm + side);
        if let Some((old_right, old_left)) = self.cone {
            if right.cross(old_right) < 0.0 {
                right = old_right;
            }
            if old_left.cross(left) < 0.0 {
                left = old_left;
            }
        }
        self.cone = Some((right, left));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_of_one_straight_move_become_one_segment() {
        let mut trace = PathTrace::new();
        let at = |i: u32| Point::new(40.0 - 0.01 * f64::from(i), 100.0 - 0.03 * f64::from(i));
        for i in 0..1000 {
            trace.push(at(i), at(i + 1), false);
        }
        assert_eq!(trace.len(), 1);
        let piece = trace.segments().next().unwrap();
        assert_eq!((piece.from, piece.to), (at(0), at(1000)));
    }

    #[test]
    fn a_reversal_and_a_change_of_kind_begin_new_segments() {
        let mut trace = PathTrace::new();
        let points = [0.0, 1.0, 2.0, 1.0].map(|z| Point::new(0.0, z));
        trace.push(points[0], points[1], true);
        trace.push(points[1], points[2], true);
        trace.push(points[2], points[3], true);
        trace.push(points[3], points[0], false);
        assert_eq!(trace.len(), 3);
    }

    #[test]
    fn a_circle_stays_within_the_tolerance() {
        let mut trace = PathTrace::new();
        let at = |i: u32| {
            let angle = f64::from(i) / 10_000.0 * core::f64::consts::TAU;
            Point::new(20.0 * angle.cos(), 20.0 * angle.sin())
        };
        for i in 0..10_000 {
            trace.push(at(i), at(i + 1), false);
        }
        assert!(trace.len() < 600, "{} pieces", trace.len());
        for piece in trace.segments() {
            let middle = (piece.from + piece.to) * 0.5;
            assert!((middle.length() - 20.0).abs() < 1.5 * TOLERANCE);
        }
    }

    #[test]
    fn the_number_of_segments_is_bounded_and_the_newest_stay() {
        let mut trace = PathTrace::new();
        let at = |i: usize| Point::new(if i.is_multiple_of(2) { 0.0 } else { 1.0 }, i as f64);
        let count = MAX_SEGMENTS + 5000;
        for i in 0..count {
            trace.push(at(i), at(i + 1), false);
        }
        assert!(trace.len() <= MAX_SEGMENTS);
        assert_eq!(trace.segments().last().unwrap().to, at(count));
        assert_eq!(trace.segments().count(), trace.len());
    }

    #[test]
    fn a_copy_shares_the_full_chunks() {
        let mut trace = PathTrace::new();
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
        let mut trace = PathTrace::new();
        trace.push(Point::default(), Point::new(1.0, 0.0), true);
        trace.clear();
        assert!(trace.is_empty());
        assert_eq!(trace.segments().count(), 0);
    }

    /// 1 mm of Z a tick, from Z0 down to -`ticks` and back up.
    fn there_and_back(ticks: u64) -> PathTrace {
        let mut trace = PathTrace::new();
        let z = |tick: u64| -(tick.min(2 * ticks - tick) as f64);
        for tick in 1..=2 * ticks {
            trace.push_pending(PendingMotion {
                tick,
                frame: Frame {
                    zero: Point::new(0.0, 5.0),
                    offset: Point::new(2.0, 0.0),
                    ..Frame::default()
                },
                piece: PathSegment {
                    from: Point::new(0.0, z(tick - 1)),
                    to: Point::new(0.0, z(tick)),
                    rapid: false,
                },
            });
        }
        trace
    }

    #[test]
    fn a_stop_ends_the_path_at_the_board() {
        let mut trace = there_and_back(20);
        assert_eq!(trace.len(), 40);
        trace.confirm_until(4);
        // Z-7.5 of the program, a fraction of a pulse beside its path.
        assert!(trace.end_at_stop(Point::new(2.0004, -2.5)));
        let end = trace.segments().last().unwrap().to;
        assert!((end - Point::new(0.0004, -7.5)).length() < 1e-9, "{end:?}");
        let least = trace.segments().map(|piece| piece.to.z);
        assert_eq!(
            least.fold(0.0, f64::min),
            -7.5,
            "the turn at Z-20 is not made"
        );
        assert!(trace.len() <= 2);
        // Nothing is pending, and later motion is appended.
        trace.confirm_until(u64::MAX);
        assert!(!trace.end_at_stop(Point::default()));
        assert_eq!(trace.segments().last().unwrap().to, end);
    }

    #[test]
    fn of_two_passes_the_one_nearest_to_the_stop_is_the_last() {
        let mut trace = there_and_back(20);
        // It stopped at tick 32, reported later.
        trace.confirm_until(38);
        assert!(trace.end_at_stop(Point::new(2.0, -2.5)));
        let segments: Vec<&PathSegment> = trace.segments().collect();
        assert_eq!(segments.len(), 2);
        assert_eq!(segments[0].to.z, -20.0);
        assert_eq!(segments[1].to.z, -7.5);
    }

    #[test]
    fn executed_motion_is_not_cancelled() {
        let mut trace = there_and_back(1000);
        trace.confirm_until(STOP_REPORT_DELAY_TICKS + 4);
        assert_eq!(trace.len(), 1997, "four in one piece");
        assert!(trace.end_at_stop(Point::new(2.0, 5.0 - 2.0)));
        let path: Vec<f64> = trace.segments().map(|piece| piece.to.z).collect();
        assert!(path.iter().any(|z| *z <= -4.0), "{path:?}");
    }

    #[test]
    fn pending_motion_is_bounded() {
        let mut trace = there_and_back(20 * MAX_PENDING_TICKS as u64);
        assert!(trace.ahead.len() <= MAX_PENDING_TICKS);
        trace.confirm_until(u64::MAX);
        assert_eq!(trace.len(), 2);
    }
}
