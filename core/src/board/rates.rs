//! Compares the pulse rates that motion needs with those of the board.

use super::BoardDrives;
use crate::units::{Axis, Point};
use gsk_messages::{Message, say};

/// Factor by which a pulse rate may exceed its limit, because of rounding.
const ROUNDING_FACTOR: f64 = 1.0 + 1e-9;

/// The axes whose motion needs a higher pulse rate than the board has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ExceededAxes {
    /// This axis exceeds its pulse rate limit.
    One(Axis),
    /// Both axes together exceed the common pulse rate limit.
    Both,
}

impl ExceededAxes {
    /// Names the axis, or both axes together, for an alarm.
    pub(crate) fn to_message(self) -> Message {
        match self {
            Self::One(axis) => say::as_written(format!("{axis:?}")),
            Self::Both => say::both_axes_together(),
        }
    }
}

impl BoardDrives {
    fn pulse_rates(&self, speed: Point) -> [f64; 2] {
        let [x, z] = self.pulses_per_mm;
        [speed.x.abs() / 60.0 * x, speed.z.abs() / 60.0 * z]
    }

    /// The first pulse rate of the board that a speed (mm/min per axis) exceeds: the axes,
    /// the needed and the available pulses per second. `None`: the speed is possible.
    pub(crate) fn exceeded_rate(
        &self,
        speed: Point,
        on_arc: bool,
    ) -> Option<(ExceededAxes, f64, f64)> {
        let [x, z] = self.pulse_rates(speed);
        // On an arc one axis is fastest where the other one has no speed.
        let both = if on_arc { libm::hypot(x, z) } else { x + z };
        let [max_x, max_z] = self.rates.each;
        [
            (ExceededAxes::One(Axis::X), x, max_x),
            (ExceededAxes::One(Axis::Z), z, max_z),
            (ExceededAxes::Both, both, self.rates.both),
        ]
        .into_iter()
        .find(|(_, needed, made)| *needed > *made * ROUNDING_FACTOR)
    }

    /// Highest manual speed of an axis, mm/min, that is possible at any speed of the other
    /// axis.
    pub(crate) fn manual_speed_limit(&self, axis: Axis) -> f64 {
        let [each_x, each_z] = self.rates.each;
        let [per_x, per_z] = self.pulses_per_mm;
        let (each, per_mm) = match axis {
            Axis::X => (each_x, per_x),
            Axis::Z => (each_z, per_z),
        };
        each.min(self.rates.both / 2.0) / per_mm * 60.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_link::PulseRates;

    #[test]
    fn both_axes_together_have_their_own_limit() {
        let board = BoardDrives {
            pulses_per_mm: [400.0, 200.0],
            rates: PulseRates {
                each: [30_000.0, 30_000.0],
                both: 40_000.0,
            },
            ..BoardDrives::default()
        };
        let exceeded = |x, z, on_arc| {
            let found = board.exceeded_rate(Point::new(x, z), on_arc);
            found.map(|(axes, needed, _)| (axes, needed as u32))
        };
        assert_eq!(exceeded(4500.0, 3000.0, false), None);
        assert_eq!(
            exceeded(4600.0, 0.0, false),
            Some((ExceededAxes::One(Axis::X), 30_666))
        );
        assert_eq!(
            exceeded(0.0, 9600.0, false),
            Some((ExceededAxes::One(Axis::Z), 32_000))
        );
        assert_eq!(
            exceeded(4500.0, 3600.0, false),
            Some((ExceededAxes::Both, 42_000))
        );
        assert_eq!(exceeded(4500.0, 4500.0, true), None);
        assert!((board.manual_speed_limit(Axis::X) - 3000.0).abs() < 1e-9);
        assert!((board.manual_speed_limit(Axis::Z) - 6000.0).abs() < 1e-9);
    }
}
