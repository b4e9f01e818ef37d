//! Converts positions at spindle angles to segments of a constant ratio for the board.
//!
//! ```text
//!  steps │        ·  ‚‚-·        vertices: position at a whole count of the encoder
//!        │     .-·'              segment: `length` counts with `numerator` / 2^20 steps each
//!        └──┴──┴──┴──┴──► counts
//! ```
//!
//! The sums of the segments are exact: an error of one segment is corrected by the next, and
//! never adds up.

use std::collections::VecDeque;

use super::super::FINE;
use super::spindle_angle::SpindleCounts;

/// Fractions of a step in which ratios are given.
pub(super) const DENOMINATOR: i64 = 1 << 20;
/// Fractions per fine unit of a position.
pub(super) const PER_FINE: i64 = DENOMINATOR / FINE;
/// Greatest distance of a segment from a vertex, fractions: an eighth of a step.
const TOLERANCE: i64 = DENOMINATOR / 8;

/// A part of a thread with a constant ratio.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct AngleSegment {
    pub(super) length: SpindleCounts,
    /// Steps per count, in fractions of [`DENOMINATOR`].
    pub(super) numerator: i64,
}

/// The path of an axis over the angle, from the start of a thread on.
#[derive(Clone, Debug, Default)]
pub(super) struct AngleSegments {
    /// The angle up to which segments were made, and their sum in fractions.
    at: SpindleCounts,
    sum: i64,
    /// Positions that are not in a segment yet, in fractions from the start.
    vertices: VecDeque<(SpindleCounts, i64)>,
}

impl AngleSegments {
    /// Adds the position, in fractions from the start, at an angle after the last one.
    pub(super) fn add(&mut self, at: SpindleCounts, position: i64) {
        let last = self.vertices.back().map_or(self.at, |(last, _)| *last);
        if at > last {
            self.vertices.push_back((at, position));
        } else if let Some((_, known)) = self.vertices.back_mut() {
            *known = position;
        }
    }

    /// Returns the angle up to which segments were made, counts from the start.
    pub(super) const fn reached(&self) -> SpindleCounts {
        self.at
    }

    /// Converts all positions to segments, as long as possible within the tolerance.
    pub(super) fn compress(&mut self, segments: &mut Vec<AngleSegment>) {
        while let Some(&(first, _)) = self.vertices.front() {
            let (mut least, mut most) = (i64::MIN, i64::MAX);
            let mut best = (first, 0, 0);
            for (taken, &(at, position)) in self.vertices.iter().enumerate() {
                let length = (at - self.at).0;
                let distance = position - self.sum;
                let low = least.max(-((TOLERANCE - distance).div_euclid(length)));
                let high = most.min((distance + TOLERANCE).div_euclid(length));
                if low > high {
                    break;
                }
                (least, most) = (low, high);
                let nearest = (2 * distance + length).div_euclid(2 * length);
                best = (at, nearest.clamp(low, high), taken + 1);
            }
            // A single position always fits: its interval has a whole number unless the segment is
            // longer than the tolerance has fractions.
            let (end, numerator, taken) = if best.2 == 0 { (first, 0, 1) } else { best };
            let length = end - self.at;
            segments.push(AngleSegment { length, numerator });
            self.vertices.drain(..taken);
            self.sum += numerator * length.0;
            self.at = end;
        }
    }

    /// Ends the path exactly at `position`, fractions from the start: corrects the rest in one
    /// count. In a last count without motion the board makes a step back that it still holds.
    pub(super) fn finish(&mut self, position: i64, segments: &mut Vec<AngleSegment>) {
        self.compress(segments);
        let one = SpindleCounts(1);
        for numerator in [position - self.sum, 0] {
            segments.push(AngleSegment {
                length: one,
                numerator,
            });
            self.at = self.at + one;
        }
        self.sum = position;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Follows positions at angles and returns the segments and their greatest error, steps.
    fn follow(path: &[(i64, i64)], flush: usize) -> (Vec<AngleSegment>, f64) {
        let mut axis = AngleSegments::default();
        let mut segments = Vec::new();
        for (index, (at, position)) in path.iter().enumerate() {
            axis.add(SpindleCounts(*at), *position);
            if index % flush == flush - 1 {
                axis.compress(&mut segments);
            }
        }
        let end = path.last().unwrap().1;
        axis.finish(end, &mut segments);
        let (mut at, mut sum, mut worst) = (0, 0, 0);
        let mut wanted = path.iter().peekable();
        for segment in &segments {
            for _ in 0..segment.length.0 {
                at += 1;
                sum += segment.numerator;
                if let Some((_, position)) = wanted.next_if(|(next, _)| *next == at) {
                    worst = worst.max((sum - position).abs());
                }
            }
        }
        assert_eq!((sum, wanted.next()), (end, None));
        (segments, worst as f64 / DENOMINATOR as f64)
    }

    #[test]
    fn a_constant_lead_is_one_segment_and_exact() {
        // 400 steps a turn of 4096 counts, a position each 41 counts.
        let path: Vec<_> = (1..500)
            .map(|tick| (tick * 41, tick * 41 * DENOMINATOR * 400 / 4096))
            .collect();
        let (segments, worst) = follow(&path, 1000);
        assert_eq!(segments.len(), 3, "one, and the two of the end");
        assert!(worst < 1e-3, "{worst}");
    }

    proptest! {
        #[test]
        fn no_position_is_missed(speeds in prop::collection::vec(-2000i64..2000, 1..200), counts in 1i64..200, flush in 1usize..20) {
            let (mut at, mut position) = (0, 0);
            let path: Vec<_> = speeds.iter().map(|speed| {
                at += counts;
                position += speed * 500;
                (at, position)
            }).collect();
            let (_, worst) = follow(&path, flush);
            prop_assert!(worst <= 0.125, "{worst}");
        }
    }
}
