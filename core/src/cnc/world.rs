//! The control as the interpreter sees it.

use crate::interpreter::Host;
use crate::memory::{Offsets, Parameters};
use crate::program::ProgramMemory;
use crate::units::{PerAxis, Point};

/// A view of the control for the interpreter, at one instant.
pub(crate) struct World<'a> {
    pub parameters: &'a mut Parameters,
    pub offsets: &'a Offsets,
    pub programs: &'a ProgramMemory,
    pub machine_position: Point,
    pub referenced: PerAxis<bool>,
    pub block_skip: bool,
    pub settled: bool,
    pub cursor_line: u32,
}

impl Host for World<'_> {
    fn parameters(&self) -> &Parameters {
        self.parameters
    }

    fn parameters_mut(&mut self) -> &mut Parameters {
        self.parameters
    }

    fn offsets(&self) -> &Offsets {
        self.offsets
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

    fn block_skip(&self) -> bool {
        self.block_skip
    }

    fn settled(&self) -> bool {
        self.settled
    }
}
