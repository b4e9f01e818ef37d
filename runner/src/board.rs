//! A real machine, as whoever carries a program or a script out meets it: a pulse board
//! that sets the pace, and a person who is asked.

use gsk_core::simulation::Simulation;

/// A pulse board that makes the motion, at its own pace.
pub trait PulseBoard {
    /// Waits until the control may make one tick; false: the end was asked for, and
    /// nothing moves any more.
    fn wait(&mut self, simulation: &mut Simulation) -> bool;
    /// The control has made its tick.
    fn after(&mut self, simulation: &mut Simulation);
    /// Lets the board make what it was handed, stops it and lets it go.
    fn close(self: Box<Self>, simulation: &mut Simulation);
}

/// Somebody at the machine, who is asked before it goes on.
pub trait Operator {
    /// What was said before a question is no answer to it.
    fn forget(&self);
    /// What was said since the last look; does not wait.
    fn answer(&self) -> Answer;
}

/// What a person said since the last look.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// Nothing.
    None,
    /// Enter alone.
    Enter,
    /// Something else.
    Other,
    /// Nobody is there any more: the end of the input.
    Gone,
}
