//! The drives as the control is going to move them: what a board is opened for.

use gsk_units::PerAxis;

/// The board's rates stand so far above the control's that they never limit.
const RATE_MARGIN: f64 = 1.2;
/// Likewise the acceleration, and not less than this, mm/s².
const LEAST_ACCELERATION: f64 = 2000.0;
const ACCELERATION_MARGIN: f64 = 10.0;

/// How fast the board must let an axis go, so that it never limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisRates {
    /// mm/min.
    pub rate: f64,
    /// mm/s².
    pub acceleration: f64,
}

impl AxisRates {
    /// From the rapid rate, mm/min, its time constant, ms, and the highest feed, mm/min.
    pub fn new(rapid: f64, time: f64, feed: f64) -> Self {
        let control = rapid / 60.0 / (time.max(1.0) / 1000.0);
        Self {
            rate: (RATE_MARGIN * rapid.max(feed)).ceil(),
            acceleration: (ACCELERATION_MARGIN * control)
                .max(LEAST_ACCELERATION)
                .ceil(),
        }
    }
}

/// The drives of X and Z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drives {
    /// Slide travel of one pulse, mm.
    pub pulse_weight: PerAxis<f64>,
    /// What the board must let them go.
    pub rates: PerAxis<AxisRates>,
}

impl Drives {
    /// Pulses per mm of slide travel, X and Z.
    pub fn pulses_per_mm(&self) -> [f64; 2] {
        [1.0 / self.pulse_weight.x, 1.0 / self.pulse_weight.z]
    }
}
