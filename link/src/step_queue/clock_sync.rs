//! The clock of the board, as the host estimates it.

use core::time::Duration;

use super::super::HostTime;

/// Answers kept, and how many of them, the quickest, make the line.
const KEPT: usize = 8;
const USED: usize = 4;
/// An answer loses so much of its worth as it grows old, s a s.
const AGES: f64 = 1e-4;
/// A quartz is no farther off than this.
const DRIFT: f64 = 300e-6;
/// Over less time the rate cannot be told.
const LEAST_SPAN: f64 = 1.0;
/// The estimate is good when no answer lies farther off.
const SPREAD: f64 = 1e-3;

#[derive(Clone, Copy, Debug)]
struct Answer {
    /// In the middle between question and answer, s.
    at: f64,
    round_trip: f64,
    clock: f64,
}

impl Answer {
    /// How far off it may lie, s.
    fn uncertainty(&self, now: f64) -> f64 {
        self.round_trip / 2.0 + (now - self.at) * AGES
    }
}

/// Ticks of the board over time of the host.
#[derive(Clone, Debug)]
pub(super) struct ClockSync {
    /// Ticks a second, as the board says.
    pub(super) rate: f64,
    answers: Vec<Answer>,
    /// One of the first.
    origin: Option<Answer>,
    /// A point of the line, and its slope.
    at: f64,
    ticks: f64,
    slope: f64,
    spread: f64,
    round_trip: f64,
    /// How long the last report was on its way.
    report_delay: Duration,
}

impl ClockSync {
    pub(super) const fn new(rate: f64) -> Self {
        Self {
            rate,
            answers: Vec::new(),
            origin: None,
            at: 0.0,
            ticks: 0.0,
            slope: rate,
            spread: f64::INFINITY,
            round_trip: 0.0,
            report_delay: Duration::ZERO,
        }
    }

    /// The board said its clock.
    pub(super) fn add_answer(&mut self, queried_at: HostTime, now: HostTime, clock: u64) {
        let (queried_at, now) = (queried_at.as_secs_f64(), now.as_secs_f64());
        let answer = Answer {
            at: (queried_at + now) / 2.0,
            round_trip: now - queried_at,
            clock: clock as f64,
        };
        if self.is_ready() && self.contradicts(&answer) {
            // One of the clocks has jumped: a computer that slept, for instance.
            self.answers.clear();
            self.origin = None;
        }
        self.answers.push(answer);
        // An answer that took long says little, even if it is the newest: on a line
        // that has become slow the older ones are held on to.
        let mut best = self.answers.clone();
        best.sort_by(|a, b| a.uncertainty(now).total_cmp(&b.uncertainty(now)));
        best.truncate(KEPT);
        self.answers.clone_from(&best);
        best.truncate(USED);
        let count = best.len() as f64;
        let mean = |value: fn(&Answer) -> f64| best.iter().map(value).sum::<f64>() / count;
        self.at = mean(|answer| answer.at);
        self.ticks = mean(|answer| answer.clock);
        // Far apart, what the answers are off matters little.
        let origin = *self.origin.get_or_insert(best[0]);
        let span = self.at - origin.at;
        self.slope = self.rate;
        if span >= LEAST_SPAN {
            let slope = (self.ticks - origin.clock) / span;
            self.slope = slope.clamp(self.rate * (1.0 - DRIFT), self.rate * (1.0 + DRIFT));
        }
        let off = |answer: &Answer| {
            (self.ticks + (answer.at - self.at) * self.slope - answer.clock).abs() / self.rate
        };
        self.spread = best.iter().map(off).fold(0.0, f64::max);
        self.round_trip = best.first().map_or(0.0, |answer| answer.round_trip);
    }

    /// The answer cannot belong to the line.
    fn contradicts(&self, answer: &Answer) -> bool {
        let line = self.ticks + (answer.at - self.at) * self.slope;
        let off = (line - answer.clock).abs() / self.rate;
        off > answer.round_trip / 2.0 + 2.0 * SPREAD
    }

    /// Enough is known to name times to the board.
    pub(super) fn is_ready(&self) -> bool {
        self.answers.len() >= USED && self.spread <= SPREAD
    }

    /// The clock at a moment.
    pub(super) fn at(&self, now: HostTime) -> u64 {
        let ticks = self.ticks + (now.as_secs_f64() - self.at) * self.slope;
        ticks.max(0.0) as u64
    }

    /// The moment of a clock.
    pub(super) fn moment(&self, clock: u64) -> HostTime {
        let seconds = self.at + (clock as f64 - self.ticks) / self.slope;
        Duration::try_from_secs_f64(seconds).unwrap_or_default()
    }

    /// Ticks of a duration.
    pub(super) fn ticks(&self, duration: Duration) -> u64 {
        (duration.as_secs_f64() * self.rate).round() as u64
    }

    /// Duration of so many ticks.
    pub(super) fn duration(&self, ticks: u64) -> Duration {
        Duration::try_from_secs_f64(ticks as f64 / self.rate).unwrap_or_default()
    }

    /// A report with the clock at which it was sent.
    pub(super) fn clock_report(&mut self, now: HostTime, clock: u32) {
        let sent = self.moment(near(clock, self.at(now)));
        self.report_delay = now.saturating_sub(sent);
    }

    /// How long the last report was on its way.
    pub(super) const fn report_delay(&self) -> Duration {
        self.report_delay
    }

    /// The shortest round trip of late.
    pub(super) fn round_trip(&self) -> Duration {
        Duration::try_from_secs_f64(self.round_trip).unwrap_or_default()
    }
}

/// The whole clock of which a message names the low half, near a known one.
pub(super) fn near(low: u32, known: u64) -> u64 {
    let away = low.wrapping_sub(known as u32) as i32;
    known.saturating_add_signed(i64::from(away))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drifting_board_is_followed() {
        for ppm in [-100.0, 0.0, 100.0] {
            let rate = 16e6 * (1.0 + ppm * 1e-6);
            let board = |seconds: f64| (5e9 + rate * seconds) as u64;
            let mut clock = ClockSync::new(16e6);
            let mut slow = 1_u64;
            for count in 0..40_u64 {
                let queried_at = Duration::from_millis(count * 500);
                // Now and then an answer is held up.
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

    /// Answers that are all held up on the way back say next to nothing.
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
        // The computer slept: the clocks go together no more.
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
    fn the_high_half_is_found() {
        assert_eq!(near(5, 0xFFFF_FFFF), 0x1_0000_0005);
        assert_eq!(near(0xFFFF_FFF0, 0x1_0000_0005), 0xFFFF_FFF0);
    }
}
