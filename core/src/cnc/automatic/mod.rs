//! Automatic operation: cycle start, feed hold, single block, and the sequence from command
//! to motion and handshake (manual III-5).

mod execution;
mod interlock;
mod intervention;
mod refusal;
pub(in crate::cnc) mod restart;
mod restart_words;
mod retrace;
mod speed_arrival;
mod thread;
mod wait_reason;

use crate::alarm::{Alarm, number};
use crate::cnc::{Cnc, ControlHost, ControlRequest, OffsetEntry};
use crate::command::{Action, ControlCommand, ProgramId};
use crate::interpreter::InterpreterStep;
use crate::mode::OperatingMode;
use crate::operation::{CommandStage, CurrentCommand, HoldProtection, RunState, SuspendedRun};
use crate::units::TICK_S;
use gsk_messages::say;

/// Contact of *STEN (start enable), X1.2, as byte and mask.
const START_ENABLE: (usize, u8) = (1, 1 << 2);

/// Time for which an input must keep its level before the program continues, ms.
const INPUT_LEVEL_MS: u32 = 30;

/// Greatest number of commands without duration that are executed in one tick, so that no loop
/// blocks a tick.
const COMMANDS_PER_TICK: usize = 16;

impl Cnc {
    /// Whether another cut continues from the current cut without a stop (007.3 = 0): neither
    /// single block nor an M, S or T function ends the block first.
    pub(crate) fn continues_cut(&self) -> bool {
        let is_stop =
            |current: &CurrentCommand| current.command.stop_point && self.is_single_block();
        !self.drives.limits.has_exact_corners()
            && self.run.automatic.continues_cut()
            && !self.run.automatic.current.as_ref().is_some_and(is_stop)
            && !self.run.handshake.is_busy()
    }

    /// Handles the falling edge of the cycle-start signal: starts or resumes the program or the MDI
    /// block, unless the state of the control forbids it.
    pub(crate) fn handle_cycle_start(&mut self) {
        let interrupted =
            self.run.automatic.state == RunState::Hold && self.run.automatic.current.is_some();
        // Axes in manual motion stop before the program takes them over.
        let in_manual = self.run.held_motion.is_some();
        let moving = (!interrupted || in_manual) && self.drives.interpolator.is_moving();
        let is_refused = moving
            || !self.run.mode.runs_programs()
            || self.plc.signals.feed_hold
            || self.is_resetting()
            || self.is_alarm_active()
            || self.is_board_stopping()
            || self.is_off_hold()
            || self.run.automatic.state == RunState::Run;
        if is_refused {
            return;
        }
        if !self.is_start_enabled() {
            return self.raise(Alarm::new(number::START_DISABLED));
        }
        let mdi = self.run.mode == OperatingMode::Mdi;
        let held = self.run.automatic.state == RunState::Hold;
        if held && !mdi && !self.run.automatic.is_mdi && !self.belongs_to_mode(self.run.mode) {
            // The rest of the held block belongs to a program of another mode.
            return;
        }
        // Only a stored program can be checked in advance.
        if let Some(alarm) = self.board_start_alarm(self.run.mode != OperatingMode::Auto) {
            return self.raise(alarm);
        }
        if !mdi && self.run.automatic.state == RunState::Stop {
            self.resume_suspended_run();
        }
        match self.run.automatic.state {
            RunState::Hold if mdi && !self.run.automatic.is_mdi => self.start_mdi(),
            RunState::Hold => self.resume_from_hold(),
            RunState::Stop if self.can_continue_program() => {
                self.shift_cycle();
                self.run.automatic.state = RunState::Run;
                self.run.automatic.stop_requested = false;
            }
            _ if mdi => self.start_mdi(),
            _ if self.run.mode == OperatingMode::Dnc => self.start_dnc(),
            _ => self.start_program(),
        }
    }

    /// Whether the signal *STEN, on the pin of T08, enables cycle start. 164.4 STEN makes the
    /// signal necessary, 164.6 AGIN reserves the pin for it, and 164.5 AGIM selects its level
    /// (manual PLC-II 13.10).
    fn is_start_enabled(&self) -> bool {
        let is_required = self.memory.parameters.has_start_enable_input();
        let high = self.plc.filter.accepted()[START_ENABLE.0] & START_ENABLE.1 != 0;
        !is_required || high == self.memory.parameters.enable_level()
    }

    /// Whether cycle start in the current mode continues a stopped run with its next block.
    fn can_continue_program(&self) -> bool {
        self.run.automatic.can_resume() && self.belongs_to_mode(self.run.mode)
    }

    /// Whether the current or stopped run belongs to `mode`: MDI, DNC or AUTO.
    pub(crate) fn belongs_to_mode(&self, mode: OperatingMode) -> bool {
        let run_mode = match (self.run.automatic.is_mdi, self.memory.programs.dnc_buffer()) {
            (true, _) => OperatingMode::Mdi,
            (false, Some(_)) => OperatingMode::Dnc,
            (false, None) => OperatingMode::Auto,
        };
        mode == run_mode
    }

    fn start_program(&mut self) {
        if self.run.automatic.restart.is_some() {
            return self.begin_restart();
        }
        if core::mem::take(&mut self.run.rewind_at_start) {
            self.run.cursor_line = 1;
        }
        self.settle_coordinates();
        self.forget_made_path();
        let (interpreter, world) = self.interpreter_and_world(true);
        let Some(program) = world.memory.programs.selected() else {
            return self.raise(Alarm::new(number::PROGRAM_MISSING));
        };
        interpreter.start(program, world.cursor_line, &world);
        self.memory.programs.set_dnc_buffer(None);
        self.run.automatic.clear();
        self.run.automatic.begin_run(false);
    }

    /// Starts the program that the device on the serial line sends (DNC).
    fn start_dnc(&mut self) {
        if let Err(alarm) = self.request_dnc_program() {
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
        if self.run.mdi.is_empty() || self.run.handshake.is_busy() || self.store_lone_nose_radius()
        {
            return;
        }
        if self.run.automatic.state == RunState::Hold {
            self.suspend_held_motion();
            let between_moves =
                self.run.automatic.current.is_none() && !self.run.automatic.can_begin_command();
            if self.run.held_motion.is_none() && !between_moves {
                return;
            }
        }
        let suspended = self.suspend_run();
        self.settle_coordinates();
        let block = self.run.mdi.program();
        let (interpreter, world) = self.interpreter_and_world(true);
        interpreter.start_mdi(block, &world);
        self.run.automatic.clear();
        self.run.automatic.suspended = suspended;
        self.run.automatic.begin_run(true);
    }

    /// Sets the nose radius of the offset in force if the MDI block contains R alone
    /// (manual II-1.3), unless R is the taper of G90, G92 or G94. Returns whether the block
    /// was handled in this way.
    fn store_lone_nose_radius(&mut self) -> bool {
        let Some(radius) = self.run.mdi.lone_r(&self.memory.parameters) else {
            return false;
        };
        if self.modal().motion.is_canned_cycle() {
            return false;
        }
        let (_, number) = self.tool();
        if number == 0 {
            let why = say::offset_none_for_nose_radius();
            self.raise(Alarm::new(number::BAD_OFFSET).with_detail(why));
            return true;
        }
        if let Err(refusal) = self.rights().check_offsets() {
            if let Some(alarm) = refusal.alarm() {
                self.raise(alarm);
            }
            return true;
        }
        // A word of a block has the unit of programs.
        let unit = if self.is_inch_input() { 25.4 } else { 1.0 };
        let entry = OffsetEntry::StoredRadius(radius * unit);
        if self
            .request(ControlRequest::SetOffset { number, entry })
            .is_ok()
        {
            self.run.mdi.clear();
        }
        true
    }

    /// Suspends the stopped AUTO run, with the commands that were read but not executed, and
    /// returns it; returns a run that is already suspended unchanged. `None` without either.
    fn suspend_run(&mut self) -> Option<Box<SuspendedRun>> {
        let is_kept = !self.run.automatic.is_mdi && !self.run.automatic.is_approaching();
        if !is_kept || !self.run.automatic.can_resume() {
            return self.run.automatic.suspended.take();
        }
        let automatic = core::mem::take(&mut self.run.automatic);
        let pending = automatic.current.is_some()
            || automatic.next_command.is_some()
            || self.run.interpreter.is_in_block();
        Some(Box::new(SuspendedRun {
            automatic,
            held: self.run.held_motion.take(),
            read_to: pending.then(|| self.run.interpreter.read_state()),
            frame: self.coordinates.frame,
        }))
    }

    /// Restores the AUTO run that was suspended before the MDI blocks.
    fn resume_suspended_run(&mut self) {
        let Some(suspended) = self.run.automatic.suspended.take() else {
            return;
        };
        self.run.interpreter.leave_mdi();
        self.run.automatic = suspended.automatic;
        self.run.held_motion = suspended.held;
        if let Some(read_to) = suspended.read_to {
            let same_frame = self.coordinates.frame == suspended.frame;
            self.run
                .interpreter
                .restore_read_position(&read_to, same_frame);
        }
    }

    fn resume_from_hold(&mut self) {
        self.resume_held_motion();
        self.run.automatic.stop_requested = false;
        self.shift_cycle();
        self.run.automatic.state = RunState::Run;
    }

    /// Whether single block is on; a macro B program can suppress it (#3003).
    pub(crate) const fn is_single_block(&self) -> bool {
        self.plc.signals.single_block && !self.run.registers.off.is_single_block_off()
    }

    /// Handles the feed hold signal, which a macro B program can defer (#3004).
    pub(crate) fn handle_feed_hold_signal(&mut self) {
        if self.run.automatic.state == RunState::Run && self.run.registers.off.is_feed_hold_off() {
            self.run.automatic.hold_deferred = true;
        } else {
            self.start_feed_hold();
        }
    }

    /// Starts feed hold of a running program: the axes decelerate. A block without motion continues
    /// to its end, and so does a thread with the first command after it.
    pub(crate) fn start_feed_hold(&mut self) {
        if self.run.automatic.state == RunState::Run {
            self.run.automatic.state = RunState::Hold;
        } else if self.run.automatic.protection == (HoldProtection::After { again: true }) {
            self.run.automatic.protection = HoldProtection::None;
        }
    }

    /// Advances automatic operation by one tick: handshakes, dwell, checks, and the next
    /// commands.
    pub(crate) fn advance_automatic(&mut self) {
        let fin = self.plc.signals.fin;
        self.run.handshake.tick(fin);
        if !(41..=44).contains(&self.run.handshake.m) {
            // The new gear applies before the next block requests one.
            self.spindle.control.end_gear_change();
        }
        if !self.run.automatic.is_operating() {
            return;
        }
        let waiting_m = self.run.handshake.waiting_m();
        self.run.automatic.update_decoded(waiting_m, fin);
        self.advance_dwell();
        self.run
            .automatic
            .arrival
            .tick(self.plc.signals.speed_arrival);
        self.advance_tap();
        self.check_spindle();
        self.check_board_spindle_fault();
        if !self.run.automatic.is_operating() {
            return;
        }
        self.drives
            .limits
            .set_exact_corners_off(self.run.registers.off.is_exact_stop_off());
        if !self.is_motion_unfinished() {
            self.execute_commands();
        }
        let between_blocks = self.run.automatic.current.is_none()
            && !self.run.automatic.within_block
            && !self.run.automatic.is_hold_protected();
        // Held at a block end; another automatic mode or EDIT turns the hold into a stop.
        if self.run.automatic.state == RunState::Hold
            && between_blocks
            && self.run.automatic.stop_requested
        {
            self.run.automatic.stop_at_block_end();
        }
        self.read_ahead();
    }

    /// Counts the remaining dwell down by one tick. While a command waits for an input that has
    /// the wrong level, restarts its debounce time instead.
    fn advance_dwell(&mut self) {
        let left = self.run.automatic.dwell_left_ms.saturating_sub(1);
        self.run.automatic.dwell_left_ms = match self.run.automatic.current_action() {
            Some(Action::InputWait { input, high }) if !self.has_input_level(*input, *high) => {
                INPUT_LEVEL_MS
            }
            _ => left,
        };
    }

    /// Ends finished commands and starts the next ones, up to a command that takes time.
    fn execute_commands(&mut self) {
        for _ in 0..COMMANDS_PER_TICK {
            if self.run.automatic.current.is_none() && !self.start_next() {
                break;
            }
            if !self.finish_current() {
                break;
            }
        }
    }

    /// Whether the current command is a motion that has not ended: the most frequent case, and
    /// cheap to check.
    fn is_motion_unfinished(&self) -> bool {
        let moves = |current: &CurrentCommand| {
            current.stage == CommandStage::Acting && current.command.action.is_motion()
        };
        !self.drives.interpolator.is_finished()
            && self.run.automatic.current.as_ref().is_some_and(moves)
    }

    /// Starts the next motion in the rest of the tick, if a motion ended within the tick.
    /// Returns whether a motion was started.
    pub(crate) fn start_within_tick(&mut self) -> bool {
        let ended = self.run.automatic.is_operating()
            && self.drives.interpolator.is_finished()
            && self.drives.interpolator.leftover_time() > 0.0;
        if ended {
            self.execute_commands();
        }
        ended && !self.drives.interpolator.is_finished()
    }

    /// Machine time since power-on, s: the end of the last tick, or the time within it at which its
    /// last block ended.
    pub(crate) fn machine_time_s(&self) -> f64 {
        self.ticks as f64 * TICK_S - self.drives.interpolator.leftover_time()
    }

    /// Starts the next command of the program. Returns whether a command is then in execution.
    fn start_next(&mut self) -> bool {
        if !self.run.automatic.can_begin_command() {
            return false;
        }
        if let Some(alarm) = self.run.automatic.fault_ahead.take() {
            self.raise(alarm);
            return false;
        }
        let command = match self.run.automatic.next_command.take() {
            Some(command) => command,
            None => match self.read_command(true) {
                Some(command) => command,
                None => return false,
            },
        };
        if self.end_spoilt_thread(&command.action) {
            return false;
        }
        if self.stops_before(&command) || self.board_delays_command(&command.action) {
            self.run.automatic.next_command = Some(command);
            return false;
        }
        self.start_command(command);
        self.run.automatic.current.is_some()
    }

    /// Reads one command while another runs, so that motion continues without a gap. Under
    /// single block nothing is read ahead, except in a thread.
    pub(crate) fn read_ahead(&mut self) {
        let threading = self.run.automatic.is_threading();
        let can_read = (self.run.automatic.state == RunState::Run || threading)
            && self.run.automatic.current.is_some()
            && self.run.automatic.next_command.is_none()
            && self.run.automatic.fault_ahead.is_none()
            && !self.run.automatic.waits_for_standstill
            && (!self.is_single_block() || threading);
        if can_read {
            self.run.automatic.next_command = self.read_command(false);
        }
    }

    /// Reads one command from the interpreter; `None` if it must wait, the program has ended, or an
    /// alarm was raised. `settled`: all previous commands are finished.
    fn read_command(&mut self, settled: bool) -> Option<ControlCommand> {
        self.read_received_blocks();
        if self.run.automatic.has_ended {
            if settled {
                self.end_program();
            }
            return None;
        }
        let settled = settled && !self.run.handshake.is_busy() && !self.board_delays_reading();
        if self.run.automatic.is_approaching() {
            return settled.then(|| self.next_approach_command()).flatten();
        }
        let slides_stand_still = !self.is_board_lagging();
        let (interpreter, mut world) = self.interpreter_and_world(settled);
        world.slides_stand_still = slides_stand_still;
        let step = interpreter.next(&mut world);
        match step {
            Ok(InterpreterStep::Command(command)) => {
                self.run.automatic.waits_for_standstill = false;
                if let Some(explanations) = &mut self.run.explanations {
                    explanations.push_back(self.run.interpreter.explain());
                }
                Some(*command)
            }
            Ok(InterpreterStep::Wait) => {
                self.run.automatic.waits_for_standstill = true;
                None
            }
            Ok(InterpreterStep::Ended) => {
                self.run.automatic.has_ended = true;
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

    /// Ends an MDI block, or a program without M30 at its end.
    pub(crate) fn end_program(&mut self) {
        let mdi = self.run.automatic.is_mdi;
        let suspended = self.run.automatic.suspended.take();
        self.run.automatic.clear();
        if mdi {
            self.run.mdi.clear();
            self.run.automatic.suspended = suspended;
            self.run.automatic.state = RunState::Stop;
        } else {
            self.run.automatic.state = RunState::Reset;
        }
    }

    /// Returns the interpreter, and the view of the control that the interpreter reads.
    /// `settled`: all previous commands are finished.
    pub(crate) fn interpreter_and_world(
        &mut self,
        settled: bool,
    ) -> (&mut crate::interpreter::Interpreter, ControlHost<'_>) {
        let machine_position = self.drives.interpolator.position();
        (
            &mut self.run.interpreter,
            ControlHost {
                memory: &mut self.memory,
                registers: &mut self.run.registers,
                now_ms: self.ticks,
                plc: self.plc.engine.memory_mut(),
                machine_position,
                referenced: self.coordinates.referenced,
                block_skip: self.plc.signals.block_skip,
                settled,
                slides_stand_still: true,
                cursor_line: self.run.cursor_line,
            },
        )
    }
}
