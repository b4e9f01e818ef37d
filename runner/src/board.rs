//! Interfaces to a real machine: the pulse board that sets the pace, and the operator at the
//! terminal.

use gsk_core::simulation::Simulation;

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
