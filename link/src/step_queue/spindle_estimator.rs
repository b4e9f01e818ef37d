//! Estimates angle and speed of the spindle from the counter of its one-turn signal.
//!
//! ```text
//!  pin      ─┐_______┌─┐_______┌─┐____
//!  count     2       3 4       5 6        even counts are one edge of the signal
//!  polls    ┴┴┴┴┴┴┴┴┴┴┴┴┴┴┴┴┴┴┴┴┴┴┴┴┴┴    a clock is up to a poll late
//! ```

use std::collections::VecDeque;

use super::step_compress::Ticks;

/// Interval at which the board polls the index pin of the spindle, s.
pub(super) const POLL: f64 = 100e-6;
/// Least number of recent turns through which the line of turns over time is fitted.
const LINE_TURNS: i64 = 4;
/// Time over which the line of turns over time is fitted if [`LINE_TURNS`] turns take less, s. The
/// poll interval is a large share of a fast turn.
const LINE_TIME: f64 = 0.4;
/// Least number of index pulses through which the line is fitted, if that many exist.
const LEAST_POINTS: usize = 3;
/// Least number of turns over which the variation of the spindle speed is calculated.
const STEADY_TURNS: i64 = 20;
/// Least time over which the variation of the spindle speed is calculated, s.
const STEADY_TIME: f64 = 2.0;
/// Time over which the duration of a turn is averaged before durations are compared, s; the poll
/// interval is a small share of this time.
const PERIOD_TIME: f64 = 0.1;
/// Greatest number of turns over which the duration of a turn is averaged.
const LONGEST_PERIOD: i64 = 10;
/// Greatest transmission time of a report with the counted index pulses, s.
const REPORT: f64 = 0.05;
/// Number of expected turns without an index pulse after which the angle is unknown.
const UNCERTAIN: f64 = 1.5;
/// Number of expected turns without an index pulse after which the signal counts as lost.
const LOST: f64 = 2.0;
/// Number of expected turns without an index pulse after which the spindle counts as stopped.
const STANDS: f64 = 4.0;
/// Time without an edge of the signal after which the spindle counts as stopped, s.
const SLOWEST: f64 = 10.0;

/// An index pulse: the number of the turn that begins, and the board clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct IndexPulse {
    pub(super) turn: i64,
    pub(super) clock: Ticks,
}

/// A line of spindle turns over the board clock; `turn` and `clock` are a point on it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct AngleLine {
    turn: f64,
    clock: f64,
    /// Slope of the fitted line, turns per tick.
    rate: f64,
}

/// Estimates angle and speed of the spindle from its index pulses.
#[derive(Clone, Debug)]
pub(super) struct SpindleEstimator {
    /// Clock rate of the board, ticks per second.
    rate: f64,
    /// The last count of edges that the board has reported; `None` before the first report.
    reported: Option<u32>,
    /// The last even count of edges of the index signal; `None` before the first one.
    count: Option<u32>,
    /// Board clock of the newest edge of the index signal, ticks.
    alive: Ticks,
    index_pulses: VecDeque<IndexPulse>,
    line: Option<AngleLine>,
    variation: Option<f64>,
}

impl SpindleEstimator {
    pub(super) const fn new(rate: f64) -> Self {
        Self {
            rate,
            reported: None,
            count: None,
            alive: 0,
            index_pulses: VecDeque::new(),
            line: None,
            variation: None,
        }
    }

    /// Restarts the estimate after the spindle has stopped or reversed.
    pub(super) fn begin_anew(&mut self) {
        let newest = self.index_pulses.back().copied();
        self.index_pulses.clear();
        self.line = None;
        self.variation = None;
        // Keep the number of the turn.
        self.index_pulses.extend(newest);
    }

    /// Takes a report of the count of edges and of the board clock of the newest edge, ticks.
    /// Returns the index pulse that the report shows; `None` if it shows none.
    pub(super) fn counter_report(&mut self, count: u32, clock: u64) -> Option<IndexPulse> {
        if self.reported == Some(count) {
            return None;
        }
        if self.reported.replace(count).is_none() {
            // The time of the first edge is unknown.
            self.count = count.is_multiple_of(2).then_some(count);
            return None;
        }
        let over = self.has_stopped(clock as Ticks);
        self.alive = clock as Ticks;
        if !count.is_multiple_of(2) {
            return None;
        }
        let more = self
            .count
            .map_or(0, |before| count.wrapping_sub(before) / 2);
        self.count = Some(count);
        let late = (POLL * self.rate / 2.0) as Ticks;
        let pulse = IndexPulse {
            turn: self.index_pulses.back().map_or(0, |last| last.turn) + i64::from(more),
            clock: clock as Ticks - late,
        };
        if over {
            self.index_pulses.clear();
        }
        self.index_pulses.push_back(pulse);
        self.drop_old(pulse);
        self.line = self.fit_line();
        self.variation = self.vary();
        Some(pulse)
    }

    fn ticks(&self, seconds: f64) -> Ticks {
        (seconds * self.rate) as Ticks
    }

    fn drop_old(&mut self, newest: IndexPulse) {
        let time = self.ticks(STEADY_TIME);
        while let Some(second) = self.index_pulses.get(1)
            && newest.turn - second.turn >= STEADY_TURNS
            && newest.clock - second.clock >= time
        {
            self.index_pulses.pop_front();
        }
    }

    /// Returns the line of turns over the board clock through the last turns; `None` with fewer
    /// than two index pulses.
    fn fit_line(&self) -> Option<AngleLine> {
        let newest = *self.index_pulses.back()?;
        let time = self.ticks(LINE_TIME);
        let used = |pulse: &&IndexPulse| {
            newest.turn - pulse.turn <= LINE_TURNS || newest.clock - pulse.clock <= time
        };
        // Coordinates relative to the newest pulse keep the numbers small.
        let newer = self.index_pulses.iter().rev().take_while(used).count();
        let points = || {
            let points = self.index_pulses.iter().rev().take(newer.max(LEAST_POINTS));
            points.map(|pulse| {
                let turn = (pulse.turn - newest.turn) as f64;
                ((pulse.clock - newest.clock) as f64, turn)
            })
        };
        let (mut count, mut clock, mut turn) = (0.0, 0.0, 0.0);
        for (at, turns) in points() {
            count += 1.0;
            clock += at;
            turn += turns;
        }
        if count < 2.0 {
            return None;
        }
        let (clock, turn) = (clock / count, turn / count);
        let (mut over, mut under) = (0.0, 0.0);
        for (at, turns) in points() {
            over += (turns - turn) * (turns - turn);
            under += (turns - turn) * (at - clock);
        }
        // Minimize the errors of the clocks: the turns are exact.
        (under > 0.0).then(|| AngleLine {
            turn: newest.turn as f64 + turn,
            clock: newest.clock as f64 + clock,
            rate: over / under,
        })
    }

    /// Returns the variation of the spindle speed: the greatest difference between the recent
    /// durations of a turn, as a fraction of their mean, less the error of polling. `None` with too
    /// few turns.
    fn vary(&self) -> Option<f64> {
        let (oldest, newest) = (*self.index_pulses.front()?, *self.index_pulses.back()?);
        let (turns, time) = (newest.turn - oldest.turn, newest.clock - oldest.clock);
        if turns < STEADY_TURNS || time < self.ticks(STEADY_TIME) {
            return None;
        }
        let mean = time as f64 / turns as f64;
        let span = libm::ceil(PERIOD_TIME * self.rate / mean) as i64;
        let span = span.clamp(1, LONGEST_PERIOD);
        let (mut least, mut most) = (f64::MAX, 0.0_f64);
        let mut from = self.index_pulses.iter().peekable();
        for to in &self.index_pulses {
            while let Some(begin) = from.next_if(|begin| to.turn - begin.turn >= span) {
                let period = (to.clock - begin.clock) as f64 / (to.turn - begin.turn) as f64;
                least = least.min(period);
                most = most.max(period);
            }
        }
        let polling = POLL * self.rate / span as f64;
        Some(((most - least - polling) / mean).max(0.0))
    }

    /// Returns the time from the newest edge to the board clock `now` less the transmission time of
    /// a report, converted to turns at the estimated speed; `None` without a line.
    fn age(&self, now: Ticks) -> Option<f64> {
        let past = now - self.alive - self.ticks(REPORT);
        Some(past as f64 * self.line?.rate)
    }

    fn has_stopped(&self, now: Ticks) -> bool {
        let slow = now - self.alive > self.ticks(SLOWEST);
        slow || self.age(now).is_some_and(|age| age > STANDS)
    }

    /// Returns the spindle speed at the board clock `now`, turns per second; 0 if the spindle is
    /// stopped or no speed is known.
    pub(super) fn speed(&self, now: Ticks) -> f64 {
        let (Some(line), Some(age)) = (self.line, self.age(now)) else {
            return 0.0;
        };
        if self.has_stopped(now) {
            0.0
        } else if age > UNCERTAIN {
            // The turn is not complete: the speed is at most this.
            line.rate * self.rate / age
        } else {
            line.rate * self.rate
        }
    }

    /// Whether the one-turn signal has been missing for more than [`LOST`] turns at the board clock
    /// `now`.
    pub(super) fn is_lost(&self, now: Ticks) -> bool {
        self.age(now).is_none_or(|age| age > LOST)
    }

    /// Whether the spindle angle can be predicted at the board clock `now`: enough turns are known,
    /// and the one-turn signal is not missing.
    pub(super) fn is_known(&self, now: Ticks) -> bool {
        let turns = self.index_pulses.front().zip(self.index_pulses.back());
        turns.is_some_and(|(oldest, newest)| newest.turn - oldest.turn >= LINE_TURNS)
            && self.age(now).is_some_and(|age| age <= UNCERTAIN)
    }

    /// Returns the spindle angle predicted for a board clock, turns; `None` if too few index pulses
    /// are known.
    pub(super) fn at(&self, clock: Ticks) -> Option<f64> {
        let line = self.line?;
        Some(line.turn + (clock as f64 - line.clock) * line.rate)
    }

    /// Returns the number of turns that the spindle makes in a number of board ticks at the
    /// estimated speed; 0 if the speed is unknown.
    pub(super) fn in_ticks(&self, ticks: Ticks) -> f64 {
        self.line.map_or(0.0, |line| ticks as f64 * line.rate)
    }

    pub(super) const fn variation(&self) -> Option<f64> {
        self.variation
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE: f64 = 16e6;

    /// Simulates a one-turn signal for `seconds`, with the spindle angle `angle`, turns, over the
    /// time, s: polled every 0.1 ms and reported to the estimator every 20 ms. Returns the board
    /// clock at the end, ticks.
    fn spin(turns: &mut SpindleEstimator, seconds: f64, angle: impl Fn(f64) -> f64) -> Ticks {
        let (mut count, mut level, mut edge) = (0_u32, false, 0_u64);
        let polls = (seconds / POLL) as u64;
        for poll in 0..polls {
            let clock = poll * 1600;
            let high = angle(clock as f64 / RATE).rem_euclid(1.0) < 0.1;
            if high != level {
                (level, edge) = (high, clock);
                count += 1;
            }
            if poll % 200 == 0 {
                turns.counter_report(count, edge);
            }
        }
        (polls * 1600) as Ticks
    }

    #[test]
    fn a_constant_speed_is_predicted() {
        for rpm in [37.0, 111.0, 596.1, 1234.5, 2987.0] {
            let mut turns = SpindleEstimator::new(RATE);
            let angle = |at: f64| at * rpm / 60.0 + 0.37;
            let now = spin(&mut turns, 40.0, angle);
            assert!(turns.is_known(now));
            let speed = turns.speed(now) * 60.0;
            assert!((speed / rpm - 1.0).abs() < 1e-3, "{speed} for {rpm}");
            assert!(turns.variation().unwrap() < 0.001, "{rpm}");
            // Even counts are falling edges, a tenth of a turn after the rising edge.
            let ahead = now + turns.ticks(0.13);
            let foreseen = turns.at(ahead).unwrap();
            let truth = angle(ahead as f64 / RATE) - 0.1;
            let off = (foreseen - truth) - (foreseen - truth).round();
            // The error is less than a poll.
            assert!(off.abs() < POLL * rpm / 60.0, "{off} at {rpm}");
        }
    }

    #[test]
    fn a_ripple_is_a_variation() {
        // ±1 % at 0.5 Hz, and ±0.05 %.
        for (part, least, most) in [(0.01, 0.015, 0.021), (0.0005, 0.0, 0.0012)] {
            for rpm in [300.0, 600.0, 2000.0] {
                let mut turns = SpindleEstimator::new(RATE);
                let pi = core::f64::consts::PI;
                spin(&mut turns, 6.0, |at| {
                    (at - part / pi * libm::cos(pi * at)) * rpm / 60.0
                });
                let variation = turns.variation().unwrap();
                assert!((least..=most).contains(&variation), "{variation} at {rpm}");
            }
        }
    }

    #[test]
    fn a_missing_signal_lowers_the_speed_to_zero() {
        let mut turns = SpindleEstimator::new(RATE);
        let now = spin(&mut turns, 5.0, |at| at * 10.0);
        assert!((turns.speed(now) - 10.0).abs() < 0.05);
        assert!(!turns.is_known(now + turns.ticks(0.31)));
        let slower = turns.speed(now + turns.ticks(0.31));
        assert!(slower > 0.0 && slower < 7.0, "{slower}");
        assert!(turns.is_lost(now + turns.ticks(0.35)));
        assert_eq!(turns.speed(now + turns.ticks(0.6)), 0.0);
    }

    #[test]
    fn a_stopped_spindle_remains_stopped_when_its_clock_is_ambiguous() {
        // At 180 MHz the low half of a clock is ambiguous after 12 s.
        let mut turns = SpindleEstimator::new(180e6);
        for turn in 0..30_u32 {
            turns.counter_report(turn * 2, u64::from(turn) * 18_000_000);
        }
        let stopped = 29 * 18_000_000_u64;
        for seconds in 0..60 {
            let now = stopped + seconds * 180_000_000;
            let clock = super::super::clock_sync::near(stopped as u32, now);
            turns.counter_report(58, clock);
            let speed = turns.speed(now as Ticks);
            assert!(seconds == 0 || speed == 0.0, "{speed} after {seconds} s");
        }
    }

    #[test]
    fn counts_wrap_and_clocks_exceed_32_bits() {
        let mut turns = SpindleEstimator::new(RATE);
        let mut last = 0;
        for turn in 0..10_u64 {
            let count = (turn as u32 * 2).wrapping_sub(10);
            turns.counter_report(count, 0xFFFF_0000 + turn * 1_600_000);
            last = 0xFFFF_0000 + turn as i64 * 1_600_000;
        }
        assert_eq!(turns.index_pulses.back().unwrap().turn, 9);
        assert!((turns.at(last - 800).unwrap() - 9.0).abs() < 1e-9);
    }
}
