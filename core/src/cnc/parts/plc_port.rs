//! The PLC and its interface to the control.

use std::sync::Arc;

use gsk_plc::{Ladder, Plc};
use serde::{Deserialize, Serialize};

use crate::operation::{FromPlc, InputFilter, OutputTimers, SoftSwitchChange, X_BYTES};
use crate::units::PerAxis;

/// Number of output bytes in the Y area.
const Y_BYTES: usize = 20;

/// The PLC with its interface to the control.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct PlcPort {
    /// Executes the ladder and contains the PLC memory.
    pub engine: Plc,
    /// G signals of the ladder after the last slot.
    pub signals: FromPlc,
    /// Filter that debounces the machine contacts.
    pub filter: InputFilter,
    /// Contacts X that the keys of the machine panel close, as bits.
    pub panel_keys: [u8; X_BYTES],
    /// A soft switch that is changing to a new state; `None` without one.
    #[serde(rename = "turning")]
    pub switch_change: Option<SoftSwitchChange>,
    /// Whether the OUTPUT key of the panel is down.
    pub output_key: bool,
    /// Switches of the soft machine panel, as the bits of F75.
    pub soft_switches: u8,
    /// Whether the ladder is halted, to be executed in single steps.
    pub halted: bool,
    /// The ladder that the next power-on loads; `None` if the current ladder stays.
    pub next_ladder: Option<Arc<Ladder>>,
    /// Whether a message of the ladder is active.
    pub message: bool,
    /// Output bytes Y when they were last written to the machine.
    pub y: Vec<u8>,
    /// Timers of outputs that a program has switched.
    #[serde(default, skip_serializing_if = "OutputTimers::is_idle")]
    pub output_timers: OutputTimers,
    /// Levels, at the last sample, of the inputs that have a function in the control model, as
    /// bits.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub input_levels: u32,
    /// Levels, at the last sample, of the keys that only the panel of the control model has, as
    /// bits.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub model_keys: u32,
    /// Levels, at the last sample, of the ladder outputs that outputs of the control model follow,
    /// as bits.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[serde(rename = "followed")]
    pub followed_levels: u32,
    /// Axes whose last motion was in the negative direction.
    pub negative: PerAxis<bool>,
    /// Whether the last motion was a rapid.
    pub last_rapid: bool,
}

#[expect(
    clippy::trivially_copy_pass_by_ref,
    reason = "the form that serde asks for"
)]
const fn is_zero(levels: &u32) -> bool {
    *levels == 0
}

impl PlcPort {
    /// Creates the port in its state at power-on.
    pub(crate) fn new(engine: Plc) -> Self {
        Self {
            signals: FromPlc::read(engine.memory()),
            engine,
            filter: InputFilter::default(),
            panel_keys: [0; X_BYTES],
            switch_change: None,
            output_key: false,
            soft_switches: 0,
            halted: false,
            next_ladder: None,
            message: false,
            y: vec![0; Y_BYTES],
            output_timers: OutputTimers::default(),
            input_levels: 0,
            model_keys: 0,
            followed_levels: 0,
            negative: PerAxis::default(),
            last_rapid: false,
        }
    }
}
