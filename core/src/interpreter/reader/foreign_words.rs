//! Reports all words of a refused block that the model does not have, not only the first.

use gsk_messages::{Message, say};

use crate::alarm::{Alarm, number};
use crate::command::SourcePosition;
use crate::interpreter::host::Host;
use crate::program::{BlockError, Program, further_foreign_words};

use super::Interpreter;
use super::pending_block::PendingBlock;

impl Interpreter {
    /// Adds messages about the other foreign words of the block to the alarm of a code that
    /// the model does not have.
    #[cold]
    pub(super) fn with_foreign_words<H: Host>(&self, mut alarm: Alarm, host: &H) -> Alarm {
        let position = self.current_run().position;
        let program = match &self.mdi {
            Some(mdi) => Some(&mdi.program),
            None => host.programs().get(position.program),
        };
        let further =
            program.map(|program| self.find_further_foreign_words(program, position.block, true));
        alarm.detail = match (alarm.detail, further) {
            (Some(detail), Some(also)) => Some(append_further(detail, also)),
            (detail, _) => detail,
        };
        alarm
    }

    /// Messages about the words of a block that the model does not have. If the block is refused
    /// for one of them (`is_one_reported`), that one is left out.
    #[cold]
    fn find_further_foreign_words(
        &self,
        program: &Program,
        block: u32,
        is_one_reported: bool,
    ) -> Vec<Message> {
        let record = self.record();
        let has_m = |code| self.machine_codes.contains(code) || record.m_function(code).is_some();
        further_foreign_words(program.block(block), record, &has_m, is_one_reported)
    }

    /// Returns the source position of a block that cannot be parsed, if block skip skips the
    /// block.
    ///
    /// # Errors
    /// The alarm of the block, with messages about its other foreign words.
    #[cold]
    pub(super) fn skip_unparsed(
        &self,
        mut error: BlockError,
        pending: &mut PendingBlock<'_>,
    ) -> Result<SourcePosition, Alarm> {
        pending.locate_unparsed();
        if pending.is_unparsed_skipped() {
            return Ok(pending.source);
        }
        // Formulas of macro B that the control does not have are no words.
        if matches!(error.alarm, number::BAD_ADDRESS | number::BAD_CHARACTER)
            && !has_formula(pending.program.block(pending.position.block))
        {
            let is_one_reported = error.alarm == number::BAD_ADDRESS;
            let (program, block) = (pending.program, pending.position.block);
            let further = self.find_further_foreign_words(program, block, is_one_reported);
            error.detail = append_further(error.detail, further);
        }
        Err(Alarm::from(error).with_source(pending.source))
    }
}

/// Whether a block has a formula or an assignment of macro B.
fn has_formula(block: &str) -> bool {
    block.contains(['[', '='])
}

/// Appends the messages about other errors of the block, if any, to the message of the first
/// one.
fn append_further(rule: Message, further: Vec<Message>) -> Message {
    match further.is_empty() {
        true => rule,
        false => say::several([rule, say::block_also(further)]),
    }
}
