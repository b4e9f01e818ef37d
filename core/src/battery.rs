//! What the control keeps while its power is off, by battery: parameters, offsets,
//! programs and the rest of what its owner and its operator have put in.

use serde::{Deserialize, Serialize};

use crate::memory::{
    Authority, Counters, Disks, Offsets, Parameters, PitchTable, Settings, Variables,
};
use crate::model::ControlModel;
use crate::program::ProgramMemory;

/// The battery-backed memory (manual III-11); the PLC keeps its own.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Memory {
    /// Parameters.
    pub parameters: Parameters,
    /// Tool offsets.
    pub offsets: Offsets,
    /// Pitch error table.
    pub pitch: PitchTable,
    /// Macro variables.
    pub variables: Variables,
    /// The rows of the setting page, 英制编程 among them.
    pub settings: Settings,
    /// Operation level and passwords.
    pub authority: Authority,
    /// The electronic disks.
    pub disks: Disks,
    /// Program memory.
    pub programs: ProgramMemory,
    /// Part counter and cutting time.
    pub counters: Counters,
    /// Which control it is, with the parameters that only this one has.
    #[serde(default, skip_serializing_if = "ControlModel::is_delivered_main")]
    pub model: ControlModel,
}

impl Memory {
    /// Becomes that of a model: parameters of the control have the values that it is
    /// delivered with, where these are its own.
    pub fn set_model(&mut self, model: ControlModel) {
        self.parameters.take_delivered(model.record());
        self.model = model;
    }

    /// What power-on does to it: values that never outlast it go, the operation level
    /// falls back.
    pub fn power_on(&mut self) {
        self.parameters.power_on();
        self.variables.power_on();
        self.authority.power_on();
    }
}
