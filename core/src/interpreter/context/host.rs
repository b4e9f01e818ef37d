//! What the interpreter needs to know of the world, and what it answers.

use crate::command::Command;
use crate::memory::{Counters, Offsets, Parameters, Registers, Settings, Variables};
use crate::program::ProgramMemory;
use crate::units::{PerAxis, Point};

/// The world as the interpreter sees it; implemented by the control and by the
/// dry run of the preview, so that both run one interpreter.
pub trait Host {
    /// Parameters, to be read.
    fn parameters(&self) -> &Parameters;
    /// Parameters, to be written back by cycles (051–060).
    fn parameters_mut(&mut self) -> &mut Parameters;
    /// Tool offsets.
    fn offsets(&self) -> &Offsets;
    /// Tool offsets, to be written by macro B.
    fn offsets_mut(&mut self) -> &mut Offsets;
    /// Macro variables, to be read.
    fn variables(&self) -> &Variables;
    /// Macro variables, to be written by G65.
    fn variables_mut(&mut self) -> &mut Variables;
    /// Timer, date and what programs have switched off, for macro B.
    fn registers(&self) -> &Registers;
    /// The same, to be written.
    fn registers_mut(&mut self) -> &mut Registers;
    /// Part counter and times. Meaningful when [`Host::settled`].
    fn counters(&self) -> &Counters;
    /// The same, to be written.
    fn counters_mut(&mut self) -> &mut Counters;
    /// Time with cycle start on, ms. Meaningful when [`Host::settled`].
    fn started_ms(&self) -> u64 {
        self.counters().started_ms
    }
    /// Sets it.
    fn set_started_ms(&mut self, ms: u64) {
        self.counters_mut().started_ms = ms;
    }
    /// The rows of the setting page.
    fn settings(&self) -> &Settings;
    /// The same, to be written.
    fn settings_mut(&mut self) -> &mut Settings;
    /// Milliseconds since power-on. Meaningful when [`Host::settled`].
    fn now_ms(&self) -> u64;
    /// What the ladder gives to macros, G54 and G55: #1000 in bit 0. Meaningful
    /// when [`Host::settled`].
    fn interface_inputs(&self) -> u16;
    /// What macros give to the ladder: F54 in the lowest byte to F59.
    fn interface_outputs(&self) -> u64;
    /// Switches the outputs F54 to F59.
    fn set_interface_outputs(&mut self, outputs: u64);
    /// Stored programs and the external one.
    fn programs(&self) -> &ProgramMemory;
    /// Commanded machine position; meaningful when [`Host::settled`].
    fn machine_position(&self) -> Point;
    /// Which axes have a reference.
    fn referenced(&self) -> PerAxis<bool>;
    /// Whether block skip is on (F4.0).
    fn block_skip(&self) -> bool;
    /// Whether every earlier command is finished, FIN included.
    fn settled(&self) -> bool;
    /// Whether besides the slides stand where they were commanded to.
    fn slides_stand(&self) -> bool {
        self.settled()
    }
}

/// One answer of the interpreter.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// A command to carry out.
    Command(Box<Command>),
    /// Nothing can be read until [`Host::settled`].
    Wait,
    /// The program has ended; nothing more comes.
    Ended,
}
