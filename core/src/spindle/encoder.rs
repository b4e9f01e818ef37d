//! Measures the spindle speed from the encoder counts.

use serde::{Deserialize, Serialize};

use crate::memory::ControlParameters;
use crate::units::TICK_S;

/// Time constant of the filter, ticks. One count more or less in a tick is ±15 r/min with
/// 1024 lines; the filter reduces it to ±0.2.
const FILTER_TICKS: f64 = 32.0;
/// Ticks without a count after which the speed is zero.
const STANDSTILL_TICKS: u16 = 200;

/// Measures the spindle speed from the counts of the encoder.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Encoder {
    #[serde(rename = "last")]
    last_count: Option<i64>,
    rpm: f64,
    #[serde(rename = "quiet")]
    quiet_ticks: u16,
    counted: bool,
}

impl Encoder {
    /// Encoder counts in one revolution of the encoder: four per line (070). `None` outside
    /// 100–5000 lines, where the encoder cannot be used (alarm 092).
    pub(crate) fn counts_per_turn(parameters: &ControlParameters) -> Option<i64> {
        let lines = i64::from(parameters.encoder_lines());
        (100..=5000).contains(&lines).then_some(4 * lines)
    }

    /// Encoder counts in one revolution of the *spindle*, through the gear ratio 110 : 111;
    /// `None` as for [`counts_per_turn`](Self::counts_per_turn).
    pub(crate) fn counts_per_spindle_turn(parameters: &ControlParameters) -> Option<f64> {
        let counts = Self::counts_per_turn(parameters)? as f64;
        Some(counts / parameters.encoder_ratio())
    }

    /// Returns the measured spindle speed, r/min; negative in reverse.
    pub const fn rpm(&self) -> f64 {
        self.rpm
    }

    /// Whether the encoder has counted since power-on.
    pub(crate) const fn has_counted(&self) -> bool {
        self.counted
    }

    /// Advances one tick with the absolute count; `rpm_per_count` is r/min per count and tick.
    pub fn tick(&mut self, count: i64, rpm_per_count: f64) {
        let step = count - self.last_count.unwrap_or(count);
        self.last_count = Some(count);
        if step != 0 {
            self.quiet_ticks = 0;
            self.counted |= rpm_per_count > 0.0;
        } else if self.quiet_ticks < STANDSTILL_TICKS {
            self.quiet_ticks += 1;
        } else {
            self.rpm = 0.0;
            return;
        }
        self.rpm += (step as f64 * rpm_per_count - self.rpm) / FILTER_TICKS;
    }

    /// Sets the speed (r/min) that a pulse board measures, which replaces the counts.
    pub(super) const fn set_measured_rpm(&mut self, rpm: f64) {
        self.last_count = None;
        self.counted |= rpm != 0.0;
        self.rpm = rpm;
    }

    /// Scale of the counts: r/min for one count per tick; 0 if the encoder cannot be used.
    pub(super) fn rpm_per_count(parameters: &ControlParameters) -> f64 {
        Self::counts_per_spindle_turn(parameters).map_or(0.0, |counts| 60.0 / (counts * TICK_S))
    }
}
