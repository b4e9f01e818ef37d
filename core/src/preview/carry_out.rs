//! Executes one command of a preview: its effect on clock, spindle and counters.

use super::{End, Walk};
use crate::alarm::Alarm;
use crate::command::{Action, Command, Frame, MoveKind, ThreadStart};
use crate::motion::ThreadMove;
use crate::units::{PerAxis, Point, TICK_S};

impl Walk<'_> {
    pub(super) fn carry_out(&mut self, command: &Command) -> Result<Option<End>, Alarm> {
        self.motionless += 1;
        self.source = Some(command.source);
        self.show_return(Some(command));
        self.settle_uncertainty(command);
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
            Action::Dwell { ms } => self.dwell(command, *ms),
            Action::Frame {
                frame,
                relative,
                program_zero,
            } => {
                self.change_frame(*frame, *relative);
                if program_zero.is_some() {
                    self.look_at_preset(command.source);
                }
            }
            Action::Miscellaneous { code } => {
                self.messages.check(*code, self.spindle.turning())?;
                self.spindle.output_m_beside(*code);
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
                    _ => self.clock.output_m(),
                }
            }
            Action::Spindle(speed) => {
                self.spindle.command(*speed);
                self.clock.output_s(speed);
            }
            Action::Tool { tool, offset, .. } => {
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
            Action::End { counts, m30, m02 } => {
                self.so_far.parts += u32::from(*counts);
                self.so_far.blocks += u64::from(*m30);
                if *m30 {
                    self.spindle.output_m(5);
                    self.so_far.coolant = false;
                }
                return Ok(Some(match (m30, m02) {
                    (_, true) => End::M02,
                    (true, false) => End::M30,
                    (false, false) => End::Text,
                }));
            }
            Action::Macro => self.clock.advance(TICK_S),
            Action::ZeroReturn { x, z } | Action::Referenced { x, z } => {
                self.look_at_return(command.source, PerAxis::new(*x, *z));
            }
            // The time of an input cannot be predicted.
            Action::Outputs { .. } | Action::InputWait { .. } | Action::Nothing => {}
        }
        if command.block_end {
            self.so_far.blocks += 1;
            self.spindle.start_pending();
            self.clock.block_end();
        }
        Ok(None)
    }

    /// Adds the deceleration of the last thread, unless the next thread continues it in
    /// phase.
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

    /// Changes the coordinate frame. The relative coordinates do not change with the work
    /// zero, unless `relative_follows` is set; an offset shifts them like the absolute ones.
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

/// Whether a spindle that starts in the block of this action may still be stopped: a thread
/// starts in parallel with the M code of its block.
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
