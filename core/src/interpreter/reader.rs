//! The interpreter itself: reads blocks as far as it may and hands out their
//! commands one at a time.

use serde::{Deserialize, Serialize};

use crate::alarm::Alarm;
use crate::command::{Action, Command, Frame, ProgramId, Source};
use crate::interpreter::block::{self, Context};
use crate::interpreter::exact::Exact;
use crate::interpreter::host::{Host, Step};
use crate::interpreter::plan::Plan;
use crate::interpreter::run::Run;
use crate::interpreter::state::State;
use crate::interpreter::subprogram::{self, Flow, Place};
use crate::interpreter::words::Words;
use crate::interpreter::{Modal, numbers};
use crate::memory::Parameters;
use crate::program::{Program, Syntax};
use crate::units::{Axis, Point};

/// Blocks without any command that one call goes through.
const SILENT_BLOCKS: u32 = 16;

/// Blocks to commands. Plain data: it can be saved and restored at any time.
///
/// A *run* begins with [`start`](Self::start); [`next`](Self::next) then gives
/// one command a call until [`Step::Ended`]. A block keyed in on the MDI page
/// is a run of its own ([`start_mdi`](Self::start_mdi)) that leaves a stopped
/// automatic run where it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Interpreter {
    state: State,
    main: Run,
    mdi: Option<Mdi>,
}

/// The run over the MDI block.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Mdi {
    program: Program,
    run: Run,
}

/// What reading one block led to.
enum Read {
    /// Its plan stands in the run.
    Planned,
    /// It must not be read yet.
    Wait,
    /// There is nothing in it.
    Skipped,
    /// The text is over.
    Ended,
}

/// One answer of [`Interpreter::advance`], the command in place.
pub(crate) enum Advance {
    Command(Command),
    Wait,
    Ended,
}

impl Interpreter {
    /// The interpreter at power-on, without a run.
    pub fn new(parameters: &Parameters) -> Self {
        let modal = Modal {
            tool: u8::try_from(parameters.value(75)).unwrap_or(0),
            ..Modal::default()
        };
        Self {
            state: State::new(modal),
            main: Run::over(),
            mdi: None,
        }
    }

    /// The modal state after the block read last.
    pub const fn modal(&self) -> &Modal {
        &self.state.modal
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

    /// How many subprogram calls are under way.
    pub fn depth(&self) -> usize {
        self.run().calls.len()
    }

    /// Whether commands of the block read last are still to come.
    pub fn in_block(&self) -> bool {
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
        self.resync(host);
    }

    /// Starts a run over the block keyed in on the MDI page. After its end
    /// [`next`](Self::next) goes on with the automatic run, if one stands.
    pub fn start_mdi(&mut self, program: Program, host: &impl Host) {
        let run = Run::from(Place {
            program: ProgramId::Mdi,
            block: 0,
        });
        self.mdi = Some(Mdi { program, run });
        self.resync(host);
    }

    /// Takes the position from the host again (after manual motion).
    pub fn resync(&mut self, host: &impl Host) {
        self.state
            .stand_at(Exact::from_point(host.machine_position()));
    }

    /// Puts another coordinate frame into force: at power-on, or after a
    /// manual reference return sets coordinates.
    pub fn set_frame(&mut self, frame: Frame, host: &impl Host) {
        self.state.zero = Exact::from_point(frame.zero);
        self.state.offset = Exact::from_point(frame.offset);
        self.resync(host);
    }

    /// Cancels the tool offset of an axis, as manual returns to the reference
    /// point and to the program zero do.
    pub fn cancel_offset(&mut self, axis: Axis, host: &impl Host) {
        self.state.offset.set(axis, 0);
        *self.state.untravelled.get_mut(axis) = false;
        if self.state.offset == Exact::default() {
            self.state.modal.offset = 0;
        }
        self.resync(host);
    }

    /// The tool number shown after a manual tool change.
    pub const fn set_tool(&mut self, tool: u8) {
        self.state.modal.tool = tool;
    }

    /// RESET, and the end of a program: runs are over, the stored words of
    /// cycles are cleared, modal codes stay. The offset stays by 004.3 TOC.
    pub fn reset(&mut self, host: &impl Host) {
        self.main = Run::over();
        self.mdi = None;
        self.state.cycle.clear();
        if !host.parameters().reset_keeps_offset() {
            self.state.offset = Exact::default();
            self.state.modal.offset = 0;
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
            Advance::Wait => Step::Wait,
            Advance::Ended => Step::Ended,
        })
    }

    /// [`next`](Self::next) without a heap allocation for the command.
    pub(crate) fn advance<H: Host>(&mut self, host: &mut H) -> Result<Advance, Alarm> {
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
        }))
    }

    fn read<H: Host>(&mut self, host: &H) -> Result<Read, Alarm> {
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
        if place.block >= program.block_count() {
            return self.end_of_text(program.line_count(), host);
        }
        let syntax = Syntax::from(host.parameters());
        let mut source = Source {
            program: place.program,
            line: program.block_line(place.block),
            sequence: run.sequence,
        };
        let block = program
            .parse(place.block, syntax)
            .map_err(|error| Alarm::from(error).at(source))?;
        source.sequence = block.n.or(source.sequence);
        let skipped = block.skip && host.block_skip() && mdi.is_none();
        if skipped || (block.is_empty() && block.o.is_some()) {
            self.note(source);
            return Ok(Read::Skipped);
        }
        let words = Words::of(&block).map_err(|alarm| alarm.at(source))?;
        if words.waits() && !host.settled() {
            return Ok(Read::Wait);
        }
        let context = context(host, source, place, &run.calls, mdi.is_some());
        let mut state = self.state;
        let plan =
            block::evaluate(&mut state, &context, &words).map_err(|alarm| alarm.at(source))?;
        self.state = state;
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
            let context = context(host, source, run.place, &run.calls, false);
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

    /// After M00 and M30 nothing is read before they are finished.
    fn planned(&mut self, plan: Plan) -> Read {
        let run = self.run_mut();
        run.paused = matches!(plan.after, Some(Action::ProgramStop | Action::End { .. }));
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

fn context<'a, H: Host>(
    host: &'a H,
    source: Source,
    place: Place,
    calls: &'a [subprogram::Call],
    mdi: bool,
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
        x_factor: if parameters.radius_programming() {
            2
        } else {
            1
        },
    }
}

fn missing(program: ProgramId) -> Alarm {
    Alarm::new(numbers::PROGRAM_MISSING).because(format!("{program:?} is not there"))
}
