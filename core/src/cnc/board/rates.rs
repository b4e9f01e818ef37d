//! Compares the pulse rates of motion with the limits of the board.

use crate::alarm::{Alarm, number};
use crate::board::{BoardDrives, Exceeding};
use crate::cnc::Cnc;
use crate::command::{Action, MoveKind};
use crate::memory::parameter;
use crate::motion::{JogRate, ThreadMove, top_speed};
use crate::units::{Axis, Feed, Point};
use gsk_messages::say;

impl Cnc {
    /// The alarm for rapids that exceed the pulse rate of the board.
    pub(crate) fn rapids_too_fast(&self, board: &BoardDrives) -> Option<Alarm> {
        let [x, z] = [Axis::X, Axis::Z].map(|axis| self.memory.parameters.rapid_rate(axis));
        let (axes, needed, made) = board.exceeded(Point::new(x, z), false)?;
        Some(Alarm::new(number::BOARD_CANNOT).because(match axes {
            Exceeding::One(Axis::X) => {
                say::rapid_pulses_too_many(parameter::X_RAPID, x, needed, "X", made)
            }
            Exceeding::One(Axis::Z) => {
                say::rapid_pulses_too_many(parameter::Z_RAPID, z, needed, "Z", made)
            }
            Exceeding::Both => say::rapids_pulses_too_many(x, z, needed, made),
        }))
    }

    /// Limits manual motion to the speed of the board, and to No.033 while the position of
    /// the slides is unknown.
    pub(crate) fn board_slows(&self, axis: Axis, rate: JogRate) -> JogRate {
        let Some(board) = self.drives.board else {
            return rate;
        };
        let mut most = board.by_hand(axis);
        if !board.known {
            most = most.min(self.memory.parameters.zero_low_rate());
        }
        match rate {
            JogRate::Feed(feed) => JogRate::Feed(feed.min(most)),
            JogRate::Rapid if self.memory.parameters.rapid_rate(axis) <= most => rate,
            JogRate::Approach(speed) if speed <= most => rate,
            JogRate::Rapid | JogRate::Approach(_) => JogRate::Feed(most),
        }
    }

    /// The alarm for a motion from `from` that exceeds the pulse rate of the board; `rpm`
    /// is the spindle speed, if known.
    pub(crate) fn too_fast_for_board(
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
                let thread = ThreadMove::of(thread)?;
                (thread.top_speed(from, rpm?, limits), false)
            }
            Action::ThreadCycle { per_revolution, .. } => (*per_revolution * rpm?.abs(), false),
            _ => return None,
        };
        let (axes, needed, made) = board.exceeded(speed, on_arc)?;
        let axes = axes.text();
        Some(
            Alarm::new(number::BOARD_CANNOT).because(match (action, rpm) {
                (Action::Thread { .. } | Action::ThreadCycle { .. }, Some(rpm)) => {
                    say::thread_pulses_too_many(rpm.abs(), axes, needed, made)
                }
                _ => say::feed_pulses_too_many(axes, needed, made),
            }),
        )
    }
}
