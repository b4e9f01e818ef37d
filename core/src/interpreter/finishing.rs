//! G70: the finishing cycle (manual I-3.2.6.4).
//!
//! ```text
//!   G70 P Q ──> blocks ns … nf, as ordinary blocks with their own F, S, T
//!                        └──> rapid to the start of G70 ──> the block after G70
//! ```

use serde::{Deserialize, Serialize};

use crate::alarm::Alarm;
use crate::command::{Action, Source};
use crate::interpreter::Modal;
use crate::interpreter::block::Context;
use crate::interpreter::cycle::Shift;
use crate::interpreter::exact::{Exact, mm};
use crate::interpreter::explanation::Explanation;
use crate::interpreter::plan::{Motion, Plan};
use crate::interpreter::profile::{self, Range};
use crate::interpreter::state::State;
use crate::interpreter::subprogram::{Flow, Place};
use crate::interpreter::words::Words;

/// A profile being finished.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Finishing {
    /// Its first block.
    pub(crate) first: Place,
    /// Index of its last block.
    pub(crate) last: u32,
    /// The block after the cycle.
    back: Place,
    /// Programmed start of the cycle.
    start: Exact,
    /// The block of the cycle.
    source: Source,
    /// Lines of its first and its last block.
    lines: (u32, u32),
}

/// A G70 block: the run goes on in the profile.
pub(crate) fn plan(state: &State, context: &Context<'_>, words: &Words) -> Result<Flow, Alarm> {
    let range: Range = profile::locate(context, words)?;
    profile::check(state, context, range)?;
    let program = profile::program(context)?;
    Ok(Flow::Finish(Finishing {
        first: Place {
            block: range.first,
            ..context.place
        },
        last: range.last,
        back: Place {
            block: context.place.block.saturating_add(1),
            ..context.place
        },
        start: state.position,
        source: context.source,
        lines: (
            program.block_line(range.first),
            program.block_line(range.last),
        ),
    }))
}

impl Finishing {
    /// Whether a run at this place has left the profile at its end.
    pub(crate) fn is_over(&self, place: Place) -> bool {
        place.program == self.first.program && place.block > self.last
    }

    /// What is said of the profile, with its first block.
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
            formula: format!(
                "lines {first} to {last} as programmed, with their own F, S, T; then rapid to X{:.3} Z{:.3}",
                mm(self.start.x),
                mm(self.start.z)
            ),
            words: "P(ns), Q(nf)",
        })
    }

    /// The way back to the start, as the end of the cycle's block.
    pub(crate) fn back(&self, state: &mut State) -> Plan {
        state.stand_at(state.machine(self.start));
        let modal: Modal = state.modal;
        let mut plan = Plan::new(self.source, modal);
        plan.motion = Motion::One(Action::Rapid {
            to: Shift::of(state).machine(self.start),
        });
        plan.apart = true;
        plan.flow = Flow::Jump(self.back);
        plan
    }
}
