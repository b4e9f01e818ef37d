//! From the path to the pulses, and the drives behind them.

use serde::{Deserialize, Serialize};

use crate::alarm::Alarm;
use crate::axis::{AxisChain, SoftLimits};
use crate::battery::Memory;
use crate::board::BoardDrives;
use crate::motion::{Interpolator, MotionLimits};
use crate::operation::{DriveWatch, Sensors};
use crate::units::{Axis, Point};

/// Interpolator, axes and drives.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Drives {
    /// The motion under way.
    pub interpolator: Interpolator,
    /// Rates and accelerations.
    pub limits: MotionLimits,
    /// Positions to pulses: pitch errors, backlash, gear.
    pub chain: AxisChain,
    /// Stored stroke limits.
    pub soft_limits: SoftLimits,
    /// Signals of drives and encoder.
    pub sensors: Sensors,
    /// What the drives' alarm and ready signals have led to.
    pub watch: DriveWatch,
    /// Real drives behind a pulse board, if they make the motion. An open link is never
    /// part of what is saved.
    #[serde(skip)]
    pub board: Option<BoardDrives>,
    /// Alarms of the board and what they are still to say.
    #[serde(skip)]
    pub board_alarms: BoardAlarms,
}

/// Alarms of the board, and what they are still to say.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct BoardAlarms {
    /// It stands as long as its cause, whatever RESET does.
    pub standing: Option<Alarm>,
    /// Alarms that do not say yet where the slides stand.
    pub incomplete: Vec<Alarm>,
    /// The reference was dropped where the axes could have moved on.
    pub fell: bool,
}

impl Drives {
    /// At power-on: slides that stand at `start`.
    pub(crate) fn new(memory: &Memory, start: Point) -> Self {
        let (parameters, pitch) = (&memory.parameters, &memory.pitch);
        let mut chain = AxisChain::new(parameters, pitch);
        chain.preset(Axis::X, start.x);
        chain.preset(Axis::Z, start.z);
        Self {
            interpolator: Interpolator::new(start),
            limits: MotionLimits::of(parameters, &memory.model),
            chain,
            soft_limits: SoftLimits::new(parameters),
            sensors: Sensors::default(),
            watch: DriveWatch::default(),
            board: None,
            board_alarms: BoardAlarms::default(),
        }
    }
}
