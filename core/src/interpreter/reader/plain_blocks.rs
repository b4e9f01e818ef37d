//! Reads blocks that only move along the contour, most blocks of a long program, without a
//! plan and without the words of other blocks.

use crate::alarm::Alarm;
use crate::command::{Action, ControlCommand, SequenceNumber, SourcePosition};
use crate::interpreter::exact::ExactPoint;
use crate::interpreter::host::Host;
use crate::interpreter::plain_move::{MoveContext, PlainMove};
use crate::interpreter::reader::word_audit::BlockRemark;
use crate::program::Program;

use super::Interpreter;
use super::block_evaluation::x_factor;
use super::pending_block::TextBoundary;

impl Interpreter {
    /// Reads the next block if it only moves along the contour, and stores its command. Returns
    /// whether it does; any other block has no effect yet.
    ///
    /// # Errors
    /// The alarm of the move. The block has no effect then.
    pub(super) fn read_plain_move<H: Host>(
        &mut self,
        host: &H,
        command: &mut Option<ControlCommand>,
    ) -> Result<bool, Alarm> {
        let run = &self.main;
        let position = run.position;
        let context = MoveContext {
            record: self.record(),
            compensation: self.compensation_mode(),
            x_factor: x_factor(host.parameters()),
        };
        let needs_plan = self.mdi.is_some()
            || self.code_calls.is_some()
            // The text before the first block may name the program.
            || position.block == 0
            || self.state.modal.inch
            || self.state.scale.is_some()
            || run.levels.has_modal_call()
            || !context.record.word_limits.is_empty();
        let text = host.programs().get(position.program);
        let Some(program) = text.filter(|_| !needs_plan) else {
            return Ok(false);
        };
        if TextBoundary::find(program, run, false, host).is_some() {
            return Ok(false);
        }
        let point_required = host.parameters().is_point_required();
        let Some((line, mut words)) = program.plain_words(position.block, point_required) else {
            return Ok(false);
        };
        let motion = self.state.modal.motion;
        let Some(plain) = PlainMove::read(&mut words, motion, context) else {
            return Ok(false);
        };
        let sequence = plain.sequence.map(SequenceNumber::from).or(run.sequence);
        let source = SourcePosition {
            program: position.program,
            line,
            sequence,
        };
        let from = self.state.position;
        // A block of an arc of no length has no motion, and needs a plan.
        let action = match plain.apply(&mut self.state, context) {
            Ok(Some(action)) => Ok(action),
            Ok(None) => return Ok(false),
            Err(alarm) => Err(alarm.with_source(source)),
        };
        self.recent.count_block(words.position());
        self.audit_plain_block(program, position.block, source);
        *command = Some(self.command_plain_move(action?, from, source));
        Ok(true)
    }

    /// Adds a remark if the block follows a semicolon in its line.
    #[inline]
    fn audit_plain_block(&mut self, program: &Program, block: u32, source: SourcePosition) {
        if let Some(audit) = &mut self.audit
            && program.follows_semicolon(block)
        {
            audit.add_remark(BlockRemark::AfterSemicolon, source);
        }
    }

    /// Makes the command of a block that only moves, and goes to the next block. `from` is the
    /// programmed position before the move.
    #[inline]
    fn command_plain_move(
        &mut self,
        action: Action,
        from: ExactPoint,
        source: SourcePosition,
    ) -> ControlCommand {
        if self.state.modal.nose_compensation != 40 && !self.compensation.is_on() {
            let frame = self.state.frame();
            let from = self.state.to_machine(from);
            self.compensation.set_position(from.to_point(), frame);
        }
        self.record_source(source);
        self.main.record_plain_move();
        ControlCommand {
            source,
            action,
            modal: self.state.modal,
            block_end: true,
            stop_point: true,
            defers_feed_hold: self.main.finishing.is_some(),
            programmed_x: None,
        }
    }
}
