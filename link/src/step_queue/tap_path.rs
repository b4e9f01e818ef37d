//! The path of a tap over the angle of the spindle: a lead-in, then the lead. Z is a function of
//! the angle, the same on the way in and on the way back.
//!
//! ```text
//!  steps │            .·┊
//!        │         .·'  ┊       first segment: the ratio grows at each count
//!        │      .·'     ┊       last segment: the lead, as far as the board follows
//!        └──┴───────┴───┴─► counts
//!         lead-in  depth bound
//! ```

use super::spindle_angle::SpindleCounts;
use crate::TapOrder;

/// Fractions of a step in which the ratios of a tap are given.
pub(super) const TAP_DENOMINATOR: i64 = 1 << 24;
/// Greatest number of counts of a tap.
const MOST_COUNTS: i64 = 1 << 30;
/// Greatest number of steps in a count: more than the axis may lag.
const MOST_RATIO: i64 = 8 * TAP_DENOMINATOR;

/// The path of a tap, in counts from its start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TapPath {
    /// Length and first ratio of the lead-in, and the growth of the ratio at each count.
    lead_in: (i64, i64, i64),
    /// Ratio of the lead.
    ratio: i64,
    /// Counts at which the programmed depth is reached.
    pub(super) depth: SpindleCounts,
    /// Counts at which the path ends: the board shuts down there.
    pub(super) bound: SpindleCounts,
}

impl TapPath {
    /// Creates the path of a tap; `None` for a lead that the board cannot make.
    pub(super) fn new(order: &TapOrder, counts_per_turn: u32) -> Option<Self> {
        let counts_per_turn = f64::from(counts_per_turn);
        let ratio = libm::round(order.lead / counts_per_turn * TAP_DENOMINATOR as f64) as i64;
        if !(1..=MOST_RATIO).contains(&ratio) {
            return None;
        }
        let first = libm::round(ratio as f64 * order.first_share.clamp(0.0, 1.0)) as i64;
        let wanted = (order.lead_in_turns * counts_per_turn).clamp(0.0, MOST_COUNTS as f64) as i64;
        let lead_in = if wanted > 0 && first < ratio {
            let growth = (ratio - first + wanted - 1) / wanted;
            ((ratio - first) / growth, first, growth)
        } else {
            (0, ratio, 0)
        };
        let mut path = Self {
            lead_in,
            ratio,
            depth: SpindleCounts(MOST_COUNTS),
            bound: SpindleCounts(MOST_COUNTS),
        };
        path.depth = path.first_at(order.depth.abs());
        path.bound = path.first_at(order.bound.max(order.depth.abs()));
        path.bound.0 = path.bound.0.max(lead_in.0 + 1);
        (path.bound.0 < MOST_COUNTS).then_some(path)
    }

    /// Returns the first count at which the distance from the start is at least `distance`, steps.
    fn first_at(&self, distance: f64) -> SpindleCounts {
        let (mut low, mut high) = (1, MOST_COUNTS);
        while low < high {
            let middle = low + (high - low) / 2;
            if self.distance(SpindleCounts(middle)) >= distance {
                high = middle;
            } else {
                low = middle + 1;
            }
        }
        SpindleCounts(low)
    }

    /// Returns the distance from the start at an angle, steps; 0 before the start.
    pub(super) fn distance(&self, at: SpindleCounts) -> f64 {
        let counts = at.0.clamp(0, MOST_COUNTS);
        let (length, first, growth) = self.lead_in;
        let begun = counts.min(length);
        let sum = i128::from(begun * first)
            + i128::from(growth) * i128::from(begun * (begun - 1).max(0) / 2)
            + i128::from(counts - begun) * i128::from(self.ratio);
        sum as f64 / TAP_DENOMINATOR as f64
    }

    /// Returns the segments for the board, each with its length, its first numerator, and the
    /// growth of the numerator at each count. `sign` is the direction of the steps on the way in.
    pub(super) fn segments(&self, sign: i64) -> Vec<[i64; 3]> {
        let (length, first, growth) = self.lead_in;
        let lead_in = [length, sign * first, sign * growth];
        let lead = [self.bound.0 - length, sign * self.ratio, 0];
        [lead_in, lead]
            .into_iter()
            .filter(|segment| segment[0] > 0)
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_units::{PerAxis, Pulses};
    use proptest::prelude::*;

    const COUNTS: u32 = 4096;

    fn order(lead: f64, depth: f64, lead_in_turns: f64, first_share: f64) -> TapOrder {
        TapOrder {
            start: PerAxis::new(Pulses(0), Pulses(0)),
            depth,
            bound: depth.abs() + 1000.0,
            lead,
            start_degrees: 0.0,
            lead_in_turns,
            first_share,
        }
    }

    #[test]
    fn a_lead_in_lags_by_half_of_its_turns() {
        let path = TapPath::new(&order(300.0, -3000.0, 0.5, 0.0), COUNTS).unwrap();
        // Ten turns and a quarter of a turn.
        let turns = path.depth.0 as f64 / f64::from(COUNTS);
        assert!((turns - 10.25).abs() < 0.01, "{turns}");
        let at = |turns: f64| path.distance(SpindleCounts((turns * 4096.0) as i64));
        assert!((at(5.0) - at(4.0) - 300.0).abs() < 1e-3);
        assert_eq!((at(0.0), at(-1.0)), (0.0, 0.0));
    }

    #[test]
    fn an_impossible_lead_is_refused() {
        assert_eq!(TapPath::new(&order(0.0, 10.0, 0.0, 1.0), COUNTS), None);
        assert_eq!(TapPath::new(&order(40_000.0, 10.0, 0.0, 1.0), COUNTS), None);
        assert_eq!(TapPath::new(&order(0.01, 1e6, 0.0, 1.0), COUNTS), None);
    }

    proptest! {
        /// The segments are the path: their sums are its distances, on both sides of their joint.
        #[test]
        fn the_segments_make_the_path(lead in 1.0..4000.0_f64, depth in 1.0..5000.0_f64, lead_in in 0.0..3.0_f64, share in 0.0..1.2_f64, sign in prop::sample::select(vec![1, -1])) {
            let path = TapPath::new(&order(lead, depth, lead_in, share), COUNTS).unwrap();
            prop_assert!(path.distance(path.depth) >= depth);
            prop_assert!(path.distance(path.depth - SpindleCounts(1)) < depth);
            prop_assert!(path.bound >= path.depth);
            let (mut sum, mut at) = (0, 0);
            for [length, numerator, add] in path.segments(sign) {
                prop_assert!(i32::try_from(numerator + add * length).is_ok());
                for count in 0..length.min(20_000) {
                    sum += numerator + add * count;
                    at += 1;
                    let distance = path.distance(SpindleCounts(at)) * TAP_DENOMINATOR as f64;
                    prop_assert_eq!(sum * sign, distance as i64);
                }
                if length > 20_000 {
                    break;
                }
            }
        }
    }
}
