//! The spindle: control, angle and override.

use serde::{Deserialize, Serialize};

use crate::memory::ControlParameters;
use crate::spindle::{SpindleAngle, SpindleControl};

/// State and commands of the spindle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct SpindleUnit {
    /// Speed, gears, constant surface speed.
    pub control: SpindleControl,
    /// Angle measured by the encoder.
    pub angle: SpindleAngle,
    /// Spindle override in force, %; a change during a thread waits for its end.
    pub override_percent: u8,
}

impl SpindleUnit {
    /// State at power-on: standstill.
    pub(crate) fn new(parameters: &ControlParameters) -> Self {
        Self {
            control: SpindleControl::new(parameters),
            angle: SpindleAngle::new(parameters),
            override_percent: 100,
        }
    }
}
