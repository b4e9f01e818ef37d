//! The interface between the interpreter and its host: the data it reads and the answers it
//! gives.

pub(super) mod immediate_host;
pub(super) mod machine_codes;

use crate::command::ControlCommand;
use crate::memory::{ControlParameters, ControlSettings, Counters, Offsets, Registers, Variables};
use crate::program::ProgramMemory;
use crate::units::{PerAxis, Point};

/// The data of a machine that the interpreter reads and writes. The control and the dry run of
/// the preview implement it, so both run one interpreter.
pub trait Host {
    /// Returns the control parameters that the interpreter reads.
    fn parameters(&self) -> &ControlParameters;
    /// Returns the control parameters for writing: cycles write 051–060.
    fn parameters_mut(&mut self) -> &mut ControlParameters;
    /// Returns the table of tool offsets.
    fn offsets(&self) -> &Offsets;
    /// The table of tool offsets, to write from macro B.
    fn offsets_mut(&mut self) -> &mut Offsets;
    /// Returns the common variables that macros read.
    fn variables(&self) -> &Variables;
    /// The common variables, to write from G65 and macro B.
    fn variables_mut(&mut self) -> &mut Variables;
    /// Timer, date and the stops that programs have switched off, for macro B.
    fn registers(&self) -> &Registers;
    /// Timer, date and switched-off stops, to write from macro B.
    fn registers_mut(&mut self) -> &mut Registers;
    /// Part counter and times. Valid while [`Host::is_settled`] holds.
    fn counters(&self) -> &Counters;
    /// Part counter and times, to write from macro B.
    fn counters_mut(&mut self) -> &mut Counters;
    /// Total time with cycle start on, ms. Valid while [`Host::is_settled`] holds.
    fn started_ms(&self) -> u64 {
        self.counters().started_ms
    }
    /// Sets the total time with cycle start on, ms.
    fn set_started_ms(&mut self, ms: u64) {
        self.counters_mut().started_ms = ms;
    }
    /// The settings of the setting page, such as inch input, and the option of macro B.
    fn settings(&self) -> &ControlSettings;
    /// The settings of the setting page, to write from macro B (#3005).
    fn settings_mut(&mut self) -> &mut ControlSettings;
    /// Time since power-on, ms. Valid while [`Host::is_settled`] holds.
    fn now_ms(&self) -> u64;
    /// Signals from the ladder to macros, G54 and G55: #1000 in bit 0. Valid while
    /// [`Host::is_settled`] holds.
    fn interface_inputs(&self) -> u16;
    /// Returns the signals from macros to the ladder, F54 (lowest byte) to F59.
    fn interface_outputs(&self) -> u64;
    /// Sets the signals from macros to the ladder, F54 (lowest byte) to F59.
    fn set_interface_outputs(&mut self, outputs: u64);
    /// The programs in the memory of the control and the external one.
    fn programs(&self) -> &ProgramMemory;
    /// Commanded machine position, mm, X as a radius. Valid while [`Host::is_settled`] holds.
    fn machine_position(&self) -> Point;
    /// For each axis, whether its reference point is known.
    fn referenced(&self) -> PerAxis<bool>;
    /// Returns whether block skip is on (F4.0).
    fn is_block_skip_on(&self) -> bool;
    /// Whether every earlier command is finished, with the FIN signal of the ladder for M, S
    /// and T.
    fn is_settled(&self) -> bool;
    /// Whether every earlier command is finished and the slides are at their commanded
    /// position.
    fn is_at_standstill(&self) -> bool {
        self.is_settled()
    }
}

/// The result of one call of [`Interpreter::next`](crate::interpreter::Interpreter::next).
#[derive(Clone, Debug, PartialEq)]
pub enum InterpreterStep {
    /// The next command of the run.
    Command(Box<ControlCommand>),
    /// The next block must wait until all earlier commands are finished: call again when
    /// [`Host::is_settled`] returns true.
    Wait,
    /// The run has ended; no further command follows.
    Ended,
}
