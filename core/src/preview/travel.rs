//! Rapids, cuts and dwells without ticks.

use super::{Walk, bounds, snapped};
use crate::alarm::Alarm;
use crate::command::{Command, Conditions, ExecutedMove, Frame, MoveKind};
use crate::motion::{duration, path_length, top_speed};
use crate::operation::{check_encoder, check_gear_speed};
use crate::units::{Feed, Point};

/// The end of the last move as reported: the next one begins there.
#[derive(Clone, Copy)]
pub(super) struct Shown {
    machine: Point,
    frame: Frame,
    program: Point,
}

impl Walk<'_> {
    /// Executes a rapid or a cut.
    pub(super) fn travel(
        &mut self,
        command: &Command,
        kind: MoveKind,
        to: Point,
        center: Option<Point>,
        feed: Option<Feed>,
    ) -> Result<(), Alarm> {
        let from = self.so_far.machine;
        let frame = self.so_far.frame;
        let per_minute = match feed {
            None => 0.0,
            Some(Feed::PerMinute(rate)) => rate,
            Some(Feed::PerRevolution(rate)) => {
                check_encoder(&self.so_far.parameters)?;
                let middle = match command.programmed_x.as_deref() {
                    Some(programmed) => programmed.at((from + to) * 0.5, from, to),
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
        self.so_far.machine = to;
        self.look_at_move(command.source);
        let unplaced = self.unplaced(command.source);
        if from == to && center.is_none() {
            return Ok(());
        }
        if kind != MoveKind::Rapid {
            self.look_at_cut(command, feed);
        }
        self.settle(true);
        self.motionless = 0;
        let over = kind != MoveKind::Rapid && !self.limits.exact_corners();
        let length = path_length(kind, from, to, center);
        let took = if over {
            self.sequel
                .cut(kind, from, to, center, per_minute, &self.limits)
        } else {
            duration(kind, to - from, length, per_minute, &self.limits)
        };
        let lengths = &mut self.so_far.lengths;
        match kind {
            MoveKind::Rapid => lengths.rapid += length,
            MoveKind::Clockwise => lengths.clockwise += length,
            MoveKind::CounterClockwise => lengths.counter_clockwise += length,
            _ => lengths.feed += length,
        }
        if kind != MoveKind::Rapid {
            self.so_far.cutting_s += took;
        }
        let begin = match self.shown {
            Some(shown) if (shown.machine, shown.frame) == (from, frame) => shown.program,
            _ => snapped(frame.program(from)),
        };
        let end = snapped(frame.program(to));
        self.shown = Some(Shown {
            machine: to,
            frame,
            program: end,
        });
        let executed = ExecutedMove {
            source: command.source,
            kind,
            from: begin,
            to: end,
            center: center.map(|center| snapped(frame.program(center))),
            feed,
            start_s: self.clock.now(),
            duration_s: took,
            conditions: Conditions {
                unplaced,
                ..self.conditions(command)
            },
        };
        self.count(&executed);
        if over {
            self.unsettled = Some((executed, self.explanation.take()));
        } else if kind == MoveKind::Rapid && self.may_return(command) {
            self.returning = Some((executed, self.explanation.take()));
        } else {
            self.show(&executed);
        }
        Ok(())
    }

    /// Counts a move: its time and its bounds.
    pub(super) fn count(&mut self, executed: &ExecutedMove) {
        bounds::include(&mut self.so_far.bounds, executed);
        self.clock.advance(executed.duration_s);
        self.so_far.moves += 1;
    }

    /// Reports a move. The moves after an alarm are not reported.
    pub(super) fn show(&mut self, executed: &ExecutedMove) {
        if self.behind.is_none() {
            (self.on_move)(executed, self.explanation.as_ref());
        }
    }

    /// Reports the cut that waited for the next command. If that is not a cut, the tool
    /// first decelerates to the end point.
    pub(super) fn settle(&mut self, goes_on: bool) {
        let Some((mut executed, explanation)) = self.unsettled.take() else {
            return;
        };
        if !goes_on {
            let closing = self.sequel.close(&self.limits);
            executed.duration_s += closing;
            self.so_far.cutting_s += closing;
            self.clock.advance(closing);
        }
        let next = core::mem::replace(&mut self.explanation, explanation);
        self.show(&executed);
        self.explanation = next;
    }

    /// The conditions during the move of a command.
    #[inline]
    pub(super) fn conditions(&self, command: &Command) -> Conditions {
        let frame = &self.so_far.frame;
        let rpm = self.spindle.rpm(frame.program(self.so_far.machine).x);
        Conditions::of(command, frame, rpm)
    }

    pub(super) fn dwell(&mut self, command: &Command, ms: u32) {
        let source = command.source;
        if ms == 0 {
            return;
        }
        let at = snapped(self.so_far.frame.program(self.so_far.machine));
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
        self.so_far.moves += 1;
        self.show(&executed);
    }
}
