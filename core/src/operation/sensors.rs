//! Signals of drives and encoder without an X contact, which DGN.008, 011 and 012 show
//! (manual III-12.7.1).

use serde::{Deserialize, Serialize};

use crate::machine::MachineInputs;
use crate::memory::ControlParameters;
use crate::units::{Axis, PerAxis};

/// Display time of the spindle's one-turn signal, ms. The signal lasts a thousandth of a
/// turn, too short for a picture.
const INDEX_DISPLAY_MS: u8 = 60;

/// Signals of drives and encoder in the last tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Sensors {
    /// PC: whether the zero signal of each axis is on.
    pub zero_signal: PerAxis<bool>,
    /// Whether the drive of each axis reports no alarm.
    #[serde(rename = "drive_well")]
    pub drive_ok: PerAxis<bool>,
    /// Count of the spindle encoder since the start, four per line.
    pub encoder: i64,
    mark_left: u8,
}

impl Sensors {
    /// Reads the signals of the machine in a tick.
    pub fn update(&mut self, inputs: &MachineInputs, parameters: &ControlParameters) {
        self.zero_signal = inputs.index_pulse;
        let well = |axis| *inputs.drive_alarm.get(axis) != parameters.drive_alarm_level(axis);
        self.drive_ok = PerAxis::new(well(Axis::X), well(Axis::Z));
        self.encoder = inputs.encoder;
        self.mark_left = if inputs.spindle_index {
            INDEX_DISPLAY_MS
        } else {
            self.mark_left.saturating_sub(1)
        };
    }

    /// Whether the spindle's one-turn signal came within the display time.
    pub const fn is_index_shown(&self) -> bool {
        self.mark_left > 0
    }
}
