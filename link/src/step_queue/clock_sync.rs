//! Clock sync: estimates the clock of the board from the times of its answers.

use core::time::Duration;

use super::super::HostTime;

/// Number of clock answers that are stored for the estimate of the board clock.
const KEPT_ANSWERS: usize = 8;
/// Number of the best answers through which the line of board ticks over host time is fitted.
const FITTED_ANSWERS: usize = 4;
/// Growth of the time error of a clock answer with its age, s per s.
const AGE_PENALTY: f64 = 1e-4;
/// Greatest relative error of the board's clock rate, which a quartz crystal determines.
const MAX_DRIFT: f64 = 300e-6;
/// Least time span between the answers for an estimate of the clock rate, s.
const MIN_SPAN_S: f64 = 1.0;
/// Greatest distance of an answer from the fitted line at which the estimate is good, s.
const MAX_SPREAD_S: f64 = 1e-3;

#[derive(Clone, Copy, Debug)]
struct Answer {
    /// Host time in the middle between query and answer, s.
    host_s: f64,
    round_trip_s: f64,
    /// The board's clock in the answer, ticks.
    clock_ticks: f64,
}

impl Answer {
    /// Returns the possible error of a clock answer at the host time `now`, s.
    fn uncertainty(&self, now: f64) -> f64 {
        self.round_trip_s / 2.0 + (now - self.host_s) * AGE_PENALTY
    }
}

/// Estimate of the board's clock: a line of board ticks over host time.
#[derive(Clone, Debug)]
pub(super) struct ClockSync {
    /// Nominal clock rate of the board, ticks per second.
    pub(super) rate: f64,
    answers: Vec<Answer>,
    /// The first answer, from which the slope of the line is computed; `None` before the first
    /// answer.
    origin: Option<Answer>,
    /// Host time of a point on the line of board ticks over host time, s.
    last_host_s: f64,
    /// Board clock of the point at `last_host_s`, ticks.
    last_clock_ticks: f64,
    /// Estimated clock rate of the board, ticks per second: the slope of the line.
    ticks_per_s: f64,
    /// Greatest distance of a used answer from the fitted line, s.
    spread_s: f64,
    /// Time from query to answer of the most accurate stored answer, s.
    round_trip_s: f64,
    /// Time that the last report took from the board to the host.
    report_delay: Duration,
}

impl ClockSync {
    pub(super) const fn new(rate: f64) -> Self {
        Self {
            rate,
            answers: Vec::new(),
            origin: None,
            last_host_s: 0.0,
            last_clock_ticks: 0.0,
            ticks_per_s: rate,
            spread_s: f64::INFINITY,
            round_trip_s: 0.0,
            report_delay: Duration::ZERO,
        }
    }

    /// Adds an answer with the board clock `clock`, ticks, to the estimate. The query was sent at
    /// the host time `queried_at`, and the answer was received at `now`.
    pub(super) fn add_answer(&mut self, queried_at: HostTime, now: HostTime, clock: u64) {
        let (queried_at, now) = (queried_at.as_secs_f64(), now.as_secs_f64());
        let answer = Answer {
            host_s: (queried_at + now) / 2.0,
            round_trip_s: now - queried_at,
            clock_ticks: clock as f64,
        };
        if self.is_ready() && self.contradicts(&answer) {
            // One of the clocks has jumped, for instance because the computer was suspended.
            self.answers.clear();
            self.origin = None;
        }
        self.answers.push(answer);
        // A slow answer is uncertain, even if it is the newest: on a line that has become
        // slow the older answers remain the best.
        let mut best = self.answers.clone();
        best.sort_by(|a, b| a.uncertainty(now).total_cmp(&b.uncertainty(now)));
        best.truncate(KEPT_ANSWERS);
        self.answers.clone_from(&best);
        best.truncate(FITTED_ANSWERS);
        let count = best.len() as f64;
        let mean = |value: fn(&Answer) -> f64| best.iter().map(value).sum::<f64>() / count;
        self.last_host_s = mean(|answer| answer.host_s);
        self.last_clock_ticks = mean(|answer| answer.clock_ticks);
        // Over a long span the errors of single answers have little effect on the slope.
        let origin = *self.origin.get_or_insert(best[0]);
        let span = self.last_host_s - origin.host_s;
        self.ticks_per_s = self.rate;
        if span >= MIN_SPAN_S {
            let slope = (self.last_clock_ticks - origin.clock_ticks) / span;
            let (least, most) = (self.rate * (1.0 - MAX_DRIFT), self.rate * (1.0 + MAX_DRIFT));
            self.ticks_per_s = slope.clamp(least, most);
        }
        self.spread_s = best
            .iter()
            .map(|answer| self.distance_to_line(answer))
            .fold(0.0, f64::max);
        self.round_trip_s = best.first().map_or(0.0, |answer| answer.round_trip_s);
    }

    /// Returns the distance of a clock answer from the fitted line, s.
    fn distance_to_line(&self, answer: &Answer) -> f64 {
        let line = self.last_clock_ticks + (answer.host_s - self.last_host_s) * self.ticks_per_s;
        (line - answer.clock_ticks).abs() / self.rate
    }

    /// Whether an answer is farther from the line than its time error allows: a clock has jumped.
    fn contradicts(&self, answer: &Answer) -> bool {
        self.distance_to_line(answer) > answer.round_trip_s / 2.0 + 2.0 * MAX_SPREAD_S
    }

    /// Whether the estimate is accurate enough for commands that the board executes at a given
    /// clock.
    pub(super) fn is_ready(&self) -> bool {
        self.answers.len() >= FITTED_ANSWERS && self.spread_s <= MAX_SPREAD_S
    }

    /// Returns the estimated board clock at the host time `now`, ticks.
    pub(super) fn at(&self, now: HostTime) -> u64 {
        let elapsed = now.as_secs_f64() - self.last_host_s;
        let ticks = self.last_clock_ticks + elapsed * self.ticks_per_s;
        ticks.max(0.0) as u64
    }

    /// Returns the host time at which the board clock reads `clock`, ticks.
    pub(super) fn moment(&self, clock: u64) -> HostTime {
        let ticks = clock as f64 - self.last_clock_ticks;
        let seconds = self.last_host_s + ticks / self.ticks_per_s;
        Duration::try_from_secs_f64(seconds).unwrap_or_default()
    }

    /// Converts a duration to ticks of the board clock at its nominal rate.
    pub(super) fn ticks(&self, duration: Duration) -> u64 {
        (duration.as_secs_f64() * self.rate).round() as u64
    }

    /// Converts a number of ticks of the board clock to a duration at the nominal rate.
    pub(super) fn duration(&self, ticks: u64) -> Duration {
        Duration::try_from_secs_f64(ticks as f64 / self.rate).unwrap_or_default()
    }

    /// Stores the transmission time of a report that was received at the host time `now`. `clock`
    /// is the low half of the board clock at which the board sent it, ticks.
    pub(super) fn clock_report(&mut self, now: HostTime, clock: u32) {
        let sent = self.moment(near(clock, self.at(now)));
        self.report_delay = now.saturating_sub(sent);
    }

    /// Returns the time that the last report took from the board to the host.
    pub(super) const fn report_delay(&self) -> Duration {
        self.report_delay
    }

    /// Returns the time from query to answer of the most accurate recent clock answer.
    pub(super) fn round_trip(&self) -> Duration {
        Duration::try_from_secs_f64(self.round_trip_s).unwrap_or_default()
    }
}

/// Extends the low 32 bits of a board clock to the full clock that is nearest to the clock `known`,
/// ticks.
pub(super) fn near(low: u32, known: u64) -> u64 {
    let away = low.wrapping_sub(known as u32) as i32;
    known.saturating_add_signed(i64::from(away))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_estimate_follows_a_drifting_clock() {
        for ppm in [-100.0, 0.0, 100.0] {
            let rate = 16e6 * (1.0 + ppm * 1e-6);
            let board = |seconds: f64| (5e9 + rate * seconds) as u64;
            let mut clock = ClockSync::new(16e6);
            let mut slow = 1_u64;
            for count in 0..40_u64 {
                let queried_at = Duration::from_millis(count * 500);
                // Some answers are delayed.
                slow = slow
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(99);
                let extra = Duration::from_micros(slow >> 60) * 500;
                let there = Duration::from_micros(900);
                let back = Duration::from_micros(1100) + extra;
                clock.add_answer(
                    queried_at,
                    queried_at + there + back,
                    board((queried_at + there).as_secs_f64()),
                );
            }
            assert!(clock.is_ready());
            let now = Duration::from_secs_f64(20.3);
            let off = clock.at(now).abs_diff(board(20.3)) as f64 / 16e6;
            assert!(off < 1e-3, "{ppm}: {off}");
            let back = clock.moment(clock.at(now)).as_secs_f64();
            assert!((back - 20.3).abs() < 1e-6);
        }
    }

    /// Answers that are delayed on the way from the board to the host must not shift the estimate
    /// of the clock.
    #[test]
    fn a_line_that_becomes_slow_does_not_shift_the_clock() {
        let rate = 16e6 * (1.0 + 100e-6);
        let board = |seconds: f64| (5e9 + rate * seconds) as u64;
        let mut clock = ClockSync::new(16e6);
        for count in 0..120_u64 {
            let queried_at = Duration::from_millis(count * 500);
            let there = Duration::from_micros(900);
            let slow = if count >= 40 {
                100_000
            } else {
                200 * (count % 5)
            };
            let back = Duration::from_micros(1100 + slow);
            let now = queried_at + there + back;
            clock.add_answer(queried_at, now, board((queried_at + there).as_secs_f64()));
            if count >= 20 {
                let now = now.as_secs_f64();
                let off = clock.at(Duration::from_secs_f64(now)).abs_diff(board(now));
                assert!(off < 16_000 * 3, "{count}: {off}");
            }
        }
        // After a suspend of the computer the estimate restarts.
        let queried_at = Duration::from_secs(90);
        clock.add_answer(
            queried_at,
            queried_at + Duration::from_millis(2),
            board(60.001),
        );
        assert!(
            clock
                .at(queried_at + Duration::from_millis(1))
                .abs_diff(board(60.001))
                < 16
        );
    }

    #[test]
    fn the_low_half_of_a_clock_is_extended() {
        assert_eq!(near(5, 0xFFFF_FFFF), 0x1_0000_0005);
        assert_eq!(near(0xFFFF_FFF0, 0x1_0000_0005), 0xFFFF_FFF0);
    }
}
