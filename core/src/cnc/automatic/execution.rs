//! Executes one command at a time: starts it, ends it, decides what follows.
//!
//! M, S and T start together. The motion waits for the FIN of a T, but not for that of M
//! and S. The block ends when motion and handshake are both done.

use std::collections::VecDeque;

use crate::alarm::{Alarm, number};
use crate::cnc::{Cnc, Event};
use crate::command::{Action, Command, Conditions, ExecutedMove, MoveKind, SpindleCommand};
use crate::memory::SwitchedOff;
use crate::motion::ThreadMove;
use crate::operation::{
    AfterThread, Current, Protection, RunState, Stage, Strobe, TapStage, is_cut,
};
use crate::units::{Axis, Feed, PerAxis, Point, TICK_MS};

use super::LEVEL_MS;
use gsk_messages::say;

/// Whether the M code has a decode signal and is output under the auxiliary lock, as M00
/// and M30 are: M01 and M02 of the machine's ladder (manual PLC-II 8.1, 8.2).
const fn is_decoded(code: u8) -> bool {
    matches!(code, 1 | 2)
}

impl Cnc {
    /// Starts a command.
    pub(crate) fn begin(&mut self, command: Command) {
        let command = self.run.automatic.cycle_shift.begin(command);
        self.run.modal = command.modal;
        if !self.run.automatic.within_block {
            self.events
                .push(Event::BlockBegan(command.source, command.modal));
        }
        let explanation = self
            .run
            .explanations
            .as_mut()
            .and_then(VecDeque::pop_front)
            .flatten();
        self.events.extend(explanation.map(Event::Explained));
        self.run.automatic.protect(&command.action);
        self.await_speed(&command.action);
        self.run.automatic.last = Some(command.source);
        let from = self.drives.interpolator.commanded();
        let started = self.now();
        let stage = match self.act(&command) {
            Ok(stage) => stage,
            Err(alarm) => return self.raise(alarm.at(command.source)),
        };
        self.run.automatic.waiting = false;
        self.run.automatic.current = Some(Current {
            command,
            stage,
            from,
            started,
        });
        let over =
            !self.drives.limits.exact_corners() && self.run.automatic.action().is_some_and(is_cut);
        if self.run.automatic.threading() || over {
            // Whether it slows down at its end depends on the next command.
            self.read_ahead();
            self.check_thread_ahead();
        }
    }

    fn act(&mut self, command: &Command) -> Result<Stage, Alarm> {
        self.check_for_board(&command.action)?;
        match &command.action {
            Action::Rapid { to } => {
                self.check_gear_before(MoveKind::Rapid, *to, Feed::PerMinute(0.0))?;
                self.drives
                    .interpolator
                    .start_rapid(*to, &self.drives.limits);
                Ok(Stage::Acting)
            }
            Action::Line { to, feed } => {
                self.check_feed(*feed)?;
                self.check_gear_before(MoveKind::Feed, *to, *feed)?;
                self.drives.interpolator.start_line(*to, *feed);
                Ok(Stage::Acting)
            }
            Action::Arc {
                to,
                center,
                clockwise,
                feed,
            } => {
                self.check_feed(*feed)?;
                self.check_gear_before(MoveKind::arc(*clockwise), *to, *feed)?;
                self.drives
                    .interpolator
                    .start_arc(*to, *center, *clockwise, *feed);
                Ok(Stage::Acting)
            }
            thread @ Action::Thread { .. } => {
                if let Some(thread) = ThreadMove::of(thread) {
                    self.begin_thread(&thread)?;
                }
                Ok(Stage::Acting)
            }
            Action::ThreadCycle { per_revolution, .. } => {
                self.check_thread_cycle(*per_revolution)?;
                Ok(Stage::Acting)
            }
            Action::Tap { to, lead, .. } => {
                self.begin_tap(*to, *lead)?;
                Ok(Stage::Acting)
            }
            Action::Dwell { ms } => {
                self.run.automatic.dwell_left = *ms;
                Ok(Stage::Acting)
            }
            Action::ZeroReturn { x, z } => {
                self.begin_zero_return(*x, *z)?;
                Ok(Stage::Acting)
            }
            Action::Referenced { x, z } => {
                // Under machine lock the slides are not at the reference point (manual
                // I-3.2.7).
                let locked = self.plc.signals.machine_lock;
                for (axis, taken) in [(Axis::X, *x), (Axis::Z, *z)] {
                    if taken && !locked.get(axis) {
                        *self.coordinates.referenced.get_mut(axis) = true;
                        let at = self.position().get(axis);
                        *self.coordinates.at_reference.get_mut(axis) = Some(at);
                    }
                }
                Ok(Stage::Acting)
            }
            Action::Frame {
                frame,
                program_zero,
                relative,
            } => {
                let shown_before = self.relative_base();
                let moved = frame.zero != self.coordinates.frame.zero;
                self.coordinates.frame = *frame;
                if let Some(point) = program_zero {
                    self.coordinates.program_zero = Some(*point);
                    self.coordinates.program_zero_ended = PerAxis::default();
                }
                // The relative display follows an offset by PROD, a G50 by PPD.
                if moved {
                    let shown = self.relative_base();
                    self.coordinates.relative_zero = if *relative {
                        Point::default()
                    } else {
                        self.coordinates.relative_zero + shown - shown_before
                    };
                }
                Ok(Stage::Acting)
            }
            Action::Miscellaneous { code } => {
                self.output_m(*code);
                Ok(Stage::Acting)
            }
            Action::Outputs { on, off, ms } => {
                if !self.plc.signals.auxiliary_lock {
                    self.switch_outputs(*on, *off, *ms);
                }
                Ok(Stage::Acting)
            }
            Action::InputWait { .. } => {
                self.run.automatic.dwell_left = LEVEL_MS;
                Ok(Stage::Acting)
            }
            Action::Spindle(spindle) => {
                self.output_s(*spindle);
                Ok(Stage::Acting)
            }
            Action::Tool { tool, offset, .. } => {
                self.run.tool = (*tool, *offset);
                // An M of the same block does not delay the motion when no tool is changed.
                Ok(match self.output_t(*tool) {
                    true => Stage::Handshake,
                    false => Stage::Acting,
                })
            }
            Action::ProgramStop => {
                self.run.automatic.decoded = Some(0);
                self.run.handshake.start(Strobe::M, 0);
                Ok(Stage::Handshake)
            }
            Action::End { m30: true, .. } => {
                self.run.automatic.decoded = Some(30);
                self.run.handshake.start(Strobe::M, 30);
                Ok(Stage::Handshake)
            }
            Action::Macro => {
                self.run.automatic.dwell_left = TICK_MS;
                Ok(Stage::Acting)
            }
            Action::End { .. } | Action::Repeat | Action::Nothing => Ok(Stage::Acting),
        }
    }

    /// A cut per revolution needs a turning spindle (alarm 011).
    fn check_feed(&self, feed: Feed) -> Result<(), Alarm> {
        if matches!(feed, Feed::PerRevolution(_)) && !self.plc.signals.dry_run {
            self.check_encoder()?;
        }
        let standing = matches!(feed, Feed::PerRevolution(_))
            && !self.plc.signals.dry_run
            && self.spindle.control.actual_rpm().abs() < 1.0;
        if standing {
            return Err(Alarm::new(number::NO_FEED).because(say::spindle_stands_at_feed()));
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

    /// Outputs T for a tool that is not in position, if there is a turret. Returns whether
    /// it did.
    fn output_t(&mut self, tool: u8) -> bool {
        let turns = tool != 0
            && tool != self.plc.signals.current_tool
            && self.memory.parameters.stations() > 0
            && !self.plc.signals.auxiliary_lock;
        if turns {
            self.run.handshake.start(Strobe::T, tool);
        }
        turns
    }

    /// Ends the command under way if it is finished. Returns whether it ended.
    pub(crate) fn finish_current(&mut self) -> bool {
        let board_behind = self.is_board_behind();
        let Some(current) = &mut self.run.automatic.current else {
            return false;
        };
        if current.stage == Stage::Acting {
            // Motion suspended for manual motion is not finished.
            let moving = !self.drives.interpolator.finished() || self.run.held.is_some();
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
            let comes_to_rest = current.command.stop_point
                && self.plc.signals.single_block
                && !self.run.registers.off.single_block();
            if self.run.automatic.dwell_left > 0 || motion || (comes_to_rest && board_behind) {
                return false;
            }
            if current.command.block_end {
                current.stage = Stage::Handshake;
            }
        }
        let waits = !self.run.registers.off.completion();
        if current.stage == Stage::Handshake && waits && self.run.handshake.busy() {
            return false;
        }
        let Some(current) = self.run.automatic.current.take() else {
            return false;
        };
        self.report(&current);
        self.run.automatic.decoded = None;
        if current.command.block_end && current.command.modal.offset == 0 {
            // A return to the reference point has ended the offset.
            self.run.tool.1 = 0;
        }
        self.run.automatic.within_block = !current.command.block_end;
        // The end of a text without M30 is not a block.
        let is_block = !matches!(current.command.action, Action::End { m30: false, .. });
        if current.command.block_end && is_block {
            self.events.push(Event::BlockEnded(current.command.source));
        }
        let at = self.position();
        self.run.automatic.cycle_shift.ended(&current.command, at);
        self.after(&current.command);
        true
    }

    /// Decides what follows a finished command: stop, end, part count.
    fn after(&mut self, command: &Command) {
        match command.action {
            Action::ProgramStop => return self.run.automatic.state = RunState::Stop,
            Action::End { counts, m30, m02 } => {
                self.program_end(counts);
                return self.events.push(Event::ProgramEnded { m30, m02 });
            }
            Action::Repeat => self.count_part(),
            _ => {}
        }
        let single_block = command.stop_point && self.single_block();
        match self.run.automatic.after_thread(command, single_block) {
            Some(AfterThread::GoesOn) => return,
            Some(AfterThread::Stops) => return self.stop_after_command(command),
            // The motion goes no farther: the hold takes effect here.
            Some(AfterThread::Stands) => return self.run.automatic.protection = Protection::None,
            None => {}
        }
        let held = self.run.automatic.state == RunState::Hold;
        let stops = single_block
            || command.block_end && self.takes_up_hold()
            || command.block_end
                && (self.run.automatic.stop_requested || held && self.ends_hold(command));
        if stops {
            self.stop_after_command(command);
        } else if held && (command.block_end || matches!(command.action, Action::Tap { .. })) {
            self.run.automatic.protection = Protection::None;
        }
    }

    /// Handles a feed hold that #3004 has deferred. At the end of a block the run stops as
    /// in single block while the button is held. Once #3004 permits it, the hold begins.
    /// Returns whether the run stops.
    fn takes_up_hold(&mut self) -> bool {
        if !self.run.automatic.hold_put_off {
            return false;
        }
        let off = self.run.registers.off;
        if !off.feed_hold() {
            self.run.automatic.hold_put_off = false;
            self.feed_hold();
            return false;
        }
        let stops = self.plc.signals.feed_hold && !off.single_block();
        self.run.automatic.hold_put_off &= !stops;
        stops
    }

    /// Whether a hold ends with its block: a block of M, S and T alone becomes a stop
    /// (manual PLC-II 6.1), and after the MDI block there is nothing to hold.
    fn ends_hold(&self, command: &Command) -> bool {
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
        functions || self.run.automatic.mdi
    }

    /// Stops the run: an MDI block ends with its last command, a program stays at its next
    /// block.
    fn stop_after_command(&mut self, command: &Command) {
        if self.run.automatic.mdi && command.block_end {
            self.run.interpreter.leave_mdi();
            return self.end_of_program();
        }
        self.run.automatic.stop();
    }

    fn count_part(&mut self) {
        self.memory.counters.count_part();
        self.events.push(Event::PartFinished);
    }

    fn program_end(&mut self, counts: bool) {
        if counts {
            self.count_part();
        }
        let rewind = self.memory.parameters.m30_rewinds();
        let end = self.run.automatic.last.map(|source| source.line);
        self.run.automatic.clear();
        self.run.registers.off = SwitchedOff::default();
        let (interpreter, world) = self.interpreter_and_world(true);
        interpreter.reset(&world);
        self.run.modal = *self.run.interpreter.modal();
        if self.memory.programs.inflow().is_some() {
            // The selected program is not the one that ran.
        } else if rewind {
            self.run.cursor_line = 1;
        } else {
            self.run.cursor_line = end.unwrap_or(self.run.cursor_line);
            self.run.rewind_at_start = true;
        }
    }

    /// Reports an executed or interrupted move.
    fn report(&mut self, current: &Current) {
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
                    Some(self.coordinates.frame.program(center)),
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
        self.events.push(Event::Moved(ExecutedMove {
            source: current.command.source,
            kind,
            from: self.coordinates.frame.program(current.from),
            to: self
                .coordinates
                .frame
                .program(self.drives.interpolator.commanded()),
            center,
            feed,
            start_s: current.started,
            duration_s: (self.now() - current.started).max(0.0),
            conditions: Conditions::of(
                &current.command,
                &self.coordinates.frame,
                self.spindle.control.actual_rpm(),
            ),
        }));
    }

    /// Reports the way in of a tap. Returns its start point; the next report begins here.
    pub(crate) fn report_half(&mut self) -> Point {
        let position = self.drives.interpolator.position();
        let Some(mut current) = self.run.automatic.current.take() else {
            return position;
        };
        self.report(&current);
        let from = core::mem::replace(&mut current.from, position);
        current.started = self.now();
        self.run.automatic.current = Some(current);
        from
    }

    /// Reports the executed part of an interrupted motion.
    pub(crate) fn abandon_current(&mut self) {
        if let Some(current) = self.run.automatic.current.take() {
            self.report(&current);
        }
    }
}
