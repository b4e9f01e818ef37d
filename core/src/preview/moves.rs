//! Rapids, cuts and dwells without ticks.

use super::caution::CautionKind;
use super::line_words::{has_letter, split_line};
use super::{PreviewRun, bounds, remove_noise};
use crate::alarm::Alarm;
use crate::command::{ControlCommand, ExecutedMove, MoveConditions, MoveKind};
use crate::motion::{move_duration, path_length, top_speed};
use crate::operation::{check_encoder, check_gear_speed};
use crate::units::{Feed, Point};

/// Duration below which a dwell probably means seconds, ms: no slide or spindle notices it.
const SHORT_DWELL_MS: u32 = 20;

/// The end of the last reported move in the frame in force; the next move begins exactly there.
#[derive(Clone, Copy)]
pub(super) struct ReportedEnd {
    machine_position: Point,
    program_position: Point,
}

impl PreviewRun<'_> {
    /// Executes a rapid or a cut to the machine position `to`, mm; fails with the alarm that
    /// the control would raise.
    pub(super) fn execute_move(
        &mut self,
        command: &ControlCommand,
        kind: MoveKind,
        to: Point,
        center: Option<Point>,
        feed: Option<Feed>,
    ) -> Result<(), Alarm> {
        let from = self.preview.machine;
        let frame = self.preview.frame;
        let per_minute = match feed {
            None => 0.0,
            Some(Feed::PerMinute(rate)) => rate,
            Some(Feed::PerRevolution(rate)) => {
                check_encoder(&self.preview.parameters)?;
                let middle = match command.programmed_x.as_deref() {
                    Some(programmed) => programmed.x_at((from + to) * 0.5, from, to),
                    None => (from.x + to.x) / 2.0,
                };
                let middle = middle - frame.zero.x - frame.offset.x;
                rate * self.spindle.rpm_for_feed(middle)?
            }
        };
        if self.limits.gear_limits_speed() {
            let top = top_speed(kind, to - from, per_minute, &self.limits);
            check_gear_speed(&self.limits, top)?;
        }
        self.preview.machine = to;
        self.record_move(command.source);
        let unplaced = self.update_unplaced(command.source);
        if from == to && center.is_none() {
            return Ok(());
        }
        if kind != MoveKind::Rapid {
            let is_sloped = center.is_some() || from.x != to.x && from.z != to.z;
            self.check_cut(command, feed, is_sloped);
        }
        self.report_pending_cut(true);
        self.motionless = 0;
        let is_blended = kind != MoveKind::Rapid && !self.limits.has_exact_corners();
        let length = path_length(kind, from, to, center);
        let took = if is_blended {
            self.sequel
                .add_cut(kind, from, to, center, per_minute, &self.limits)
        } else {
            move_duration(kind, to - from, length, per_minute, &self.limits)
        };
        let lengths = &mut self.preview.lengths;
        match kind {
            MoveKind::Rapid => lengths.rapid += length,
            MoveKind::Clockwise => lengths.clockwise += length,
            MoveKind::CounterClockwise => lengths.counter_clockwise += length,
            _ => lengths.feed += length,
        }
        if kind != MoveKind::Rapid {
            self.preview.cutting_s += took;
        }
        let begin = match self.last_reported {
            Some(shown) if shown.machine_position == from => shown.program_position,
            _ => remove_noise(frame.to_program(from)),
        };
        let end = remove_noise(frame.to_program(to));
        self.last_reported = Some(ReportedEnd {
            machine_position: to,
            program_position: end,
        });
        let conditions = self.conditions(command);
        let executed = ExecutedMove {
            source: command.source,
            kind,
            from: begin,
            to: end,
            center: center.map(|center| remove_noise(frame.to_program(center))),
            feed,
            start_s: self.clock.now(),
            duration_s: took,
            conditions: MoveConditions {
                unplaced,
                rpm: match self.spindle.follows_radius() {
                    true => self.spindle.rpm(begin.x),
                    false => conditions.rpm,
                },
                ..conditions
            },
        };
        self.count_move(&executed);
        if is_blended {
            self.pending_cut = Some((executed, self.explanation.take()));
        } else if kind == MoveKind::Rapid && self.can_reach_machine_zero(command) {
            self.pending_return = Some((executed, self.explanation.take()));
        } else {
            self.report_move(&executed);
        }
        Ok(())
    }

    /// Adds the time, the bounds and the number of a move to the result.
    pub(super) fn count_move(&mut self, executed: &ExecutedMove) {
        bounds::extend_bounds(&mut self.preview.bounds, executed);
        self.clock.advance(executed.duration_s);
        self.preview.moves += 1;
    }

    /// Passes a move to `on_move`, unless an alarm has already ended the program.
    pub(super) fn report_move(&mut self, executed: &ExecutedMove) {
        if self.alarm_search.is_none() {
            (self.on_move)(executed, self.explanation.as_ref());
        }
    }

    /// Reports the cut that waited for the next command. If that command is not a cut, adds
    /// the time in which the tool decelerates to the end point.
    pub(super) fn report_pending_cut(&mut self, is_followed_by_cut: bool) {
        let Some((mut executed, explanation)) = self.pending_cut.take() else {
            return;
        };
        if !is_followed_by_cut {
            let closing = self.sequel.finish(&self.limits);
            executed.duration_s += closing;
            self.preview.cutting_s += closing;
            self.clock.advance(closing);
        }
        let next = core::mem::replace(&mut self.explanation, explanation);
        self.report_move(&executed);
        self.explanation = next;
    }

    /// The conditions, such as spindle speed and offset, under which a command moves the tool.
    #[inline]
    pub(super) fn conditions(&self, command: &ControlCommand) -> MoveConditions {
        let frame = &self.preview.frame;
        let rpm = self.spindle.rpm(frame.to_program(self.preview.machine).x);
        MoveConditions::from_command(command, frame, rpm)
    }

    pub(super) fn execute_dwell(&mut self, command: &ControlCommand, ms: u32) {
        let source = command.source;
        if ms == 0 {
            return;
        }
        // X and U count seconds: a short dwell is meant as one.
        if ms < SHORT_DWELL_MS && has_letter(&split_line(self.line_text(source)), b'P') {
            self.add_caution(CautionKind::ShortDwell(ms), source);
        }
        let at = remove_noise(self.preview.frame.to_program(self.preview.machine));
        let took = f64::from(ms) / 1000.0;
        let executed = ExecutedMove {
            source,
            kind: MoveKind::Dwell,
            from: at,
            to: at,
            center: None,
            feed: None,
            start_s: self.clock.now(),
            duration_s: took,
            conditions: self.conditions(command),
        };
        self.clock.advance(took);
        self.preview.moves += 1;
        self.report_move(&executed);
    }
}
