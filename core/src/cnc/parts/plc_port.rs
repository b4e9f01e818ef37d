//! The PLC and what passes between it and the control.

use std::sync::Arc;

use gsk_plc::{Ladder, Plc};
use serde::{Deserialize, Serialize};

use crate::operation::{FromPlc, InputFilter, OutputTimers, Turning, X_BYTES};
use crate::units::PerAxis;

/// Bytes of outputs.
const Y_BYTES: usize = 20;

/// The PLC at its port.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct PlcPort {
    /// The ladder engine with its memory.
    pub engine: Plc,
    /// G signals of the last slot.
    pub signals: FromPlc,
    /// Contacts that are accepted.
    pub filter: InputFilter,
    /// Contacts that the keys of the machine panel close.
    pub panel_keys: [u8; X_BYTES],
    /// A soft switch on its way.
    pub turning: Option<Turning>,
    /// The OUTPUT key is down.
    pub output_key: bool,
    /// The soft machine panel, as F75 has it.
    pub soft_switches: u8,
    /// The ladder stands still, for stepping.
    pub halted: bool,
    /// The ladder that the next power-on loads.
    pub next_ladder: Option<Arc<Ladder>>,
    /// A message of the ladder stands.
    pub message: bool,
    /// Outputs, as last refreshed.
    pub y: Vec<u8>,
    /// Outputs that a program has switched for a time.
    #[serde(default, skip_serializing_if = "OutputTimers::is_idle")]
    pub output_timers: OutputTimers,
    /// Inputs that act by themselves, as they were sampled last.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub input_levels: u32,
    /// Outputs of the ladder that outputs of the model follow, as they were last.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub followed: u32,
    /// Axes whose last motion went minus.
    pub negative: PerAxis<bool>,
    /// The last motion was a rapid.
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
    /// At power-on.
    pub(crate) fn new(engine: Plc) -> Self {
        Self {
            signals: FromPlc::read(engine.memory()),
            engine,
            filter: InputFilter::default(),
            panel_keys: [0; X_BYTES],
            turning: None,
            output_key: false,
            soft_switches: 0,
            halted: false,
            next_ladder: None,
            message: false,
            y: vec![0; Y_BYTES],
            output_timers: OutputTimers::default(),
            input_levels: 0,
            followed: 0,
            negative: PerAxis::default(),
            last_rapid: false,
        }
    }
}
