//! The handwheel at the board: passes its turns on, except those that are too old to be a motion
//! that the operator makes now.

use core::time::Duration;

use super::StepLink;
use crate::step_queue::clock_sync::near;
use crate::step_queue::commands::Command;
use crate::{HostTime, LinkEvent};

/// Interval of the reports of the handwheel.
const REPORT_EVERY: Duration = Duration::from_millis(20);
/// Greatest age of a report with turns that move an axis.
const FRESH: Duration = Duration::from_millis(100);
/// Greatest time between two reports: turns after a longer silence move nothing.
const LEASE: Duration = Duration::from_millis(200);

/// The handwheel as the board has reported it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Wheel {
    /// The last count and the host time of its report; `None` before the first report.
    last: Option<(u32, HostTime)>,
    /// Counts since the first report.
    position: i64,
}

impl Wheel {
    /// Takes a count; returns the graduations since the last report, with `counts` a graduation.
    fn take(&mut self, count: u32, now: HostTime, counts: u32) -> i32 {
        let counts = i64::from(counts.max(1));
        // At rest a graduation is in the middle of its counts: a trembling wheel turns nothing.
        let graduation = |position: i64| (position + counts / 2).div_euclid(counts);
        let before = graduation(self.position);
        if let Some((last, _)) = self.last {
            self.position += i64::from(count.wrapping_sub(last) as i32);
        }
        self.last = Some((count, now));
        let turned = graduation(self.position) - before;
        turned.clamp(i32::MIN.into(), i32::MAX.into()) as i32
    }
}

impl StepLink {
    /// Asks the board for periodic reports of the handwheel.
    pub(super) fn query_wheel(&mut self) {
        if let Some(oid) = self.wiring.as_ref().and_then(|wiring| wiring.wheel) {
            let at = self.soon();
            let every = self.clock.ticks(REPORT_EVERY) as i64;
            self.wire
                .send(Command::QueryWheel, &[oid, i64::from(at as u32), every]);
        }
    }

    /// Takes a report of the handwheel: object number, clock, count.
    pub(super) fn wheel_report(&mut self, [_, clock, count, _]: [u32; 4]) {
        let now = self.session.now;
        let board_now = self.clock.at(now);
        let age = board_now.saturating_sub(near(clock, board_now));
        let wheel = &mut self.periodic.wheel;
        let is_linked = wheel
            .last
            .is_some_and(|(_, at)| now.saturating_sub(at) <= LEASE);
        let turned = wheel.take(count, now, self.config.io.wheel_counts);
        let is_fresh = age <= self.clock.ticks(FRESH);
        if turned != 0 && is_linked && is_fresh && self.is_running() {
            self.session.events.push(LinkEvent::WheelTurned(turned));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wheel_that_trembles_at_rest_turns_nothing() {
        let mut wheel = Wheel::default();
        let mut turned = |count: i32| wheel.take(count as u32, Duration::ZERO, 4);
        // The count at the first report is no turn.
        assert_eq!(turned(1000), 0);
        assert_eq!([1, -1, 1, 0].map(|count| turned(1000 + count)), [0; 4]);
        assert_eq!([1004, 1005, 1003].map(&mut turned), [1, 0, 0]);
        assert_eq!(turned(960), -11);
        // Across the end of 32 bits.
        let mut wheel = Wheel::default();
        wheel.take(u32::MAX, Duration::ZERO, 4);
        assert_eq!(wheel.take(7, Duration::ZERO, 4), 2);
    }
}
