//! Compares the pulse rates of motion with the limits of the board.

use crate::alarm::{Alarm, number};
use crate::board::{BoardDrives, ExceededAxes};
use crate::cnc::Cnc;
use crate::command::{Action, MoveKind};
use crate::memory::parameter;
use crate::motion::{JogRate, ThreadMove, top_speed};
use crate::units::{Axis, Feed, Point};
use gsk_messages::say;

impl Cnc {
    /// Returns the alarm for rapid rates (022, 023) that exceed the pulse rate of the board; `None`
    /// if the board can make them.
    pub(crate) fn rapid_rate_alarm(&self, board: &BoardDrives) -> Option<Alarm> {
        let [x, z] = [Axis::X, Axis::Z].map(|axis| self.memory.parameters.rapid_rate(axis));
        let (axes, needed, made) = board.exceeded_rate(Point::new(x, z), false)?;
        Some(Alarm::new(number::BOARD_CANNOT).with_detail(match axes {
            ExceededAxes::One(Axis::X) => {
                say::rapid_pulses_too_many(parameter::X_RAPID, x, needed, "X", made)
            }
            ExceededAxes::One(Axis::Z) => {
                say::rapid_pulses_too_many(parameter::Z_RAPID, z, needed, "Z", made)
            }
            ExceededAxes::Both => say::rapids_pulses_too_many(x, z, needed, made),
        }))
    }

    /// Returns the manual rate `rate` of an axis, limited to the speed of the board, and to No.033
    /// while the position of the slides is unknown.
    pub(crate) fn limit_manual_rate(&self, axis: Axis, rate: JogRate) -> JogRate {
        let Some(board) = self.drives.board else {
            return rate;
        };
        let mut max_rate = board.manual_speed_limit(axis);
        if !board.position_known {
            max_rate = max_rate.min(self.memory.parameters.zero_low_rate());
        }
        match rate {
            JogRate::Feed(feed) => JogRate::Feed(feed.min(max_rate)),
            JogRate::Rapid if self.memory.parameters.rapid_rate(axis) <= max_rate => rate,
            JogRate::Approach(speed) if speed <= max_rate => rate,
            JogRate::Rapid | JogRate::Approach(_) => JogRate::Feed(max_rate),
        }
    }

    /// Returns the alarm for a motion from `from`, mm, that exceeds the pulse rate of the board;
    /// `None` if the board can make it. `rpm` is the spindle speed, r/min; `None` if it is unknown.
    pub(crate) fn pulse_rate_alarm(
        &self,
        board: &BoardDrives,
        action: &Action,
        from: Point,
        rpm: Option<f64>,
    ) -> Option<Alarm> {
        let limits = &self.drives.limits;
        let per_minute = |feed: Feed| match feed {
            Feed::PerMinute(rate) => Some(rate),
            Feed::PerRevolution(rate) => Some(rate * rpm?.abs()),
        };
        let factor = self.feed_override_factor();
        let (speed, on_arc) = match action {
            Action::Line { to, feed } => {
                let feed = per_minute(*feed)? * factor;
                (top_speed(MoveKind::Feed, *to - from, feed, limits), false)
            }
            Action::Arc {
                to,
                clockwise,
                feed,
                ..
            } => {
                let feed = per_minute(*feed)? * factor;
                let kind = MoveKind::arc(*clockwise);
                (top_speed(kind, *to - from, feed, limits), true)
            }
            thread @ Action::Thread { .. } => {
                let thread = ThreadMove::from_action(thread)?;
                (thread.top_speed(from, rpm?, limits), false)
            }
            Action::ThreadCycle { per_revolution, .. } => (*per_revolution * rpm?.abs(), false),
            Action::Tap { lead, .. } => (Point::new(0.0, (lead * rpm?).abs()), false),
            _ => return None,
        };
        let (axes, needed, made) = board.exceeded_rate(speed, on_arc)?;
        let axes = axes.to_message();
        Some(
            Alarm::new(number::BOARD_CANNOT).with_detail(match (action, rpm) {
                (
                    Action::Thread { .. } | Action::ThreadCycle { .. } | Action::Tap { .. },
                    Some(rpm),
                ) => say::thread_pulses_too_many(rpm.abs(), axes, needed, made),
                _ => say::feed_pulses_too_many(axes, needed, made),
            }),
        )
    }
}
