//! The interpreter itself: reads blocks as far as it may and hands out their
//! commands one at a time.

use gsk_messages::say;
use serde::{Deserialize, Serialize};

use crate::alarm::{Alarm, number};
use crate::command::{Action, Command, Frame, ProgramId, Source};
use crate::compensation::Compensation;
use crate::interpreter::Modal;
use crate::interpreter::block;
use crate::interpreter::calls::jump::Jumps;
use crate::interpreter::calls::subprogram;
use crate::interpreter::codes::corner;
use crate::interpreter::codes::inch;
use crate::interpreter::codes::nose_radius::check_call;
use crate::interpreter::context::exact::Exact;
use crate::interpreter::context::explanation::{Explanation, Note};
use crate::interpreter::context::flow::Flow;
use crate::interpreter::context::host::{Host, Step};
use crate::interpreter::context::machine_codes::MachineCodes;
use crate::interpreter::context::place::{Call, Place};
use crate::interpreter::context::state::State;
use crate::interpreter::context::words::Words;
use crate::interpreter::context::{Compensated, Context};
use crate::interpreter::macros::lookahead;
use crate::interpreter::macros::lookahead::Reading;
use crate::interpreter::macros::macro_block;
use crate::interpreter::macros::macro_block::Outcome;
use crate::interpreter::macros::variable;
use crate::interpreter::macros::variable::NotNow;
use crate::interpreter::plan::Plan;
use crate::interpreter::run::Run;
use crate::memory::Parameters;
use crate::program::{Block, Program, Syntax};
use crate::units::{Axis, Point};

/// Blocks without any command that one call goes through.
const SILENT_BLOCKS: u32 = 16;

/// Blocks to commands. Plain data: it can be saved and restored at any time.
///
/// A *run* begins with [`start`](Self::start); [`next`](Self::next) then gives
/// one command a call until [`Step::Ended`]. A block keyed in on the MDI page
/// is a run of its own (`start_mdi`) that leaves a stopped
/// automatic run where it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Interpreter {
    pub(super) state: State,
    pub(super) main: Run,
    pub(super) mdi: Option<Mdi>,
    /// The nose radius compensation of the automatic run.
    pub(super) compensation: Compensation,
    /// Programmed end of what a compensated run has read, machine coordinates,
    /// while something else moves the tool.
    pub(super) aside: Option<Exact>,
    jumps: Jumps,
    machine_codes: MachineCodes,
}

/// The run over the MDI block.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Mdi {
    program: Program,
    run: Run,
}

/// Where a run has been read to, while the tool stands elsewhere.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ReadTo(State);

/// What reading one block led to.
enum Read {
    /// Its plan stands in the run.
    Planned,
    /// It must not be read yet.
    Wait,
    /// It has not come through the line yet.
    Starved,
    /// There is nothing in it.
    Skipped,
    /// The text is over.
    Ended,
}

/// One answer of [`Interpreter::advance`], the command in place.
pub(crate) enum Advance {
    Command(Command),
    Wait,
    /// What follows has not come through the line yet.
    Starved,
    Ended,
}

impl Interpreter {
    /// The interpreter at power-on, without a run.
    pub fn new(parameters: &Parameters) -> Self {
        let modal = Modal {
            tool: parameters.tool_in_position(),
            ..Modal::default()
        };
        Self {
            state: State::new(modal),
            main: Run::over(),
            mdi: None,
            compensation: Compensation::default(),
            aside: None,
            jumps: Jumps::default(),
            machine_codes: MachineCodes::default(),
        }
    }

    /// Whether programs are in inches, from the next block on.
    pub(crate) const fn set_inch_input(&mut self, inch: bool) {
        self.state.modal.inch = inch;
    }

    /// The modal state after the block read last.
    pub const fn modal(&self) -> &Modal {
        &self.state.modal
    }

    /// Spindle and coolant stopped without a program: the last M code is the one for that.
    pub(crate) const fn machine_stopped(&mut self) {
        self.state.modal.m = match self.state.modal.m {
            Some(3 | 4) => Some(5),
            Some(8) => Some(9),
            other => other,
        };
    }

    /// The thread lead in force, mm; zero = none yet.
    pub const fn thread_lead(&self) -> f64 {
        self.state.lead
    }

    /// The coordinate frame after the block read last.
    pub fn frame(&self) -> Frame {
        self.state.frame()
    }

    /// Programmed position where the motion read so far ends, radius mm.
    pub fn position(&self) -> Point {
        self.state.position.point()
    }

    /// The block read last, in the run that goes on.
    pub fn cursor(&self) -> Option<Source> {
        self.run().source
    }

    /// Why the move of a cycle taken last is where it is: its pass, level, depth
    /// and formula. `None` outside cycles. Worked out when asked.
    pub fn explanation(&self) -> Option<Explanation> {
        let run = self.run();
        if let (Some(finishing), Some(source)) = (&run.finishing, run.source) {
            return finishing.explanation(source);
        }
        let note = match &run.plan {
            Some(plan) => plan.note(),
            None => run.note,
        };
        note.and_then(Note::explanation)
    }

    /// How many subprogram calls are under way.
    pub fn depth(&self) -> usize {
        self.run().calls.len()
    }

    /// The block of the program coming in through the line that is read next; none
    /// while a place in it is kept.
    pub(crate) fn next_coming_in(&self) -> Option<u32> {
        let run = &self.main;
        let free = run.plan.is_none() && run.calls.is_empty() && run.finishing.is_none();
        (free && run.place.program == ProgramId::Dnc).then_some(run.place.block)
    }

    /// So many blocks in front of that one are gone.
    pub(crate) const fn blocks_gone(&mut self, count: u32) {
        self.main.place.block = self.main.place.block.saturating_sub(count);
    }

    /// Whether commands of the block read last are still to come.
    pub(crate) fn in_block(&self) -> bool {
        self.run().plan.is_some()
    }

    /// Starts a run over a program at the first block of a line or after it.
    /// The position comes from the host, the modal state stays.
    pub fn start(&mut self, program: ProgramId, line: u32, host: &impl Host) {
        let block = host
            .programs()
            .get(program)
            .map_or(0, |text| text.block_from_line(line));
        self.main = Run::from(Place { program, block });
        self.mdi = None;
        self.drop_compensation();
        self.jumps = Jumps::default();
        self.resync(host);
    }

    /// Starts a run over the block keyed in on the MDI page. After its end
    /// [`next`](Self::next) goes on with the automatic run, if one stands.
    pub(crate) fn start_mdi(&mut self, program: Program, host: &impl Host) {
        let run = Run::from(Place {
            program: ProgramId::Mdi,
            block: 0,
        });
        self.mdi = Some(Mdi { program, run });
        self.resync(host);
    }

    /// The run over the MDI block is over.
    pub(crate) fn leave_mdi(&mut self) {
        self.mdi = None;
    }

    /// Where the automatic run has been read to.
    pub(crate) const fn read_to(&self) -> ReadTo {
        ReadTo(self.state)
    }

    /// After MDI blocks the automatic run counts on from where it was read to. The
    /// modal codes that they left are in force, and so is a frame that they changed.
    pub(crate) fn stand_where_read(&mut self, read_to: &ReadTo, same_frame: bool) {
        let ReadTo(before) = read_to;
        if same_frame {
            self.state.zero = before.zero;
            self.state.offset = before.offset;
            self.state.untravelled = before.untravelled;
        }
        self.state.stand_at(before.machine(before.position));
        self.state.ahead = before.ahead;
        self.state.threading = before.threading;
    }

    /// Takes the position from the host again (after manual motion).
    pub fn resync(&mut self, host: &impl Host) {
        self.lay_aside();
        self.state
            .stand_at(Exact::from_point(host.machine_position()));
    }

    /// Puts another coordinate frame into force: at power-on, or after a
    /// manual reference return sets coordinates.
    pub(crate) fn set_frame(&mut self, frame: Frame, host: &impl Host) {
        self.state.zero = Exact::from_point(frame.zero);
        self.state.offset = Exact::from_point(frame.offset);
        self.resync(host);
    }

    /// Cancels the tool offset of an axis, as manual returns to the reference
    /// point and to the program zero do.
    pub(crate) fn cancel_offset(&mut self, axis: Axis, host: &impl Host) {
        self.state.offset.set(axis, 0);
        *self.state.untravelled.get_mut(axis) = false;
        if self.state.offset == Exact::default() {
            self.state.cancel_offset_number();
        }
        self.resync(host);
    }

    /// M codes that the machine's ladder carries out.
    pub(crate) const fn set_machine_codes(&mut self, codes: MachineCodes) {
        self.machine_codes = codes;
    }

    /// The tool number shown after a manual tool change.
    pub(crate) const fn set_tool(&mut self, tool: u8) {
        self.state.modal.tool = tool;
    }

    /// RESET, and the end of a program: runs are over, the stored words of
    /// cycles are cleared, modal codes stay, but G41 and G42 are cancelled and
    /// their vector is dropped. The offset stays by 004.3 TOC.
    pub fn reset(&mut self, host: &impl Host) {
        self.main = Run::over();
        self.mdi = None;
        self.drop_compensation();
        self.state.modal.nose_compensation = 40;
        self.state.cycle.clear();
        if !host.parameters().reset_keeps_offset() {
            self.state.offset = Exact::default();
            self.state.cancel_offset_number();
            self.state.untravelled = Default::default();
        }
        self.resync(host);
    }

    /// The next command. Reads at most a few blocks and makes at most one
    /// command, so that a tick is never held up.
    ///
    /// # Errors
    /// The alarm of the block being read. The block has had no effect then,
    /// and the next call reads it again.
    pub fn next(&mut self, host: &mut impl Host) -> Result<Step, Alarm> {
        Ok(match self.advance(host)? {
            Advance::Command(command) => Step::Command(Box::new(command)),
            Advance::Wait | Advance::Starved => Step::Wait,
            Advance::Ended => Step::Ended,
        })
    }

    /// The next command as it is programmed, without the compensation.
    pub(super) fn step<H: Host>(&mut self, host: &mut H) -> Result<Advance, Alarm> {
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
                Read::Skipped => self.run_mut().place.block += 1,
                Read::Wait => return Ok(Advance::Wait),
                Read::Starved => return Ok(Advance::Starved),
                Read::Ended => self.run_mut().ended = true,
            }
        }
        self.nothing_yet()
    }

    /// Many silent blocks in a row: the control gets a turn.
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
            // The last block of the profile ends square to itself.
            self.compensation.flush();
            let mut plan = Plan::after_profile(&finishing, &mut self.state);
            plan.whole = true;
            self.run_mut().finishing = None;
            self.note(plan.source);
            return Ok(self.planned(plan));
        }
        if place.block >= program.block_count() {
            if mdi.is_none() && host.programs().goes_on(place.program) {
                return Ok(Read::Starved);
            }
            return self.end_of_text(program.line_count(), host);
        }
        let syntax = Syntax {
            inch: self.state.modal.inch,
            ..Syntax::from(host.parameters())
        };
        let mut source = Source {
            program: place.program,
            line: program.block_line(place.block),
            sequence: run.sequence,
        };
        let skipping = host.block_skip() && mdi.is_none();
        let mut block = Block::default();
        if let Err(error) = program.read(place.block, syntax, &mut block) {
            source.sequence = program.sequence(place.block).or(source.sequence);
            if !(skipping && program.has_skip_mark(place.block)) {
                return Err(Alarm::from(error).at(source));
            }
            self.note(source);
            return Ok(Read::Skipped);
        }
        source.sequence = block.n.or(source.sequence);
        let skipped = skipping && block.skip;
        if skipped || (block.is_empty() && block.o.is_some()) {
            self.note(source);
            return Ok(Read::Skipped);
        }
        if block.has_g(65) {
            return self.operate(&block, source, place, host);
        }
        if block.has_variables() {
            block = match variable::resolve(block, syntax, host) {
                Ok(block) => block,
                Err(NotNow::Wait) => return Ok(Read::Wait),
                Err(NotNow::Fault(alarm)) => return Err(alarm.at(source)),
            };
        }
        if syntax.inch {
            inch::to_metric(&mut block, self.state.modal.motion);
        }
        let words = Words::of(&block).map_err(|alarm| alarm.at(source))?;
        if words.waits() && !host.settled() && !self.reads_early(&words) {
            return Ok(Read::Wait);
        }
        let reading = Reading {
            program,
            syntax,
            skipping,
            host: &*host,
        };
        let corner = corner::is_possible(&words, &self.state.modal);
        // How a corner or a thread ends depends on the block behind it, and not on
        // when that comes through the line.
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
        let context = Context {
            compensated: self.compensated(),
            machine_codes: self.machine_codes,
            next: next.as_ref(),
            ..context(&*host, source, place, &run.calls, mdi.is_some(), &read)
        };
        let mut state = self.state;
        let mut plan =
            block::evaluate(&mut state, &context, &words).map_err(|alarm| alarm.at(source))?;
        plan.writes
            .apply(host.parameters_mut())
            .map_err(|error| Alarm::from(error).at(source))?;
        self.stand_before(&state);
        self.state = state;
        self.note(source);
        Ok(self.planned(plan))
    }

    /// G65: acts while it is read; as a code of group 00 it clears the stored
    /// words of G90, G92 and G94 (manual I-3.2.5.3).
    fn operate<H: Host>(
        &mut self,
        block: &Block,
        source: Source,
        place: Place,
        host: &mut H,
    ) -> Result<Read, Alarm> {
        let outcome = match macro_block::evaluate(block, host) {
            Ok(outcome) => outcome,
            Err(NotNow::Wait) => return Ok(Read::Wait),
            Err(NotNow::Fault(alarm)) => return Err(alarm.at(source)),
        };
        let mut plan = Plan::new(source, self.state.modal);
        plan.after = Some(Action::Macro);
        plan.stops = host.parameters().macro_blocks_stop();
        match outcome {
            Outcome::Nothing => {}
            Outcome::Value(slot, value) => {
                slot.write(value, host).map_err(|alarm| alarm.at(source))?;
            }
            Outcome::Jump(p) => {
                let program = match &self.mdi {
                    Some(mdi) => &mdi.program,
                    None => host
                        .programs()
                        .get(place.program)
                        .ok_or_else(|| missing(place.program))?,
                };
                let target = match place.program {
                    ProgramId::Dnc => Err(Alarm::new(number::BAD_JUMP).because(say::jump_in_dnc())),
                    _ => self.jumps.target(program, place, p),
                };
                let block = target.map_err(|alarm| alarm.at(source))?;
                plan.flow = Flow::Jump(Place { block, ..place });
            }
        }
        self.state.cycle.clear_end();
        self.note(source);
        Ok(self.planned(plan))
    }

    /// The text is over without M30 or M99.
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
                ..context(host, source, run.place, &run.calls, false, &|_, _| Ok(None))
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
        });
        plan.flow = Flow::End;
        self.state.cycle.clear();
        Ok(self.planned(plan))
    }

    /// After M00, M30 and a G28 that seeks the reference point nothing is read
    /// before they are finished.
    fn planned(&mut self, mut plan: Plan) -> Read {
        let run = self.run_mut();
        plan.whole |= run.finishing.is_some();
        run.paused = plan.motion.ends_unknown()
            || matches!(plan.after, Some(Action::ProgramStop | Action::End { .. }));
        run.plan = Some(plan);
        Read::Planned
    }

    fn note(&mut self, source: Source) {
        let run = self.run_mut();
        run.source = Some(source);
        run.sequence = source.sequence;
    }

    fn run(&self) -> &Run {
        self.mdi.as_ref().map_or(&self.main, |mdi| &mdi.run)
    }

    fn run_mut(&mut self) -> &mut Run {
        match &mut self.mdi {
            Some(mdi) => &mut mdi.run,
            None => &mut self.main,
        }
    }
}

/// Whether a block cuts a thread that may go on in the next one.
fn is_thread(words: &Words, modal: &Modal) -> bool {
    let motion = words.motion.unwrap_or(modal.motion);
    matches!(motion, 32 | 34) && words.one_shot.is_none() && words.has_axis_words()
}

fn context<'a, H: Host>(
    host: &'a H,
    source: Source,
    place: Place,
    calls: &'a [Call],
    mdi: bool,
    read: &'a dyn Fn(u32, u8) -> Result<Option<Words>, Alarm>,
) -> Context<'a> {
    let parameters = host.parameters();
    Context {
        parameters,
        offsets: host.offsets(),
        programs: host.programs(),
        referenced: host.referenced(),
        calls,
        source,
        place,
        mdi,
        machine_codes: MachineCodes::default(),
        x_factor: if parameters.radius_programming() {
            2
        } else {
            1
        },
        compensated: Compensated::Never,
        read,
        next: None,
    }
}

fn missing(program: ProgramId) -> Alarm {
    Alarm::new(number::PROGRAM_MISSING).because(say::program_not_there(format_args!("{program:?}")))
}
