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
    /// Values of the parameters, by number.
    pub parameters: ControlParameters,
    /// Tool offsets: X, Z, nose radius R and tip direction T of each offset number.
    pub offsets: Offsets,
    /// Pitch errors of both axes at the points 0 to 255.
    pub pitch: PitchTable,
    /// Macro variables; [`power_on`](Self::power_on) clears those that are not retained.
    pub variables: Variables,
    /// The settings of the setting page, such as inch input (英制编程).
    pub settings: ControlSettings,
    /// Active operation level, and the passwords of all levels.
    pub authority: Authority,
    /// The electronic disks: saved sets of parameters, offsets and pitch errors (manual
    /// III-2.1.10).
    pub disks: Disks,
    /// The stored programs, and which one is selected.
    pub programs: ProgramMemory,
    /// Part counter, cutting time and the counters of macro B.
    pub counters: Counters,
    /// The control model, with the values of the parameters that only this model has.
    #[serde(default, skip_serializing_if = "ControlModel::is_delivered_main")]
    pub model: ControlModel,
}

impl BatteryMemory {
    /// Switches to the control model `model`, and sets the parameters to its delivered values
    /// where these differ from the GSK980TD.
    pub fn set_model(&mut self, model: ControlModel) {
        self.parameters.apply_delivered_values(model.record());
        self.model = model;
    }

    /// Changes the data as power-on does: corrects parameters, clears variables that are not
    /// retained, and lowers a high operation level.
    pub fn power_on(&mut self) {
        self.parameters.power_on();
        self.variables.power_on();
        self.authority.power_on();
    }
}
