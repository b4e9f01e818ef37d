//! Reads blocks, as far as the host and the compensation allow.

use gsk_messages::{Message, say};

use crate::alarm::{Alarm, number};
use crate::command::{Action, ControlCommand, ProgramId, SequenceNumber, SourcePosition};
use crate::interpreter::ModalState;
use crate::interpreter::block;
use crate::interpreter::calls::subprogram;
use crate::interpreter::codes::corner;
use crate::interpreter::codes::inch;
use crate::interpreter::codes::nose_radius::check_call;
use crate::interpreter::context::code_calls::{self, CodeCalls};
use crate::interpreter::context::exact::ExactPoint;
use crate::interpreter::context::flow::Flow;
use crate::interpreter::context::host::Host;
use crate::interpreter::context::machine_codes::MachineCodes;
use crate::interpreter::context::program_position::{ProgramCall, ProgramPosition};
use crate::interpreter::context::state::State;
use crate::interpreter::context::words::SortedWords;
use crate::interpreter::context::{BlockContext, CompensationMode};
use crate::interpreter::macros::formula;
use crate::interpreter::macros::lookahead;
use crate::interpreter::macros::lookahead::LookaheadReader;
use crate::interpreter::macros::statement::{self, StatementContext};
use crate::interpreter::macros::system::VariableSources;
use crate::interpreter::macros::variable::ReadError;
use crate::interpreter::plain_move::{MoveContext, PlainMove};
use crate::interpreter::plan::Plan;
use crate::interpreter::run::InterpreterRun;
use crate::interpreter::word_audit::{BlockRemark, EvaluatedBlock};
use crate::memory::ControlParameters;
use crate::model::ControlModel;
use crate::program::{BlockCache, Program, ProgramBlock, further_foreign_words};

use super::block_read::{BlockRead, missing_program_alarm};
use super::statements::{huaxing_alarm, resolve_block};
use super::{AdvanceResult, Interpreter};

/// Greatest number of blocks without a command in one call.
const SILENT_BLOCKS: u32 = 16;

impl Interpreter {
    /// The next command as programmed, without the nose radius compensation.
    ///
    /// # Errors
    /// The alarm of the block. It has no effect then.
    pub(in crate::interpreter) fn next_programmed<H: Host>(
        &mut self,
        host: &mut H,
    ) -> Result<AdvanceResult, Alarm> {
        for _ in 0..SILENT_BLOCKS {
            let run = self.current_run_mut();
            if let Some(command) = run.take_command() {
                return Ok(AdvanceResult::Command(command));
            }
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
            match self.read_next_block(host)? {
                BlockRead::Planned => {}
                BlockRead::Moves(command) => return Ok(AdvanceResult::Command(command)),
                BlockRead::Skipped => self.current_run_mut().position.block += 1,
                BlockRead::Wait => return Ok(AdvanceResult::Wait),
                BlockRead::Starved => return Ok(AdvanceResult::Starved),
                BlockRead::Ended => self.current_run_mut().has_ended = true,
            }
        }
        self.yield_turn()
    }

    /// A command without action after many silent blocks, which gives the control a turn.
    fn yield_turn(&self) -> Result<AdvanceResult, Alarm> {
        let Some(source) = self.current_run().source else {
            return Ok(AdvanceResult::Wait);
        };
        Ok(AdvanceResult::Command(ControlCommand {
            source,
            action: Action::Nothing,
            modal: self.state.modal,
            block_end: false,
            stop_point: false,
            defers_feed_hold: false,
            programmed_x: None,
        }))
    }

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

    /// Adds the other foreign words of the block to the alarm of a foreign code.
    #[cold]
    fn with_foreign_words<H: Host>(&self, mut alarm: Alarm, host: &H) -> Alarm {
        let position = self.current_run().position;
        let program = match &self.mdi {
            Some(mdi) => Some(&mdi.program),
            None => host.programs().get(position.program),
        };
        let further =
            program.map(|program| self.find_further_foreign_words(program, position.block));
        alarm.detail = match (alarm.detail, further) {
            (Some(detail), Some(also)) => Some(append_further(detail, also)),
            (detail, _) => detail,
        };
        alarm
    }

    /// Messages about the foreign words of a block after the first one.
    #[cold]
    fn find_further_foreign_words(&self, program: &Program, block: u32) -> Vec<Message> {
        let record = self.record();
        let has_m = |code| self.machine_codes.contains(code) || record.m_function(code).is_some();
        further_foreign_words(program.block(block), record, &has_m)
    }

    fn read_block<H: Host>(
        &mut self,
        recent: &mut BlockCache,
        host: &mut H,
    ) -> Result<BlockRead, Alarm> {
        let mdi = self.mdi.as_ref();
        let run = mdi.map_or(&self.main, |mdi| &mdi.run);
        let position = run.position;
        let program = match mdi {
            Some(mdi) => &mdi.program,
            None => host
                .programs()
                .get(position.program)
                .ok_or_else(|| missing_program_alarm(position.program))?,
        };
        if let Some(finishing) = run
            .finishing
            .filter(|profile| profile.is_finished_at(position))
        {
            // The last block of the profile ends square to its direction.
            self.compensation.flush();
            let mut plan = Plan::return_from_profile(&finishing, &mut self.state);
            plan.holds_at_move_end = true;
            self.current_run_mut().finishing = None;
            self.record_source(plan.source);
            return Ok(self.store_plan(plan));
        }
        if run
            .calls
            .last()
            .is_some_and(|call| call.is_finished_at(position))
        {
            return self
                .handle_end_of_text(program.block_line(position.block.saturating_sub(1)), host);
        }
        if position.block >= program.block_count() {
            if mdi.is_none() && host.programs().has_more(position.program) {
                return Ok(BlockRead::Starved);
            }
            return self.handle_end_of_text(program.line_count(), host);
        }
        let syntax = self.syntax(position.program, program, host.parameters());
        let mut source = SourcePosition {
            program: position.program,
            line: 0,
            sequence: run.sequence,
        };
        let is_skipping = host.is_block_skip_on() && mdi.is_none();
        if let Some(calls) = active_code_calls(self.code_calls.as_deref(), run, position) {
            let call = program.code_call(position.block, &|letter, code| {
                calls.find_macro(letter, code)
            });
            let call = match call {
                Ok(call) => call.filter(|call| !(is_skipping && call.skip)),
                Err(_) if is_skipping && program.has_skip_mark(position.block) => None,
                Err(error) => {
                    source.line = program.block_line(position.block);
                    return Err(Alarm::from(error).with_source(source));
                }
            };
            if let Some(call) = call {
                source.line = program.block_line(position.block);
                source.sequence = call.n.map(SequenceNumber::from).or(source.sequence);
                let sources = VariableSources {
                    levels: &run.levels,
                    state: self.state,
                    source,
                    has_huaxing_variables: false,
                };
                let statement_context = StatementContext {
                    program,
                    programs: host.programs(),
                    position,
                    calls: &run.calls,
                    syntax,
                    current_loop: None,
                };
                let read_variable = |it| sources.read(it, &*host);
                let effect = statement::evaluate_code_call(
                    &call,
                    &statement_context,
                    formula::FormulaContext::new(&read_variable),
                );
                return self.execute_statement(effect, source, position, host);
            }
        }
        let mut block = match recent.read(program, position.block, syntax) {
            Ok(block) => block,
            Err(mut error) => {
                if error.alarm == number::BAD_ADDRESS {
                    let further = self.find_further_foreign_words(program, position.block);
                    error.detail = append_further(error.detail, further);
                }
                source.line = program.block_line(position.block);
                let number = program.sequence(position.block).map(SequenceNumber::from);
                source.sequence = number.or(source.sequence);
                if !(is_skipping && program.has_skip_mark(position.block)) {
                    return Err(Alarm::from(error).with_source(source));
                }
                self.record_source(source);
                return Ok(BlockRead::Skipped);
            }
        };
        source.line = block.line;
        source.sequence = block.n.map(SequenceNumber::from).or(source.sequence);
        let is_skipped = is_skipping && block.skip;
        if is_skipped || block.is_name_only() {
            self.record_source(source);
            return Ok(BlockRead::Skipped);
        }
        let is_audited = self.audit.is_some() && mdi.is_none();
        if is_audited
            && program.follows_semicolon(position.block)
            && let Some(audit) = &mut self.audit
        {
            audit.add_remark(BlockRemark::AfterSemicolon, source);
        }
        if block.has_g(65) {
            if self.record().g_code(65).is_none() {
                let rule = say::g_unknown(65);
                return Err(Alarm::new(number::BAD_G)
                    .with_detail(rule)
                    .with_source(source));
            }
            if is_audited && let Some(audit) = &mut self.audit {
                audit.audit_macro_block(program, position.block, block, source);
            }
            return self.execute_macro_block(block, source, position, host);
        }
        let plain_move = match mdi.is_some()
            || syntax.inch
            || self.state.scale.is_some()
            || run.levels.has_modal_call()
            || (is_audited && has_competing_words(block))
        {
            true => None,
            false => PlainMove::from_block(block, self.state.modal.motion, self.record()),
        };
        if let Some(plain) = plain_move {
            let move_context = MoveContext {
                record: self.record(),
                compensation: self.compensation_mode(),
                x_factor: x_factor(host.parameters()),
            };
            let from = self.state.to_machine(self.state.position);
            let action = plain.apply(&mut self.state, move_context);
            // A block of an arc of no length has no motion.
            if let Some(action) = action.map_err(|alarm| alarm.with_source(source))? {
                return Ok(self.command_plain_move(action, from, source));
            }
        }
        // The state is large: copy it only for formulas.
        let sources = match syntax.macro_b {
            true => Some(VariableSources {
                levels: &run.levels,
                state: self.state,
                source,
                has_huaxing_variables: self.has_huaxing_variables,
            }),
            false => None,
        };
        if let (Some(statement), Some(known)) = (block.macro_statement(), &sources) {
            if known.has_huaxing_variables
                && let Some(alarm) = huaxing_alarm(statement)
            {
                return Err(alarm.with_source(source));
            }
            let statement_context = StatementContext {
                program,
                programs: host.programs(),
                position,
                calls: &run.calls,
                syntax,
                current_loop: run.levels.innermost_loop(run.calls.len()),
            };
            let read_variable = |it| known.read(it, &*host);
            let effect = statement::evaluate_statement(
                statement,
                &statement_context,
                formula::FormulaContext::new(&read_variable),
            );
            return self.execute_statement(effect, source, position, host);
        }
        let resolved = match resolve_block(block, sources.as_ref(), syntax, &*host) {
            Ok(resolved) => resolved,
            Err(ReadError::Wait) => return Ok(BlockRead::Wait),
            Err(ReadError::Fault(alarm)) => return Err(alarm.with_source(source)),
        };
        block = resolved.as_ref().unwrap_or(block);
        let mut metric;
        if syntax.inch {
            metric = block.clone();
            inch::convert_to_metric(&mut metric, self.state.modal.motion);
            block = &metric;
        }
        let mut words = SortedWords::default();
        words
            .sort_block(block, self.record())
            .map_err(|alarm| alarm.with_source(source))?;
        if words.needs_standstill() && !host.is_settled() && !self.can_read_early(&words) {
            return Ok(BlockRead::Wait);
        }
        let ahead_reader = LookaheadReader {
            program,
            syntax,
            is_skipping,
            host: &*host,
            sources: sources.as_ref(),
        };
        let is_corner = corner::can_be_corner(&words, &self.state.modal);
        // A corner or the end of a thread depends on the next block, and not on the time of
        // its arrival through the serial line.
        let may_arrive = mdi.is_none() && host.programs().can_bring_block(position.program);
        if may_arrive
            && (is_corner || is_thread(&words, &self.state.modal))
            && !ahead_reader.has_next(position.block)
        {
            return Ok(BlockRead::Starved);
        }
        let next = if is_corner {
            match ahead_reader.read_words_after(position.block, 1) {
                Ok(next) => next,
                Err(ReadError::Wait) => return Ok(BlockRead::Wait),
                Err(ReadError::Fault(alarm)) => return Err(alarm.with_source(source)),
            }
        } else {
            None
        };
        let read_words = |index, motion| {
            ahead_reader
                .read_words_at(index, motion)
                .map_err(lookahead::to_alarm)
        };
        let code_calls = active_code_calls(self.code_calls.as_deref(), run, position);
        let t_calls = code_calls.and_then(|calls| calls.find_subprogram(&words));
        let context = BlockContext {
            compensation: self.compensation_mode(),
            machine_codes: self.machine_codes,
            code_calls,
            next: next.as_ref(),
            ..build_context(
                &*host,
                &self.model,
                source,
                position,
                &run.calls,
                mdi.is_some(),
                &read_words,
            )
        };
        let before = self.state;
        let mut plan = Plan::new(source, before.modal);
        let result = block::evaluate(&mut self.state, &context, &words, &mut plan);
        if is_audited
            && result.is_ok()
            && let Some(audit) = &mut self.audit
        {
            let evaluated = EvaluatedBlock {
                block,
                words: &words,
                record: self.model.record(),
                before: &before,
                after: &self.state,
                plan: &plan,
            };
            let mut evaluate = |words: &SortedWords, state: &mut State, plan: &mut Plan| {
                block::evaluate(state, &context, words, plan)
            };
            audit.audit_block(program, position.block, &evaluated, &mut evaluate);
        }
        let result = result
            .and_then(|()| plan_modal_call(run, &self.state, &context, &mut plan))
            .and_then(|()| Ok(plan.writes.apply(host.parameters_mut())?));
        if let Err(alarm) = result {
            self.state = before;
            return Err(alarm.with_source(source));
        }
        if let Some(call) = t_calls
            && call.address == 'T'
        {
            let variables = host.variables_mut();
            let set = variables.set_real(code_calls::T_VARIABLE, Some(call.code as f64));
            set.map_err(|alarm| alarm.with_source(source))?;
        }
        self.set_compensation_start(&before);
        self.record_source(source);
        Ok(self.store_plan(plan))
    }

    /// The command of a block that only moves, from machine position `from`, without a plan.
    #[inline]
    fn command_plain_move(
        &mut self,
        action: Action,
        from: ExactPoint,
        source: SourcePosition,
    ) -> BlockRead {
        if self.state.modal.nose_compensation != 40 && !self.compensation.is_on() {
            let frame = self.state.frame();
            self.compensation.set_position(from.to_point(), frame);
        }
        self.record_source(source);
        self.main.record_plain_move();
        BlockRead::Moves(ControlCommand {
            source,
            action,
            modal: self.state.modal,
            block_end: true,
            stop_point: true,
            defers_feed_hold: self.main.finishing.is_some(),
            programmed_x: None,
        })
    }

    /// Handles the end of the text without M30 or M99.
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
            plan.flow = subprogram::plan_return(&context, None)?;
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

    /// Stores a plan in the run. After M00, M30 and a G28 that seeks the reference point the
    /// reader pauses until they are finished.
    pub(super) fn store_plan(&mut self, mut plan: Plan) -> BlockRead {
        let run = self.current_run_mut();
        plan.holds_at_move_end |= run.finishing.is_some();
        run.is_paused = plan.motion.is_end_unknown()
            || matches!(plan.after, Some(Action::ProgramStop | Action::End { .. }));
        run.plan = Some(plan);
        BlockRead::Planned
    }

    pub(super) fn record_source(&mut self, source: SourcePosition) {
        let run = self.current_run_mut();
        run.source = Some(source);
        run.sequence = source.sequence;
    }
}

/// The message of a rule, with the other errors of its block.
fn append_further(rule: Message, further: Vec<Message>) -> Message {
    match further.is_empty() {
        true => rule,
        false => say::several([rule, say::block_also(further)]),
    }
}

/// Whether a move has two words for the same thing.
const fn has_competing_words(block: &ProgramBlock) -> bool {
    block.has(b'X') && block.has(b'U')
        || block.has(b'Z') && block.has(b'W')
        || block.has(b'R') && block.has_any(b"IK")
        || block.has_two_g_codes()
}

/// The codes that call a program at the position of a run; `None` if they are ordinary.
#[inline]
fn active_code_calls<'a>(
    calls: Option<&'a CodeCalls>,
    run: &InterpreterRun,
    position: ProgramPosition,
) -> Option<&'a CodeCalls> {
    let stored = !matches!(position.program, ProgramId::Mdi | ProgramId::Dnc);
    calls.filter(|_| stored && !code_calls::are_ordinary(&run.calls))
}

/// Plans the macro call that G66 makes after a move, outside the profile of a cycle.
#[inline]
fn plan_modal_call(
    run: &InterpreterRun,
    state: &State,
    context: &BlockContext<'_>,
    plan: &mut Plan,
) -> Result<(), Alarm> {
    let can_call =
        run.levels.has_modal_call() && plan.motion.has_motion() && run.finishing.is_none();
    if !can_call || !matches!(plan.flow, Flow::Next) {
        return Ok(());
    }
    plan.flow = run.flow_after_move(context.position);
    match plan.flow {
        Flow::MacroCall(_) => check_call(state, context, plan.motion.is_contour()),
        _ => Ok(()),
    }
}

/// Whether a block cuts a thread that may continue in the next block.
fn is_thread(words: &SortedWords, modal: &ModalState) -> bool {
    let motion = words.motion.unwrap_or(modal.motion);
    matches!(motion, 32 | 34) && words.one_shot.is_none() && words.has_axis_words()
}

fn build_context<'a, H: Host>(
    host: &'a H,
    model: &'a ControlModel,
    source: SourcePosition,
    position: ProgramPosition,
    calls: &'a [ProgramCall],
    mdi: bool,
    read_words: &'a dyn Fn(u32, u8) -> Result<Option<SortedWords>, Alarm>,
) -> BlockContext<'a> {
    let parameters = host.parameters();
    BlockContext {
        parameters,
        model,
        offsets: host.offsets(),
        programs: host.programs(),
        referenced: host.referenced(),
        calls,
        source,
        position,
        is_mdi: mdi,
        machine_codes: MachineCodes::default(),
        code_calls: None,
        x_factor: x_factor(parameters),
        compensation: CompensationMode::Never,
        read_words,
        next: None,
    }
}

/// Diameters per programmed X: 2 under radius programming (001.2), else 1.
fn x_factor(parameters: &ControlParameters) -> i64 {
    match parameters.is_radius_programming() {
        true => 2,
        false => 1,
    }
}
