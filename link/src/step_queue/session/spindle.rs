//! The spindle as the kernel is shown it: at the clock at which the board will make
//! the motion of the tick, which is some time ahead.
//!
//! ```text
//!  index     ┴────────┴────────┴────────┴ ─ ─ ─ ─ ─ ┬ ─ ─ ─ ─ ┬
//!  clock                             now   ...   from to          line through the last
//!                                    └─ lookahead ─┘              turns, drawn on
//! ```

use std::collections::VecDeque;

use super::super::super::SpindleView;
use super::super::clock_sync::near;
use super::super::spindle_estimator::{IndexPulse, POLL, SpindleEstimator};
use super::super::step_compress::Ticks;
use super::StepLink;
use core::time::Duration;

/// A tick of the kernel.
const TICK: Duration = Duration::from_millis(1);
/// Ticks remembered, to hold what was shown against what came.
const REMEMBERED: usize = 700;
/// Farther off than this a thread is spoilt, turns.
const ALLOWED: f64 = 0.005;

/// What is known and what was shown.
#[derive(Clone, Debug)]
pub(super) struct Spindle {
    estimator: SpindleEstimator,
    /// End of each tick without a gap, and the turns shown for it.
    shown: VecDeque<(Ticks, f64)>,
    /// The axes follow it; up to this clock they did.
    followed: Option<(Ticks, Ticks)>,
    /// Farthest that an index came beside what was shown, not told yet.
    deviation: Option<f64>,
    /// The axes follow it, and a tick began later than the one before had ended: they
    /// are behind the angle they were shown.
    has_gap: bool,
}

impl Spindle {
    pub(super) const fn new(rate: f64) -> Self {
        Self {
            estimator: SpindleEstimator::new(rate),
            shown: VecDeque::new(),
            followed: None,
            deviation: None,
            has_gap: false,
        }
    }

    /// Whether axes that follow it must not go on.
    pub(super) const fn has_gap(&self) -> bool {
        self.has_gap
    }

    /// What was learned of its turns does not go on.
    pub(super) fn reversed(&mut self) {
        self.estimator.begin_anew();
    }

    /// What was shown for a clock.
    fn shown_at(&self, clock: Ticks) -> Option<f64> {
        let after_clock = self.shown.partition_point(|(end, _)| *end < clock);
        let (to, after) = *self.shown.get(after_clock)?;
        let (from, before) = *self.shown.get(after_clock.checked_sub(1)?)?;
        let share = (clock - from) as f64 / (to - from).max(1) as f64;
        Some(before + (after - before) * share)
    }

    fn compare(&mut self, pulse: IndexPulse, poll: f64) {
        let followed = |(from, to): (Ticks, Ticks)| (from..=to).contains(&pulse.clock);
        if !self.followed.is_some_and(followed) {
            return;
        }
        let Some(shown) = self.shown_at(pulse.clock) else {
            return;
        };
        let off = (shown - pulse.turn as f64).abs();
        if off > ALLOWED + poll {
            self.deviation = Some(self.deviation.map_or(off, |worst| worst.max(off)));
        }
    }
}

impl StepLink {
    /// Whether the spindle has its index at this board.
    pub(super) const fn sees_spindle(&self) -> bool {
        !self.config.io.index.is_empty()
    }

    pub(super) fn counter_report(&mut self, count: u32, clock: u32) {
        let clock = near(clock, self.clock.at(self.session.now));
        let spindle = &mut self.spindle;
        if let Some(pulse) = spindle.estimator.counter_report(count, clock) {
            let poll = spindle
                .estimator
                .in_ticks(self.clock.ticks(Duration::from_secs_f64(POLL)) as Ticks);
            spindle.compare(pulse, poll);
        }
    }

    /// The spindle in the kernel's next tick, which the axes follow if it may be corrected by `give` turns.
    pub(super) fn next_spindle(&mut self, max_correction: Option<f64>) -> SpindleView {
        let now = self.clock.at(self.session.now) as Ticks;
        let from = self.next_begin();
        let to = from + self.clock.ticks(TICK) as Ticks;
        let spindle = &mut self.spindle;
        let turns = &spindle.estimator;
        let mut view = SpindleView {
            rpm: turns.speed(now) * 60.0,
            variation: turns.variation(),
            deviation: spindle.deviation.take(),
            ..SpindleView::default()
        };
        let last = spindle.shown.back().copied();
        let gap = |(end, _): (Ticks, f64)| from > end + self.clock.ticks(TICK) as Ticks;
        spindle.has_gap = max_correction.is_some() && (spindle.has_gap || last.is_some_and(gap));
        let continued = last.filter(|(end, _)| *end == from || max_correction.is_some());
        let line = turns.at(from).zip(turns.at(to));
        let known = line.filter(|_| max_correction.is_some() || turns.is_known(now));
        let Some((begin, end)) = known else {
            spindle.shown.clear();
            spindle.followed = None;
            view.before = last.map_or(0.0, |(_, turns)| turns);
            view.now = view.before;
            return view;
        };
        match (continued, max_correction) {
            (Some((_, before)), Some(max_correction)) => {
                let even = end - begin;
                view.lost = turns.is_lost(now);
                view.before = before;
                // Without an index to go by it only goes on.
                let max_correction = if turns.is_known(now) {
                    max_correction
                } else {
                    0.0
                };
                view.now =
                    before + even + (end - before - even).clamp(-max_correction, max_correction);
            }
            (Some((_, before)), None) => {
                view.before = before.min(end);
                view.now = end;
            }
            (None, _) => {
                spindle.shown.clear();
                spindle.shown.push_back((from, begin));
                view.before = begin;
                view.now = end;
            }
        }
        view.passed = view.before.floor() < view.now.floor();
        spindle.shown.push_back((to, view.now));
        if spindle.shown.len() > REMEMBERED {
            spindle.shown.pop_front();
        }
        if max_correction.is_some() {
            let (since, _) = spindle
                .followed
                .filter(|(_, end)| *end == from)
                .unwrap_or((from, from));
            spindle.followed = Some((since, to));
        }
        view
    }

    /// The spindle of another board, or of this one after it has begun anew.
    pub(super) fn forget_spindle(&mut self) {
        self.spindle = Spindle::new(self.clock.rate);
    }
}
