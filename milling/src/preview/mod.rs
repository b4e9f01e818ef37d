//! Runs a whole program without ticks, for `check` and `plot`.

mod further_alarms;

use gsk_core::alarm::{Alarm, number};
use gsk_core::command::{ProgramId, SourcePosition};
use gsk_core::compensation::cutter::CutterSide;
use gsk_core::interpreter::{PlainCall, T_VARIABLE, WalkedBlock, Walker};
use gsk_core::memory::{Counters, DayTime};
use gsk_core::model::{ControlModel, ModelId};
use gsk_core::preview::LONGEST_RUN_S;
use gsk_core::program::{Program, ProgramBlock, ProgramMemory, Syntax, WordNumber};
use gsk_messages::say;

pub use gsk_core::preview::{PreviewEnd, PreviewProgress};

use crate::axes::Axes;
use crate::block::{self, BlockFlow};
use crate::caution::{self, MillCaution};
use crate::memory::{MillMemory, parameter};
use crate::modal::{MillModal, MillMotion};
use crate::options::{MillWordError, parse_position};
use crate::path::bounds::{MillBounds, MillPathLengths};
use crate::path::cutter::CutterStream;
use crate::path::tracker::{MoveCallback, Tracker};
use crate::path::travel::{ProgressCallback, ProgressCheck, RunContext};
use crate::space::{Length, MillAxis, MillPosition};
use crate::state::MillState;
use crate::system::{MillVariables, VariableContext};
use crate::transform::Transform;
use crate::words::BlockWords;

/// Number of blocks between two progress callbacks.
const BLOCKS_PER_CALLBACK: u64 = 1024;
/// Greatest number of warnings that are listed.
const MAX_CAUTIONS: usize = 50;
/// Greatest number of repetitions of a subprogram call.
const MAX_RUNS: u16 = 9999;

/// The state of a mill at the start of a program: memory, position and settings.
#[derive(Clone, Debug, PartialEq)]
pub struct MillSetup {
    /// Parameters, tool offsets and work zeros of the mill.
    pub memory: MillMemory,
    /// Position of the axes at the start, machine coordinates.
    pub start: MillPosition,
    /// Whether blocks that begin with `/` are skipped.
    pub block_skip: bool,
    /// Date and time of the control's clock at the start of the program.
    pub day_time: DayTime,
}

impl Default for MillSetup {
    /// Returns a mill as delivered, with the tool 100 mm above machine zero.
    fn default() -> Self {
        let mut start = MillPosition::default();
        start.set(MillAxis::Z, Length::from_mm(100.0));
        Self {
            memory: MillMemory::default(),
            start,
            block_skip: false,
            day_time: DayTime::default(),
        }
    }
}

impl MillSetup {
    /// Replaces the parameters by those of `model`, which must be a mill.
    #[must_use]
    pub fn with(mut self, model: &ControlModel) -> Self {
        self.memory.model.clone_from(model);
        self
    }

    /// Parses the start position: machine coordinates `X,Y,Z` in mm, optionally followed by
    /// the fourth and fifth axis.
    ///
    /// # Errors
    ///
    /// Returns a message if the word has another form or a value is out of range.
    pub fn take_start(&mut self, word: &str) -> Result<(), MillWordError> {
        let start = parse_position(&self.memory, word);
        self.start = start.ok_or_else(|| MillWordError(say::mill_start_form(word)))?;
        Ok(())
    }
}

/// The result of the preview of a mill program.
#[derive(Clone, Debug, PartialEq)]
pub struct MillPreview {
    /// Whether the program ended, raised an alarm or was stopped.
    pub end: PreviewEnd,
    /// The alarm that ended the program; `None` without one.
    pub alarm: Option<Alarm>,
    /// Alarms after the first one that do not depend on the position of the tool.
    pub further: Vec<Alarm>,
    /// Warnings about the program, each kind once.
    pub cautions: Vec<MillCaution>,
    /// Machine time of motion and dwells, s. M, S and T take no time.
    pub time_s: f64,
    /// Part of the machine time spent cutting, s.
    pub cutting_s: f64,
    /// Number of executed blocks, each repetition counted.
    pub blocks: u64,
    /// Number of moves and dwells of the program.
    pub moves: u64,
    /// Number of program stops (M00).
    pub stops: u32,
    /// Number of finished parts.
    pub parts: u32,
    /// Numbers of the tools of the program, in the order of their first use.
    pub tools: Vec<u16>,
    /// The bounding box of the path; `None` without motion.
    pub bounds: Option<MillBounds>,
    /// Lengths of the path, by kind of move.
    pub lengths: MillPathLengths,
    /// Final position of the tool tip, work coordinates.
    pub work: MillPosition,
    /// Final position of the axes, machine coordinates.
    pub machine: MillPosition,
    /// The fourth and fifth axis of the machine, if it has them.
    pub axes: Axes,
    /// Modal codes and words at the end of the program.
    pub modal: MillModal,
}

/// Previews the selected program. `on_move` receives every move in order. `on_progress` is
/// called every 1024 blocks and before each repeated hole of a block. The run stops when it
/// returns false.
pub fn preview_while(
    setup: &MillSetup,
    programs: &ProgramMemory,
    on_move: &mut MoveCallback<'_>,
    on_progress: &mut dyn FnMut(&PreviewProgress) -> bool,
) -> MillPreview {
    let Some(program) = programs.selected() else {
        let alarm = Alarm::new(number::PROGRAM_MISSING).with_detail(say::program_not_selected());
        return Run::new(setup, programs, ProgramId::External, on_move)
            .result(PreviewEnd::Alarm, Some(alarm));
    };
    let mut run = Run::new(setup, programs, program, on_move);
    let (end, alarm) = match run.run_blocks(on_progress) {
        Ok(end) => match run.cutter.flush(&mut run.tracker) {
            Ok(()) => (end, None),
            Err(alarm) => (PreviewEnd::Alarm, Some(alarm)),
        },
        Err(alarm) => {
            // The blocks before the refused one are executed.
            let alarm = match run.cutter.flush(&mut run.tracker) {
                Ok(()) => alarm,
                Err(earlier) => earlier,
            };
            (PreviewEnd::Alarm, Some(alarm))
        }
    };
    let mut preview = run.result(end, alarm);
    if preview.end == PreviewEnd::Alarm {
        preview.further = run.find_further_alarms(preview.alarm.as_ref(), on_progress);
    }
    preview
}

/// The state of a program that is being previewed.
struct Run<'a> {
    programs: &'a ProgramMemory,
    main: ProgramId,
    walker: Walker,
    state: MillState,
    memory: MillMemory,
    variables: MillVariables,
    cutter: CutterStream,
    tracker: Tracker<'a>,
    block_skip: bool,
    blocks: u64,
    work: u64,
    motionless: u64,
    stops: u32,
    parts: u32,
    tools: Vec<u16>,
    cautions: Vec<MillCaution>,
}

impl<'a> Run<'a> {
    fn new(
        setup: &MillSetup,
        programs: &'a ProgramMemory,
        program: ProgramId,
        on_move: &'a mut MoveCallback<'_>,
    ) -> Self {
        let memory = setup.memory.clone();
        let axes = Axes::from_memory(&memory);
        let start = axes.wrapped(setup.start);
        let mut state = MillState {
            axes,
            machine: start,
            ..MillState::default()
        };
        state.modal.feed = memory.speed(parameter::FIRST_FEED);
        if memory.bit(parameter::MOTION, 4) {
            state.modal.motion = MillMotion::Line;
        }
        state.resync(&memory);
        Self {
            programs,
            main: program,
            walker: Walker::new(program, &memory.model),
            state,
            cutter: CutterStream::new(start, axes, axes.compensation(&memory)),
            tracker: Tracker::new(&memory, start, on_move),
            memory,
            variables: MillVariables::new(setup.day_time),
            block_skip: setup.block_skip,
            blocks: 0,
            work: 0,
            motionless: 0,
            stops: 0,
            parts: 0,
            tools: Vec::new(),
            cautions: Vec::new(),
        }
    }

    fn run_blocks(
        &mut self,
        on_progress: &mut dyn FnMut(&PreviewProgress) -> bool,
    ) -> Result<PreviewEnd, Alarm> {
        for count in 1_u64.. {
            if self.tracker.now >= LONGEST_RUN_S {
                break;
            }
            if count % BLOCKS_PER_CALLBACK == 0 && !on_progress(&self.progress()) {
                break;
            }
            let moves = self.tracker.moves;
            self.work = count;
            let block = match self.read()? {
                WalkedBlock::Words(block) => block,
                WalkedBlock::Nothing => {
                    self.motionless += 1;
                    continue;
                }
                WalkedBlock::Ended => return Ok(PreviewEnd::Text),
            };
            self.blocks += 1;
            let source = self.source();
            let end = self.execute_block(&block, on_progress);
            let end = end.map_err(|alarm| alarm.with_source(source))?;
            self.motionless = match self.tracker.moves > moves {
                true => 0,
                false => self.motionless + 1,
            };
            if let Some(end) = end {
                return Ok(end);
            }
        }
        Ok(PreviewEnd::Limit)
    }

    fn source(&self) -> SourcePosition {
        self.walker.source(self.programs)
    }

    fn progress(&self) -> PreviewProgress {
        PreviewProgress {
            line: self.source().line,
            blocks: self.blocks,
            moves: self.tracker.moves,
            work: self.work,
            motionless: self.motionless,
            time_s: self.tracker.now,
        }
    }

    /// Returns the next block, after executing the macro B statements before it.
    fn read(&mut self) -> Result<WalkedBlock, Alarm> {
        let syntax = Syntax {
            inch: self.state.modal.inch,
            fine: self.state.axes.have_fine_words(),
            macro_b: true,
            model: ModelId::Gsk980mdi,
            ..Syntax::default()
        };
        let program = self.programs.get(self.main).and_then(Program::number);
        let mut known = VariableContext {
            source: self.walker.source(self.programs),
            program: match self.walker.current_program() {
                ProgramId::Stored(number) => number,
                _ => program.unwrap_or(0),
            },
            now: self.tracker.now,
            machine: self.tracker.machine,
            state: &mut self.state,
            memory: &mut self.memory,
            variables: &mut self.variables,
        };
        let read = self
            .walker
            .next(self.programs, syntax, self.block_skip, &mut known);
        read.map_err(|alarm| alarm.with_source(self.source()))
    }

    fn execute_block(
        &mut self,
        block: &ProgramBlock,
        on_progress: &mut ProgressCallback<'_>,
    ) -> Result<Option<PreviewEnd>, Alarm> {
        let mut words = BlockWords::parse(block, self.memory.model.record(), self.state.axes)?;
        let called = self.take_call(&mut words)?;
        let source = self.source();
        let progress = self.progress();
        let mut context = RunContext {
            memory: &mut self.memory,
            cutter: &mut self.cutter,
            tracker: &mut self.tracker,
            source,
            exact: false,
            progress_check: ProgressCheck {
                on_progress,
                progress,
                is_stopped: false,
            },
        };
        let block_result = block::execute_block(&mut self.state, block, &words, &mut context)?;
        if context.progress_check.is_stopped {
            return Ok(Some(PreviewEnd::Limit));
        }
        self.store_cautions(block, &words, &block_result.flow, source);
        let tool = self.state.modal.tool;
        if tool > 0 && !self.tools.contains(&tool) {
            self.tools.push(tool);
        }
        let calls = !matches!(
            block_result.flow,
            BlockFlow::Next | BlockFlow::Stop | BlockFlow::End
        );
        if !block_result.moved && !calls && words.letters.m.is_some() {
            // An M code acts after the motion has stopped.
            self.tracker.stop();
        }
        if let Some(call) = called {
            return self.enter_called(&call, &block_result.flow).map(|()| None);
        }
        match block_result.flow {
            BlockFlow::Next if block_result.moved => self.walker.call_modal_macro(),
            BlockFlow::Stop => self.stops += 1,
            BlockFlow::End => {
                self.finish_part();
                self.walker.end();
                self.reset();
                return Ok(Some(match words.letters.m.map(WordNumber::integer) {
                    Some(2) => PreviewEnd::M02,
                    _ => PreviewEnd::M30,
                }));
            }
            flow => {
                if self.follow(flow, block)? {
                    self.finish_part();
                    return Ok(Some(PreviewEnd::M99));
                }
            }
        }
        Ok(None)
    }

    /// Makes the call or the return of a block. Returns whether the main program restarts.
    fn follow(&mut self, flow: BlockFlow, block: &ProgramBlock) -> Result<bool, Alarm> {
        match flow {
            BlockFlow::Next | BlockFlow::Stop | BlockFlow::End => {}
            BlockFlow::Call {
                program,
                runs,
                name,
            } => self.walker.call(self.programs, program, runs, &name)?,
            BlockFlow::Macro {
                program,
                runs,
                name,
            } => {
                let words = block::arguments(block);
                self.walker
                    .call_macro(self.programs, program, runs, &name, words)?;
            }
            BlockFlow::Back(p) => return self.walker.plan_return(self.programs, p),
        }
        Ok(false)
    }

    /// Returns the program that M or T of a block calls by 240 to 242 or 040.5, with its
    /// number of runs; `None` if neither calls one. Removes the word, which has no other
    /// effect.
    fn take_call(&mut self, words: &mut BlockWords) -> Result<Option<(PlainCall, u16)>, Alarm> {
        let letters = &mut words.letters;
        let [m, t] = [letters.m, letters.t].map(|it| it.map(WordNumber::integer));
        let Some(call) = self.walker.find_called_subprogram(m, t) else {
            return Ok(None);
        };
        if call.address == 'T' {
            letters.t = None;
            let t = call.code as f64;
            self.variables.set_common(T_VARIABLE.into(), t);
            return Ok(Some((call, 1)));
        }
        letters.m = None;
        let runs = letters.l.take().map_or(1, WordNumber::integer);
        match u16::try_from(runs) {
            Ok(runs @ 1..=MAX_RUNS) => Ok(Some((call, runs))),
            _ => {
                let detail = say::macro_runs_out_of_range(runs, MAX_RUNS);
                Err(Alarm::new(number::OUT_OF_RANGE).with_detail(detail))
            }
        }
    }

    /// Enters the called program. Errors: no other word of the block may change the flow.
    fn enter_called(
        &mut self,
        (call, runs): &(PlainCall, u16),
        rest: &BlockFlow,
    ) -> Result<(), Alarm> {
        if *rest != BlockFlow::Next {
            let detail = say::call_twice_in_block(call.address, call.code);
            return Err(Alarm::new(number::TOO_MANY_WORDS).with_detail(detail));
        }
        self.walker.call_by_code(self.programs, call, *runs)
    }

    /// Stores the warnings of a block, each once.
    fn store_cautions(
        &mut self,
        block: &ProgramBlock,
        words: &BlockWords,
        flow: &BlockFlow,
        source: SourcePosition,
    ) {
        if matches!(flow, BlockFlow::Macro { .. }) {
            return;
        }
        for slip in caution::find_slips(block, words, &self.state, &self.memory) {
            let known = self.cautions.iter().any(|it| it.slip == slip);
            if !known && self.cautions.len() < MAX_CAUTIONS {
                self.cautions.push(MillCaution { slip, source });
            }
        }
    }

    fn finish_part(&mut self) {
        self.parts += 1;
        self.variables.parts = (self.variables.parts + 1) % Counters::PART_COUNT_LIMIT;
    }

    /// Resets at M30 the states that a reset cancels.
    fn reset(&mut self) {
        self.state.modal.hole = None;
        self.state.modal.cutter = CutterSide::On;
        self.state.transform = Transform::default();
        self.state.polar = None;
        if self.memory.bit(parameter::LOCAL, 1) {
            self.state.local = MillPosition::default();
        }
    }

    fn result(&mut self, end: PreviewEnd, alarm: Option<Alarm>) -> MillPreview {
        self.tracker.stop();
        let frame = self.state.frame(&self.memory);
        MillPreview {
            end,
            alarm,
            further: Vec::new(),
            cautions: core::mem::take(&mut self.cautions),
            time_s: self.tracker.now,
            cutting_s: self.tracker.cutting_s,
            blocks: self.blocks,
            moves: self.tracker.moves,
            stops: self.stops,
            parts: self.parts,
            tools: self.tools.clone(),
            bounds: self.tracker.bounds,
            lengths: self.tracker.lengths,
            work: self.state.axes.wrapped(self.tracker.machine - frame),
            axes: self.state.axes,
            machine: self.tracker.machine,
            modal: self.state.modal,
        }
    }
}
