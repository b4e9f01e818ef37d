//! The data that the calls and returns of a block depend on.

use crate::interpreter::flow::program_position::{ProgramCall, ProgramPosition};
use crate::program::ProgramMemory;

/// The data that the calls and returns of a block depend on, besides its words.
#[derive(Clone, Copy)]
pub(crate) struct CallContext<'a> {
    pub(crate) programs: &'a ProgramMemory,
    /// The calls in execution, the innermost last.
    pub(crate) calls: &'a [ProgramCall],
    /// The program of the block, and its index.
    pub(crate) position: ProgramPosition,
    /// Greatest sequence number that P of M99 can name.
    pub(crate) last_target: u32,
}
