//! Reads blocks ahead of their turn: the profile of a cycle, and the block after a chamfer.

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::command::MotionCode;
use crate::interpreter::codes::inch;
use crate::interpreter::host::Host;
use crate::interpreter::macros::system::VariableSources;
use crate::interpreter::macros::variable::{self, ReadError};
use crate::interpreter::words::SortedWords;
use crate::program::{Program, ProgramBlock, Syntax};

/// Greatest number of blocks that the search for the next block that is not skipped reads.
const MAX_SKIPPED_BLOCKS: u32 = 16;

/// Reads blocks of a program ahead of their turn.
pub(crate) struct LookaheadReader<'a, H> {
    pub(crate) program: &'a Program,
    pub(crate) syntax: Syntax,
    /// Whether block skip is on, so that blocks marked `/` are skipped.
    pub(crate) is_skipping: bool,
    pub(crate) host: &'a H,
    /// The sources of variables for formulas of macro B; `None` without macro B.
    pub(crate) sources: Option<&'a VariableSources<'a, H>>,
}

/// The alarm of a block read ahead. A wait becomes an alarm, too: the planner of a cycle waits
/// until everything before it is finished, so its blocks never need to wait.
pub(crate) fn to_alarm(reason: ReadError) -> Alarm {
    match reason {
        ReadError::Fault(alarm) => alarm,
        ReadError::Wait => {
            Alarm::new(number::BAD_VARIABLE).with_detail(say::variable_not_read_ahead())
        }
    }
}

impl<H: Host> LookaheadReader<'_, H> {
    /// Reads the words of the block `index` (from 0); `None` for a skipped block. `motion` is
    /// the code of group 01 in force before the block.
    ///
    /// # Errors
    /// The alarm of the block, or a variable that cannot be read yet.
    pub(crate) fn read_words_at(
        &self,
        index: u32,
        motion: MotionCode,
    ) -> Result<Option<SortedWords>, ReadError> {
        let mut block = ProgramBlock::default();
        if let Err(error) = self.program.read(index, self.syntax, &mut block) {
            if self.is_skipping && self.program.has_skip_mark(index) {
                return Ok(None);
            }
            return Err(ReadError::Fault(error.into()));
        }
        let is_skipped = self.is_skipping && block.skip;
        if is_skipped || block.is_name_only() {
            return Ok(None);
        }
        if block.macro_statement().is_some() {
            let rule = say::profile_macro_statement();
            return Err(Alarm::new(number::PROFILE_CODE).with_detail(rule).into());
        }
        if let (Some(formulas), Some(known)) = (block.formulas(), self.sources) {
            block = known.evaluate_words(&block, formulas, self.syntax)?;
        }
        if block.has_g(65) {
            return Err(ReadError::Fault(
                Alarm::new(number::PROFILE_CODE).with_detail(say::profile_macro()),
            ));
        }
        if block.has_variables() {
            block = variable::resolve_variables(block, self.syntax, motion, self.host)?;
        }
        if self.syntax.inch {
            inch::convert_to_metric(&mut block, motion);
        }
        SortedWords::from_block(&block, self.syntax.model.record())
            .map(Some)
            .map_err(ReadError::Fault)
    }

    /// Whether a block that is not skipped follows the block `index`; blocks with errors
    /// count.
    pub(crate) fn has_next(&self, index: u32) -> bool {
        let next = index.saturating_add(1);
        let end = self
            .program
            .block_count()
            .min(next.saturating_add(MAX_SKIPPED_BLOCKS));
        end.saturating_sub(next) == MAX_SKIPPED_BLOCKS
            || (next..end)
                .any(|index| !matches!(self.read_words_at(index, MotionCode::Line), Ok(None)))
    }

    /// Reads the words of the next block after `index` that is not skipped. `None` at the end
    /// of the text, and for a block with an alarm, which the reader raises at the turn of that
    /// block.
    pub(crate) fn read_words_after(
        &self,
        index: u32,
        motion: MotionCode,
    ) -> Result<Option<SortedWords>, ReadError> {
        let next = index.saturating_add(1);
        let end = self
            .program
            .block_count()
            .min(next.saturating_add(MAX_SKIPPED_BLOCKS));
        for index in next..end {
            match self.read_words_at(index, motion) {
                Ok(None) => {}
                Err(ReadError::Fault(_)) => return Ok(None),
                found => return found,
            }
        }
        Ok(None)
    }
}
