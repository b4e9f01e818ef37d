//! The path, its conversion to pulses, and the drives.

use serde::{Deserialize, Serialize};

use crate::alarm::Alarm;
use crate::axis::{AxisChain, SoftLimits};
use crate::battery::BatteryMemory;
use crate::board::BoardDrives;
use crate::motion::{Interpolator, MotionLimits};
use crate::operation::{DriveWatch, Sensors};
use crate::units::{Axis, Point};

/// All parts from the path to the pulses: interpolator, limits, axis chain, and the drives or the
/// board.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct DriveUnit {
    /// Computes the commanded position in each tick.
    pub interpolator: Interpolator,
    /// Rates and accelerations of the axes, from the parameters.
    pub limits: MotionLimits,
    /// Converts positions to pulses: pitch errors, backlash, gear.
    #[serde(rename = "chain")]
    pub axis_chain: AxisChain,
    /// Soft travel limits of the axes.
    pub soft_limits: SoftLimits,
    /// Signals of drives and encoder in the last tick.
    pub sensors: Sensors,
    /// Supervision of the drives' alarm and ready signals.
    pub watch: DriveWatch,
    /// The pulse board that makes the motion, with its drives; `None` without one. A saved
    /// state never contains an open link.
    #[serde(skip)]
    pub board: Option<BoardDrives>,
    /// Alarms of the board, and the details that must still be added to them.
    #[serde(skip)]
    pub board_alarms: BoardAlarms,
}

/// Alarms of the board, and details that must still be added to them.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct BoardAlarms {
    /// An alarm that remains active as long as its cause, regardless of RESET; `None` without one.
    pub persistent: Option<Alarm>,
    /// Alarms whose detail does not name the position of the slides yet.
    pub incomplete: Vec<Alarm>,
    /// Whether the loss of a reference requires an alarm that is not raised yet.
    pub reference_dropped: bool,
}

impl DriveUnit {
    /// Creates the state at power-on, with the slides at the machine position `start`, mm.
    pub(crate) fn new(memory: &BatteryMemory, start: Point) -> Self {
        let (parameters, pitch) = (&memory.parameters, &memory.pitch);
        let mut axis_chain = AxisChain::new(parameters, pitch);
        axis_chain.preset(Axis::X, start.x);
        axis_chain.preset(Axis::Z, start.z);
        Self {
            interpolator: Interpolator::new(start),
            limits: MotionLimits::from_model(parameters, &memory.model),
            axis_chain,
            soft_limits: SoftLimits::new(parameters),
            sensors: Sensors::default(),
            watch: DriveWatch::default(),
            board: None,
            board_alarms: BoardAlarms::default(),
        }
    }
}
