//! The spindle: its control, its angle, the override in force.

use serde::{Deserialize, Serialize};

use crate::memory::Parameters;
use crate::spindle::{SpindleAngle, SpindleControl};

/// What the control knows and commands of the spindle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct SpindleUnit {
    /// Speed, gears, constant surface speed.
    pub control: SpindleControl,
    /// Angle by the encoder.
    pub angle: SpindleAngle,
    /// Spindle override in force, %; a change waits for the end of a thread.
    pub override_percent: u8,
}

impl SpindleUnit {
    /// At power-on: it stands.
    pub(crate) fn new(parameters: &Parameters) -> Self {
        Self {
            control: SpindleControl::new(parameters),
            angle: SpindleAngle::new(parameters),
            override_percent: 100,
        }
    }
}
