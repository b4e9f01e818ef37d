//! Interprets a whole program without ticks, for `check` and the plotted path. Moves go to a
//! callback; the memory needed does not grow with the program.

mod bounds;
mod carry_out;
mod caution;
mod clock;
mod facts;
mod further;
mod messages;
mod preset;
mod spindle;
#[cfg(test)]
mod tests;
mod thread;
mod travel;
mod work_budget;
mod written;

use core::cell::LazyCell;

use crate::alarm::{Alarm, number};
use crate::command::{Action, ExecutedMove, Frame, Source};
use crate::interpreter::Advance;
use crate::interpreter::Explanation;
use crate::interpreter::Immediate;
use crate::interpreter::Interpreter;
use crate::interpreter::MachineCodes;
use crate::interpreter::Modal;
use crate::memory::{Parameters, Registers};
use crate::motion::{MotionLimits, Sequel};
use crate::program::ProgramMemory;
use crate::setup::Setup;
use crate::simulation::Simulation;
use crate::units::{PerAxis, Point, round};

pub use bounds::Bounds;
pub use caution::{Caution, Slip};
use clock::Clock;
use further::{Behind, Raised};
pub use further::{Further, MOST_FURTHER};
use gsk_messages::say;
use messages::Messages;
use preset::SetPlace;
use spindle::Spindle;
pub use spindle::Turning;
use travel::Shown;
pub use work_budget::WorkBudget;

/// Blocks without motion after which [`preview`] stops.
const MOTIONLESS_BLOCKS: u64 = 1_500_000;

/// Number of commands between two calls of the progress callback.
const COMMANDS_A_LOOK: u32 = 4096;

/// Machine time after which a preview stops, s: 1000 hours.
const LONGEST_S: f64 = 3.6e6;

/// The way in which a preview ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// At M30.
    M30,
    /// At M02, on models that have it.
    M02,
    /// At M99 of the main program.
    M99,
    /// At the end of the text without M30 or M99.
    Text,
    /// At an alarm.
    Alarm,
    /// At 1000 hours of machine time without an end, or when the caller cancelled.
    Limit,
}

/// Lengths of the path by kind of move, mm; a rapid counts as its chord.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lengths {
    /// Length of all rapids, mm.
    pub rapid: f64,
    /// Length of all straight cuts, mm.
    pub feed: f64,
    /// Length of all clockwise arcs, mm.
    pub clockwise: f64,
    /// Length of all counter-clockwise arcs, mm.
    pub counter_clockwise: f64,
    /// Length of all threads with their run-outs, and of all taps, mm.
    pub thread: f64,
}

/// The result of a preview. X of points is a radius, mm.
#[derive(Clone, Debug, PartialEq)]
pub struct Preview {
    /// How the program ended.
    pub end: End,
    /// The alarm that ended the program.
    pub alarm: Option<Alarm>,
    /// Further errors after that alarm. All other fields describe the run up to it.
    pub further: Further,
    /// Estimated machine time, s: motion, M, S, T and dwell.
    pub time_s: f64,
    /// Part of [`Self::time_s`] spent in cutting moves, s.
    pub cutting_s: f64,
    /// Number of executed blocks.
    pub blocks: u64,
    /// Number of moves and dwells, without those of zero length.
    pub moves: u64,
    /// Number of executed M00.
    pub stops: u32,
    /// Number of finished parts.
    pub parts: u32,
    /// Tools that were called, with their offset numbers, in order; each pair once.
    pub tools: Vec<(u8, u8)>,
    /// Bounding box of the path in work coordinates; `None` without motion.
    pub bounds: Option<Bounds>,
    /// Probable mistakes that raise no alarm. Most kinds are listed at their first
    /// occurrence only.
    pub cautions: Vec<Caution>,
    /// Path lengths by kind of move.
    pub lengths: Lengths,
    /// Absolute position at the end, mm.
    pub absolute: Point,
    /// Machine position at the end, mm.
    pub machine: Point,
    /// Relative position at the end, mm.
    pub relative: Point,
    /// Coordinate frame at the end.
    pub frame: Frame,
    /// Modal state at the end.
    pub modal: Modal,
    /// Direction of the spindle at the end.
    pub spindle: Turning,
    /// Whether coolant is on at the end.
    pub coolant: bool,
    /// Parameters at the end; cycles may have written some of them.
    pub parameters: Parameters,
}

/// Progress of a running preview.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Progress {
    /// Line of the current block, from 1.
    pub line: u32,
    /// Number of executed blocks.
    pub blocks: u64,
    /// Number of moves.
    pub moves: u64,
    /// Number of blocks read, repeated for loops and subprograms, plus one for each 64 bytes
    /// of their text.
    pub work: u64,
    /// Number of commands since the last move.
    pub motionless: u64,
    /// Machine time, s.
    pub time_s: f64,
}

/// Interprets the selected program from its first line to its end, at most 1.5 million
/// blocks without motion. `on_move` receives all moves in order.
pub fn preview(
    setup: &Setup,
    programs: &ProgramMemory,
    on_move: &mut dyn FnMut(&ExecutedMove),
) -> Preview {
    preview_while(setup, programs, on_move, &mut |progress| {
        progress.motionless < MOTIONLESS_BLOCKS
    })
}

/// Like [`preview`], while `go_on` returns true: it is called every few thousand commands.
/// When it returns false, the preview ends with [`End::Limit`].
pub fn preview_while(
    setup: &Setup,
    programs: &ProgramMemory,
    on_move: &mut dyn FnMut(&ExecutedMove),
    go_on: &mut dyn FnMut(&Progress) -> bool,
) -> Preview {
    let wanted = Wanted::default();
    interpret(setup, programs, &mut |it, _| on_move(it), go_on, wanted)
}

/// Like [`preview_while`]; `on_move` also receives the explanation of a move of a cycle.
pub fn preview_explained(
    setup: &Setup,
    programs: &ProgramMemory,
    on_move: &mut dyn FnMut(&ExecutedMove, Option<&Explanation>),
    go_on: &mut dyn FnMut(&Progress) -> bool,
) -> Preview {
    let wanted = Wanted {
        explanations: true,
        ..Wanted::default()
    };
    interpret(setup, programs, on_move, go_on, wanted)
}

/// Like [`preview_while`]; after an alarm it continues and collects [`Further`] ones.
pub fn preview_beyond_alarms(
    setup: &Setup,
    programs: &ProgramMemory,
    on_move: &mut dyn FnMut(&ExecutedMove),
    go_on: &mut dyn FnMut(&Progress) -> bool,
) -> Preview {
    let wanted = Wanted {
        beyond_alarms: true,
        ..Wanted::default()
    };
    interpret(setup, programs, &mut |it, _| on_move(it), go_on, wanted)
}

/// Optional outputs that cost time.
#[derive(Clone, Copy, Default)]
struct Wanted {
    /// Continue after an alarm.
    beyond_alarms: bool,
    /// Explain the position of moves of cycles.
    explanations: bool,
}

fn interpret(
    setup: &Setup,
    programs: &ProgramMemory,
    on_move: &mut OnMove<'_>,
    go_on: &mut dyn FnMut(&Progress) -> bool,
    wanted: Wanted,
) -> Preview {
    let frame = frame_at_start(setup);
    let mut host = Immediate {
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
        position: setup.start.unwrap_or_default(),
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
    interpreter.set_machine_codes(MachineCodes::of(setup.ladder.m_codes()));
    interpreter.set_frame(frame, &host);
    interpreter.audit_words();
    let mut walk = Walk::new(setup, programs, *interpreter.modal(), on_move);
    walk.explains = wanted.explanations;
    let met = match programs.current() {
        Some(program) => {
            interpreter.start(program, 1, &host);
            walk.look_at_text(program);
            walk.run(&mut interpreter, &mut host, go_on)
        }
        None => {
            let alarm = Alarm::new(number::PROGRAM_MISSING).because(say::program_not_selected());
            Some((alarm, Raised::Reading))
        }
    };
    walk.show_return(None);
    if let Some((alarm, _)) = &met {
        walk.fail(alarm.clone());
    }
    walk.look_at_end();
    let mut preview = walk.result(&host.parameters);
    preview.modal = *interpreter.modal();
    if matches!(preview.end, End::M30 | End::M02 | End::Text) {
        // The end of a program resets the control.
        preview.modal.nose_compensation = 40;
    }
    if let (Some(met), true) = (met, wanted.beyond_alarms) {
        preview.further = walk.look_on(met, &mut interpreter, &mut host, go_on);
        preview.cautions = walk.so_far.cautions;
    }
    let record = setup.memory.model.record();
    preview.alarm = preview.alarm.map(|alarm| alarm.of_model(record));
    for alarm in &mut preview.further.alarms {
        *alarm = alarm.clone().of_model(record);
    }
    preview
}

/// The work zero before the first block.
fn frame_at_start(setup: &Setup) -> Frame {
    let start = setup.start.unwrap_or_default();
    Frame {
        zero: setup
            .absolute
            .map_or_else(Point::default, |absolute| start - absolute),
        ..Frame::default()
    }
}

/// The ladder's inputs to macros while the lathe is idle.
fn idle_inputs(setup: &Setup) -> u16 {
    const SETTLED_TICKS: u32 = 500;
    let mut simulation = Simulation::new(setup.clone());
    for _ in 0..SETTLED_TICKS {
        simulation.tick();
    }
    let memory = simulation.cnc.plc().memory();
    u16::from_le_bytes([memory.g(54), memory.g(55)])
}

/// Callback for the moves, each with its explanation.
type OnMove<'a> = dyn FnMut(&ExecutedMove, Option<&Explanation>) + 'a;

/// State of the preview while it executes commands.
struct Walk<'a> {
    limits: MotionLimits,
    clock: Clock,
    spindle: Spindle,
    messages: Messages,
    relative_zero: Point,
    motionless: u64,
    /// Block of the last executed command.
    source: Option<Source>,
    /// The program has reached its end.
    ended: bool,
    programs: &'a ProgramMemory,
    set_place: SetPlace,
    /// State of the preview after the first alarm.
    behind: Option<Behind>,
    /// Deceleration time at the end of the last thread, s. It is added to the clock later.
    owed: f64,
    /// Cuts that blend into each other (007.3 = 0), and the last of them. Its duration is
    /// known at the next command.
    sequel: Sequel,
    unsettled: Option<(ExecutedMove, Option<Explanation>)>,
    /// A rapid that may lead to a machine zero: the next command decides.
    returning: Option<(ExecutedMove, Option<Explanation>)>,
    shown: Option<Shown>,
    /// Time in which the spindle reaches a new speed, s.
    settle_s: f64,
    so_far: Preview,
    on_move: &'a mut OnMove<'a>,
    /// Whether moves are explained, and the explanation of the current command.
    explains: bool,
    explanation: Option<Explanation>,
}

impl<'a> Walk<'a> {
    fn new(
        setup: &Setup,
        programs: &'a ProgramMemory,
        modal: Modal,
        on_move: &'a mut OnMove<'a>,
    ) -> Self {
        let start = setup.start.unwrap_or_default();
        Self {
            limits: MotionLimits::of(&setup.memory.parameters, &setup.memory.model),
            clock: Clock::new(setup),
            spindle: Spindle::new(setup),
            messages: Messages::new(setup),
            relative_zero: Point::default(),
            motionless: 0,
            source: None,
            ended: false,
            programs,
            set_place: SetPlace::new(setup),
            behind: None,
            owed: 0.0,
            sequel: Sequel::default(),
            unsettled: None,
            returning: None,
            shown: None,
            settle_s: f64::from(setup.lathe.spindle.settle_ms) / 1000.0,
            so_far: Preview {
                end: End::Limit,
                alarm: None,
                further: Further::default(),
                time_s: 0.0,
                cutting_s: 0.0,
                blocks: 0,
                moves: 0,
                stops: 0,
                parts: 0,
                tools: Vec::new(),
                cautions: Vec::new(),
                bounds: None,
                lengths: Lengths::default(),
                absolute: start,
                machine: start,
                relative: start,
                frame: frame_at_start(setup),
                modal,
                spindle: Turning::Stopped,
                coolant: false,
                parameters: setup.memory.parameters.clone(),
            },
            on_move,
            explains: false,
            explanation: None,
        }
    }

    /// Executes commands to the end of the program or to an alarm.
    fn run(
        &mut self,
        interpreter: &mut Interpreter,
        host: &mut Immediate<'_>,
        go_on: &mut dyn FnMut(&Progress) -> bool,
    ) -> Option<(Alarm, Raised)> {
        let mut until_look = COMMANDS_A_LOOK;
        while self.clock.now() < LONGEST_S {
            until_look -= 1;
            if until_look == 0 {
                until_look = COMMANDS_A_LOOK;
                if !go_on(&self.progress(interpreter)) {
                    return None;
                }
            }
            let advance = interpreter.advance(host);
            if interpreter.has_remarks() {
                self.take_remarks(interpreter);
            }
            match advance {
                Ok(Advance::Command(command)) => {
                    if self.explains {
                        self.explanation = interpreter.explanation();
                    }
                    match self.carry_out(&command) {
                        Ok(None) => {
                            host.now_s = self.clock.now();
                            if matches!(command.action, Action::Repeat) {
                                host.counters.count_part();
                            }
                        }
                        Ok(Some(end)) => {
                            self.so_far.end = end;
                            self.ended = true;
                            return None;
                        }
                        Err(alarm) => return Some((alarm.at(command.source), Raised::Making)),
                    }
                }
                Ok(Advance::Wait | Advance::Starved | Advance::Ended) => return None,
                Err(alarm) => return Some((alarm, Raised::Reading)),
            }
        }
        None
    }

    fn progress(&self, interpreter: &Interpreter) -> Progress {
        Progress {
            line: self.source.map_or(0, |source| source.line),
            blocks: self.so_far.blocks,
            moves: self.so_far.moves,
            work: interpreter.work(),
            motionless: self.motionless,
            time_s: self.clock.now(),
        }
    }

    fn fail(&mut self, alarm: Alarm) {
        self.so_far.end = End::Alarm;
        self.so_far.alarm = Some(alarm);
    }

    /// The result up to here.
    fn result(&mut self, parameters: &Parameters) -> Preview {
        self.settle(false);
        self.so_far.time_s = self.clock.now() + self.owed;
        self.so_far.spindle = self.spindle.turning();
        let mut preview = self.so_far.clone();
        preview.parameters = parameters.clone();
        preview.absolute = snapped(preview.frame.program(preview.machine));
        let offset = match preview.parameters.relative_is_programmed() {
            true => Point::default(),
            false => preview.frame.offset,
        };
        preview.relative = snapped(preview.absolute + offset - self.relative_zero);
        preview
    }
}

/// Rounds off the errors in the last bits that a change of frame causes. End points are
/// multiples of 0.0005 mm, centres are accurate to 1e-9 mm.
fn snapped(point: Point) -> Point {
    const FINE: f64 = 1e9;
    Point::new(round(point.x * FINE) / FINE, round(point.z * FINE) / FINE)
}
