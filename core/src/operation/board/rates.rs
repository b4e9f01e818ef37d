//! How many pulses a second motion needs, against what the board makes.

use super::BoardDrives;
use crate::alarm::Alarm;
use crate::cnc::Cnc;
use crate::command::{Action, MoveKind};
use crate::motion::{JogRate, ThreadMove, top_speed};
use crate::units::{Axis, Feed, Point};

/// What rounding may add.
const ROUNDING: f64 = 1.0 + 1e-9;

impl BoardDrives {
    fn pulses(&self, speed: Point) -> [f64; 2] {
        let [x, z] = self.pulses_per_mm;
        [speed.x.abs() / 60.0 * x, speed.z.abs() / 60.0 * z]
    }

    /// Which axes a speed, mm/min, asks too much of: the pulses a second it needs and
    /// those the board makes.
    fn exceeded(&self, speed: Point, on_arc: bool) -> Option<(&'static str, f64, f64)> {
        let [x, z] = self.pulses(speed);
        // On an arc the one axis is fastest where the other stands.
        let both = if on_arc { libm::hypot(x, z) } else { x + z };
        let [most_x, most_z] = self.rates.each;
        [
            ("X", x, most_x),
            ("Z", z, most_z),
            ("X and Z together", both, self.rates.both),
        ]
        .into_iter()
        .find(|(_, needed, made)| *needed > *made * ROUNDING)
    }

    /// The fastest an axis may be moved by hand, mm/min, whatever the other one does.
    fn by_hand(&self, axis: Axis) -> f64 {
        let [each_x, each_z] = self.rates.each;
        let [per_x, per_z] = self.pulses_per_mm;
        let (each, per_mm) = match axis {
            Axis::X => (each_x, per_x),
            Axis::Z => (each_z, per_z),
        };
        each.min(self.rates.both / 2.0) / per_mm * 60.0
    }
}

impl Cnc {
    /// The rapids against what the board can make.
    pub(super) fn rapids_too_fast(&self, board: &BoardDrives) -> Option<Alarm> {
        let [x, z] = [Axis::X, Axis::Z].map(|axis| self.parameters.rapid_rate(axis));
        let (axes, needed, made) = board.exceeded(Point::new(x, z), false)?;
        let one = |number, rate| {
            format!(
                "No.{number} = {rate} mm/min makes {needed:.0} pulses/s of {axes}, the board \
                 {made:.0} at most: lower it, or set the electronic gear 015-018"
            )
        };
        Some(Alarm::new(604).because(match axes {
            "X" => one("022", x),
            "Z" => one("023", z),
            _ => format!(
                "No.022 = {x} and No.023 = {z} mm/min make {needed:.0} pulses/s together, the \
                 board {made:.0} at most: lower them, or set the electronic gear 015-018"
            ),
        }))
    }

    /// Manual motion is no faster than the board can make it, and slow (No.033) while
    /// the place of the slides is not known.
    pub(in crate::operation) fn board_slows(&self, axis: Axis, rate: JogRate) -> JogRate {
        let Some(board) = self.board else {
            return rate;
        };
        let mut most = board.by_hand(axis);
        if !board.known {
            most = most.min(self.parameters.zero_low_rate());
        }
        match rate {
            JogRate::Feed(feed) => JogRate::Feed(feed.min(most)),
            JogRate::Rapid if self.parameters.rapid_rate(axis) <= most => rate,
            JogRate::Approach(speed) if speed <= most => rate,
            JogRate::Rapid | JogRate::Approach(_) => JogRate::Feed(most),
        }
    }

    /// Why the board cannot make a motion from here, with the spindle at this speed if
    /// that is known.
    pub(super) fn too_fast_for_board(
        &self,
        board: &BoardDrives,
        action: &Action,
        from: Point,
        rpm: Option<f64>,
    ) -> Option<Alarm> {
        let limits = &self.limits;
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
        Some(Alarm::new(604).because(match (action, rpm) {
            (Action::Thread { .. } | Action::ThreadCycle { .. }, Some(rpm)) => format!(
                "at {:.0} r/min {axes} would need {needed:.0} pulses/s, the board makes {made:.0} \
                 at most",
                rpm.abs()
            ),
            _ => format!(
                "at this feed {axes} would need {needed:.0} pulses/s, the board makes {made:.0} \
                 at most"
            ),
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::link::PulseRates;

    #[test]
    fn both_axes_together_have_their_own_limit() {
        let board = BoardDrives {
            pulses_per_mm: [400.0, 200.0],
            rates: PulseRates {
                each: [30_000.0, 30_000.0],
                both: 40_000.0,
            },
            ..BoardDrives::default()
        };
        let exceeded = |x, z, on_arc| {
            let found = board.exceeded(Point::new(x, z), on_arc);
            found.map(|(axes, needed, _)| (axes, needed as u32))
        };
        assert_eq!(exceeded(4500.0, 3000.0, false), None);
        assert_eq!(exceeded(4600.0, 0.0, false), Some(("X", 30_666)));
        assert_eq!(exceeded(0.0, 9600.0, false), Some(("Z", 32_000)));
        assert_eq!(
            exceeded(4500.0, 3600.0, false),
            Some(("X and Z together", 42_000))
        );
        assert_eq!(exceeded(4500.0, 4500.0, true), None);
        assert!((board.by_hand(Axis::X) - 3000.0).abs() < 1e-9);
        assert!((board.by_hand(Axis::Z) - 6000.0).abs() < 1e-9);
    }
}
