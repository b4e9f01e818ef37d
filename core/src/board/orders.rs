//! What the control wants of a pulse board after a tick.

use crate::command::ProgramId;
use crate::run_state::RunState;
use crate::units::PerAxis;
use gsk_link::{AwaitedInput, BoardOutputs, ThreadPass};

/// Orders to the board, besides the pulses.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct BoardOrders {
    /// What the ladder and the spindle control want switched.
    pub outputs: BoardOutputs,
    /// The parts of a pulse that the axes are beyond their count.
    pub fine: PerAxis<f64>,
    /// Motion is under way or waits for the spindle.
    pub moving: bool,
    /// The axes have speed.
    pub feeding: bool,
    /// The spindle that motion goes by.
    pub spindle: SpindleOrders,
    /// A pass of a thread that waits for the board.
    pub pass: Option<ThreadPass>,
    /// Returns to the machine zero.
    pub returns: ReturnOrders,
    /// The emergency stop stands.
    pub emergency_stop: bool,
    /// RESET acts.
    pub resetting: bool,
    /// An alarm of the board waits for RESET.
    pub board_alarm: bool,
    /// Backlash is compensated: a stop may leave it half made.
    pub backlash: bool,
    /// The run.
    pub run: RunOrders,
}

/// How motion follows the spindle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct SpindleOrders {
    /// A thread waits for its angle.
    pub waits: bool,
    /// Lead of the thread under way, mm.
    pub lead: Option<f64>,
}

/// Returns to the machine zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ReturnOrders {
    /// Axes whose return the board makes.
    pub by_board: PerAxis<bool>,
    /// What the return of an axis waits for at the board.
    pub awaited: PerAxis<Option<AwaitedInput>>,
    /// Axes with a reference.
    pub referenced: PerAxis<bool>,
}

/// The run of a program, for the log of the board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RunOrders {
    /// Its state.
    pub state: RunState,
    /// A program that ended in this tick.
    pub ended: Option<ProgramId>,
}

impl Default for RunOrders {
    fn default() -> Self {
        Self {
            state: RunState::Reset,
            ended: None,
        }
    }
}
