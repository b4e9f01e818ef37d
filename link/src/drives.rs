//! Pulse weights of the drives, and the rates that a board must allow.

use gsk_units::PerAxis;

/// Ratio of the greatest rate set in the board to the greatest rate of the control: the board must
/// never limit a move.
const RATE_MARGIN: f64 = 1.2;
/// Least acceleration that the link sets in the board, mm/s².
const LEAST_ACCELERATION: f64 = 2000.0;
/// Ratio of the acceleration set in the board to the acceleration of the control.
const ACCELERATION_MARGIN: f64 = 10.0;

/// The limits of an axis in the board, set so high that the board never limits a move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisRates {
    /// Greatest rate of the axis, mm/min.
    pub rate: f64,
    /// Greatest acceleration of the axis, mm/s².
    pub acceleration: f64,
}

impl AxisRates {
    /// Computes the limits from the rapid rate, mm/min, its time constant, ms, and the
    /// greatest feed, mm/min.
    pub fn new(rapid: f64, time_ms: f64, feed: f64) -> Self {
        let control = rapid / 60.0 / (time_ms.max(1.0) / 1000.0);
        Self {
            rate: (RATE_MARGIN * rapid.max(feed)).ceil(),
            acceleration: (ACCELERATION_MARGIN * control)
                .max(LEAST_ACCELERATION)
                .ceil(),
        }
    }
}

/// The pulse weight of X and Z, and the limits of speed and acceleration of their drives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drives {
    /// Distance that the slide moves with one pulse, mm, for each axis.
    pub pulse_weight: PerAxis<f64>,
    /// Rate and acceleration that the board must permit for each axis.
    pub rates: PerAxis<AxisRates>,
}

impl Drives {
    /// Returns the number of pulses per mm of slide travel, for X and Z.
    pub fn pulses_per_mm(&self) -> [f64; 2] {
        [1.0 / self.pulse_weight.x, 1.0 / self.pulse_weight.z]
    }
}
