//! Reads blocks, as far as the host and the compensation allow.

use gsk_messages::{Message, say};

use crate::alarm::{Alarm, number};
use crate::command::{Action, BlockNumber, Command, ProgramId, Source};
use crate::interpreter::Modal;
use crate::interpreter::block;
use crate::interpreter::calls::subprogram;
use crate::interpreter::codes::corner;
use crate::interpreter::codes::inch;
use crate::interpreter::codes::nose_radius::check_call;
use crate::interpreter::context::code_calls::{self, CodeCalls};
use crate::interpreter::context::exact::Exact;
use crate::interpreter::context::flow::Flow;
use crate::interpreter::context::host::Host;
use crate::interpreter::context::machine_codes::MachineCodes;
use crate::interpreter::context::place::{Call, Place};
use crate::interpreter::context::state::State;
use crate::interpreter::context::words::Words;
use crate::interpreter::context::{Compensated, Context};
use crate::interpreter::macros::formula;
use crate::interpreter::macros::lookahead;
use crate::interpreter::macros::lookahead::Reading;
use crate::interpreter::macros::statement::{self, Here};
use crate::interpreter::macros::system::Known;
use crate::interpreter::macros::variable::NotNow;
use crate::interpreter::plain_move::{PlainMove, Under};
use crate::interpreter::plan::Plan;
use crate::interpreter::run::Run;
use crate::interpreter::word_audit::{Evaluated, Remark};
use crate::memory::Parameters;
use crate::model::ControlModel;
use crate::program::{Block, Program, Recent, further_foreign_words};

use super::read::{Read, missing};
use super::statements::{refused_by_huaxing, resolve};
use super::{Advance, Interpreter};

/// Greatest number of blocks without a command in one call.
const SILENT_BLOCKS: u32 = 16;

impl Interpreter {
    /// The next command as programmed, without the nose radius compensation.
    ///
    /// # Errors
    /// The alarm of the block. It has no effect then.
    pub(in crate::interpreter) fn step<H: Host>(&mut self, host: &mut H) -> Result<Advance, Alarm> {
        for _ in 0..SILENT_BLOCKS {
            let run = self.run_mut();
            if let Some(command) = run.take() {
                return Ok(Advance::Command(command));
            }
            if run.ended {
                self.mdi = None;
                return Ok(Advance::Ended);
            }
            if run.paused {
                if !host.settled() {
                    return Ok(Advance::Wait);
                }
                run.paused = false;
            }
            match self.read(host)? {
                Read::Planned => {}
                Read::Moves(command) => return Ok(Advance::Command(command)),
                Read::Skipped => self.run_mut().place.block += 1,
                Read::Wait => return Ok(Advance::Wait),
                Read::Starved => return Ok(Advance::Starved),
                Read::Ended => self.run_mut().ended = true,
            }
        }
        self.nothing_yet()
    }

    /// A command without action after many silent blocks, which gives the control a turn.
    fn nothing_yet(&self) -> Result<Advance, Alarm> {
        let Some(source) = self.run().source else {
            return Ok(Advance::Wait);
        };
        Ok(Advance::Command(Command {
            source,
            action: Action::Nothing,
            modal: self.state.modal,
            block_end: false,
            stop_point: false,
            whole: false,
            programmed_x: None,
        }))
    }

    fn read<H: Host>(&mut self, host: &mut H) -> Result<Read, Alarm> {
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
        let place = self.run().place;
        let program = match &self.mdi {
            Some(mdi) => Some(&mdi.program),
            None => host.programs().get(place.program),
        };
        let also = program.map(|program| self.further_foreign(program, place.block));
        alarm.detail = match (alarm.detail, also) {
            (Some(detail), Some(also)) => Some(with_further(detail, also)),
            (detail, _) => detail,
        };
        alarm
    }

    /// Messages about the foreign words of a block after the first one.
    #[cold]
    fn further_foreign(&self, program: &Program, block: u32) -> Vec<Message> {
        let record = self.record();
        let has_m = |code| self.machine_codes.has(code) || record.m_function(code).is_some();
        further_foreign_words(program.block(block), record, &has_m)
    }

    fn read_block<H: Host>(&mut self, recent: &mut Recent, host: &mut H) -> Result<Read, Alarm> {
        let mdi = self.mdi.as_ref();
        let run = mdi.map_or(&self.main, |mdi| &mdi.run);
        let place = run.place;
        let program = match mdi {
            Some(mdi) => &mdi.program,
            None => host
                .programs()
                .get(place.program)
                .ok_or_else(|| missing(place.program))?,
        };
        if let Some(finishing) = run.finishing.filter(|profile| profile.is_over(place)) {
            // The last block of the profile ends square to its direction.
            self.compensation.flush();
            let mut plan = Plan::after_profile(&finishing, &mut self.state);
            plan.whole = true;
            self.run_mut().finishing = None;
            self.note(plan.source);
            return Ok(self.planned(plan));
        }
        if run.calls.last().is_some_and(|call| call.is_over(place)) {
            return self.end_of_text(program.block_line(place.block.saturating_sub(1)), host);
        }
        if place.block >= program.block_count() {
            if mdi.is_none() && host.programs().goes_on(place.program) {
                return Ok(Read::Starved);
            }
            return self.end_of_text(program.line_count(), host);
        }
        let syntax = self.syntax(place.program, program, host.parameters());
        let mut source = Source {
            program: place.program,
            line: 0,
            sequence: run.sequence,
        };
        let skipping = host.block_skip() && mdi.is_none();
        if let Some(calls) = calls_by_codes(self.code_calls.as_deref(), run, place) {
            let call = program.code_call(place.block, &|letter, code| calls.called(letter, code));
            let call = match call {
                Ok(call) => call.filter(|call| !(skipping && call.skip)),
                Err(_) if skipping && program.has_skip_mark(place.block) => None,
                Err(error) => {
                    source.line = program.block_line(place.block);
                    return Err(Alarm::from(error).at(source));
                }
            };
            if let Some(call) = call {
                source.line = program.block_line(place.block);
                source.sequence = call.n.map(BlockNumber::from).or(source.sequence);
                let known = Known {
                    levels: &run.levels,
                    state: self.state,
                    source,
                    counted: false,
                };
                let here = Here {
                    program,
                    programs: host.programs(),
                    place,
                    calls: &run.calls,
                    syntax,
                    within: None,
                };
                let read = |it| known.read(it, &*host);
                let outcome =
                    statement::carry_out_code_call(&call, &here, formula::Read::of(&read));
                return self.follow_statement(outcome, source, place, host);
            }
        }
        let mut block = match recent.read(program, place.block, syntax) {
            Ok(block) => block,
            Err(mut error) => {
                if error.alarm == number::BAD_ADDRESS {
                    let also = self.further_foreign(program, place.block);
                    error.detail = with_further(error.detail, also);
                }
                source.line = program.block_line(place.block);
                let number = program.sequence(place.block).map(BlockNumber::from);
                source.sequence = number.or(source.sequence);
                if !(skipping && program.has_skip_mark(place.block)) {
                    return Err(Alarm::from(error).at(source));
                }
                self.note(source);
                return Ok(Read::Skipped);
            }
        };
        source.line = block.line;
        source.sequence = block.n.map(BlockNumber::from).or(source.sequence);
        let skipped = skipping && block.skip;
        if skipped || block.is_name() {
            self.note(source);
            return Ok(Read::Skipped);
        }
        let audits = self.audit.is_some() && mdi.is_none();
        if audits
            && program.follows_semicolon(place.block)
            && let Some(audit) = &mut self.audit
        {
            audit.keep(Remark::AfterSemicolon, source);
        }
        if block.has_g(65) {
            if self.record().g_code(65).is_none() {
                let rule = say::g_unknown(65);
                return Err(Alarm::new(number::BAD_G).because(rule).at(source));
            }
            if audits && let Some(audit) = &mut self.audit {
                audit.look_at_macro(program, place.block, block, source);
            }
            return self.operate(block, source, place, host);
        }
        let plain = match mdi.is_some()
            || syntax.inch
            || self.state.scale.is_some()
            || run.levels.has_modal_call()
            || (audits && has_rivals(block))
        {
            true => None,
            false => PlainMove::of(block, self.state.modal.motion, self.record()),
        };
        if let Some(plain) = plain {
            let under = Under {
                record: self.record(),
                compensated: self.compensated(),
                x_factor: x_factor(host.parameters()),
            };
            let from = self.state.machine(self.state.position);
            let action = plain.action(&mut self.state, under);
            // A block of an arc of no length has no motion.
            if let Some(action) = action.map_err(|alarm| alarm.at(source))? {
                return Ok(self.plain_move(action, from, source));
            }
        }
        // The state is large: copy it only for formulas.
        let known = match syntax.macro_b {
            true => Some(Known {
                levels: &run.levels,
                state: self.state,
                source,
                counted: self.own_variables,
            }),
            false => None,
        };
        if let (Some(statement), Some(known)) = (block.macro_statement(), &known) {
            if known.counted
                && let Some(alarm) = refused_by_huaxing(statement)
            {
                return Err(alarm.at(source));
            }
            let here = Here {
                program,
                programs: host.programs(),
                place,
                calls: &run.calls,
                syntax,
                within: run.levels.innermost(run.calls.len()),
            };
            let read = |it| known.read(it, &*host);
            let outcome = statement::carry_out(statement, &here, formula::Read::of(&read));
            return self.follow_statement(outcome, source, place, host);
        }
        let resolved = match resolve(block, known.as_ref(), syntax, &*host) {
            Ok(resolved) => resolved,
            Err(NotNow::Wait) => return Ok(Read::Wait),
            Err(NotNow::Fault(alarm)) => return Err(alarm.at(source)),
        };
        block = resolved.as_ref().unwrap_or(block);
        let mut metric;
        if syntax.inch {
            metric = block.clone();
            inch::to_metric(&mut metric, self.state.modal.motion);
            block = &metric;
        }
        let mut words = Words::default();
        words
            .take(block, self.record())
            .map_err(|alarm| alarm.at(source))?;
        if words.waits() && !host.settled() && !self.reads_early(&words) {
            return Ok(Read::Wait);
        }
        let reading = Reading {
            program,
            syntax,
            skipping,
            host: &*host,
            known: known.as_ref(),
        };
        let corner = corner::is_possible(&words, &self.state.modal);
        // A corner or the end of a thread depends on the next block, and not on the time of
        // its arrival through the serial line.
        let coming = mdi.is_none() && host.programs().may_bring_another(place.program);
        if coming
            && (corner || is_thread(&words, &self.state.modal))
            && !reading.has_next(place.block)
        {
            return Ok(Read::Starved);
        }
        let next = if corner {
            match reading.words_after(place.block, 1) {
                Ok(next) => next,
                Err(NotNow::Wait) => return Ok(Read::Wait),
                Err(NotNow::Fault(alarm)) => return Err(alarm.at(source)),
            }
        } else {
            None
        };
        let read = |index, motion| reading.words_at(index, motion).map_err(lookahead::alarm);
        let code_calls = calls_by_codes(self.code_calls.as_deref(), run, place);
        let t_calls = code_calls.and_then(|calls| calls.plain(&words));
        let context = Context {
            compensated: self.compensated(),
            machine_codes: self.machine_codes,
            code_calls,
            next: next.as_ref(),
            ..context(
                &*host,
                &self.model,
                source,
                place,
                &run.calls,
                mdi.is_some(),
                &read,
            )
        };
        let before = self.state;
        let mut plan = Plan::new(source, before.modal);
        let outcome = block::evaluate(&mut self.state, &context, &words, &mut plan);
        if audits
            && outcome.is_ok()
            && let Some(audit) = &mut self.audit
        {
            let evaluated = Evaluated {
                block,
                words: &words,
                record: self.model.record(),
                before: &before,
                after: &self.state,
                plan: &plan,
            };
            let mut evaluate = |words: &Words, state: &mut State, plan: &mut Plan| {
                block::evaluate(state, &context, words, plan)
            };
            audit.look(program, place.block, &evaluated, &mut evaluate);
        }
        let outcome = outcome
            .and_then(|()| call_after_move(run, &self.state, &context, &mut plan))
            .and_then(|()| Ok(plan.writes.apply(host.parameters_mut())?));
        if let Err(alarm) = outcome {
            self.state = before;
            return Err(alarm.at(source));
        }
        if let Some(call) = t_calls
            && call.address == 'T'
        {
            let variables = host.variables_mut();
            let set = variables.set_real(code_calls::T_VARIABLE, Some(call.code as f64));
            set.map_err(|alarm| alarm.at(source))?;
        }
        self.stand_as(&before);
        self.note(source);
        Ok(self.planned(plan))
    }

    /// The command of a block that only moves, from machine position `from`, without a plan.
    #[inline]
    fn plain_move(&mut self, action: Action, from: Exact, source: Source) -> Read {
        if self.state.modal.nose_compensation != 40 && !self.compensation.is_on() {
            let frame = self.state.frame();
            self.compensation.stand_at(from.point(), frame);
        }
        self.note(source);
        self.main.move_alone();
        Read::Moves(Command {
            source,
            action,
            modal: self.state.modal,
            block_end: true,
            stop_point: true,
            whole: self.main.finishing.is_some(),
            programmed_x: None,
        })
    }

    /// Handles the end of the text without M30 or M99.
    fn end_of_text<H: Host>(&mut self, last_line: u32, host: &H) -> Result<Read, Alarm> {
        if self.mdi.is_some() {
            return Ok(Read::Ended);
        }
        let run = &self.main;
        let source = Source {
            program: run.place.program,
            line: last_line,
            sequence: run.sequence,
        };
        let mut plan = Plan::new(source, self.state.modal);
        plan.stops = false;
        if !run.calls.is_empty() {
            let context = Context {
                compensated: self.compensated(),
                machine_codes: self.machine_codes,
                ..context(
                    host,
                    &self.model,
                    source,
                    run.place,
                    &run.calls,
                    false,
                    &|_, _| Ok(None),
                )
            };
            check_call(&self.state, &context, plan.motion.is_contour())
                .map_err(|alarm| alarm.at(source))?;
            plan.flow = subprogram::back(&context, None)?;
            return Ok(self.planned(plan));
        }
        if !host.settled() {
            return Ok(Read::Wait);
        }
        plan.after = Some(Action::End {
            counts: false,
            m30: false,
            m02: false,
        });
        plan.flow = Flow::End;
        self.state.cycle.clear();
        Ok(self.planned(plan))
    }

    /// Stores a plan in the run. After M00, M30 and a G28 that seeks the reference point the
    /// reader pauses until they are finished.
    pub(super) fn planned(&mut self, mut plan: Plan) -> Read {
        let run = self.run_mut();
        plan.whole |= run.finishing.is_some();
        run.paused = plan.motion.ends_unknown()
            || matches!(plan.after, Some(Action::ProgramStop | Action::End { .. }));
        run.plan = Some(plan);
        Read::Planned
    }

    pub(super) fn note(&mut self, source: Source) {
        let run = self.run_mut();
        run.source = Some(source);
        run.sequence = source.sequence;
    }
}

/// The message of a rule, with the other errors of its block.
fn with_further(rule: Message, further: Vec<Message>) -> Message {
    match further.is_empty() {
        true => rule,
        false => say::several([rule, say::block_also(further)]),
    }
}

/// Whether a move has two words for the same thing.
const fn has_rivals(block: &Block) -> bool {
    block.has(b'X') && block.has(b'U')
        || block.has(b'Z') && block.has(b'W')
        || block.has(b'R') && block.has_any(b"IK")
        || block.has_two_codes()
}

/// The codes that call a program at the position of a run; `None` if they are ordinary.
#[inline]
fn calls_by_codes<'a>(
    calls: Option<&'a CodeCalls>,
    run: &Run,
    place: Place,
) -> Option<&'a CodeCalls> {
    let stored = !matches!(place.program, ProgramId::Mdi | ProgramId::Dnc);
    calls.filter(|_| stored && !code_calls::are_ordinary(&run.calls))
}

/// Plans the macro call that G66 makes after a move, outside the profile of a cycle.
#[inline]
fn call_after_move(
    run: &Run,
    state: &State,
    context: &Context<'_>,
    plan: &mut Plan,
) -> Result<(), Alarm> {
    let calls = run.levels.has_modal_call() && plan.motion.moves() && run.finishing.is_none();
    if !calls || !matches!(plan.flow, Flow::Next) {
        return Ok(());
    }
    plan.flow = run.modal_call(context.place);
    match plan.flow {
        Flow::MacroCall(_) => check_call(state, context, plan.motion.is_contour()),
        _ => Ok(()),
    }
}

/// Whether a block cuts a thread that may continue in the next block.
fn is_thread(words: &Words, modal: &Modal) -> bool {
    let motion = words.motion.unwrap_or(modal.motion);
    matches!(motion, 32 | 34) && words.one_shot.is_none() && words.has_axis_words()
}

fn context<'a, H: Host>(
    host: &'a H,
    model: &'a ControlModel,
    source: Source,
    place: Place,
    calls: &'a [Call],
    mdi: bool,
    read: &'a dyn Fn(u32, u8) -> Result<Option<Words>, Alarm>,
) -> Context<'a> {
    let parameters = host.parameters();
    Context {
        parameters,
        model,
        offsets: host.offsets(),
        programs: host.programs(),
        referenced: host.referenced(),
        calls,
        source,
        place,
        mdi,
        machine_codes: MachineCodes::default(),
        code_calls: None,
        x_factor: x_factor(parameters),
        compensated: Compensated::Never,
        read,
        next: None,
    }
}

/// Diameters per programmed X: 2 under radius programming (001.2), else 1.
fn x_factor(parameters: &Parameters) -> i64 {
    match parameters.radius_programming() {
        true => 2,
        false => 1,
    }
}
