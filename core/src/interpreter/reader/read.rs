//! What comes of reading a block.

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::command::{Command, ProgramId};

/// What reading one block led to.
pub(super) enum Read {
    /// Its plan stands in the run.
    Planned,
    /// It is this command, and nothing else.
    Moves(Command),
    /// It must not be read yet.
    Wait,
    /// It has not come through the line yet.
    Starved,
    /// There is nothing in it.
    Skipped,
    /// The text is over.
    Ended,
}

/// The program of a place is not there.
pub(super) fn missing(program: ProgramId) -> Alarm {
    Alarm::new(number::PROGRAM_MISSING).because(say::program_not_there(format_args!("{program:?}")))
}
