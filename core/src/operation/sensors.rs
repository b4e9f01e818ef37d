//! Signals of drives and encoder that have no contact in X: what DGN.008, 011 and
//! 012 show (manual III-12.7.1).

use serde::{Deserialize, Serialize};

use crate::machine::Inputs;
use crate::memory::Parameters;
use crate::units::{Axis, PerAxis};

/// How long the one-turn signal of the spindle is shown, ms: it stands for a
/// thousandth of a turn, too short for a picture.
const MARK_MS: u8 = 60;

/// The signals as they are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Sensors {
    /// PC: the zero signal of each axis stands.
    pub zero_signal: PerAxis<bool>,
    /// The drive gives no alarm.
    pub drive_well: PerAxis<bool>,
    /// Counts of the spindle encoder.
    pub encoder: i64,
    mark_left: u8,
}

impl Sensors {
    /// Once a millisecond.
    pub fn sense(&mut self, inputs: &Inputs, parameters: &Parameters) {
        self.zero_signal = inputs.index_pulse;
        let well = |axis| *inputs.drive_alarm.get(axis) != parameters.drive_alarm_level(axis);
        self.drive_well = PerAxis::new(well(Axis::X), well(Axis::Z));
        self.encoder = inputs.encoder;
        self.mark_left = if inputs.spindle_index {
            MARK_MS
        } else {
            self.mark_left.saturating_sub(1)
        };
    }

    /// The one-turn signal of the spindle came a moment ago.
    pub const fn spindle_mark(&self) -> bool {
        self.mark_left > 0
    }
}
