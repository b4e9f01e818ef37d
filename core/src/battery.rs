//! The battery-backed memory: what the control keeps while its power is off.

use serde::{Deserialize, Serialize};

use crate::memory::{
    Authority, ControlParameters, ControlSettings, Counters, Disks, Offsets, PitchTable, Variables,
};
use crate::model::ControlModel;
use crate::program::ProgramMemory;

/// The battery-backed memory (manual III-11). The PLC memory is separate.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BatteryMemory {
    /// Parameters by number: bits and values.
    pub parameters: ControlParameters,
    /// Tool offsets: X, Z, nose radius R and tip T of each number.
    pub offsets: Offsets,
    /// Pitch error corrections by axis and point, 0–255.
    pub pitch: PitchTable,
    /// Macro variables; [`power_on`](Self::power_on) clears the volatile ones.
    pub variables: Variables,
    /// The rows of the setting page, inch input (英制编程) among them.
    pub settings: ControlSettings,
    /// Operation level and passwords that protect programs and parameters.
    pub authority: Authority,
    /// The electronic disks that hold sets of parameter values (manual III-2.1.10).
    pub disks: Disks,
    /// Program memory: all stored programs by O number.
    pub programs: ProgramMemory,
    /// Part counter and cutting time.
    pub counters: Counters,
    /// The control model with its model-specific parameters.
    #[serde(default, skip_serializing_if = "ControlModel::is_delivered_main")]
    pub model: ControlModel,
}

impl BatteryMemory {
    /// Switches to a control model and takes over the values that its parameters are
    /// delivered with.
    pub fn set_model(&mut self, model: ControlModel) {
        self.parameters.apply_delivered_values(model.record());
        self.model = model;
    }

    /// Applies power-on: volatile values are cleared and the operation level falls back.
    pub fn power_on(&mut self) {
        self.parameters.power_on();
        self.variables.power_on();
        self.authority.power_on();
    }
}
