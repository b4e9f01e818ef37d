//! Speed measured from the counts of the spindle encoder.

use serde::{Deserialize, Serialize};

use crate::memory::Parameters;
use crate::units::TICK_S;

/// Time constant of the filter, ticks: a count more or less in a tick would be
/// ±15 r/min with 1024 lines, filtered it is ±0.2.
const FILTER_TICKS: f64 = 32.0;
/// Without a count for so long the spindle stands, ticks.
const STANDS_AFTER: u16 = 200;

/// Turns encoder counts into r/min.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Encoder {
    last: Option<i64>,
    rpm: f64,
    quiet: u16,
    counted: bool,
}

impl Encoder {
    /// Counts of one encoder turn: four for each line (070); `None` outside
    /// 100…5000 lines, where the encoder cannot be used (alarm 092).
    pub(crate) fn counts_per_turn(parameters: &Parameters) -> Option<i64> {
        let lines = i64::from(parameters.encoder_lines());
        (100..=5000).contains(&lines).then_some(4 * lines)
    }

    /// Counts of one *spindle* turn, through the gearing 110 : 111.
    pub(crate) fn counts_per_spindle_turn(parameters: &Parameters) -> Option<f64> {
        let counts = Self::counts_per_turn(parameters)? as f64;
        Some(counts / parameters.encoder_ratio())
    }

    /// Spindle speed, r/min, signed.
    pub const fn rpm(&self) -> f64 {
        self.rpm
    }

    /// Whether it has counted since power-on.
    pub(crate) const fn has_counted(&self) -> bool {
        self.counted
    }

    /// One tick with the absolute count; `scale` is r/min for one count a tick.
    pub fn tick(&mut self, count: i64, scale: f64) {
        let step = count - self.last.unwrap_or(count);
        self.last = Some(count);
        if step != 0 {
            self.quiet = 0;
            self.counted |= scale > 0.0;
        } else if self.quiet < STANDS_AFTER {
            self.quiet += 1;
        } else {
            self.rpm = 0.0;
            return;
        }
        self.rpm += (step as f64 * scale - self.rpm) / FILTER_TICKS;
    }

    /// The speed comes from elsewhere: a pulse board sees the spindle.
    pub(super) const fn tell(&mut self, rpm: f64) {
        self.last = None;
        self.counted |= rpm != 0.0;
        self.rpm = rpm;
    }

    /// R/min for one count in a tick.
    pub(super) fn scale(parameters: &Parameters) -> f64 {
        Self::counts_per_spindle_turn(parameters).map_or(0.0, |counts| 60.0 / (counts * TICK_S))
    }
}
