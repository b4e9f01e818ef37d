//! The interface between the interpreter and its host: the data it reads and the answers it
//! gives.

use crate::command::ControlCommand;
use crate::memory::{ControlParameters, ControlSettings, Counters, Offsets, Registers, Variables};
use crate::program::ProgramMemory;
use crate::units::{PerAxis, Point};

/// The data of a machine that the interpreter reads and writes. The control and the dry run of
/// the preview implement it, so both run one interpreter.
pub trait Host {
    /// The parameters.
    fn parameters(&self) -> &ControlParameters;
    /// The parameters, mutable: cycles write 051–060.
    fn parameters_mut(&mut self) -> &mut ControlParameters;
    /// The tool offsets.
    fn offsets(&self) -> &Offsets;
    /// The tool offsets, mutable: macro B writes them.
    fn offsets_mut(&mut self) -> &mut Offsets;
    /// The macro variables.
    fn variables(&self) -> &Variables;
    /// The macro variables, mutable: G65 and macro B write them.
    fn variables_mut(&mut self) -> &mut Variables;
    /// Timer, date and the stops that programs have switched off, for macro B.
    fn registers(&self) -> &Registers;
    /// Timer, date and switched-off stops, mutable.
    fn registers_mut(&mut self) -> &mut Registers;
    /// Part counter and times. Valid while [`Host::is_settled`] holds.
    fn counters(&self) -> &Counters;
    /// Part counter and times, mutable.
    fn counters_mut(&mut self) -> &mut Counters;
    /// Total time with cycle start on, ms. Valid while [`Host::is_settled`] holds.
    fn started_ms(&self) -> u64 {
        self.counters().started_ms
    }
    /// Sets the total time with cycle start on, ms.
    fn set_started_ms(&mut self, ms: u64) {
        self.counters_mut().started_ms = ms;
    }
    /// The rows of the setting page.
    fn settings(&self) -> &ControlSettings;
    /// The rows of the setting page, mutable.
    fn settings_mut(&mut self) -> &mut ControlSettings;
    /// Time since power-on, ms. Valid while [`Host::is_settled`] holds.
    fn now_ms(&self) -> u64;
    /// Signals from the ladder to macros, G54 and G55: #1000 in bit 0. Valid while
    /// [`Host::is_settled`] holds.
    fn interface_inputs(&self) -> u16;
    /// Signals from macros to the ladder, F54 (lowest byte) to F59.
    fn interface_outputs(&self) -> u64;
    /// Sets the signals F54 to F59.
    fn set_interface_outputs(&mut self, outputs: u64);
    /// The stored programs and the external one.
    fn programs(&self) -> &ProgramMemory;
    /// Commanded machine position, mm, X as a radius. Valid while [`Host::is_settled`] holds.
    fn machine_position(&self) -> Point;
    /// Whether each axis has a reference.
    fn referenced(&self) -> PerAxis<bool>;
    /// Whether block skip is on (F4.0).
    fn is_block_skip_on(&self) -> bool;
    /// Whether every earlier command is finished, FIN included.
    fn is_settled(&self) -> bool;
    /// Whether every earlier command is finished and the slides are at their commanded
    /// position.
    fn is_at_standstill(&self) -> bool {
        self.is_settled()
    }
}

/// An answer of the interpreter to a query for the next command.
#[derive(Clone, Debug, PartialEq)]
pub enum InterpreterStep {
    /// The next command.
    Command(Box<ControlCommand>),
    /// The reader needs a finished machine: query again when [`Host::is_settled`] holds.
    Wait,
    /// The run has ended; no command follows.
    Ended,
}
