//! Automatic operation: cycle start, feed hold, single block, and the sequence from command
//! to motion and handshake (manual III-5).

mod arrival;
mod execution;
mod interlock;
mod intervention;
mod refusal;
mod thread;
mod wait;

use crate::alarm::{Alarm, number};
use crate::cnc::{Cnc, OffsetEntry, Request, World};
use crate::command::{Action, Command, ProgramId};
use crate::interpreter::Step;
use crate::mode::Mode;
use crate::operation::{Aside, Current, Protection, RunState, Stage};
use crate::units::TICK_S;
use gsk_messages::say;

/// X1.2, *STEN: byte and mask.
const START_ENABLE: (usize, u8) = (1, 1 << 2);

/// Time for which an input must keep its level before the program continues, ms.
const LEVEL_MS: u32 = 30;

/// Most commands without duration that are executed in one tick, so that no loop blocks a
/// tick.
const COMMANDS_PER_TICK: usize = 16;

impl Cnc {
    /// Whether the next cut follows the one under way without a stop (007.3 = 0): neither
    /// single block nor an M, S or T function ends the block first.
    pub(crate) fn cut_continues(&self) -> bool {
        let stops = |current: &Current| current.command.stop_point && self.single_block();
        !self.drives.limits.exact_corners()
            && self.run.automatic.cut_continues()
            && !self.run.automatic.current.as_ref().is_some_and(stops)
            && !self.run.handshake.busy()
    }

    /// Handles the falling edge of the cycle-start signal.
    pub(crate) fn cycle_start(&mut self) {
        let interrupted =
            self.run.automatic.state == RunState::Hold && self.run.automatic.current.is_some();
        // Axes in manual motion stop before the program takes them over.
        let by_hand = self.run.held.is_some();
        let moving = (!interrupted || by_hand) && self.drives.interpolator.is_moving();
        let refused = moving
            || !self.run.mode.runs_programs()
            || self.plc.signals.feed_hold
            || self.resetting()
            || self.alarm_state()
            || self.board_is_stopping()
            || self.run.automatic.state == RunState::Run;
        if refused {
            return;
        }
        if !self.start_enabled() {
            return self.raise(Alarm::new(number::START_DISABLED));
        }
        let mdi = self.run.mode == Mode::Mdi;
        let held = self.run.automatic.state == RunState::Hold;
        if held && !mdi && !self.run.automatic.mdi && !self.runs_in(self.run.mode) {
            // The rest of the held block belongs to a program of another mode.
            return;
        }
        // Only a stored program can be checked in advance.
        if let Some(alarm) = self.board_refuses_start(self.run.mode != Mode::Auto) {
            return self.raise(alarm);
        }
        if !mdi && self.run.automatic.state == RunState::Stop {
            self.take_up_aside();
        }
        match self.run.automatic.state {
            RunState::Hold if mdi && !self.run.automatic.mdi => self.start_mdi(),
            RunState::Hold => self.resume_from_hold(),
            RunState::Stop if self.continues_program() => {
                self.shift_cycle();
                self.run.automatic.state = RunState::Run;
                self.run.automatic.stop_requested = false;
            }
            _ if mdi => self.start_mdi(),
            _ if self.run.mode == Mode::Dnc => self.start_dnc(),
            _ => self.start_program(),
        }
    }

    /// Whether cycle start is enabled by *STEN on the pin of T08. 164.4 STEN requires the
    /// signal and 164.6 AGIN leaves it the pin; 164.5 AGIM selects its level (manual PLC-II
    /// 13.10).
    fn start_enabled(&self) -> bool {
        let asked = self.memory.parameters.start_is_enabled_outside();
        let high = self.plc.filter.accepted()[START_ENABLE.0] & START_ENABLE.1 != 0;
        !asked || high == self.memory.parameters.enable_level()
    }

    /// Whether a stopped run continues with its next block in this mode.
    fn continues_program(&self) -> bool {
        self.run.automatic.goes_on() && self.runs_in(self.run.mode)
    }

    /// Whether the present or stopped run belongs to this mode.
    pub(crate) fn runs_in(&self, mode: Mode) -> bool {
        let own = match (self.run.automatic.mdi, self.memory.programs.inflow()) {
            (true, _) => Mode::Mdi,
            (false, Some(_)) => Mode::Dnc,
            (false, None) => Mode::Auto,
        };
        mode == own
    }

    fn start_program(&mut self) {
        if core::mem::take(&mut self.run.rewind_at_start) {
            self.run.cursor_line = 1;
        }
        self.settle_coordinates();
        let (interpreter, world) = self.interpreter_and_world(true);
        let Some(program) = world.memory.programs.current() else {
            return self.raise(Alarm::new(number::PROGRAM_MISSING));
        };
        interpreter.start(program, world.cursor_line, &world);
        self.memory.programs.set_inflow(None);
        self.run.automatic.clear();
        self.run.automatic.begin_run(false);
    }

    /// Starts the program that the partner at the line is sending.
    fn start_dnc(&mut self) {
        if let Err(alarm) = self.call_for_program() {
            return self.raise(alarm);
        }
        self.settle_coordinates();
        let (interpreter, world) = self.interpreter_and_world(true);
        interpreter.start(ProgramId::Dnc, 1, &world);
        self.run.automatic.clear();
        self.run.automatic.begin_run(false);
    }

    /// Starts the block keyed in on the MDI page. A stopped AUTO run stays suspended until
    /// it is resumed.
    fn start_mdi(&mut self) {
        if self.run.mdi.is_empty() || self.run.handshake.busy() || self.take_nose_radius() {
            return;
        }
        if self.run.automatic.state == RunState::Hold {
            self.set_aside_held_motion();
            let between_moves =
                self.run.automatic.current.is_none() && !self.run.automatic.may_begin();
            if self.run.held.is_none() && !between_moves {
                return;
            }
        }
        let aside = self.lay_run_aside();
        self.settle_coordinates();
        let block = self.run.mdi.program();
        let (interpreter, world) = self.interpreter_and_world(true);
        interpreter.start_mdi(block, &world);
        self.run.automatic.clear();
        self.run.automatic.aside = aside;
        self.run.automatic.begin_run(true);
    }

    /// Sets the nose radius of the offset in force if the MDI block contains R alone
    /// (manual II-1.3), unless R is the taper of G90, G92 or G94. Returns whether it did.
    fn take_nose_radius(&mut self) -> bool {
        let Some(radius) = self.run.mdi.lone_r(&self.memory.parameters) else {
            return false;
        };
        if matches!(self.modal().motion, 90 | 92 | 94) {
            return false;
        }
        let (_, number) = self.tool();
        if number == 0 {
            let why = say::offset_none_for_nose_radius();
            self.raise(Alarm::new(number::BAD_OFFSET).because(why));
            return true;
        }
        if let Err(refusal) = self.rights().offsets() {
            if let Some(alarm) = refusal.alarm() {
                self.raise(alarm);
            }
            return true;
        }
        // A word of a block has the unit of programs.
        let unit = if self.inch_input() { 25.4 } else { 1.0 };
        let entry = OffsetEntry::StoredRadius(radius * unit);
        if self.request(Request::SetOffset { number, entry }).is_ok() {
            self.run.mdi.clear();
        }
        true
    }

    /// Suspends the stopped AUTO run, with the commands that were read but not executed.
    fn lay_run_aside(&mut self) -> Option<Box<Aside>> {
        if self.run.automatic.mdi || !self.run.automatic.goes_on() {
            return self.run.automatic.aside.take();
        }
        let automatic = core::mem::take(&mut self.run.automatic);
        let pending = automatic.current.is_some()
            || automatic.ahead.is_some()
            || self.run.interpreter.in_block();
        Some(Box::new(Aside {
            automatic,
            held: self.run.held.take(),
            read_to: pending.then(|| self.run.interpreter.read_to()),
            frame: self.coordinates.frame,
        }))
    }

    /// Restores the AUTO run as it was before the MDI blocks.
    fn take_up_aside(&mut self) {
        let Some(aside) = self.run.automatic.aside.take() else {
            return;
        };
        self.run.interpreter.leave_mdi();
        self.run.automatic = aside.automatic;
        self.run.held = aside.held;
        if let Some(read_to) = aside.read_to {
            let same_frame = self.coordinates.frame == aside.frame;
            self.run.interpreter.stand_where_read(&read_to, same_frame);
        }
    }

    fn resume_from_hold(&mut self) {
        self.absorb_manual_motion();
        self.run.automatic.stop_requested = false;
        self.shift_cycle();
        self.run.automatic.state = RunState::Run;
    }

    /// Whether single block stops the run; a macro B program can prevent it (#3003).
    pub(crate) const fn single_block(&self) -> bool {
        self.plc.signals.single_block && !self.run.registers.off.single_block()
    }

    /// Handles the feed hold signal, which a macro B program can defer (#3004).
    pub(crate) fn feed_hold_signal(&mut self) {
        if self.run.automatic.state == RunState::Run && self.run.registers.off.feed_hold() {
            self.run.automatic.hold_put_off = true;
        } else {
            self.feed_hold();
        }
    }

    /// Starts feed hold: the axes decelerate. A block without motion finishes, and so does
    /// a thread with the first command after it.
    pub(crate) fn feed_hold(&mut self) {
        if self.run.automatic.state == RunState::Run {
            self.run.automatic.state = RunState::Hold;
        } else if self.run.automatic.protection == (Protection::After { again: true }) {
            self.run.automatic.protection = Protection::None;
        }
    }

    /// Advances automatic operation by one tick.
    pub(crate) fn automatic_tick(&mut self) {
        let fin = self.plc.signals.fin;
        self.run.handshake.tick(fin);
        if !(41..=44).contains(&self.run.handshake.m) {
            // The new gear applies before the next block requests one.
            self.spindle.control.end_gear_change();
        }
        if !self.run.automatic.operating() {
            return;
        }
        let waiting_m = self.run.handshake.waiting_m();
        self.run.automatic.follow_decoded(waiting_m, fin);
        self.dwell_tick();
        self.run
            .automatic
            .arrival
            .tick(self.plc.signals.speed_arrival);
        self.tap_tick();
        self.watch_spindle();
        self.watch_board_spindle();
        if !self.run.automatic.operating() {
            return;
        }
        self.drives
            .limits
            .pass_corners(self.run.registers.off.exact_stop());
        if !self.is_moving_on() {
            self.carry_out();
        }
        let between_blocks = self.run.automatic.current.is_none()
            && !self.run.automatic.within_block
            && !self.run.automatic.protected();
        // Held at a block end; another automatic mode or EDIT turns the hold into a stop.
        if self.run.automatic.state == RunState::Hold
            && between_blocks
            && self.run.automatic.stop_requested
        {
            self.run.automatic.stop();
        }
        self.read_ahead();
    }

    /// Advances the dwell. The wait for an input starts again while the input has the other
    /// level.
    fn dwell_tick(&mut self) {
        let left = self.run.automatic.dwell_left.saturating_sub(1);
        self.run.automatic.dwell_left = match self.run.automatic.action() {
            Some(Action::InputWait { input, high }) if !self.input_is(*input, *high) => LEVEL_MS,
            _ => left,
        };
    }

    /// Ends finished commands and starts the next ones, until one takes time.
    fn carry_out(&mut self) {
        for _ in 0..COMMANDS_PER_TICK {
            if self.run.automatic.current.is_none() && !self.begin_next() {
                break;
            }
            if !self.finish_current() {
                break;
            }
        }
    }

    /// Whether the command under way is a motion that has not ended: the most frequent
    /// case, and cheap to check.
    fn is_moving_on(&self) -> bool {
        let moves = |current: &Current| {
            current.stage == Stage::Acting && current.command.action.is_motion()
        };
        !self.drives.interpolator.finished()
            && self.run.automatic.current.as_ref().is_some_and(moves)
    }

    /// Starts the next motion in the rest of the tick, when a motion ended within it.
    /// Returns whether it did.
    pub(crate) fn begin_within_tick(&mut self) -> bool {
        let ended = self.run.automatic.operating()
            && self.drives.interpolator.finished()
            && self.drives.interpolator.time_left() > 0.0;
        if ended {
            self.carry_out();
        }
        ended && !self.drives.interpolator.finished()
    }

    /// Machine time now, s: within the tick if a block ended in it.
    pub(crate) fn now(&self) -> f64 {
        self.ticks as f64 * TICK_S - self.drives.interpolator.time_left()
    }

    /// Takes the next command and starts it. Returns whether one is under way.
    fn begin_next(&mut self) -> bool {
        if !self.run.automatic.may_begin() {
            return false;
        }
        if let Some(alarm) = self.run.automatic.fault_ahead.take() {
            self.raise(alarm);
            return false;
        }
        let command = match self.run.automatic.ahead.take() {
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
            self.run.automatic.ahead = Some(command);
            return false;
        }
        self.begin(command);
        self.run.automatic.current.is_some()
    }

    /// Reads one command while another runs, so that motion continues without a gap. Under
    /// single block nothing is read ahead, except in a thread.
    pub(crate) fn read_ahead(&mut self) {
        let threading = self.run.automatic.threading();
        let may_read = (self.run.automatic.state == RunState::Run || threading)
            && self.run.automatic.current.is_some()
            && self.run.automatic.ahead.is_none()
            && self.run.automatic.fault_ahead.is_none()
            && !self.run.automatic.waiting
            && (!self.single_block() || threading);
        if may_read {
            self.run.automatic.ahead = self.read(false);
        }
    }

    /// Whether a program runs or can be resumed; MDI blocks do not count.
    pub(crate) fn has_program_run(&self) -> bool {
        let aside = self.run.automatic.aside.is_some();
        aside || (self.run.automatic.started && !self.run.automatic.mdi)
    }

    /// Reads one command from the interpreter; `settled`: all previous commands are
    /// finished.
    fn read(&mut self, settled: bool) -> Option<Command> {
        self.take_in_what_arrived();
        if self.run.automatic.ended {
            if settled {
                self.end_of_program();
            }
            return None;
        }
        let settled = settled && !self.run.handshake.busy() && !self.board_holds_reading();
        let stands = !self.is_board_behind();
        let (interpreter, mut world) = self.interpreter_and_world(settled);
        world.stands = stands;
        let step = interpreter.next(&mut world);
        match step {
            Ok(Step::Command(command)) => {
                self.run.automatic.waiting = false;
                if let Some(explanations) = &mut self.run.explanations {
                    explanations.push_back(self.run.interpreter.explanation());
                }
                Some(*command)
            }
            Ok(Step::Wait) => {
                self.run.automatic.waiting = true;
                None
            }
            Ok(Step::Ended) => {
                self.run.automatic.ended = true;
                None
            }
            Err(alarm) if !settled => {
                self.run.automatic.fault_ahead = Some(alarm);
                None
            }
            Err(alarm) => {
                self.raise(alarm);
                None
            }
        }
    }

    /// Ends an MDI block, or a program that ended without M30.
    pub(crate) fn end_of_program(&mut self) {
        let mdi = self.run.automatic.mdi;
        let aside = self.run.automatic.aside.take();
        self.run.automatic.clear();
        if mdi {
            self.run.mdi.clear();
            self.run.automatic.aside = aside;
            self.run.automatic.state = RunState::Stop;
        } else {
            self.run.automatic.state = RunState::Reset;
        }
    }

    /// The interpreter, and the view of the control that it reads.
    pub(crate) fn interpreter_and_world(
        &mut self,
        settled: bool,
    ) -> (&mut crate::interpreter::Interpreter, World<'_>) {
        let machine_position = self.drives.interpolator.position();
        (
            &mut self.run.interpreter,
            World {
                memory: &mut self.memory,
                registers: &mut self.run.registers,
                now_ms: self.ticks,
                plc: self.plc.engine.memory_mut(),
                machine_position,
                referenced: self.coordinates.referenced,
                block_skip: self.plc.signals.block_skip,
                settled,
                stands: true,
                cursor_line: self.run.cursor_line,
            },
        )
    }
}
