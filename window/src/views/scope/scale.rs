//! The value range of a lane, in round steps.

use super::trace::Quantity;

/// The range of values that a lane shows, in the unit of its quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LaneRange {
    /// Value at the lower edge of the lane, in the unit of its trace.
    pub low: f64,
    /// Value at the upper edge of the lane, in the unit of its trace.
    pub high: f64,
}

impl LaneRange {
    /// Returns the smallest range of a quantity, centred at a value.
    pub fn around_value(value: f64, quantity: Quantity) -> Self {
        let half = quantity.least_range() / 2.0;
        Self {
            low: value - half,
            high: value + half,
        }
    }

    /// The difference between the values at both edges of the lane, in the unit of its trace.
    pub fn span(self) -> f64 {
        self.high - self.low
    }

    /// Returns the range for values from `low` to `high`. The present range is kept while they
    /// fit, so that the picture does not move.
    pub fn fit_values(self, low: f64, high: f64, quantity: Quantity) -> Self {
        let needed = (high - low).max(quantity.least_range());
        let edge = self.span() * 0.04;
        let is_inside = self.low + edge <= low && self.high - edge >= high;
        let fits = is_inside && self.span() <= 2.5 * needed;
        if fits {
            return self;
        }
        let middle = f64::midpoint(low, high);
        let half = needed * 0.6;
        let step = round_step(needed, 4.0);
        Self {
            low: ((middle - half) / step).floor() * step,
            high: ((middle + half) / step).ceil() * step,
        }
    }

    /// Scales the range by `factor`. The value at `at`, 0 to 1 from the lower edge, keeps its
    /// position.
    pub fn zoom(&mut self, factor: f64, at: f64) {
        let fixed = self.low + at * self.span();
        self.low = fixed - (fixed - self.low) * factor;
        self.high = fixed + (self.high - fixed) * factor;
    }

    /// Shifts the range by `share` of its span.
    pub fn shift(&mut self, share: f64) {
        let offset = self.span() * share;
        self.low += offset;
        self.high += offset;
    }
}

/// Returns a step of 1, 2 or 5 times a power of ten that divides a range into about `parts`
/// parts.
pub fn round_step(range: f64, parts: f64) -> f64 {
    let rough = (range / parts).max(1e-9);
    let ten = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .find(|step| step * ten >= rough * 0.999)
        .unwrap_or(10.0);
    step * ten
}

/// Number of decimals that the multiples of a step need, at most 6.
pub fn step_decimals(step: f64) -> usize {
    (-step.log10().floor()).clamp(0.0, 6.0) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_round() {
        for (range, parts, step) in [
            (10.0, 5.0, 2.0),
            (1.0, 4.0, 0.5),
            (7.0, 7.0, 1.0),
            (0.03, 3.0, 0.01),
        ] {
            assert!(
                (round_step(range, parts) - step).abs() < 1e-12,
                "{range} in {parts}"
            );
        }
        assert_eq!(
            (
                step_decimals(0.05),
                step_decimals(1.0),
                step_decimals(200.0)
            ),
            (2, 0, 0)
        );
    }

    #[test]
    fn a_range_stands_still_while_it_fits() {
        let range = LaneRange::around_value(0.0, Quantity::Speed).fit_values(
            -3000.0,
            3000.0,
            Quantity::Speed,
        );
        assert!(range.low <= -3000.0 && range.high >= 3000.0);
        assert_eq!(range.fit_values(-2800.0, 2900.0, Quantity::Speed), range);
        assert_ne!(range.fit_values(0.0, 10.0, Quantity::Speed), range);
        assert!(range.fit_values(0.0, 9000.0, Quantity::Speed).high >= 9000.0);
    }
}
