//! G70: the finishing cycle (manual I-3.2.6.4).
//!
//! ```text
//!   G70 P Q ──> blocks ns … nf, as ordinary blocks with their own F, S, T
//!                        └──> rapid to the start of G70 ──> the block after G70
//! ```

use gsk_messages::say;

use crate::alarm::Alarm;
use crate::command::Source;
use crate::interpreter::context::Context;
use crate::interpreter::context::exact::mm;
use crate::interpreter::context::explanation::Explanation;
use crate::interpreter::context::flow::{Finishing, Flow};
use crate::interpreter::context::place::Place;
use crate::interpreter::context::state::State;
use crate::interpreter::context::words::Words;
use crate::interpreter::profile::{self, Range};

/// Plans a G70: the flow continues in the profile.
///
/// # Errors
/// The alarm of the profile.
pub(crate) fn plan(state: &State, context: &Context<'_>, words: &Words) -> Result<Flow, Alarm> {
    let range: Range = profile::locate(context, words)?;
    profile::check(state, context, range)?;
    let program = profile::program(context)?;
    Ok(Flow::Finish(Box::new(Finishing {
        first: Place {
            block: range.first,
            ..context.place
        },
        last: range.last,
        back: context.place.after(),
        start: state.position,
        source: context.source,
        lines: (
            program.block_line(range.first),
            program.block_line(range.last),
        ),
    })))
}

impl Finishing {
    /// Whether a position is after the last block of the profile.
    pub(crate) fn is_over(&self, place: Place) -> bool {
        place.program == self.first.program && place.block > self.last
    }

    /// The explanation of the profile, while its first block runs; `None` in other blocks.
    pub(crate) fn explanation(&self, block: Source) -> Option<Explanation> {
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
            formula: say::explain_finishing(first, last, mm(self.start.x), mm(self.start.z)),
            words: "P(ns), Q(nf)",
        })
    }
}
