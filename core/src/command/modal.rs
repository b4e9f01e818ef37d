//! The modal state of a part program.

use serde::{Deserialize, Serialize};

use crate::command::MotionCode;

/// Codes and words that stay in force from block to block, as the pages show them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModalState {
    /// Group 01: the motion code in force.
    pub motion: MotionCode,
    /// Group 02: constant surface speed on (G96) or off (G97).
    pub surface_speed: bool,
    /// Group 03: feed per revolution (G99) or per minute (G98).
    pub feed_per_revolution: bool,
    /// Group 04: G40, G41 or G42, by number.
    pub nose_compensation: u8,
    /// Whether the input is in inches (G20), not metric (G21).
    pub inch: bool,
    /// F word in force, in the unit of its group-03 code; 0 = none yet.
    pub feed: f64,
    /// S word in force: r/min, m/min or a step number.
    pub spindle: f64,
    /// Tool number in force; 0 for none.
    pub tool: u8,
    /// Tool offset number in force; 0 for none.
    pub offset: u8,
    /// The last M code that a block output; `None` before the first one.
    pub m: Option<u8>,
}

impl Default for ModalState {
    /// The state at power-on (manual I-3.2, table 3-7).
    fn default() -> Self {
        Self {
            motion: MotionCode::Rapid,
            surface_speed: false,
            feed_per_revolution: false,
            nose_compensation: 40,
            inch: false,
            feed: 0.0,
            spindle: 0.0,
            tool: 0,
            offset: 0,
            m: None,
        }
    }
}
