//! Interfaces to a real machine: the pulse board that sets the pace, and the operator at the
//! terminal.

use gsk_core::simulation::Simulation;
use gsk_messages::Message;

use crate::machining::live_part::LivePart;
use crate::restart::RestartPlan;

/// A pulse board that moves the axes and determines the pace of machine time.
pub trait PulseBoard {
    /// Blocks until the control may make its next tick. Returns false if the end was requested
    /// (Ctrl-C); the board then moves nothing more.
    fn wait_for_tick(&mut self, simulation: &mut Simulation) -> bool;
    /// Takes over the motion of a finished tick. Called after every tick of the control.
    fn finish_tick(&mut self, simulation: &mut Simulation);
    /// Waits until the board has made all motion sent so far, then stops it and closes its
    /// port.
    fn close(self: Box<Self>, simulation: &mut Simulation);
}

/// The operator at the terminal, who confirms there that a stopped program continues.
pub trait TerminalOperator {
    /// Discards all input typed so far, so that it does not answer the next question.
    fn discard_input(&self);
    /// Returns the operator's input since the last call; returns at once, also without input.
    fn read_answer(&self) -> OperatorAnswer;
}

/// Plans a restart at a block while a board is served.
pub trait RestartPlanner {
    /// Begins to plan with a copy of the machine, and returns at once.
    fn begin(&mut self, simulation: &Simulation);
    /// Returns the plan or why there is none; `None` while it is not finished.
    fn poll(&mut self) -> Option<Result<BoardRestart, Message>>;
}

/// A planned restart on a real machine.
#[derive(Clone, Debug)]
pub struct BoardRestart {
    /// The plan, with the differences that the operator confirms.
    pub plan: RestartPlan,
    /// The part that the skipped blocks leave; `None` without one.
    pub part: Option<LivePart>,
    /// The lines that name the block and the calls that lead to it.
    pub block_lines: Vec<Message>,
    /// Whether an option has confirmed all differences.
    pub is_confirmed: bool,
}

/// The operator's input at the terminal since the last query.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OperatorAnswer {
    /// The operator has typed nothing.
    None,
    /// The operator pressed Enter alone: the program continues.
    Enter,
    /// The operator typed any other text.
    Other,
    /// The input has ended: no operator is at the terminal.
    EndOfInput,
}
