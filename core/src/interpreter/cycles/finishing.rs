//! G70: the finishing cycle (manual I-3.2.6.4).
//!
//! ```text
//!   G70 P Q ──> blocks ns … nf, as ordinary blocks with their own F, S, T
//!                        └──> rapid to the start of G70 ──> the block after G70
//! ```

use gsk_messages::say;

use crate::alarm::Alarm;
use crate::command::SourcePosition;
use crate::interpreter::context::BlockContext;
use crate::interpreter::exact::to_mm;
use crate::interpreter::flow::program_position::ProgramPosition;
use crate::interpreter::flow::{Finishing, Flow};
use crate::interpreter::moves::explanation::Explanation;
use crate::interpreter::profile::{self, ProfileRange};
use crate::interpreter::state::State;
use crate::interpreter::words::SortedWords;

/// Plans a G70: finds and checks the profile, and returns the flow that runs it.
///
/// # Errors
/// The alarm of the profile.
pub(crate) fn plan_finishing(
    state: &State,
    context: &BlockContext<'_>,
    words: &SortedWords,
) -> Result<Flow, Alarm> {
    let range: ProfileRange = profile::find_range(context, words)?;
    profile::check_blocks(state, context, range)?;
    let program = profile::find_program(context)?;
    Ok(Flow::RunProfile(Box::new(Finishing {
        first: ProgramPosition {
            block: range.first,
            ..context.position
        },
        last: range.last,
        return_position: context.position.next_block(),
        start: state.position,
        source: context.source,
        lines: (
            program.block_line(range.first),
            program.block_line(range.last),
        ),
    })))
}

impl Finishing {
    /// Whether `position` is after the last block of the profile.
    pub(crate) fn is_finished_at(&self, position: ProgramPosition) -> bool {
        position.program == self.first.program && position.block > self.last
    }

    /// Explains the G70 while the first block of the profile runs; `None` in other blocks.
    pub(crate) fn explain(&self, block: SourcePosition) -> Option<Explanation> {
        if block.line != self.lines.0 || block.program != self.first.program {
            return None;
        }
        let (first, last) = self.lines;
        Some(Explanation {
            code: 70,
            pass: 1,
            passes: Some(1),
            level: None,
            depth: 0.0,
            remaining: 0.0,
            formula: say::explain_finishing(first, last, to_mm(self.start.x), to_mm(self.start.z)),
            words: "P(ns), Q(nf)",
        })
    }
}
