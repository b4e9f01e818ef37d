//! Executes one command of the program at a time: starts it, ends it, and decides what follows.
//!
//! M, S and T start together. The motion waits for the FIN of a T, but not for that of M
//! and S. The block ends when motion and handshake are both done.

use std::collections::VecDeque;

use crate::alarm::{Alarm, number};
use crate::cnc::{Cnc, Event};
use crate::command::{
    Action, ControlCommand, ExecutedMove, Frame, MoveConditions, MoveKind, SpindleCommand,
};
use crate::memory::SwitchedOff;
use crate::motion::ThreadMove;
use crate::operation::{
    AfterThread, CommandStage, CurrentCommand, HoldProtection, RunState, Strobe, TapStage, is_cut,
};
use crate::units::{Axis, Feed, PerAxis, Point, TICK_MS};

use super::INPUT_LEVEL_MS;
use gsk_messages::say;

/// Whether the M code has a decode signal and is output under the auxiliary lock, as M00
/// and M30 are: M01 and M02 of the machine's ladder (manual PLC-II 8.1, 8.2).
const fn is_decoded(code: u8) -> bool {
    matches!(code, 1 | 2)
}

impl Cnc {
    /// Starts a command: reports it, begins its motion or function, and makes it the current
    /// command.
    pub(crate) fn start_command(&mut self, command: ControlCommand) {
        let command = self.run.automatic.cycle_shift.shift_command(command);
        self.run.modal = command.modal;
        let is_approach = self.run.automatic.is_approaching();
        if !self.run.automatic.within_block && !is_approach {
            self.events
                .push(Event::BlockStarted(command.source, command.modal));
        }
        let explanation = self
            .run
            .explanations
            .as_mut()
            .and_then(VecDeque::pop_front)
            .flatten();
        self.events.extend(explanation.map(Event::Explained));
        self.run.automatic.update_protection(&command.action);
        self.limit_retrace(&command.action);
        self.update_speed_arrival(&command.action);
        if !is_approach {
            self.run.automatic.last_source = Some(command.source);
        }
        let from = self.drives.interpolator.commanded();
        let start_s = self.machine_time_s();
        let stage = match self.execute(&command) {
            Ok(stage) => stage,
            Err(alarm) => return self.raise(alarm.with_source(command.source)),
        };
        self.run.automatic.waits_for_standstill = false;
        self.run.automatic.current = Some(CurrentCommand {
            command,
            stage,
            from,
            start_s,
        });
        let is_rounded_cut = !self.drives.limits.has_exact_corners()
            && self.run.automatic.current_action().is_some_and(is_cut);
        if self.run.automatic.is_threading() || is_rounded_cut {
            // Whether it slows down at its end depends on the next command.
            self.read_ahead();
            self.check_thread_ahead();
        }
    }

    fn execute(&mut self, command: &ControlCommand) -> Result<CommandStage, Alarm> {
        self.check_for_board(&command.action)?;
        match &command.action {
            Action::Rapid { .. } | Action::Line { .. } | Action::Arc { .. } => {
                self.start_path_move(&command.action)?;
            }
            thread @ Action::Thread { .. } => {
                if let Some(thread) = ThreadMove::from_action(thread) {
                    self.start_thread(&thread)?;
                }
            }
            Action::ThreadCycle { per_revolution, .. } => {
                self.check_thread_cycle(*per_revolution)?;
            }
            Action::Tap { to, lead, .. } => self.start_tap(*to, *lead)?,
            Action::Dwell { ms } => self.run.automatic.dwell_left_ms = *ms,
            Action::ZeroReturn { x, z } => self.start_zero_return(*x, *z)?,
            Action::Referenced { x, z } => self.record_reference(PerAxis::new(*x, *z)),
            Action::Frame {
                frame,
                program_zero,
                relative,
            } => self.change_frame(*frame, *program_zero, *relative),
            Action::Miscellaneous { code } => self.output_m(*code),
            Action::Outputs { on, off, ms } => {
                if !self.plc.signals.auxiliary_lock {
                    self.switch_outputs(*on, *off, *ms);
                }
            }
            Action::InputWait { .. } => self.run.automatic.dwell_left_ms = INPUT_LEVEL_MS,
            Action::Spindle(spindle) => self.output_s(*spindle),
            Action::Tool { tool, offset, .. } => {
                self.run.tool = (*tool, *offset);
                // An M of the same block does not delay the motion when no tool is changed.
                return Ok(match self.output_t(*tool) {
                    true => CommandStage::Handshake,
                    false => CommandStage::Acting,
                });
            }
            Action::ProgramStop => return Ok(self.start_decoded_m(0)),
            Action::End { m30: true, .. } => return Ok(self.start_decoded_m(30)),
            Action::Macro => self.run.automatic.dwell_left_ms = TICK_MS,
            Action::End { .. } | Action::Repeat | Action::Nothing => {}
        }
        Ok(CommandStage::Acting)
    }

    /// Starts a rapid, a straight or a circular cut.
    ///
    /// # Errors
    /// The alarm of a cut without feed or of an axis that would be too fast for its gear.
    #[inline]
    fn start_path_move(&mut self, action: &Action) -> Result<(), Alarm> {
        match action {
            Action::Rapid { to } => {
                self.check_gear_before_move(MoveKind::Rapid, *to, Feed::PerMinute(0.0))?;
                self.drives
                    .interpolator
                    .start_rapid(*to, &self.drives.limits);
            }
            Action::Line { to, feed } => {
                self.check_feed(*feed)?;
                self.check_gear_before_move(MoveKind::Feed, *to, *feed)?;
                self.drives.interpolator.start_line(*to, *feed);
            }
            Action::Arc {
                to,
                center,
                clockwise,
                feed,
            } => {
                self.check_feed(*feed)?;
                self.check_gear_before_move(MoveKind::arc(*clockwise), *to, *feed)?;
                self.drives
                    .interpolator
                    .start_arc(*to, *center, *clockwise, *feed);
            }
            _ => {}
        }
        Ok(())
    }

    /// Records that axes are at their reference point. Under machine lock the slides are
    /// not at it (manual I-3.2.7).
    fn record_reference(&mut self, axes: PerAxis<bool>) {
        let locked = self.plc.signals.machine_lock;
        for axis in [Axis::X, Axis::Z] {
            if *axes.get(axis) && !locked.get(axis) {
                *self.coordinates.referenced.get_mut(axis) = true;
                let at = self.position().get(axis);
                *self.coordinates.at_reference.get_mut(axis) = Some(at);
            }
        }
    }

    /// Puts a new coordinate frame into force. When the work zero moves, the relative coordinates
    /// become the absolute ones if `is_relative_cleared` (PPD); otherwise they keep their values.
    /// `program_zero` is the new program zero, machine coordinates, mm; `None` if it stays.
    fn change_frame(
        &mut self,
        frame: Frame,
        program_zero: Option<Point>,
        is_relative_cleared: bool,
    ) {
        let relative_before = self.relative_base();
        let moved = frame.zero != self.coordinates.frame.zero;
        self.coordinates.frame = frame;
        if let Some(point) = program_zero {
            self.coordinates.program_zero = Some(point);
            self.coordinates.program_zero_ended = PerAxis::default();
        }
        if moved {
            let relative_after = self.relative_base();
            self.coordinates.relative_zero = if is_relative_cleared {
                Point::default()
            } else {
                self.coordinates.relative_zero + relative_after - relative_before
            };
        }
    }

    /// Outputs the decode signal and the strobe of M00 or M30. Returns the stage of the command,
    /// which waits for FIN.
    fn start_decoded_m(&mut self, code: u8) -> CommandStage {
        self.run.automatic.decoded_m = Some(code);
        self.run.handshake.start(Strobe::M, code);
        CommandStage::Handshake
    }

    /// Returns an alarm as error if a cut with feed per revolution cannot begin: 092 for
    /// the encoder, 011 for a spindle at standstill.
    fn check_feed(&self, feed: Feed) -> Result<(), Alarm> {
        if matches!(feed, Feed::PerRevolution(_)) && !self.plc.signals.dry_run {
            self.check_encoder()?;
        }
        let spindle_stands_still = matches!(feed, Feed::PerRevolution(_))
            && !self.plc.signals.dry_run
            && self.spindle.control.actual_rpm().abs() < 1.0;
        if spindle_stands_still {
            return Err(Alarm::new(number::NO_FEED).with_detail(say::spindle_stands_at_feed()));
        }
        Ok(())
    }

    pub(in crate::cnc) fn output_m(&mut self, code: u8) {
        // M01 and M02 are output under the lock too, as M00 and M30 are.
        if self.plc.signals.auxiliary_lock && !is_decoded(code) {
            return;
        }
        // No change to a gear that is already engaged (manual IV-2.8.6).
        if !(41..=44).contains(&code) || self.spindle.control.begin_gear_change(code - 40) {
            self.run.handshake.start(Strobe::M, code);
        }
    }

    fn output_s(&mut self, spindle: SpindleCommand) {
        match spindle {
            SpindleCommand::Step(step) if !self.plc.signals.auxiliary_lock => {
                self.run.handshake.start(Strobe::S, step);
            }
            SpindleCommand::Step(_) => {}
            analog => self.output_analog_s(analog),
        }
    }

    /// Outputs the S code of an analog spindle on F22–F25, without a strobe.
    fn output_analog_s(&mut self, spindle: SpindleCommand) {
        self.spindle.control.command(spindle);
        if let SpindleCommand::Speed(word) | SpindleCommand::Surface(word) = spindle
            && !self.plc.signals.auxiliary_lock
        {
            self.run.handshake.s = word as u32;
        }
    }

    /// Outputs the T code if there is a turret and the tool is not in position. Returns whether it
    /// was output.
    fn output_t(&mut self, tool: u8) -> bool {
        let needs_change = tool != 0
            && tool != self.plc.signals.current_tool
            && self.memory.parameters.station_count() > 0
            && !self.plc.signals.auxiliary_lock;
        if needs_change {
            self.run.handshake.start(Strobe::T, tool);
        }
        needs_change
    }

    /// Ends the current command if its motion and its M, S or T function are finished. Returns
    /// whether the command has ended.
    pub(crate) fn finish_current(&mut self) -> bool {
        let board_lags = self.is_board_lagging();
        let Some(current) = &mut self.run.automatic.current else {
            return false;
        };
        if current.stage == CommandStage::Acting {
            // Motion suspended for manual motion is not finished.
            let moving = !self.drives.interpolator.is_finished() || self.run.held_motion.is_some();
            let motion = match current.command.action {
                Action::Rapid { .. }
                | Action::Line { .. }
                | Action::Arc { .. }
                | Action::Thread { .. } => moving,
                Action::Tap { .. } => self.run.automatic.tap != Some(TapStage::Done) || moving,
                Action::ZeroReturn { .. } => {
                    self.coordinates.returns.x.is_some() || self.coordinates.returns.z.is_some()
                }
                _ => false,
            };
            let stops_after = current.command.stop_point
                && self.plc.signals.single_block
                && !self.run.registers.off.is_single_block_off();
            if self.run.automatic.dwell_left_ms > 0 || motion || (stops_after && board_lags) {
                return false;
            }
            if current.command.block_end {
                current.stage = CommandStage::Handshake;
            }
        }
        let waits = !self.run.registers.off.is_completion_wait_off();
        if current.stage == CommandStage::Handshake && waits && self.run.handshake.is_busy() {
            return false;
        }
        let Some(current) = self.run.automatic.current.take() else {
            return false;
        };
        self.report_move(&current);
        self.run.automatic.decoded_m = None;
        if current.command.block_end && current.command.modal.offset == 0 {
            // A return to the reference point has ended the offset.
            self.run.tool.1 = 0;
        }
        self.run.automatic.within_block = !current.command.block_end;
        // The end of a text without M30 is not a block.
        let is_block = !matches!(current.command.action, Action::End { m30: false, .. })
            && !self.run.automatic.is_approaching();
        if current.command.block_end && is_block {
            self.events.push(Event::BlockEnded(current.command.source));
        }
        let at = self.position();
        self.run
            .automatic
            .cycle_shift
            .note_end(&current.command, at);
        self.decide_next(&current.command);
        true
    }

    /// Decides whether a finished command is followed by the next command, a stop, or the end of
    /// the program.
    fn decide_next(&mut self, command: &ControlCommand) {
        match command.action {
            Action::ProgramStop => return self.run.automatic.state = RunState::Stop,
            Action::End { counts, m30, m02 } => {
                self.finish_program(counts);
                return self.events.push(Event::ProgramEnded { m30, m02 });
            }
            Action::Repeat => self.count_part(),
            _ => {}
        }
        let single_block = command.stop_point && self.is_single_block();
        match self.run.automatic.after_thread(command, single_block) {
            Some(AfterThread::Continue) => return,
            Some(AfterThread::Stop) => return self.stop_after_command(command),
            // The motion goes no farther: the hold takes effect here.
            Some(AfterThread::Hold) => return self.run.automatic.protection = HoldProtection::None,
            None => {}
        }
        let held = self.run.automatic.state == RunState::Hold;
        let stops_here = single_block
            || command.block_end && self.apply_deferred_hold()
            || command.block_end
                && (self.run.automatic.stop_requested || held && self.is_hold_ended_by(command));
        if stops_here {
            self.stop_after_command(command);
        } else if held && (command.block_end || matches!(command.action, Action::Tap { .. })) {
            self.run.automatic.protection = HoldProtection::None;
        }
    }

    /// Handles a feed hold that #3004 has deferred, at the end of a block: while #3004 still
    /// forbids it, the run stops as in single block if the button is held; otherwise the hold
    /// begins. Returns whether the run stops.
    fn apply_deferred_hold(&mut self) -> bool {
        if !self.run.automatic.hold_deferred {
            return false;
        }
        let off = self.run.registers.off;
        if !off.is_feed_hold_off() {
            self.run.automatic.hold_deferred = false;
            self.start_feed_hold();
            return false;
        }
        let stops_here = self.plc.signals.feed_hold && !off.is_single_block_off();
        self.run.automatic.hold_deferred &= !stops_here;
        stops_here
    }

    /// Whether a hold becomes a stop at the end of this command: if the block consists of
    /// M, S and T alone (manual PLC-II 6.1), and at the end of the MDI block.
    fn is_hold_ended_by(&self, command: &ControlCommand) -> bool {
        let functions = matches!(
            command.action,
            Action::Miscellaneous { .. }
                | Action::Spindle(_)
                | Action::Tool { .. }
                // The offset of a T.
                | Action::Frame {
                    program_zero: None,
                    ..
                }
        );
        functions || self.run.automatic.is_mdi
    }

    /// Stops the run after `command`. An MDI block ends with its last command; a program can be
    /// resumed at its next block.
    fn stop_after_command(&mut self, command: &ControlCommand) {
        if self.run.automatic.is_mdi && command.block_end {
            self.run.interpreter.leave_mdi();
            return self.end_program();
        }
        self.run.automatic.stop_at_block_end();
    }

    fn count_part(&mut self) {
        self.memory.counters.count_part();
        self.events.push(Event::PartFinished);
    }

    fn finish_program(&mut self, counts: bool) {
        if counts {
            self.count_part();
        }
        let rewind = self.memory.parameters.m30_rewinds();
        let end = self.run.automatic.last_source.map(|source| source.line);
        self.run.automatic.clear();
        self.run.registers.off = SwitchedOff::default();
        let (interpreter, world) = self.interpreter_and_world(true);
        interpreter.reset(&world);
        self.run.modal = *self.run.interpreter.modal();
        if self.memory.programs.dnc_buffer().is_some() {
            // The selected program is not the one that ran.
        } else if rewind {
            self.run.cursor_line = 1;
        } else {
            self.run.cursor_line = end.unwrap_or(self.run.cursor_line);
            self.run.rewind_at_start = true;
        }
    }

    /// Reports an executed or interrupted move as an event.
    fn report_move(&mut self, current: &CurrentCommand) {
        let (kind, center, feed) = match current.command.action {
            Action::Rapid { .. } | Action::ZeroReturn { .. } => (MoveKind::Rapid, None, None),
            Action::Line { feed, .. } => (MoveKind::Feed, None, Some(feed)),
            Action::Arc {
                center,
                clockwise,
                feed,
                ..
            } => {
                let kind = MoveKind::arc(clockwise);
                (
                    kind,
                    Some(self.coordinates.frame.to_program(center)),
                    Some(feed),
                )
            }
            Action::Thread { lead, run_out, .. } => {
                let kind = if run_out {
                    MoveKind::RunOut
                } else {
                    MoveKind::Thread
                };
                (kind, None, Some(Feed::PerRevolution(lead)))
            }
            Action::Tap { lead, .. } => (MoveKind::Thread, None, Some(Feed::PerRevolution(lead))),
            Action::Dwell { ms: 1.. } => (MoveKind::Dwell, None, None),
            _ => return,
        };
        self.events.push(Event::MoveEnded(ExecutedMove {
            source: current.command.source,
            kind,
            from: self.coordinates.frame.to_program(current.from),
            to: self
                .coordinates
                .frame
                .to_program(self.drives.interpolator.commanded()),
            center,
            feed,
            start_s: current.start_s,
            duration_s: (self.machine_time_s() - current.start_s).max(0.0),
            conditions: MoveConditions::from_command(
                &current.command,
                &self.coordinates.frame,
                self.spindle.control.actual_rpm(),
            ),
        }));
    }

    /// Reports the inward motion of a tap as a move. Returns the start point of that move, mm; the
    /// next reported move begins at the current position.
    pub(crate) fn report_tap_half(&mut self) -> Point {
        let position = self.drives.interpolator.position();
        let Some(mut current) = self.run.automatic.current.take() else {
            return position;
        };
        self.report_move(&current);
        let from = core::mem::replace(&mut current.from, position);
        current.start_s = self.machine_time_s();
        self.run.automatic.current = Some(current);
        from
    }

    /// Drops the current command, and reports the executed part of its move.
    pub(crate) fn abandon_current(&mut self) {
        if let Some(current) = self.run.automatic.current.take() {
            self.report_move(&current);
        }
    }
}
