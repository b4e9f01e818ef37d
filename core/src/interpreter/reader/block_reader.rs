//! Reads blocks, as far as the host and the compensation allow.

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::command::{Action, ControlCommand, SourcePosition};
use crate::interpreter::calls::subprogram;
use crate::interpreter::codes::nose_radius::check_call;
use crate::interpreter::context::BlockContext;
use crate::interpreter::flow::Flow;
use crate::interpreter::flow::code_calls::{self, PlainCall};
use crate::interpreter::host::Host;
use crate::interpreter::macros::lookahead::LookaheadReader;
use crate::interpreter::macros::statement::StatementEffect;
use crate::interpreter::macros::system::VariableSources;
use crate::interpreter::macros::variable::ReadError;
use crate::interpreter::plan::Plan;
use crate::interpreter::reader::run::InterpreterRun;
use crate::interpreter::words::SortedWords;
use crate::model::ModelRecord;
use crate::program::{BlockCache, MacroStatement, Program, ProgramBlock};

use super::block_evaluation::{BlockEvaluation, build_context};
use super::block_read::{BlockRead, missing_program_alarm};
use super::pending_block::{PendingBlock, ReadObstacle, TextBoundary};
use super::statements::huaxing_alarm;
use super::{AdvanceResult, Interpreter, MdiRun};

/// Greatest number of blocks without a command that one call reads.
const SILENT_BLOCKS: u32 = 16;

impl Interpreter {
    /// Reads blocks up to the next command, as programmed, without the nose radius
    /// compensation, and stores it in `command`.
    ///
    /// # Errors
    /// The alarm of the block. The block has no effect then.
    pub(in crate::interpreter) fn next_programmed<H: Host>(
        &mut self,
        host: &mut H,
        command: &mut Option<ControlCommand>,
    ) -> Result<AdvanceResult, Alarm> {
        for _ in 0..SILENT_BLOCKS {
            let run = self.current_run_mut();
            if run.plan.is_some() {
                *command = run.take_command();
                if command.is_some() {
                    return Ok(AdvanceResult::Command);
                }
            }
            let run = self.current_run_mut();
            if run.has_ended {
                self.mdi = None;
                return Ok(AdvanceResult::Ended);
            }
            if run.is_paused {
                if !host.is_settled() {
                    return Ok(AdvanceResult::Wait);
                }
                run.is_paused = false;
            }
            if self.read_plain_move(host, command)? {
                return Ok(AdvanceResult::Command);
            }
            match self.read_next_block(host)? {
                BlockRead::Planned => {}
                BlockRead::Skipped => self.current_run_mut().position.block += 1,
                BlockRead::Wait => return Ok(AdvanceResult::Wait),
                BlockRead::Starved => return Ok(AdvanceResult::Starved),
                BlockRead::Ended => self.current_run_mut().has_ended = true,
            }
        }
        *command = self.idle_command();
        Ok(match command {
            Some(_) => AdvanceResult::Command,
            None => AdvanceResult::Wait,
        })
    }

    /// A command without action, for the turn after many blocks without a command, so that one
    /// call never takes long; `None` before the first block.
    fn idle_command(&self) -> Option<ControlCommand> {
        Some(ControlCommand {
            source: self.current_run().source?,
            action: Action::Nothing,
            modal: self.state.modal,
            block_end: false,
            stop_point: false,
            defers_feed_hold: false,
            programmed_x: None,
        })
    }

    // Apart from the caller, whose part for plain moves stays small.
    #[inline(never)]
    fn read_next_block<H: Host>(&mut self, host: &mut H) -> Result<BlockRead, Alarm> {
        // Taken out of `self`, which changes while the block is borrowed.
        let mut recent = core::mem::take(&mut self.recent);
        let read = self.read_block(&mut recent, host);
        self.recent = recent;
        match read {
            Err(alarm) if matches!(alarm.number, number::BAD_G | number::BAD_M) => {
                Err(self.with_foreign_words(alarm, host))
            }
            read => read,
        }
    }

    fn read_block<H: Host>(
        &mut self,
        recent: &mut BlockCache,
        host: &mut H,
    ) -> Result<BlockRead, Alarm> {
        let is_mdi = self.mdi.is_some();
        let (program, run) = find_text(self.mdi.as_ref(), &self.main, &*host)?;
        if let Some(boundary) = TextBoundary::find(program, run, is_mdi, &*host) {
            return self.pass_boundary(boundary, host);
        }
        let position = run.position;
        let syntax = self.syntax(position.program, program, host.parameters());
        let is_skipping = host.is_block_skip_on() && !is_mdi;
        let mut pending = PendingBlock::new((program, run), syntax, is_mdi, is_skipping);
        let code_calls = pending.active_code_calls(self.code_calls.as_deref());
        if let Some(calls) = code_calls
            && let Some(call) = pending.find_code_call(calls)?
        {
            let sources = pending.variable_sources(self.state, false, &*host);
            let effect = pending.evaluate_code_call(&call, host.programs(), &sources);
            let source = pending.source;
            return self.execute_statement(effect, source, host);
        }
        let block = match recent.read(program, position.block, syntax) {
            Ok(block) => block,
            Err(error) => {
                let source = self.skip_unparsed(error, &mut pending)?;
                return Ok(self.skip_block(source));
            }
        };
        pending.locate(block.line, block.n);
        let source = pending.source;
        if pending.is_without_effect(block) {
            return Ok(self.skip_block(source));
        }
        let mut audit = self.audit.as_deref_mut().filter(|_| !is_mdi);
        if let Some(audit) = &mut audit {
            pending.audit_semicolon(audit);
        }
        if block.has_g(65) {
            check_macro_code(self.model.record()).map_err(|alarm| alarm.with_source(source))?;
            if let Some(audit) = audit {
                audit.audit_macro_block(program, position.block, block, source);
            }
            return self.execute_macro_block(block, source, position, host);
        }
        let is_audited = audit.is_some();
        let sources = self.variable_sources(&pending, &*host);
        if let (Some(statement), Some(known)) = (block.macro_statement(), &sources) {
            let effect = self.evaluate_statement(statement, &pending, known);
            return self.execute_statement(effect, source, host);
        }
        let motion = self.state.modal.motion;
        let converted = match pending.convert(block, sources.as_ref(), motion, &*host) {
            Ok(converted) => converted,
            Err(reason) => return ReadObstacle::from(reason).into_read(source),
        };
        let block = converted.as_ref().unwrap_or(block);
        let ahead = pending.lookahead_reader(sources.as_ref(), &*host);
        let mut words = SortedWords::default();
        let next = match self.sort_words(block, &pending, &ahead, &mut words) {
            Ok(next) => next,
            Err(obstacle) => return obstacle.into_read(source),
        };
        let t_call = code_calls.and_then(|calls| calls.find_subprogram(&words));
        let evaluation = BlockEvaluation {
            pending: &pending,
            block,
            words: &words,
            next: next.as_ref(),
            code_calls,
            compensation: self.compensation_mode(),
            machine_codes: self.machine_codes,
            model: &self.model,
            ahead: &ahead,
        };
        let before = self.state;
        let mut plan = Plan::new(source, before.modal);
        let audit = self.audit.as_deref_mut().filter(|_| is_audited);
        let result = evaluation
            .evaluate(&mut self.state, &before, audit, &mut plan)
            .and_then(|()| Ok(plan.writes.apply(host.parameters_mut())?));
        if let Err(alarm) = result {
            self.state = before;
            return Err(alarm.with_source(source));
        }
        set_t_variable(t_call, host).map_err(|alarm| alarm.with_source(source))?;
        self.set_compensation_start(&before);
        Ok(self.record_plan(plan))
    }

    /// Handles the end of a text, of a profile or of the blocks that have arrived.
    fn pass_boundary<H: Host>(
        &mut self,
        boundary: TextBoundary,
        host: &H,
    ) -> Result<BlockRead, Alarm> {
        match boundary {
            TextBoundary::Starved => Ok(BlockRead::Starved),
            TextBoundary::TextEnd(last_line) => self.handle_end_of_text(last_line, host),
            TextBoundary::ProfileEnd(finishing) => {
                // The last block of the profile ends square to its direction.
                self.compensation.flush();
                let mut plan = Plan::return_from_profile(&finishing, &mut self.state);
                plan.holds_at_move_end = true;
                self.current_run_mut().finishing = None;
                Ok(self.record_plan(plan))
            }
        }
    }

    /// The variables that formulas of the block read; `None` if the syntax has no formulas.
    #[inline]
    fn variable_sources<'a, H: Host>(
        &self,
        pending: &PendingBlock<'a>,
        host: &'a H,
    ) -> Option<VariableSources<'a, H>> {
        // The state is large: copy it only for formulas.
        match pending.syntax.macro_b {
            true => Some(pending.variable_sources(self.state, self.has_huaxing_variables, host)),
            false => None,
        }
    }

    /// Evaluates a statement of macro B without changing anything. Returns an error if the model
    /// does not have the statement, or if a formula has no value or must wait.
    fn evaluate_statement<H: Host>(
        &self,
        statement: &MacroStatement,
        pending: &PendingBlock<'_>,
        sources: &VariableSources<'_, H>,
    ) -> Result<StatementEffect, ReadError> {
        if self.has_huaxing_variables
            && let Some(alarm) = huaxing_alarm(statement)
        {
            return Err(alarm.into());
        }
        pending.evaluate_statement(statement, sources.host.programs(), sources)
    }

    /// Sorts the words of a block into the empty `words`. Returns the words of the next block
    /// if this block has a corner, else `None`.
    #[inline]
    fn sort_words<H: Host>(
        &self,
        block: &ProgramBlock,
        pending: &PendingBlock<'_>,
        ahead: &LookaheadReader<'_, H>,
        words: &mut SortedWords,
    ) -> Result<Option<SortedWords>, ReadObstacle> {
        words
            .sort_block(block, self.record())
            .map_err(ReadObstacle::Fault)?;
        if words.needs_standstill() && !ahead.host.is_settled() && !self.can_read_early(words) {
            return Err(ReadObstacle::Wait);
        }
        pending.read_next_words(words, &self.state.modal, ahead)
    }

    /// Handles the end of a text without M30 or M99: returns from a call, or ends the run.
    /// `last_line` is the line of the end, for messages.
    fn handle_end_of_text<H: Host>(
        &mut self,
        last_line: u32,
        host: &H,
    ) -> Result<BlockRead, Alarm> {
        if self.mdi.is_some() {
            return Ok(BlockRead::Ended);
        }
        let run = &self.main;
        let source = SourcePosition {
            program: run.position.program,
            line: last_line,
            sequence: run.sequence,
        };
        let mut plan = Plan::new(source, self.state.modal);
        plan.is_stop = false;
        if !run.calls.is_empty() {
            let context = BlockContext {
                compensation: self.compensation_mode(),
                machine_codes: self.machine_codes,
                ..build_context(
                    host,
                    &self.model,
                    source,
                    run.position,
                    &run.calls,
                    false,
                    &|_, _| Ok(None),
                )
            };
            check_call(&self.state, &context, plan.motion.is_contour())
                .map_err(|alarm| alarm.with_source(source))?;
            plan.flow = subprogram::plan_return(&context.call_context(), None)?;
            return Ok(self.store_plan(plan));
        }
        if !host.is_settled() {
            return Ok(BlockRead::Wait);
        }
        plan.after = Some(Action::End {
            counts: false,
            m30: false,
            m02: false,
        });
        plan.flow = Flow::End;
        self.state.cycle.clear();
        Ok(self.store_plan(plan))
    }

    /// Stores the plan of a block in the run. After M00, M30 and a G28 that seeks the
    /// reference point the reader waits until the machine has finished them.
    pub(super) fn store_plan(&mut self, mut plan: Plan) -> BlockRead {
        let run = self.current_run_mut();
        plan.holds_at_move_end |= run.finishing.is_some();
        run.is_paused = plan.motion.is_end_unknown()
            || matches!(plan.after, Some(Action::ProgramStop | Action::End { .. }));
        run.plan = Some(plan);
        BlockRead::Planned
    }

    /// Stores the plan of a block, and its source as that of the block read last.
    #[inline]
    pub(super) fn record_plan(&mut self, plan: Plan) -> BlockRead {
        self.record_source(plan.source);
        self.store_plan(plan)
    }

    fn skip_block(&mut self, source: SourcePosition) -> BlockRead {
        self.record_source(source);
        BlockRead::Skipped
    }

    pub(super) fn record_source(&mut self, source: SourcePosition) {
        let run = self.current_run_mut();
        run.source = Some(source);
        run.sequence = source.sequence;
    }
}

/// Finds the program and the run of the next block: those of the MDI block if there is one.
///
/// # Errors
/// 031 for a missing program.
#[inline]
fn find_text<'a, H: Host>(
    mdi: Option<&'a MdiRun>,
    main: &'a InterpreterRun,
    host: &'a H,
) -> Result<(&'a Program, &'a InterpreterRun), Alarm> {
    match mdi {
        Some(mdi) => Ok((&mdi.program, &mdi.run)),
        None => host
            .programs()
            .get(main.position.program)
            .map(|program| (program, main))
            .ok_or_else(|| missing_program_alarm(main.position.program)),
    }
}

/// Checks that the model has G65; alarm 010 if not.
fn check_macro_code(record: &ModelRecord) -> Result<(), Alarm> {
    match record.g_code(65) {
        Some(_) => Ok(()),
        None => Err(Alarm::new(number::BAD_G).with_detail(say::g_unknown(65))),
    }
}

/// Stores the number of a T word that calls a program into #149.
#[inline]
fn set_t_variable<H: Host>(call: Option<PlainCall>, host: &mut H) -> Result<(), Alarm> {
    match call {
        Some(call) if call.address == 'T' => {
            let variables = host.variables_mut();
            variables.set_real(code_calls::T_VARIABLE, Some(call.code as f64))
        }
        _ => Ok(()),
    }
}
