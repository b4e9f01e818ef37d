//! The spindle: control, angle and override.

use serde::{Deserialize, Serialize};

use crate::memory::ControlParameters;
use crate::spindle::{SpindleAngle, SpindleControl};

/// The spindle as the control drives and measures it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct SpindleUnit {
    /// Computes commanded speed, gear and measured speed of the spindle.
    pub control: SpindleControl,
    /// Spindle angle, estimated from the encoder or measured by a board.
    pub angle: SpindleAngle,
    /// Spindle override that is applied, %; a change during a thread waits for its end.
    pub override_percent: u8,
}

impl SpindleUnit {
    /// Creates the state at power-on, with the spindle at standstill.
    pub(crate) fn new(parameters: &ControlParameters) -> Self {
        Self {
            control: SpindleControl::new(parameters),
            angle: SpindleAngle::new(parameters),
            override_percent: 100,
        }
    }
}
