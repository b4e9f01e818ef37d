//! A machine on which everything is done at once.

use core::cell::LazyCell;

use super::Host;
use crate::memory::{Counters, Offsets, Parameters, Registers, Settings, Variables};
use crate::program::ProgramMemory;
use crate::units::{PerAxis, Point};

/// What a program is interpreted against when no time is to pass: it may write to
/// parameters, offsets, variables and outputs, and every command is finished when it is given.
pub struct Immediate<'a> {
    /// Parameters, its own.
    pub parameters: Parameters,
    /// Tool offsets, its own.
    pub offsets: Offsets,
    /// Macro variables, its own.
    pub variables: Variables,
    /// Timer, date and what the program switches off, its own.
    pub registers: Registers,
    /// Part counter and times, its own.
    pub counters: Counters,
    /// The rows of the setting page, its own.
    pub settings: Settings,
    /// Machine time so far, s.
    pub now_s: f64,
    /// What the ladder gives to macros; worked out when a program asks for it.
    pub inputs: LazyCell<u16, Box<dyn FnOnce() -> u16 + 'a>>,
    /// What macros give to the ladder.
    pub outputs: u64,
    /// Stored programs and the external one.
    pub programs: &'a ProgramMemory,
    /// Machine position where the interpreter asks for it.
    pub position: Point,
    /// Which axes have a reference.
    pub referenced: PerAxis<bool>,
    /// Whether block skip is on.
    pub block_skip: bool,
}

impl Host for Immediate<'_> {
    fn parameters(&self) -> &Parameters {
        &self.parameters
    }
    fn parameters_mut(&mut self) -> &mut Parameters {
        &mut self.parameters
    }
    fn offsets(&self) -> &Offsets {
        &self.offsets
    }
    fn offsets_mut(&mut self) -> &mut Offsets {
        &mut self.offsets
    }
    fn registers(&self) -> &Registers {
        &self.registers
    }
    fn registers_mut(&mut self) -> &mut Registers {
        &mut self.registers
    }
    fn counters(&self) -> &Counters {
        &self.counters
    }
    fn counters_mut(&mut self) -> &mut Counters {
        &mut self.counters
    }
    // Cycle start is on all the time.
    fn started_ms(&self) -> u64 {
        self.counters.started_ms.wrapping_add(self.now_ms())
    }
    fn set_started_ms(&mut self, ms: u64) {
        self.counters.started_ms = ms.wrapping_sub(self.now_ms());
    }
    fn settings(&self) -> &Settings {
        &self.settings
    }
    fn settings_mut(&mut self) -> &mut Settings {
        &mut self.settings
    }
    fn now_ms(&self) -> u64 {
        (self.now_s * 1000.0) as u64
    }
    fn variables(&self) -> &Variables {
        &self.variables
    }
    fn variables_mut(&mut self) -> &mut Variables {
        &mut self.variables
    }
    fn interface_inputs(&self) -> u16 {
        *self.inputs
    }
    fn interface_outputs(&self) -> u64 {
        self.outputs
    }
    fn set_interface_outputs(&mut self, outputs: u64) {
        self.outputs = outputs;
    }
    fn programs(&self) -> &ProgramMemory {
        self.programs
    }
    fn machine_position(&self) -> Point {
        self.position
    }
    fn referenced(&self) -> PerAxis<bool> {
        self.referenced
    }
    fn block_skip(&self) -> bool {
        self.block_skip
    }
    fn settled(&self) -> bool {
        true
    }
}
