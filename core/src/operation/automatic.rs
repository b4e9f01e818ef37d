//! Automatic operation: cycle start, feed hold, single block, the walk from
//! command to motion and handshake (manual III-5, PLC-I «automatic operation»).
//!
//! ```text
//!            cycle start                 *SP, manual mode
//!  RESET ───────────────► RUN ◄──────────────────────────► HOLD
//!    ▲    ▲                │ block end with single block,   │ block without motion
//!    │    └── STOP ◄───────┘ M00, mode change               │ done (M/S/T, dwell)
//!    │          ▲───────────────────────────────────────────┘
//!    └─ RESET key, M30, emergency stop: from every state
//! ```

use serde::{Deserialize, Serialize};

use super::arrival::Arrival;
use super::intervention::CycleShift;
use super::mode::Mode;
use super::thread::{Protection, SpindleWatch, TapStage};
use crate::alarm::Alarm;
use crate::cnc::{Cnc, World};
use crate::command::{Action, Command, Frame, Source};
use crate::interpreter::{ReadTo, Step};
use crate::motion::Interpolator;
use crate::units::{Point, TICK_S};

/// States of automatic operation (STL, SPL, OP).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum RunState {
    /// After power-on, RESET and M30: the next cycle start begins at the cursor.
    Reset,
    /// At the end of a block: cycle start goes on with the next one.
    Stop,
    /// Running.
    Run,
    /// Feed hold.
    Hold,
}

/// What a command under way still waits for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) enum Stage {
    /// Motion or dwell.
    Acting,
    /// Only the M/S/T handshake (DEN is up if nothing else runs).
    Handshake,
}

/// A command under way.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Current {
    pub(crate) command: Command,
    pub(super) stage: Stage,
    /// Where it began, machine coordinates.
    pub(crate) from: Point,
    /// When it began, s.
    pub(super) started: f64,
}

/// Automatic operation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Automatic {
    /// Run state.
    pub state: RunState,
    pub(crate) current: Option<Current>,
    pub(super) ahead: Option<Command>,
    /// A fault found while reading ahead; it counts when its block's turn comes.
    fault_ahead: Option<Alarm>,
    /// The interpreter waits for standstill; not asked again before.
    pub(super) waiting: bool,
    /// A program has been started and its rest can be gone on with.
    started: bool,
    /// The interpreter has nothing more.
    ended: bool,
    /// Stop at the end of the block, whatever single block says.
    pub(super) stop_requested: bool,
    pub(super) dwell_left: u32,
    /// M00 or M30 whose decode signal stands.
    pub(crate) decoded: Option<u8>,
    /// Which program runs: AUTO's or the MDI block.
    pub(crate) mdi: bool,
    /// Source of the last executed command.
    pub(crate) last: Option<Source>,
    /// More commands of the running block follow the one that ended.
    pub(super) within_block: bool,
    pub(super) protection: Protection,
    /// Tapping under way.
    pub(super) tap: Option<TapStage>,
    /// M function that leads the tap out.
    pub(super) tap_reverse: u8,
    pub(super) watch: SpindleWatch,
    pub(crate) arrival: Arrival,
    /// The stopped AUTO run that MDI blocks are keyed in between.
    aside: Option<Box<Aside>>,
    pub(super) cycle_shift: CycleShift,
}

/// A stopped AUTO run while MDI blocks are carried out (manual II, MDI; III-6).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Aside {
    automatic: Automatic,
    /// The rest of its block, if it was held in one.
    held: Option<Interpolator>,
    /// Where its program has been read to, if that is not where the tool stands.
    read_to: Option<ReadTo>,
    /// The frame it was read in.
    frame: Frame,
}

/// Commands without duration carried out in one tick at most, so that no loop
/// stalls a tick.
const COMMANDS_PER_TICK: usize = 16;

impl Default for Automatic {
    fn default() -> Self {
        Self {
            state: RunState::Reset,
            current: None,
            ahead: None,
            fault_ahead: None,
            waiting: false,
            started: false,
            ended: false,
            stop_requested: false,
            dwell_left: 0,
            decoded: None,
            mdi: false,
            last: None,
            within_block: false,
            protection: Protection::None,
            tap: None,
            tap_reverse: 0,
            watch: SpindleWatch::default(),
            arrival: Arrival::default(),
            aside: None,
            cycle_shift: CycleShift::default(),
        }
    }
}

impl Automatic {
    /// STL or SPL: a block is under way or held.
    pub const fn operating(&self) -> bool {
        matches!(self.state, RunState::Run | RunState::Hold)
    }

    /// DEN: all that is left of the block is FIN.
    pub(crate) fn distribution_end(&self) -> bool {
        matches!(&self.current, Some(current) if current.stage == Stage::Handshake)
    }

    /// Whether the dwell of a G04 runs.
    pub(crate) fn dwelling(&self) -> bool {
        self.dwell_left > 0 && matches!(self.action(), Some(Action::Dwell { .. }))
    }

    /// The action under way.
    pub(crate) fn action(&self) -> Option<&Action> {
        self.current.as_ref().map(|current| &current.command.action)
    }

    /// Whether the cut under way goes over into the command read ahead: it is a cut
    /// too, and nothing stops the run in between.
    pub(crate) fn cut_continues(&self) -> bool {
        self.state == RunState::Run
            && !self.stop_requested
            && self.ahead.as_ref().is_some_and(|next| is_cut(&next.action))
    }

    /// Drops everything that was read.
    pub(crate) fn clear(&mut self) {
        *self = Self {
            last: self.last,
            ..Self::default()
        };
    }

    /// Whether a run stands that can be gone on with.
    const fn goes_on(&self) -> bool {
        self.started && !self.ended
    }

    const fn begin_run(&mut self, mdi: bool) {
        self.mdi = mdi;
        self.started = true;
        self.state = RunState::Run;
    }

    /// Where the stopped AUTO run stands that MDI blocks are keyed in between.
    pub(crate) fn source_aside(&self) -> Option<Source> {
        self.aside.as_ref().and_then(|aside| aside.automatic.last)
    }

    /// The block of the program that a stop breaks off.
    pub(super) fn broken_off(&self) -> Option<Source> {
        let run = match &self.aside {
            Some(aside) => &aside.automatic,
            None => self,
        };
        run.last.filter(|_| run.operating() && !run.mdi)
    }

    /// Stops at the end of a block.
    pub(super) const fn stop(&mut self) {
        self.state = RunState::Stop;
        self.stop_requested = false;
        self.protection = Protection::None;
    }

    /// Asks for a stop at the end of the running block.
    pub(crate) const fn request_stop(&mut self) {
        self.stop_requested = true;
    }
}

/// Whether an action is a cut whose speed is its own (no thread).
pub(super) const fn is_cut(action: &Action) -> bool {
    matches!(action, Action::Line { .. } | Action::Arc { .. })
}

impl Cnc {
    /// Whether the next cut follows the one under way without a stop (007.3 = 0):
    /// neither single block nor an M, S or T function ends the block first.
    pub(crate) fn cut_continues(&self) -> bool {
        let stops = |current: &Current| current.command.stop_point && self.from_plc.single_block;
        !self.limits.exact_corners()
            && self.automatic.cut_continues()
            && !self.automatic.current.as_ref().is_some_and(stops)
            && !self.handshake.busy()
    }

    /// The cycle-start signal fell from 1 to 0.
    pub(crate) fn cycle_start(&mut self) {
        let interrupted =
            self.automatic.state == RunState::Hold && self.automatic.current.is_some();
        // Axes moved by hand come to rest before the program takes them over.
        let by_hand = self.held.is_some();
        let moving = (!interrupted || by_hand) && self.interpolator.is_moving();
        let refused = moving
            || !self.mode.runs_programs()
            || self.from_plc.feed_hold
            || self.resetting()
            || self.alarm_state()
            || self.board_is_stopping()
            || self.automatic.state == RunState::Run;
        if refused {
            return;
        }
        let mdi = self.mode == Mode::Mdi;
        if let Some(alarm) = self.board_refuses_start(mdi) {
            return self.raise(alarm);
        }
        if !mdi && self.automatic.state == RunState::Stop {
            self.take_up_aside();
        }
        match self.automatic.state {
            RunState::Hold if mdi && !self.automatic.mdi => self.start_mdi(),
            RunState::Hold => self.resume_from_hold(),
            RunState::Stop if self.continues_program() => {
                self.shift_cycle();
                self.automatic.state = RunState::Run;
                self.automatic.stop_requested = false;
            }
            _ if mdi => self.start_mdi(),
            _ => self.start_program(),
        }
    }

    /// Whether a stopped run goes on with its next block in this mode.
    fn continues_program(&self) -> bool {
        self.automatic.goes_on() && self.automatic.mdi == (self.mode == Mode::Mdi)
    }

    fn start_program(&mut self) {
        if core::mem::take(&mut self.rewind_at_start) {
            self.cursor_line = 1;
        }
        self.settle_coordinates();
        let (interpreter, world) = self.interpreter_and_world(true);
        let Some(program) = world.programs.current() else {
            return self.raise(Alarm::new(31));
        };
        interpreter.start(program, world.cursor_line, &world);
        self.automatic.clear();
        self.automatic.begin_run(false);
    }

    /// The block keyed in. A stopped AUTO run waits until it is gone on with.
    fn start_mdi(&mut self) {
        if self.mdi.is_empty() || self.handshake.busy() {
            return;
        }
        if self.automatic.state == RunState::Hold {
            self.set_aside_held_motion();
            if self.held.is_none() {
                return;
            }
        }
        let aside = self.lay_run_aside();
        self.settle_coordinates();
        let block = self.mdi.program();
        let (interpreter, world) = self.interpreter_and_world(true);
        interpreter.start_mdi(block, &world);
        self.automatic.clear();
        self.automatic.aside = aside;
        self.automatic.begin_run(true);
    }

    /// The AUTO run that stands, with what was read of it and not carried out.
    fn lay_run_aside(&mut self) -> Option<Box<Aside>> {
        if self.automatic.mdi || !self.automatic.goes_on() {
            return self.automatic.aside.take();
        }
        let automatic = core::mem::take(&mut self.automatic);
        let pending =
            automatic.current.is_some() || automatic.ahead.is_some() || self.interpreter.in_block();
        Some(Box::new(Aside {
            automatic,
            held: self.held.take(),
            read_to: pending.then(|| self.interpreter.read_to()),
            frame: self.frame,
        }))
    }

    /// The AUTO run stands again as it did before the MDI blocks.
    fn take_up_aside(&mut self) {
        let Some(aside) = self.automatic.aside.take() else {
            return;
        };
        self.interpreter.leave_mdi();
        self.automatic = aside.automatic;
        self.held = aside.held;
        if let Some(read_to) = aside.read_to {
            let same_frame = self.frame == aside.frame;
            self.interpreter.stand_where_read(&read_to, same_frame);
        }
    }

    fn resume_from_hold(&mut self) {
        self.absorb_manual_motion();
        self.automatic.stop_requested = false;
        self.shift_cycle();
        self.automatic.state = RunState::Run;
    }

    /// Feed hold: the axes decelerate; a block without motion finishes, and so does
    /// a thread with the first thing after it.
    pub(crate) fn feed_hold(&mut self) {
        if self.automatic.state == RunState::Run {
            self.automatic.state = RunState::Hold;
        } else if self.automatic.protection == (Protection::After { again: true }) {
            self.automatic.protection = Protection::None;
        }
    }

    /// One tick of automatic operation.
    pub(crate) fn automatic_tick(&mut self) {
        self.handshake.tick(self.from_plc.fin);
        if !self.automatic.operating() {
            return;
        }
        self.automatic.dwell_left = self.automatic.dwell_left.saturating_sub(1);
        self.automatic.arrival.tick(self.from_plc.speed_arrival);
        self.tap_tick();
        self.watch_spindle();
        self.watch_board_spindle();
        if !self.automatic.operating() {
            return;
        }
        self.carry_out();
        let between_blocks = self.automatic.current.is_none()
            && !self.automatic.within_block
            && !self.automatic.protected();
        // Held at a block end; another automatic mode or EDIT makes a stop of it.
        if self.automatic.state == RunState::Hold && between_blocks && self.automatic.stop_requested
        {
            self.automatic.stop();
        }
        self.read_ahead();
    }

    /// Ends what is finished and begins what follows, until something takes time.
    fn carry_out(&mut self) {
        for _ in 0..COMMANDS_PER_TICK {
            if self.automatic.current.is_none() && !self.begin_next() {
                break;
            }
            if !self.finish_current() {
                break;
            }
        }
    }

    /// A motion that ended within the tick leaves the rest of it to the next one:
    /// begins that. Returns whether there is one.
    pub(crate) fn begin_within_tick(&mut self) -> bool {
        let ended = self.automatic.operating()
            && self.interpolator.finished()
            && self.interpolator.time_left() > 0.0;
        if ended {
            self.carry_out();
        }
        ended && !self.interpolator.finished()
    }

    /// Machine time now, s: within a tick when a block ended in it.
    pub(super) fn now(&self) -> f64 {
        self.ticks as f64 * TICK_S - self.interpolator.time_left()
    }

    /// Takes the next command and starts it. Returns whether one is under way.
    fn begin_next(&mut self) -> bool {
        if !self.automatic.may_begin() {
            return false;
        }
        if let Some(alarm) = self.automatic.fault_ahead.take() {
            self.raise(alarm);
            return false;
        }
        let command = match self.automatic.ahead.take() {
            Some(command) => command,
            None => match self.read(true) {
                Some(command) => command,
                None => return false,
            },
        };
        if self.ends_spoilt(&command.action) {
            return false;
        }
        if self.board_delays(&command.action) {
            self.automatic.ahead = Some(command);
            return false;
        }
        self.begin(command);
        self.automatic.current.is_some()
    }

    /// Reads one command while another runs, so that motion goes on without a
    /// gap. Under single block nothing is read ahead, except in a thread.
    pub(super) fn read_ahead(&mut self) {
        let threading = self.automatic.threading();
        let may_read = (self.automatic.state == RunState::Run || threading)
            && self.automatic.current.is_some()
            && self.automatic.ahead.is_none()
            && self.automatic.fault_ahead.is_none()
            && !self.automatic.waiting
            && (!self.from_plc.single_block || threading);
        if may_read {
            self.automatic.ahead = self.read(false);
        }
    }

    /// Asks the interpreter for one command.
    fn read(&mut self, settled: bool) -> Option<Command> {
        if self.automatic.ended {
            if settled {
                self.end_of_program();
            }
            return None;
        }
        let settled = settled && !self.handshake.busy() && !self.board_holds_reading();
        let stands = !self.is_board_behind();
        let (interpreter, mut world) = self.interpreter_and_world(settled);
        world.stands = stands;
        let step = interpreter.next(&mut world);
        match step {
            Ok(Step::Command(command)) => {
                self.automatic.waiting = false;
                if let Some(explanations) = &mut self.explanations {
                    explanations.push_back(self.interpreter.explanation());
                }
                Some(*command)
            }
            Ok(Step::Wait) => {
                self.automatic.waiting = true;
                None
            }
            Ok(Step::Ended) => {
                self.automatic.ended = true;
                None
            }
            Err(alarm) if !settled => {
                self.automatic.fault_ahead = Some(alarm);
                None
            }
            Err(alarm) => {
                self.raise(alarm);
                None
            }
        }
    }

    /// The end of an MDI block, or of a program whose end came without M30.
    pub(super) fn end_of_program(&mut self) {
        let mdi = self.automatic.mdi;
        let aside = self.automatic.aside.take();
        self.automatic.clear();
        if mdi {
            self.mdi.clear();
            self.automatic.aside = aside;
            self.automatic.state = RunState::Stop;
        } else {
            self.automatic.state = RunState::Reset;
        }
    }

    /// The interpreter, and the world as it may see it.
    pub(crate) fn interpreter_and_world(
        &mut self,
        settled: bool,
    ) -> (&mut crate::interpreter::Interpreter, World<'_>) {
        let machine_position = self.interpolator.position();
        (
            &mut self.interpreter,
            World {
                parameters: &mut self.parameters,
                offsets: &self.offsets,
                variables: &mut self.variables,
                programs: &self.programs,
                plc: self.plc.memory_mut(),
                machine_position,
                referenced: self.referenced,
                block_skip: self.from_plc.block_skip,
                settled,
                stands: true,
                cursor_line: self.cursor_line,
            },
        )
    }
}
