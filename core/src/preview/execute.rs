//! Executes one command of a preview: its effect on clock, spindle and counters.

use super::{PreviewEnd, PreviewRun};
use crate::alarm::Alarm;
use crate::command::{Action, ControlCommand, Frame, MoveKind, ProgramId, ThreadStart};
use crate::motion::ThreadMove;
use crate::units::{PerAxis, Point, TICK_S};

impl PreviewRun<'_> {
    pub(super) fn execute_command(
        &mut self,
        command: &ControlCommand,
    ) -> Result<Option<PreviewEnd>, Alarm> {
        self.motionless += 1;
        let program = command.source.program;
        if self.source.is_none_or(|last| last.program != program) {
            self.record_program(program);
        }
        self.source = Some(command.source);
        self.report_return(Some(command));
        self.settle_uncertainty(command);
        if self.owed_deceleration_s > 0.0 {
            self.add_owed_deceleration(&command.action);
        }
        if !matches!(&command.action, Action::Line { .. } | Action::Arc { .. }) {
            self.report_pending_cut(false);
        }
        if !can_spindle_be_stopped(&command.action) {
            self.spindle.start_pending();
        }
        match &command.action {
            Action::Rapid { .. } | Action::Line { .. } | Action::Arc { .. } => {
                self.execute_path_move(command)?;
            }
            thread @ Action::Thread { .. } => {
                if let Some(thread) = ThreadMove::from_action(thread) {
                    self.execute_thread(command, &thread)?;
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
                self.execute_tap(command, *to, *lead)?;
            }
            Action::Dwell { ms } => self.execute_dwell(command, *ms),
            Action::Frame {
                frame,
                relative,
                program_zero,
            } => {
                self.change_frame(*frame, *relative);
                if program_zero.is_some() {
                    self.record_preset(command.source);
                }
            }
            Action::Miscellaneous { code } => self.execute_miscellaneous(*code)?,
            Action::Spindle(speed) => {
                self.spindle.set_speed(*speed);
                self.clock.add_speed_time(speed);
            }
            Action::Tool { tool, offset, .. } => {
                self.clock.change_tool(*tool);
                self.last_pass = None;
                if !self.preview.tools.contains(&(*tool, *offset)) {
                    self.preview.tools.push((*tool, *offset));
                }
            }
            Action::ProgramStop => self.preview.stops += 1,
            Action::Repeat | Action::End { .. } => return Ok(self.end_part(&command.action)),
            Action::Macro => self.clock.advance(TICK_S),
            Action::ZeroReturn { x, z } | Action::Referenced { x, z } => {
                self.record_return(command.source, PerAxis::new(*x, *z));
            }
            // The time of an input cannot be predicted.
            Action::Outputs { .. } | Action::InputWait { .. } | Action::Nothing => {}
        }
        if command.block_end {
            self.preview.blocks += 1;
            self.spindle.start_pending();
            self.clock.end_block();
        }
        Ok(None)
    }

    fn record_program(&mut self, program: ProgramId) {
        let programs = &mut self.preview.programs;
        if !programs.contains(&program) {
            programs.push(program);
        }
    }

    /// Executes a rapid, a line or an arc, or returns its alarm.
    #[inline]
    fn execute_path_move(&mut self, command: &ControlCommand) -> Result<(), Alarm> {
        match &command.action {
            Action::Rapid { to } => self.execute_move(command, MoveKind::Rapid, *to, None, None),
            Action::Line { to, feed } => {
                self.execute_move(command, MoveKind::Feed, *to, None, Some(*feed))
            }
            Action::Arc {
                to,
                center,
                clockwise,
                feed,
            } => {
                let kind = MoveKind::arc(*clockwise);
                self.execute_move(command, kind, *to, Some(*center), Some(*feed))
            }
            _ => Ok(()),
        }
    }

    fn execute_miscellaneous(&mut self, code: u8) -> Result<(), Alarm> {
        self.messages.check_m_code(code, self.spindle.rotation())?;
        self.spindle.start_m_in_parallel(code);
        match code {
            8 => self.preview.coolant = true,
            9 => self.preview.coolant = false,
            _ => {}
        }
        match code {
            41..=44 if self.spindle.change_gear(code - 40) => {
                self.clock.change_gear(code - 40);
            }
            41..=44 => {}
            _ => self.clock.start_m_function(),
        }
        Ok(())
    }

    /// Counts a finished part at an action that ends the program, and returns the kind of end;
    /// `None` for other actions.
    fn end_part(&mut self, action: &Action) -> Option<PreviewEnd> {
        match action {
            Action::Repeat => {
                self.preview.parts += 1;
                self.preview.blocks += 1;
                Some(PreviewEnd::M99)
            }
            Action::End { counts, m30, m02 } => {
                self.preview.parts += u32::from(*counts);
                self.preview.blocks += u64::from(*m30);
                if *m30 {
                    self.spindle.execute_m(5);
                    self.preview.coolant = false;
                }
                Some(match (m30, m02) {
                    (_, true) => PreviewEnd::M02,
                    (true, false) => PreviewEnd::M30,
                    (false, false) => PreviewEnd::Text,
                })
            }
            _ => None,
        }
    }

    /// Advances the clock by the deceleration of the last thread, unless `next` is a thread
    /// that continues it in phase.
    fn add_owed_deceleration(&mut self, next: &Action) {
        let owed = core::mem::take(&mut self.owed_deceleration_s);
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

    /// Sets the coordinate frame. A new work zero does not change the relative coordinates,
    /// unless `relative_follows` is set; a tool offset shifts them like the absolute ones.
    fn change_frame(&mut self, frame: Frame, relative_follows: bool) {
        let before = self.preview.frame;
        self.preview.frame = frame;
        self.last_reported = None;
        if before.zero == frame.zero {
            return;
        }
        if relative_follows {
            self.relative_zero = Point::default();
            return;
        }
        let machine = self.preview.machine;
        self.relative_zero =
            self.relative_zero + frame.to_program(machine) - before.to_program(machine);
    }
}

/// Whether the spindle that an M code of the same block starts may still be stopped at this
/// action: a thread starts in parallel with the M code.
const fn can_spindle_be_stopped(action: &Action) -> bool {
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
