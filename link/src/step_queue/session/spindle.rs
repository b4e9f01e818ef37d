//! Predicts angle and speed of the spindle for the kernel, at the board clock at which the board
//! will execute the motion of the tick.
//!
//! ```text
//!  index     ┴────────┴────────┴────────┴ ─ ─ ─ ─ ─ ┬ ─ ─ ─ ─ ┬
//!  clock                             now   ...   from to          extrapolated line
//!                                    └─ lookahead ─┘              through the last turns
//! ```

use std::collections::VecDeque;

use super::super::super::SpindleView;
use super::super::clock_sync::near;
use super::super::spindle_estimator::{IndexPulse, POLL, SpindleEstimator};
use super::super::step_compress::Ticks;
use super::StepLink;
use super::angle::AngleDrive;
use core::time::Duration;

/// Duration of a tick of the kernel.
const TICK: Duration = Duration::from_millis(1);
/// Number of predictions of the spindle angle that are stored for the comparison with index pulses.
const REMEMBERED: usize = 700;
/// Greatest permitted error of a predicted spindle angle during a thread, turns.
const ALLOWED: f64 = 0.005;

/// The estimate of the spindle's angle, and its predictions.
#[derive(Clone, Debug)]
pub(super) struct Spindle {
    estimator: SpindleEstimator,
    /// Board clock at the end of each tick and the spindle angle predicted for it, turns; without
    /// gaps.
    shown: VecDeque<(Ticks, f64)>,
    /// Board clocks between which the axes have followed the spindle; `None` if they have not.
    followed: Option<(Ticks, Ticks)>,
    /// Greatest error of a prediction that is not reported yet, turns; `None` without such an
    /// error.
    deviation: Option<f64>,
    /// Whether there was a gap between two ticks while the axes follow the spindle: they
    /// lag the predicted angle.
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

    /// Whether axes that follow the spindle must stop because there was a gap between two ticks.
    pub(super) const fn has_gap(&self) -> bool {
        self.has_gap
    }

    /// Restarts the estimate of the angle after a reversal of the spindle.
    pub(super) fn reversed(&mut self) {
        self.estimator.begin_anew();
    }

    /// Returns the spindle angle that was predicted for a board clock, turns; `None` outside the
    /// stored predictions.
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
    /// Whether the one-turn signal of the spindle is wired to the board.
    pub(super) const fn sees_spindle(&self) -> bool {
        !self.config.io.index.is_empty() || self.has_spindle_encoder()
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

    /// Predicts angle and speed of the spindle for the kernel's next tick. With `max_correction`
    /// the axes follow the spindle: the prediction deviates from a constant speed by this many
    /// turns per tick at most.
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
                // With an unknown angle continue at constant speed.
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

    /// Forgets the estimate and the predictions of the spindle, for another or a restarted board.
    pub(super) fn forget_spindle(&mut self) {
        self.spindle = Spindle::new(self.clock.rate);
        self.angle = AngleDrive::default();
        if self.has_spindle_encoder() {
            self.angle = AngleDrive::new(self.config.io.encoder_counts, self.clock.rate);
        }
    }
}
