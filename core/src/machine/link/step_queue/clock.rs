//! The clock of the board, as the host estimates it.

use core::time::Duration;
use std::collections::VecDeque;

use super::super::HostTime;

/// Answers kept, and how many of them, the quickest, make the line.
const KEPT: usize = 8;
const USED: usize = 4;
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

/// Ticks of the board over time of the host.
#[derive(Clone, Debug)]
pub(super) struct Clock {
    /// Ticks a second, as the board says.
    pub(super) rate: f64,
    answers: VecDeque<Answer>,
    /// A point of the line, and its slope.
    at: f64,
    ticks: f64,
    slope: f64,
    spread: f64,
    round_trip: f64,
}

impl Clock {
    pub(super) const fn new(rate: f64) -> Self {
        Self {
            rate,
            answers: VecDeque::new(),
            at: 0.0,
            ticks: 0.0,
            slope: rate,
            spread: f64::INFINITY,
            round_trip: 0.0,
        }
    }

    /// The board said its clock.
    pub(super) fn hear(&mut self, asked: HostTime, now: HostTime, clock: u64) {
        let (asked, now) = (asked.as_secs_f64(), now.as_secs_f64());
        if self.answers.len() == KEPT {
            self.answers.pop_front();
        }
        self.answers.push_back(Answer {
            at: (asked + now) / 2.0,
            round_trip: now - asked,
            clock: clock as f64,
        });
        let mut best: Vec<Answer> = self.answers.iter().copied().collect();
        best.sort_by(|a, b| a.round_trip.total_cmp(&b.round_trip));
        best.truncate(USED);
        let count = best.len() as f64;
        let mean = |value: fn(&Answer) -> f64| best.iter().map(value).sum::<f64>() / count;
        self.at = mean(|answer| answer.at);
        self.ticks = mean(|answer| answer.clock);
        let least = best.iter().map(|answer| answer.at).fold(f64::MAX, f64::min);
        let most = best.iter().map(|answer| answer.at).fold(0.0, f64::max);
        self.slope = self.rate;
        if most - least >= LEAST_SPAN {
            let (mut over, mut under) = (0.0, 0.0);
            for answer in &best {
                let away = answer.at - self.at;
                over += away * (answer.clock - self.ticks);
                under += away * away;
            }
            self.slope = (over / under).clamp(self.rate * (1.0 - DRIFT), self.rate * (1.0 + DRIFT));
        }
        let off = |answer: &Answer| {
            (self.ticks + (answer.at - self.at) * self.slope - answer.clock).abs() / self.rate
        };
        self.spread = best.iter().map(off).fold(0.0, f64::max);
        self.round_trip = best.first().map_or(0.0, |answer| answer.round_trip);
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
            let mut clock = Clock::new(16e6);
            let mut slow = 1_u64;
            for count in 0..40_u64 {
                let asked = Duration::from_millis(count * 500);
                // Now and then an answer is held up.
                slow = slow
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(99);
                let extra = Duration::from_micros(slow >> 60) * 500;
                let there = Duration::from_micros(900);
                let back = Duration::from_micros(1100) + extra;
                clock.hear(
                    asked,
                    asked + there + back,
                    board((asked + there).as_secs_f64()),
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

    #[test]
    fn the_high_half_is_found() {
        assert_eq!(near(5, 0xFFFF_FFFF), 0x1_0000_0005);
        assert_eq!(near(0xFFFF_FFF0, 0x1_0000_0005), 0xFFFF_FFF0);
    }
}
