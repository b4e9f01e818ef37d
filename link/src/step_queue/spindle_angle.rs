//! The angle of the spindle in counts of its encoder, apart from times of the board clock, and
//! the speed of the spindle from the reports of its encoder.

use std::collections::VecDeque;

use super::step_compress::Ticks;

/// Least time over which the speed is averaged, s.
const LEAST_TIME: f64 = 0.1;
/// Greatest time over which the speed is averaged, s.
const MOST_TIME: f64 = 1.5;
/// Time without a count after which the spindle counts as stopped, s.
const STANDS: f64 = 0.3;

/// An angle of the spindle, or a distance of angle: counts of its encoder.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct SpindleCounts(pub(super) i64);

impl core::ops::Sub for SpindleCounts {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self(self.0 - other.0)
    }
}

impl core::ops::Add for SpindleCounts {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

/// The reports of the spindle encoder.
#[derive(Clone, Debug)]
pub(super) struct EncoderTrack {
    counts_per_turn: f64,
    /// Clock rate of the board, ticks per second.
    rate: f64,
    /// Board clock and count of the last reports, the oldest first.
    reports: VecDeque<(Ticks, SpindleCounts)>,
    /// Board clock at which the count has last changed, ticks.
    moved: Ticks,
    /// Low 32 bits of the count at the last index; `None` before the first index.
    index: Option<u32>,
}

impl EncoderTrack {
    pub(super) const fn new(counts_per_turn: u32, rate: f64) -> Self {
        Self {
            counts_per_turn: counts_per_turn as f64,
            rate,
            reports: VecDeque::new(),
            moved: 0,
            index: None,
        }
    }

    /// Takes a report of the low 32 bits of the count at a board clock, and of the count at the
    /// last index, which is 0 before the first one.
    pub(super) fn report(&mut self, clock: Ticks, low: u32, index: u32) {
        let last = self.reports.back().copied();
        let count = match last {
            Some((at, _)) if clock <= at => return,
            Some((_, SpindleCounts(known))) => {
                known + i64::from(low.wrapping_sub(known as u32) as i32)
            }
            None => i64::from(low as i32),
        };
        if last.is_none_or(|(_, known)| known.0 != count) {
            self.moved = clock;
        }
        self.index = (index != 0).then_some(index).or(self.index);
        self.reports.push_back((clock, SpindleCounts(count)));
        let ticks = |seconds: f64| (seconds * self.rate) as Ticks;
        let (most, least) = (ticks(MOST_TIME), ticks(LEAST_TIME));
        while let Some(&(at, from)) = self.reports.get(1) {
            let turned = (count - from.0).unsigned_abs() as f64 >= self.counts_per_turn;
            if clock - at > most || (turned && clock - at >= least) {
                self.reports.pop_front();
            } else {
                break;
            }
        }
    }

    /// Returns the last reported count; `None` before the first report.
    pub(super) fn count(&self) -> Option<SpindleCounts> {
        self.reports.back().map(|(_, count)| *count)
    }

    /// Returns the angle after the index, turns, 0 to 1; `None` before the first index.
    pub(super) fn angle(&self) -> Option<f64> {
        let count = self.count()?.0 as u32;
        let counts = f64::from(count.wrapping_sub(self.index?) as i32);
        Some((counts / self.counts_per_turn).rem_euclid(1.0))
    }

    /// Returns the greatest deviation of the speed between two reports from the mean of the last
    /// turn, as a fraction of the mean; `None` until a turn is complete, and at standstill.
    pub(super) fn ripple(&self, now: Ticks) -> Option<f64> {
        let ((_, first), (_, last)) = (self.reports.front()?, self.reports.back()?);
        let is_turn = (*last - *first).0.unsigned_abs() as f64 >= self.counts_per_turn;
        let mean = self.speed(now);
        if !is_turn || mean == 0.0 {
            return None;
        }
        let mut worst: f64 = 0.0;
        for ((from, begin), (to, end)) in self.reports.iter().zip(self.reports.iter().skip(1)) {
            let turns = (*end - *begin).0 as f64 / self.counts_per_turn;
            let speed = turns * self.rate / (to - from).max(1) as f64;
            worst = worst.max((speed / mean - 1.0).abs());
        }
        Some(worst)
    }

    /// Returns the speed at the board clock `now`, averaged over a turn, turns per second, negative
    /// if the encoder counts down; 0 at standstill.
    pub(super) fn speed(&self, now: Ticks) -> f64 {
        let (Some((from, begin)), Some((to, end))) = (self.reports.front(), self.reports.back())
        else {
            return 0.0;
        };
        let stands = (now - self.moved) as f64 > STANDS * self.rate;
        if stands || to <= from {
            return 0.0;
        }
        let turns = (*end - *begin).0 as f64 / self.counts_per_turn;
        turns * self.rate / (to - from) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_speed_is_the_mean_of_a_turn() {
        let mut track = EncoderTrack::new(4096, 1e6);
        assert_eq!((track.speed(0), track.count()), (0.0, None));
        // 10 turns/s with a ripple of 20 % in each turn, reported every 10 ms.
        let turns = |seconds: f64| {
            let even = 10.0 * seconds;
            even + 0.2 / core::f64::consts::TAU * libm::sin(even * core::f64::consts::TAU)
        };
        for report in 1..100_i64 {
            let clock = report * 10_000;
            let count = (turns(clock as f64 * 1e-6) * 4096.0) as i64;
            // Across the end of 32 bits.
            track.report(clock, (count + 0xFFFF_F000) as u32, 0);
        }
        assert!((track.speed(990_000) - 10.0).abs() < 0.3);
        assert!(track.count().is_some_and(|count| count.0 > 30_000));
        assert_eq!(track.speed(1_400_000), 0.0);
        // An older report changes nothing.
        let count = track.count();
        track.report(980_000, 7, 0);
        assert_eq!(track.count(), count);
    }

    #[test]
    fn angle_and_ripple_are_those_of_the_encoder() {
        let mut track = EncoderTrack::new(4096, 1e6);
        // 5 turns/s, index at 100 counts, a report every 10 ms: the speed swings by 20 % once a
        // turn, of which the mean of 10 ms shows 19.7 %.
        let count = |seconds: f64| {
            let turns = 5.0 * seconds;
            let tau = core::f64::consts::TAU;
            ((turns + 0.2 / tau * libm::sin(turns * tau)) * 4096.0) as i64
        };
        for report in 1..=10_i64 {
            track.report(report * 10_000, count(report as f64 * 0.01) as u32, 0);
        }
        assert_eq!((track.angle(), track.ripple(100_000)), (None, None));
        for report in 11..=60_i64 {
            let (now, index) = (count(report as f64 * 0.01), 100 + 4096 * (report / 20));
            track.report(report * 10_000, now as u32, index as u32);
        }
        let expected = (count(0.6) - 100).rem_euclid(4096) as f64 / 4096.0;
        assert!((track.angle().unwrap_or_default() - expected).abs() < 1e-9);
        let ripple = track.ripple(600_000).unwrap_or_default();
        assert!((ripple - 0.197).abs() < 0.01, "{ripple}");
        assert_eq!(track.ripple(1_000_000), None, "at standstill");
    }
}
