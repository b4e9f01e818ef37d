//! The result of reading a block.

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::command::ProgramId;

/// The result of reading one block.
pub(super) enum BlockRead {
    /// The block is evaluated and its plan is stored in the run.
    Planned,
    /// The block must wait until every earlier command is finished.
    Wait,
    /// The block has not arrived through the serial line yet.
    Starved,
    /// The block is skipped or has no words.
    Skipped,
    /// The end of the program text is reached.
    Ended,
}

/// Alarm 031: the program `program` of the run is missing.
pub(super) fn missing_program_alarm(program: ProgramId) -> Alarm {
    Alarm::new(number::PROGRAM_MISSING)
        .with_detail(say::program_not_there(format_args!("{program:?}")))
}
