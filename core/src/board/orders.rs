//! Orders of the control to a pulse board after a tick.

use crate::command::ProgramId;
use crate::run_state::RunState;
use crate::units::PerAxis;
use gsk_link::{AwaitedInput, BoardOutputs, TapOrder, ThreadPass};

/// The orders of the control to the board in a tick, besides the pulses.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct BoardOrders {
    /// Outputs that the ladder and the spindle control command.
    pub outputs: BoardOutputs,
    /// The position of each axis in fractional pulses, from which the pulse count is
    /// rounded.
    pub fraction: PerAxis<f64>,
    /// Whether an axis moves, or a motion waits for the spindle.
    pub is_moving: bool,
    /// Whether the speed along the path is above zero.
    pub is_feeding: bool,
    /// The orders that make motion depend on the spindle.
    pub spindle: SpindleOrders,
    /// The thread pass that the board is to cut; `None` if none waits.
    pub pass: Option<ThreadPass>,
    /// The tap that the board is to make; `None` if none waits.
    pub tap: Option<TapOrder>,
    /// Whether the control follows a tap that the board has started. If it no longer does, the
    /// board must stop.
    pub follows_tap: bool,
    /// State of the reference returns of the axes.
    pub returns: ReturnOrders,
    /// Whether the emergency stop is in force.
    pub is_emergency_stop: bool,
    /// Whether the reset signal RST of the control is on.
    pub is_resetting: bool,
    /// Whether an alarm of the board or of its link is in force.
    pub has_board_alarm: bool,
    /// Whether an axis has backlash compensation: a stop may interrupt it.
    pub compensates_backlash: bool,
    /// State of the program run, for the log of the board.
    pub run: RunOrders,
}

/// The orders that make motion depend on the spindle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct SpindleOrders {
    /// Whether a thread waits for its start angle.
    pub waits_for_angle: bool,
    /// Lead of the current thread, mm per revolution; `None` outside threads.
    pub lead_mm: Option<f64>,
    /// Whether a thread has ended and another continues it without a stop.
    pub continues: bool,
    /// Whether the axes brake after a motion that was stopped.
    pub is_braking: bool,
    /// Spindle speed for which a thread is planned, r/min; 0 if unknown.
    pub planned_rpm: f64,
}

/// State of the reference returns, as far as the board takes part in them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ReturnOrders {
    /// Axes that the board must home.
    pub by_board: PerAxis<bool>,
    /// Input of each axis that a return driven by the control waits for; `None`: no return
    /// waits.
    pub awaited: PerAxis<Option<AwaitedInput>>,
    /// Axes whose reference point the control knows.
    pub referenced: PerAxis<bool>,
}

/// State of the program run, for the log of the board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RunOrders {
    /// State of the program run after the tick.
    pub run_state: RunState,
    /// The program that ended in this tick; `None` if none did.
    pub ended: Option<ProgramId>,
}

impl Default for RunOrders {
    fn default() -> Self {
        Self {
            run_state: RunState::Reset,
            ended: None,
        }
    }
}
