//! Reads blocks ahead of their turn: the profile of a cycle, and the block after a chamfer.

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::interpreter::codes::inch;
use crate::interpreter::context::host::Host;
use crate::interpreter::context::words::Words;
use crate::interpreter::macros::system::Known;
use crate::interpreter::macros::variable::{self, NotNow};
use crate::program::{Block, Program, Syntax};

/// Greatest number of blocks to search for one that is not skipped.
const REACH: u32 = 16;

/// What reading ahead needs.
pub(crate) struct Reading<'a, H> {
    pub(crate) program: &'a Program,
    pub(crate) syntax: Syntax,
    /// Whether blocks marked `/` are skipped.
    pub(crate) skipping: bool,
    pub(crate) host: &'a H,
    /// The sources of variables for formulas of macro B.
    pub(crate) known: Option<&'a Known<'a>>,
}

/// The alarm of a block read ahead. The planner of a cycle waits until everything before it is
/// finished, so its blocks never need to wait.
pub(crate) fn alarm(reason: NotNow) -> Alarm {
    match reason {
        NotNow::Fault(alarm) => alarm,
        NotNow::Wait => Alarm::new(number::BAD_VARIABLE).because(say::variable_not_read_ahead()),
    }
}

impl<H: Host> Reading<'_, H> {
    /// The words of a block; `None` for a skipped one. `motion` is the code of group 01 in
    /// force before it.
    ///
    /// # Errors
    /// The alarm of the block, or a variable that cannot be read yet.
    pub(crate) fn words_at(&self, index: u32, motion: u8) -> Result<Option<Words>, NotNow> {
        let mut block = Block::default();
        if let Err(error) = self.program.read(index, self.syntax, &mut block) {
            if self.skipping && self.program.has_skip_mark(index) {
                return Ok(None);
            }
            return Err(NotNow::Fault(error.into()));
        }
        let skipped = self.skipping && block.skip;
        if skipped || block.is_name() {
            return Ok(None);
        }
        if block.macro_statement().is_some() {
            let rule = say::profile_macro_statement();
            return Err(Alarm::new(number::PROFILE_CODE).because(rule).into());
        }
        if let (Some(formulas), Some(known)) = (block.formulas(), self.known) {
            block = known.words(&block, formulas, self.syntax, self.host)?;
        }
        if block.has_g(65) {
            return Err(NotNow::Fault(
                Alarm::new(number::PROFILE_CODE).because(say::profile_macro()),
            ));
        }
        if block.has_variables() {
            block = variable::resolve(block, self.syntax, self.host)?;
        }
        if self.syntax.inch {
            inch::to_metric(&mut block, motion);
        }
        Words::of(&block, self.syntax.model.record())
            .map(Some)
            .map_err(NotNow::Fault)
    }

    /// Whether another block follows that is not skipped, with or without errors.
    pub(crate) fn has_next(&self, index: u32) -> bool {
        let next = index.saturating_add(1);
        let end = self.program.block_count().min(next.saturating_add(REACH));
        end.saturating_sub(next) == REACH
            || (next..end).any(|index| !matches!(self.words_at(index, 1), Ok(None)))
    }

    /// The words of the next block; `None` at the end of the text and for a block with an
    /// alarm, which is raised at its turn.
    pub(crate) fn words_after(&self, index: u32, motion: u8) -> Result<Option<Words>, NotNow> {
        let next = index.saturating_add(1);
        let end = self.program.block_count().min(next.saturating_add(REACH));
        for index in next..end {
            match self.words_at(index, motion) {
                Ok(None) => {}
                Err(NotNow::Fault(_)) => return Ok(None),
                found => return found,
            }
        }
        Ok(None)
    }
}
