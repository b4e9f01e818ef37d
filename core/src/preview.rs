//! The path of `check`: a whole program interpreted without ticks. It streams:
//! moves go to a callback, what is kept does not grow with the program.

mod bounds;
mod clock;
mod spindle;
mod thread;
mod travel;

use core::cell::LazyCell;

use crate::alarm::Alarm;
use crate::command::{Action, Command, ExecutedMove, Frame, MoveKind, ThreadStart, Timing};
use crate::interpreter::{Advance, Immediate, Interpreter, MachineCodes, Modal};
use crate::memory::Parameters;
use crate::motion::{MotionLimits, Sequel, ThreadMove};
use crate::program::ProgramMemory;
use crate::setup::Setup;
use crate::simulation::Simulation;
use crate::units::{PerAxis, Point, TICK_S};

pub use bounds::Bounds;
use clock::Clock;
use spindle::Spindle;
pub use spindle::Turning;

/// Blocks without motion after which a preview gives up.
const MOTIONLESS_BLOCKS: u32 = 1_500_000;

/// Machine time after which a preview gives up, s: 1000 hours.
const LONGEST_S: f64 = 3.6e6;

/// How a preview ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// M30.
    M30,
    /// M99 of the main program.
    M99,
    /// The end of the text without either.
    Text,
    /// An alarm.
    Alarm,
    /// No end within 1000 hours of machine time or 1.5 million blocks without motion.
    Limit,
}

/// Path lengths, mm; a rapid counts as its chord.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lengths {
    /// Rapids.
    pub rapid: f64,
    /// Straight cuts.
    pub feed: f64,
    /// Clockwise arcs.
    pub clockwise: f64,
    /// Counter-clockwise arcs.
    pub counter_clockwise: f64,
    /// Threads with their run-outs, and taps.
    pub thread: f64,
}

/// What a program does. Points have a radius X.
#[derive(Clone, Debug, PartialEq)]
pub struct Preview {
    /// How it ended.
    pub end: End,
    /// The alarm that ended it.
    pub alarm: Option<Alarm>,
    /// Estimated machine time, s: motion, M, S, T and dwell.
    pub time_s: f64,
    /// Part of it spent cutting, s.
    pub cutting_s: f64,
    /// Blocks carried out.
    pub blocks: u64,
    /// Moves and dwells, without those of no length.
    pub moves: u64,
    /// M00 met.
    pub stops: u32,
    /// Parts finished.
    pub parts: u32,
    /// Tools called, with their offset numbers, in order, each pair once.
    pub tools: Vec<(u8, u8)>,
    /// Box around the path in work coordinates.
    pub bounds: Option<Bounds>,
    /// Path lengths by kind.
    pub lengths: Lengths,
    /// Final absolute position.
    pub absolute: Point,
    /// Final machine position.
    pub machine: Point,
    /// Final relative position.
    pub relative: Point,
    /// Frame at the end.
    pub frame: Frame,
    /// Modal state at the end.
    pub modal: Modal,
    /// Whether and how the spindle turns at the end.
    pub spindle: Turning,
    /// Whether coolant is on at the end.
    pub coolant: bool,
    /// Parameters at the end; cycles may have written some.
    pub parameters: Parameters,
}

/// Interprets the selected program from its first line to its end. `on_move`
/// gets every move in order.
pub fn preview(
    setup: &Setup,
    programs: &ProgramMemory,
    on_move: &mut dyn FnMut(&ExecutedMove),
) -> Preview {
    let mut host = Immediate {
        parameters: setup.parameters.clone(),
        offsets: &setup.offsets,
        variables: setup.variables.clone(),
        inputs: LazyCell::new(Box::new(|| idle_inputs(setup))),
        outputs: 0,
        programs,
        position: setup.start.unwrap_or_default(),
        // The work is drawn where the machine coordinates put it, whether the real
        // reference point has been sought or not.
        referenced: PerAxis::new(true, true),
        block_skip: false,
    };
    let mut interpreter = Interpreter::new(&host.parameters);
    interpreter.set_inch_input(setup.settings.inch);
    interpreter.set_tool(setup.tool_in_position());
    interpreter.set_machine_codes(MachineCodes::of(&setup.ladder));
    let mut walk = Walk::new(setup, *interpreter.modal(), on_move);
    match programs.current() {
        Some(program) => {
            interpreter.start(program, 1, &host);
            walk.run(&mut interpreter, &mut host);
        }
        None => walk.fail(Alarm::new(31).because("no program is selected")),
    }
    let mut preview = walk.finish();
    preview.modal = *interpreter.modal();
    if matches!(preview.end, End::M30 | End::Text) {
        // The end of a program is a reset.
        preview.modal.nose_compensation = 40;
    }
    preview.parameters = host.parameters;
    preview
}

/// What the ladder gives to macros while the lathe stands idle.
fn idle_inputs(setup: &Setup) -> u16 {
    const SETTLED_TICKS: u32 = 500;
    let mut simulation = Simulation::new(setup.clone());
    for _ in 0..SETTLED_TICKS {
        simulation.tick();
    }
    let memory = simulation.cnc.plc().memory();
    u16::from_le_bytes([memory.g(54), memory.g(55)])
}

/// The walk over the commands.
struct Walk<'a> {
    limits: MotionLimits,
    clock: Clock,
    spindle: Spindle,
    relative_zero: Point,
    motionless: u32,
    /// Slowing down at the end of the last thread, s.
    owed: f64,
    /// Cuts that go over into each other (007.3 = 0), and the last of them, whose
    /// time is known when the next command is.
    sequel: Sequel,
    unsettled: Option<ExecutedMove>,
    /// Time the spindle needs for a new speed, s.
    settle_s: f64,
    so_far: Preview,
    on_move: &'a mut dyn FnMut(&ExecutedMove),
}

impl<'a> Walk<'a> {
    fn new(setup: &Setup, modal: Modal, on_move: &'a mut dyn FnMut(&ExecutedMove)) -> Self {
        let start = setup.start.unwrap_or_default();
        Self {
            limits: MotionLimits::from(&setup.parameters),
            clock: Clock::new(setup),
            spindle: Spindle::new(setup),
            relative_zero: Point::default(),
            motionless: 0,
            owed: 0.0,
            sequel: Sequel::default(),
            unsettled: None,
            settle_s: f64::from(setup.lathe.spindle.settle_ms) / 1000.0,
            so_far: Preview {
                end: End::Limit,
                alarm: None,
                time_s: 0.0,
                cutting_s: 0.0,
                blocks: 0,
                moves: 0,
                stops: 0,
                parts: 0,
                tools: Vec::new(),
                bounds: None,
                lengths: Lengths::default(),
                absolute: start,
                machine: start,
                relative: start,
                frame: Frame::default(),
                modal,
                spindle: Turning::Stopped,
                coolant: false,
                parameters: setup.parameters.clone(),
            },
            on_move,
        }
    }

    fn run(&mut self, interpreter: &mut Interpreter, host: &mut Immediate<'_>) {
        while self.motionless < MOTIONLESS_BLOCKS && self.clock.now() < LONGEST_S {
            match interpreter.advance(host) {
                Ok(Advance::Command(command)) => match self.carry_out(&command) {
                    Ok(None) => {}
                    Ok(Some(end)) => {
                        self.so_far.end = end;
                        return;
                    }
                    Err(alarm) => return self.fail(alarm.at(command.source)),
                },
                Ok(Advance::Wait | Advance::Ended) => return,
                Err(alarm) => return self.fail(alarm),
            }
        }
    }

    fn fail(&mut self, alarm: Alarm) {
        self.so_far.end = End::Alarm;
        self.so_far.alarm = Some(alarm);
    }

    fn finish(mut self) -> Preview {
        self.settle(false);
        self.so_far.time_s = self.clock.now() + self.owed;
        self.so_far.spindle = self.spindle.turning();
        let mut preview = self.so_far;
        preview.absolute = snapped(preview.frame.program(preview.machine));
        let offset = match preview.parameters.relative_is_programmed() {
            true => Point::default(),
            false => preview.frame.offset,
        };
        preview.relative = snapped(preview.absolute + offset - self.relative_zero);
        preview
    }

    fn carry_out(&mut self, command: &Command) -> Result<Option<End>, Alarm> {
        self.motionless += 1;
        if self.owed > 0.0 {
            self.pay(&command.action);
        }
        if !matches!(&command.action, Action::Line { .. } | Action::Arc { .. }) {
            self.settle(false);
        }
        if !may_stand_before(&command.action) {
            self.spindle.start_pending();
        }
        match &command.action {
            Action::Rapid { to } => self.travel(command, MoveKind::Rapid, *to, None, None)?,
            Action::Line { to, feed } => {
                self.travel(command, MoveKind::Feed, *to, None, Some(*feed))?;
            }
            Action::Arc {
                to,
                center,
                clockwise,
                feed,
            } => {
                let kind = MoveKind::arc(*clockwise);
                self.travel(command, kind, *to, Some(*center), Some(*feed))?;
            }
            thread @ Action::Thread { .. } => {
                if let Some(thread) = ThreadMove::of(thread) {
                    self.thread(command, &thread)?;
                }
            }
            Action::ThreadCycle { per_revolution, .. } => {
                self.check_thread_cycle(*per_revolution)?;
            }
            Action::Tap {
                to,
                lead,
                start_degrees,
            } => {
                if *start_degrees > 0.0 {
                    self.restart_spindle();
                }
                self.tap(command, *to, *lead)?;
            }
            Action::Dwell { ms } => self.dwell(command.source, *ms),
            Action::Frame {
                frame, relative, ..
            } => self.change_frame(*frame, *relative),
            Action::Miscellaneous { code, timing } => {
                match timing {
                    Timing::WithMotion => self.spindle.output_m_with_motion(*code),
                    Timing::BeforeMotion => self.spindle.output_m(*code),
                }
                match code {
                    8 => self.so_far.coolant = true,
                    9 => self.so_far.coolant = false,
                    _ => {}
                }
                match code {
                    41..=44 if self.spindle.change_gear(code - 40) => {
                        self.clock.change_gear(code - 40);
                    }
                    41..=44 => {}
                    _ => self.clock.output_m(*timing),
                }
            }
            Action::Spindle(speed) => {
                self.spindle.command(*speed);
                self.clock.output_s(speed);
            }
            Action::Tool { tool, offset } => {
                self.clock.change_tool(*tool);
                if !self.so_far.tools.contains(&(*tool, *offset)) {
                    self.so_far.tools.push((*tool, *offset));
                }
            }
            Action::ProgramStop => self.so_far.stops += 1,
            Action::Repeat => {
                self.so_far.parts += 1;
                self.so_far.blocks += 1;
                return Ok(Some(End::M99));
            }
            Action::End { counts, m30 } => {
                self.so_far.parts += u32::from(*counts);
                self.so_far.blocks += u64::from(*m30);
                if *m30 {
                    self.spindle.output_m(5);
                    self.so_far.coolant = false;
                }
                return Ok(Some(if *m30 { End::M30 } else { End::Text }));
            }
            Action::Macro => self.clock.advance(TICK_S),
            Action::ZeroReturn { .. } | Action::Referenced { .. } | Action::Nothing => {}
        }
        if command.block_end {
            self.so_far.blocks += 1;
            self.spindle.start_pending();
            self.clock.block_end();
        }
        Ok(None)
    }

    /// The slowing down of the thread before, unless it goes on in phase.
    fn pay(&mut self, next: &Action) {
        let owed = core::mem::take(&mut self.owed);
        let in_phase = matches!(
            next,
            Action::Thread {
                start: ThreadStart::Continued,
                ..
            }
        );
        if !in_phase {
            self.clock.advance(owed);
        }
    }

    /// The relative coordinates stay at a change of the work zero, unless they
    /// follow it; an offset shifts them like the absolute ones.
    fn change_frame(&mut self, frame: Frame, relative_follows: bool) {
        let before = self.so_far.frame;
        self.so_far.frame = frame;
        if before.zero == frame.zero {
            return;
        }
        if relative_follows {
            self.relative_zero = Point::default();
            return;
        }
        let machine = self.so_far.machine;
        self.relative_zero = self.relative_zero + frame.program(machine) - before.program(machine);
    }
}

/// Whether a spindle that starts in the block of this action may still stand: a
/// thread begins beside the M code of its block.
const fn may_stand_before(action: &Action) -> bool {
    matches!(
        action,
        Action::Thread { .. }
            | Action::Tap { .. }
            | Action::Miscellaneous { .. }
            | Action::Spindle(_)
            | Action::Tool { .. }
            | Action::Frame { .. }
    )
}

/// Without the noise in the last bits that a change of frame leaves: end points
/// are multiples of 0.0005 mm, centres good to a billionth of one.
fn snapped(point: Point) -> Point {
    const FINE: f64 = 1e9;
    Point::new(
        libm::round(point.x * FINE) / FINE,
        libm::round(point.z * FINE) / FINE,
    )
}
