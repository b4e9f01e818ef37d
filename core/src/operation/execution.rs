//! One command at a time: what it starts, when it is finished, what follows it.
//!
//! T comes before all else of its block and waits for FIN; M and S start together
//! with the motion; the block ends when motion and handshake are both done.

use std::collections::VecDeque;

use super::automatic::{Current, RunState, Stage, is_cut};
use super::handshake::Strobe;
use super::thread::{Protection, TapStage};
use crate::alarm::Alarm;
use crate::cnc::{Cnc, Event};
use crate::command::{Action, Command, ExecutedMove, MoveKind, SpindleCommand, Timing};
use crate::motion::ThreadMove;
use crate::units::{Axis, Feed, Point, TICK_MS};

impl Cnc {
    /// Starts a command.
    pub(super) fn begin(&mut self, command: Command) {
        let command = self.automatic.cycle_shift.begin(command);
        self.modal = command.modal;
        if !self.automatic.within_block {
            self.events
                .push(Event::BlockBegan(command.source, command.modal));
        }
        let explanation = self
            .explanations
            .as_mut()
            .and_then(VecDeque::pop_front)
            .flatten();
        self.events.extend(explanation.map(Event::Explained));
        self.automatic.protect(&command.action);
        self.await_speed(&command.action);
        self.automatic.last = Some(command.source);
        let from = self.interpolator.commanded();
        let started = self.now();
        let stage = match self.act(&command) {
            Ok(stage) => stage,
            Err(alarm) => return self.raise(alarm.at(command.source)),
        };
        self.automatic.waiting = false;
        self.automatic.current = Some(Current {
            command,
            stage,
            from,
            started,
        });
        let over = !self.limits.exact_corners() && self.automatic.action().is_some_and(is_cut);
        if self.automatic.threading() || over {
            // Whether it slows down at its end depends on what follows.
            self.read_ahead();
            self.check_thread_ahead();
        }
    }

    fn act(&mut self, command: &Command) -> Result<Stage, Alarm> {
        self.check_for_board(&command.action)?;
        match &command.action {
            Action::Rapid { to } => {
                self.check_gear_before(MoveKind::Rapid, *to, Feed::PerMinute(0.0))?;
                self.interpolator.start_rapid(*to);
                Ok(Stage::Acting)
            }
            Action::Line { to, feed } => {
                self.check_feed(*feed)?;
                self.check_gear_before(MoveKind::Feed, *to, *feed)?;
                self.interpolator.start_line(*to, *feed);
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
                self.interpolator.start_arc(*to, *center, *clockwise, *feed);
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
                self.automatic.dwell_left = *ms;
                Ok(Stage::Acting)
            }
            Action::ZeroReturn { x, z } => {
                self.begin_zero_return(*x, *z)?;
                Ok(Stage::Acting)
            }
            Action::Referenced { x, z } => {
                // Under machine lock the slides are not there (manual I-3.2.7).
                let locked = self.from_plc.machine_lock;
                for (axis, taken) in [(Axis::X, *x), (Axis::Z, *z)] {
                    if taken && !locked.get(axis) {
                        *self.referenced.get_mut(axis) = true;
                        let at = self.position().get(axis);
                        *self.at_reference.get_mut(axis) = Some(at);
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
                let moved = frame.zero != self.frame.zero;
                self.frame = *frame;
                if let Some(point) = program_zero {
                    self.program_zero = Some(*point);
                }
                // An offset shows in the relative display by PROD, a G50 with PPD.
                if moved {
                    let shown = self.relative_base();
                    self.relative_zero = if *relative {
                        Point::default()
                    } else {
                        self.relative_zero + shown - shown_before
                    };
                }
                Ok(Stage::Acting)
            }
            Action::Miscellaneous { code, timing } => {
                self.output_m(*code);
                Ok(match timing {
                    Timing::WithMotion => Stage::Acting,
                    Timing::BeforeMotion => Stage::Handshake,
                })
            }
            Action::Spindle(spindle) => {
                self.output_s(*spindle);
                Ok(Stage::Acting)
            }
            Action::Tool { tool, offset } => {
                self.tool = (*tool, *offset);
                self.output_t(*tool);
                Ok(Stage::Handshake)
            }
            Action::ProgramStop => {
                self.automatic.decoded = Some(0);
                self.handshake.start(Strobe::M, 0);
                Ok(Stage::Handshake)
            }
            Action::End { m30: true, .. } => {
                self.automatic.decoded = Some(30);
                self.handshake.start(Strobe::M, 30);
                Ok(Stage::Handshake)
            }
            Action::Macro => {
                self.automatic.dwell_left = TICK_MS;
                Ok(Stage::Acting)
            }
            Action::End { .. } | Action::Repeat | Action::Nothing => Ok(Stage::Acting),
        }
    }

    /// A cut per revolution needs a turning spindle (alarm 011).
    fn check_feed(&self, feed: Feed) -> Result<(), Alarm> {
        if matches!(feed, Feed::PerRevolution(_)) && !self.from_plc.dry_run {
            self.check_encoder()?;
        }
        let standing = matches!(feed, Feed::PerRevolution(_))
            && !self.from_plc.dry_run
            && self.spindle.actual_rpm().abs() < 1.0;
        if standing {
            return Err(Alarm::new(11).because("feed per revolution (G99) with a standing spindle"));
        }
        Ok(())
    }

    fn output_m(&mut self, code: u8) {
        if self.from_plc.auxiliary_lock {
            return;
        }
        // A gear that is engaged already is not changed to (manual IV-2.8.6).
        if !(41..=44).contains(&code) || self.spindle.begin_gear_change(code - 40) {
            self.handshake.start(Strobe::M, code);
        }
    }

    fn output_s(&mut self, spindle: SpindleCommand) {
        match spindle {
            SpindleCommand::Step(step) if !self.from_plc.auxiliary_lock => {
                self.handshake.start(Strobe::S, step);
            }
            SpindleCommand::Step(_) => {}
            analog => self.output_analog_s(analog),
        }
    }

    /// S of an analog spindle stands on F22–F25, without a strobe.
    fn output_analog_s(&mut self, spindle: SpindleCommand) {
        self.spindle.command(spindle);
        if let SpindleCommand::Speed(word) | SpindleCommand::Surface(word) = spindle
            && !self.from_plc.auxiliary_lock
        {
            self.handshake.s = word as u32;
        }
    }

    /// T goes out only for a tool that is not in position, and only to a turret.
    fn output_t(&mut self, tool: u8) {
        let turns = tool != 0
            && tool != self.from_plc.current_tool
            && self.parameters.stations() > 0
            && !self.from_plc.auxiliary_lock;
        if turns {
            self.handshake.start(Strobe::T, tool);
        }
    }

    /// Ends the command under way if it is finished. Returns whether it ended.
    pub(super) fn finish_current(&mut self) -> bool {
        let board_behind = self.is_board_behind();
        let Some(current) = &mut self.automatic.current else {
            return false;
        };
        if current.stage == Stage::Acting {
            // Motion laid aside for jogging is not finished.
            let moving = !self.interpolator.finished() || self.held.is_some();
            let motion = match current.command.action {
                Action::Rapid { .. }
                | Action::Line { .. }
                | Action::Arc { .. }
                | Action::Thread { .. } => moving,
                Action::Tap { .. } => self.automatic.tap != Some(TapStage::Done) || moving,
                Action::ZeroReturn { .. } => self.returns.x.is_some() || self.returns.z.is_some(),
                _ => false,
            };
            let comes_to_rest = current.command.stop_point && self.from_plc.single_block;
            if self.automatic.dwell_left > 0 || motion || (comes_to_rest && board_behind) {
                return false;
            }
            if current.command.block_end {
                current.stage = Stage::Handshake;
            }
        }
        if current.stage == Stage::Handshake && self.handshake.busy() {
            return false;
        }
        let Some(current) = self.automatic.current.take() else {
            return false;
        };
        self.report(&current);
        self.automatic.decoded = None;
        self.automatic.within_block = !current.command.block_end;
        // The end of a text without M30 is no block.
        let is_block = !matches!(current.command.action, Action::End { m30: false, .. });
        if current.command.block_end && is_block {
            self.events.push(Event::BlockEnded(current.command.source));
        }
        let at = self.position();
        self.automatic.cycle_shift.ended(&current.command, at);
        self.after(&current.command);
        true
    }

    /// What follows a finished command: stop, end, part count.
    fn after(&mut self, command: &Command) {
        match command.action {
            Action::ProgramStop => return self.automatic.state = RunState::Stop,
            Action::End { counts, m30 } => return self.program_end(counts, m30),
            Action::Repeat => self.count_part(),
            _ => {}
        }
        let by_thread = self
            .automatic
            .stop_after(command, self.from_plc.single_block);
        if let Some(stops) = by_thread {
            if stops {
                self.stop_after_command(command);
            }
            return;
        }
        // A hold in a motion stands, also when the motion came to its end meanwhile;
        // one in a block without motion ends with it (manual PLC-I «feed hold»).
        let moved = !command.whole
            && self.automatic.protection == Protection::None
            && (is_cut(&command.action) || matches!(command.action, Action::Rapid { .. }));
        let stops = (self.automatic.state == RunState::Hold && !moved)
            || (command.block_end && self.automatic.stop_requested)
            || (command.stop_point && self.from_plc.single_block);
        if stops && (command.stop_point || command.block_end) {
            self.stop_after_command(command);
        }
    }

    /// An MDI block is over with its last command, a program stands at its next.
    fn stop_after_command(&mut self, command: &Command) {
        if self.automatic.mdi && command.block_end {
            self.interpreter.leave_mdi();
            return self.end_of_program();
        }
        self.automatic.stop();
    }

    fn count_part(&mut self) {
        self.counters.count_part();
        self.events.push(Event::PartFinished);
    }

    fn program_end(&mut self, counts: bool, m30: bool) {
        if counts {
            self.count_part();
        }
        let rewind = self.parameters.m30_rewinds();
        let end = self.automatic.last.map(|source| source.line);
        self.automatic.clear();
        let (interpreter, world) = self.interpreter_and_world(true);
        interpreter.reset(&world);
        self.modal = *self.interpreter.modal();
        if rewind {
            self.cursor_line = 1;
        } else {
            self.cursor_line = end.unwrap_or(self.cursor_line);
            self.rewind_at_start = true;
        }
        self.events.push(Event::ProgramEnded { m30 });
    }

    /// Reports an executed (or interrupted) piece of motion.
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
                (kind, Some(self.frame.program(center)), Some(feed))
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
            from: self.frame.program(current.from),
            to: self.frame.program(self.interpolator.commanded()),
            center,
            feed,
            start_s: current.started,
            duration_s: (self.now() - current.started).max(0.0),
        }));
    }

    /// Reports the way in of a tap; the rest counts from here. Returns where it began.
    pub(super) fn report_half(&mut self) -> Point {
        let position = self.interpolator.position();
        let Some(mut current) = self.automatic.current.take() else {
            return position;
        };
        self.report(&current);
        let from = core::mem::replace(&mut current.from, position);
        current.started = self.now();
        self.automatic.current = Some(current);
        from
    }

    /// An interrupted motion still leaves its piece of path.
    pub(crate) fn abandon_current(&mut self) {
        if let Some(current) = self.automatic.current.take() {
            self.report(&current);
        }
    }
}
