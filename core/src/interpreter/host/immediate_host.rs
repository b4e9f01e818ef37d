//! A host that finishes every command at once, for interpretation without machine time.

use core::cell::LazyCell;

use crate::interpreter::host::Host;
use crate::memory::{ControlParameters, ControlSettings, Counters, Offsets, Registers, Variables};
use crate::program::ProgramMemory;
use crate::units::{PerAxis, Point};

/// A host that stores everything a program may write (parameters, offsets, variables, outputs)
/// and reports every command as finished.
pub struct ImmediateHost<'a> {
    /// The parameters: a separate copy, which the program may change.
    pub parameters: ControlParameters,
    /// The tool offsets: a separate copy, which the program may change.
    pub offsets: Offsets,
    /// The macro variables: a separate copy, which the program may change.
    pub variables: Variables,
    /// Timer, date and the stops that the program switches off: a separate copy.
    pub registers: Registers,
    /// Part counter and times: a separate copy, which the program may change.
    pub counters: Counters,
    /// The settings of the setting page: a separate copy, which the program may change.
    pub settings: ControlSettings,
    /// Machine time since the start of the interpretation, s. The caller advances this clock.
    pub now_s: f64,
    /// Signals from the ladder to macros, G54 (low byte) and G55; computed when a program
    /// first reads one.
    pub inputs: LazyCell<u16, Box<dyn FnOnce() -> u16 + 'a>>,
    /// Signals from macros to the ladder, F54 in the lowest byte.
    pub outputs: u64,
    /// The programs in the memory of the control and the external one.
    pub programs: &'a ProgramMemory,
    /// Machine position at the start of a run, mm, X as a radius.
    pub machine_position: Point,
    /// For each axis, whether its reference point is known.
    pub referenced: PerAxis<bool>,
    /// Whether block skip is on, so that blocks marked `/` are skipped.
    pub block_skip: bool,
}

impl Host for ImmediateHost<'_> {
    fn parameters(&self) -> &ControlParameters {
        &self.parameters
    }
    fn parameters_mut(&mut self) -> &mut ControlParameters {
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
    // Cycle start is always on here.
    fn started_ms(&self) -> u64 {
        self.counters.started_ms.wrapping_add(self.now_ms())
    }
    fn set_started_ms(&mut self, ms: u64) {
        self.counters.started_ms = ms.wrapping_sub(self.now_ms());
    }
    fn settings(&self) -> &ControlSettings {
        &self.settings
    }
    fn settings_mut(&mut self) -> &mut ControlSettings {
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
        self.machine_position
    }
    fn referenced(&self) -> PerAxis<bool> {
        self.referenced
    }
    fn is_block_skip_on(&self) -> bool {
        self.block_skip
    }
    fn is_settled(&self) -> bool {
        true
    }
}
