//! Interprets a whole program without ticks, for `check` and the plotted path. Moves go to a
//! callback; the memory needed does not grow with the program.

mod bounds;
mod caution;
mod certainty;
mod clock;
mod execute;
mod further_alarms;
mod ladder_messages;
mod line_words;
mod lint;
mod moves;
mod result;
mod spindle;
mod start_position;
#[cfg(test)]
mod tests;
mod thread;
mod thread_check;
mod unreachable;
mod work_budget;

use core::cell::LazyCell;

use crate::alarm::{Alarm, number};
use crate::command::{Action, ExecutedMove, Frame, SourcePosition};
use crate::interpreter::AdvanceResult;
use crate::interpreter::Explanation;
use crate::interpreter::ImmediateHost;
use crate::interpreter::Interpreter;
use crate::interpreter::MachineCodes;
use crate::interpreter::ModalState;
use crate::memory::{ControlParameters, OFFSET_ROWS, Offsets, Registers};
use crate::motion::{CutChain, MotionLimits};
use crate::program::ProgramMemory;
use crate::setup::Setup;
use crate::simulation::Simulation;
use crate::units::{PerAxis, Point, round};

pub use bounds::PathBounds;
pub use caution::{Caution, CautionKind};
use clock::PreviewClock;
use further_alarms::{AlarmSearch, AlarmStage};
pub use further_alarms::{FurtherAlarms, MAX_FURTHER_ALARMS};
use gsk_messages::say;
use ladder_messages::LadderMessages;
pub use lint::Lint;
use moves::ReportedEnd;
pub use result::{PathLengths, Preview, PreviewEnd, PreviewProgress};
use spindle::PreviewSpindle;
pub use spindle::SpindleRotation;
use start_position::StartPositionCheck;
use thread_check::ThreadPass;
pub use work_budget::WorkBudget;

/// Number of consecutive commands without motion after which [`preview`] stops.
const MOTIONLESS_BLOCKS: u64 = 1_500_000;

/// Number of commands between two calls of `should_continue`.
const COMMANDS_PER_PROGRESS: u32 = 4096;

/// Simulated machine time after which a preview stops, s: 1000 hours.
pub const LONGEST_RUN_S: f64 = 3.6e6;

/// Interprets the selected program from its first line to its end, or until 1.5 million
/// consecutive commands have moved nothing. `on_move` receives all moves in order.
pub fn preview(
    setup: &Setup,
    programs: &ProgramMemory,
    on_move: &mut dyn FnMut(&ExecutedMove),
) -> Preview {
    preview_with_progress(setup, programs, on_move, &mut |progress| {
        progress.motionless < MOTIONLESS_BLOCKS
    })
}

/// Interprets the selected program like [`preview`]. Calls `should_continue` every few
/// thousand commands; when it returns `false`, the preview ends with [`PreviewEnd::Limit`].
pub fn preview_with_progress(
    setup: &Setup,
    programs: &ProgramMemory,
    on_move: &mut dyn FnMut(&ExecutedMove),
    should_continue: &mut dyn FnMut(&PreviewProgress) -> bool,
) -> Preview {
    let options = PreviewOptions::default();
    interpret(
        setup,
        programs,
        &mut |it, _| on_move(it),
        should_continue,
        options,
    )
}

/// Works like [`preview_with_progress`], but `on_move` also receives the explanation of each
/// move of a cycle; `None` for other moves.
pub fn preview_explained(
    setup: &Setup,
    programs: &ProgramMemory,
    on_move: &mut dyn FnMut(&ExecutedMove, Option<&Explanation>),
    should_continue: &mut dyn FnMut(&PreviewProgress) -> bool,
) -> Preview {
    let options = PreviewOptions {
        explanations: true,
        ..PreviewOptions::default()
    };
    interpret(setup, programs, on_move, should_continue, options)
}

/// Works like [`preview_with_progress`], but continues after an alarm and collects the
/// following ones in [`Preview::further`].
pub fn preview_beyond_alarms(
    setup: &Setup,
    programs: &ProgramMemory,
    on_move: &mut dyn FnMut(&ExecutedMove),
    should_continue: &mut dyn FnMut(&PreviewProgress) -> bool,
) -> Preview {
    let options = PreviewOptions {
        beyond_alarms: true,
        ..PreviewOptions::default()
    };
    interpret(
        setup,
        programs,
        &mut |it, _| on_move(it),
        should_continue,
        options,
    )
}

/// Optional outputs of a preview that cost computing time.
#[derive(Clone, Copy, Default)]
struct PreviewOptions {
    /// Whether the preview continues after an alarm.
    beyond_alarms: bool,
    /// Whether `on_move` receives explanations of the moves of cycles.
    explanations: bool,
}

fn interpret(
    setup: &Setup,
    programs: &ProgramMemory,
    on_move: &mut OnMove<'_>,
    should_continue: &mut dyn FnMut(&PreviewProgress) -> bool,
    options: PreviewOptions,
) -> Preview {
    let frame = frame_at_start(setup);
    let mut host = ImmediateHost {
        parameters: setup.memory.parameters.clone(),
        offsets: setup.memory.offsets.clone(),
        registers: Registers::new(setup.day_time),
        counters: setup.memory.counters,
        settings: setup.memory.settings,
        now_s: 0.0,
        variables: setup.memory.variables.clone(),
        inputs: LazyCell::new(Box::new(|| idle_inputs(setup))),
        outputs: 0,
        programs,
        machine_position: setup.start.unwrap_or_default(),
        // The machine coordinates determine where the work is drawn, whether the real
        // reference point is known or not.
        referenced: PerAxis::new(true, true),
        block_skip: false,
    };
    let mut interpreter = Interpreter::new(&host.parameters);
    interpreter.set_inch_input(setup.memory.settings.inch);
    interpreter.set_macro_b(setup.memory.settings.macro_b);
    interpreter.set_model(&setup.memory.model);
    interpreter.set_tool(setup.tool_in_position());
    interpreter.set_machine_codes(MachineCodes::from_declared(setup.ladder.m_codes()));
    interpreter.set_frame(frame, &host);
    interpreter.start_word_audit();
    let mut preview_run = PreviewRun::new(setup, programs, *interpreter.modal(), on_move);
    preview_run.has_explanations = options.explanations;
    let first_alarm = match programs.selected() {
        Some(program) => {
            interpreter.start(program, 1, &host);
            preview_run.check_text(program);
            preview_run.run(&mut interpreter, &mut host, should_continue)
        }
        None => {
            let alarm =
                Alarm::new(number::PROGRAM_MISSING).with_detail(say::program_not_selected());
            Some((alarm, AlarmStage::Reading))
        }
    };
    preview_run.report_return(None);
    if let Some((alarm, _)) = &first_alarm {
        preview_run.fail(alarm.clone());
    }
    preview_run.check_end_position();
    if let Some(program) = programs.selected() {
        preview_run.check_reach(program);
    }
    let mut preview = preview_run.finish(&host.parameters);
    preview.modal = *interpreter.modal();
    if matches!(
        preview.end,
        PreviewEnd::M30 | PreviewEnd::M02 | PreviewEnd::Text
    ) {
        // The end of a program resets the control.
        preview.modal.nose_compensation = 40;
    }
    if let (Some(met), true) = (first_alarm, options.beyond_alarms) {
        preview.further =
            preview_run.search_further_alarms(met, &mut interpreter, &mut host, should_continue);
        preview.cautions = preview_run.preview.cautions;
    }
    let record = setup.memory.model.record();
    preview.alarm = preview.alarm.map(|alarm| alarm.with_model(record));
    for alarm in &mut preview.further.alarms {
        *alarm = alarm.clone().with_model(record);
    }
    preview
}

/// The frame before the first block: its work zero follows from the start position.
fn frame_at_start(setup: &Setup) -> Frame {
    let start = setup.start.unwrap_or_default();
    Frame {
        zero: setup
            .absolute
            .map_or_else(Point::default, |absolute| start - absolute),
        ..Frame::default()
    }
}

/// The inputs of macros (#1000 to #1015, one bit each) that the ladder sets on an idle lathe.
fn idle_inputs(setup: &Setup) -> u16 {
    const SETTLED_TICKS: u32 = 500;
    let mut simulation = Simulation::new(setup.clone());
    for _ in 0..SETTLED_TICKS {
        simulation.tick();
    }
    let memory = simulation.cnc.plc().memory();
    u16::from_le_bytes([memory.g(54), memory.g(55)])
}

/// Callback for the moves, each with its explanation (`None` without one).
type OnMove<'a> = dyn FnMut(&ExecutedMove, Option<&Explanation>) + 'a;

/// State of the preview while it executes commands.
struct PreviewRun<'a> {
    limits: MotionLimits,
    clock: PreviewClock,
    spindle: PreviewSpindle,
    messages: LadderMessages,
    relative_zero: Point,
    motionless: u64,
    /// Position of the block of the last executed command; `None` before the first one.
    source: Option<SourcePosition>,
    /// Whether the program has reached its end.
    ended: bool,
    programs: &'a ProgramMemory,
    /// Tool offsets before the program.
    offsets: Offsets,
    /// Whether one of them has a nose radius.
    has_nose_radii: bool,
    /// The last pass of a thread; `None` before the first one of the tool.
    last_pass: Option<ThreadPass>,
    position_check: StartPositionCheck,
    /// The search for further alarms; `None` before the first alarm.
    alarm_search: Option<AlarmSearch>,
    /// Deceleration time at the end of the last thread, s, not yet added to the clock.
    owed_deceleration_s: f64,
    /// Cuts that blend into each other (007.3 = 0), and the last of them, whose duration
    /// depends on the next command.
    sequel: CutChain,
    pending_cut: Option<(ExecutedMove, Option<Explanation>)>,
    /// A rapid that may lead to a machine zero, which the next command decides; `None` without one.
    pending_return: Option<(ExecutedMove, Option<Explanation>)>,
    last_reported: Option<ReportedEnd>,
    /// Time that the spindle needs to reach a new speed, s.
    spindle_settle_s: f64,
    preview: Preview,
    on_move: &'a mut OnMove<'a>,
    /// Whether moves are explained, and the explanation of the current command, if any.
    has_explanations: bool,
    explanation: Option<Explanation>,
}

impl<'a> PreviewRun<'a> {
    fn new(
        setup: &Setup,
        programs: &'a ProgramMemory,
        modal: ModalState,
        on_move: &'a mut OnMove<'a>,
    ) -> Self {
        let start = setup.start.unwrap_or_default();
        Self {
            limits: MotionLimits::from_model(&setup.memory.parameters, &setup.memory.model),
            clock: PreviewClock::new(setup),
            spindle: PreviewSpindle::new(setup),
            messages: LadderMessages::new(setup),
            relative_zero: Point::default(),
            motionless: 0,
            source: None,
            ended: false,
            programs,
            offsets: setup.memory.offsets.clone(),
            has_nose_radii: (1..OFFSET_ROWS as u8).any(|it| setup.memory.offsets.get(it).r > 0.0),
            last_pass: None,
            position_check: StartPositionCheck::new(setup),
            alarm_search: None,
            owed_deceleration_s: 0.0,
            sequel: CutChain::default(),
            pending_cut: None,
            pending_return: None,
            last_reported: None,
            spindle_settle_s: f64::from(setup.lathe.spindle.settle_ms) / 1000.0,
            preview: Preview {
                end: PreviewEnd::Limit,
                alarm: None,
                further: FurtherAlarms::default(),
                time_s: 0.0,
                cutting_s: 0.0,
                blocks: 0,
                moves: 0,
                stops: 0,
                parts: 0,
                programs: Vec::new(),
                tools: Vec::new(),
                cautions: Vec::new(),
                bounds: None,
                lengths: PathLengths::default(),
                absolute: start,
                machine: start,
                relative: start,
                frame: frame_at_start(setup),
                modal,
                spindle: SpindleRotation::Stopped,
                coolant: false,
                parameters: setup.memory.parameters.clone(),
            },
            on_move,
            has_explanations: false,
            explanation: None,
        }
    }

    /// Executes commands until the program ends or `should_continue` returns `false` (`None`),
    /// or until an alarm, which is returned.
    fn run(
        &mut self,
        interpreter: &mut Interpreter,
        host: &mut ImmediateHost<'_>,
        should_continue: &mut dyn FnMut(&PreviewProgress) -> bool,
    ) -> Option<(Alarm, AlarmStage)> {
        let mut commands_left = COMMANDS_PER_PROGRESS;
        let mut next = None;
        while self.clock.now() < LONGEST_RUN_S {
            commands_left -= 1;
            if commands_left == 0 {
                commands_left = COMMANDS_PER_PROGRESS;
                if !should_continue(&self.progress(interpreter)) {
                    return None;
                }
            }
            let advance = interpreter.advance(host, &mut next);
            if interpreter.has_remarks() {
                self.take_remarks(interpreter);
            }
            match advance {
                Ok(AdvanceResult::Command) => {
                    let command = next.as_ref()?;
                    if self.has_explanations {
                        self.explanation = interpreter.explain();
                    }
                    match self.execute_command(command) {
                        Ok(None) => {
                            host.now_s = self.clock.now();
                            if matches!(command.action, Action::Repeat) {
                                host.counters.count_part();
                            }
                        }
                        Ok(Some(end)) => {
                            self.preview.end = end;
                            self.ended = true;
                            return None;
                        }
                        Err(alarm) => {
                            return Some((
                                alarm.with_source(command.source),
                                AlarmStage::Executing,
                            ));
                        }
                    }
                }
                Ok(AdvanceResult::Wait | AdvanceResult::Starved | AdvanceResult::Ended) => {
                    return None;
                }
                Err(alarm) => return Some((alarm, AlarmStage::Reading)),
            }
        }
        None
    }

    fn progress(&self, interpreter: &Interpreter) -> PreviewProgress {
        PreviewProgress {
            line: self.source.map_or(0, |source| source.line),
            blocks: self.preview.blocks,
            moves: self.preview.moves,
            work: interpreter.work_units(),
            motionless: self.motionless,
            time_s: self.clock.now(),
        }
    }

    fn fail(&mut self, alarm: Alarm) {
        self.preview.end = PreviewEnd::Alarm;
        self.preview.alarm = Some(alarm);
    }

    /// Ends the pending cut and returns the result of all commands executed so far.
    fn finish(&mut self, parameters: &ControlParameters) -> Preview {
        self.report_pending_cut(false);
        self.preview.time_s = self.clock.now() + self.owed_deceleration_s;
        self.preview.spindle = self.spindle.rotation();
        let mut preview = self.preview.clone();
        preview.parameters = parameters.clone();
        preview.absolute = remove_noise(preview.frame.to_program(preview.machine));
        let offset = match preview.parameters.is_relative_programmed() {
            true => Point::default(),
            false => preview.frame.offset,
        };
        preview.relative = remove_noise(preview.absolute + offset - self.relative_zero);
        preview
    }
}

/// Rounds a point to 1e-9 mm, which removes the errors in the last bits after a change of
/// frame. End points are multiples of 0.0005 mm.
fn remove_noise(point: Point) -> Point {
    const FINE: f64 = 1e9;
    Point::new(round(point.x * FINE) / FINE, round(point.z * FINE) / FINE)
}
