//! Implements the interface through which the interpreter reads and changes the control.

use gsk_plc::PlcMemory;

use crate::battery;
use crate::interpreter::Host;
use crate::memory::{ControlParameters, ControlSettings, Counters, Offsets, Registers, Variables};
use crate::program::ProgramMemory;
use crate::units::{PerAxis, Point};

/// First G byte of the macro inputs UI0 and up (#1000): G54.
const MACRO_INPUTS: u16 = 54;
/// F bytes of the macro outputs UO0 and up (#1100): F54 to F59.
const MACRO_OUTPUTS: core::ops::RangeInclusive<u16> = 54..=59;

/// The view of the control that the interpreter reads, at one instant.
pub(crate) struct ControlHost<'a> {
    pub memory: &'a mut battery::BatteryMemory,
    pub registers: &'a mut Registers,
    /// Milliseconds since the control was switched on.
    pub now_ms: u64,
    pub plc: &'a mut PlcMemory,
    pub machine_position: Point,
    pub referenced: PerAxis<bool>,
    pub block_skip: bool,
    pub settled: bool,
    /// Whether the slides have executed all commanded motion.
    pub slides_stand_still: bool,
    pub cursor_line: u32,
}

impl Host for ControlHost<'_> {
    fn parameters(&self) -> &ControlParameters {
        &self.memory.parameters
    }

    fn parameters_mut(&mut self) -> &mut ControlParameters {
        &mut self.memory.parameters
    }

    fn offsets(&self) -> &Offsets {
        &self.memory.offsets
    }

    fn offsets_mut(&mut self) -> &mut Offsets {
        &mut self.memory.offsets
    }

    fn registers(&self) -> &Registers {
        self.registers
    }

    fn registers_mut(&mut self) -> &mut Registers {
        self.registers
    }

    fn counters(&self) -> &Counters {
        &self.memory.counters
    }

    fn counters_mut(&mut self) -> &mut Counters {
        &mut self.memory.counters
    }

    fn settings(&self) -> &ControlSettings {
        &self.memory.settings
    }

    fn settings_mut(&mut self) -> &mut ControlSettings {
        &mut self.memory.settings
    }

    fn now_ms(&self) -> u64 {
        self.now_ms
    }

    fn variables(&self) -> &Variables {
        &self.memory.variables
    }

    fn variables_mut(&mut self) -> &mut Variables {
        &mut self.memory.variables
    }

    fn interface_inputs(&self) -> u16 {
        u16::from_le_bytes([self.plc.g(MACRO_INPUTS), self.plc.g(MACRO_INPUTS + 1)])
    }

    fn interface_outputs(&self) -> u64 {
        let mut bytes = [0; 8];
        for (byte, number) in bytes.iter_mut().zip(MACRO_OUTPUTS) {
            *byte = self.plc.f(number);
        }
        u64::from_le_bytes(bytes)
    }

    fn set_interface_outputs(&mut self, outputs: u64) {
        for (byte, number) in outputs.to_le_bytes().into_iter().zip(MACRO_OUTPUTS) {
            self.plc.set_f(number, byte);
        }
    }

    fn programs(&self) -> &ProgramMemory {
        &self.memory.programs
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
        self.settled
    }

    fn is_at_standstill(&self) -> bool {
        self.settled && self.slides_stand_still
    }
}
