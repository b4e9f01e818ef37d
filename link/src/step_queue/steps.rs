//! One axis: samples become times of pulses, times become runs for the board.

use std::collections::VecDeque;

use super::super::FINE;
use super::compression::{Run, Ticks, Tolerance, longest_run};

/// Before it may be set, the board's step clock must have stood for so long, s.
const SETTLED: f64 = 0.008;

/// Where steps may lie farther from their time: this part of the way between two of
/// them, at the finest.
const FINEST_PART: Ticks = 64;

/// A pulse and when it is due.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Due {
    at: Ticks,
    up: bool,
}

/// What the board is sent for some steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Entry {
    /// Sets the step clock first.
    pub(super) from: Option<Ticks>,
    /// Sets the direction first.
    pub(super) up: Option<bool>,
    pub(super) run: Run,
    /// Clock of its first and of its last step.
    pub(super) first: Ticks,
    pub(super) last: Ticks,
}

impl Entry {
    /// Messages it takes.
    pub(super) fn messages(&self) -> u32 {
        1 + u32::from(self.from.is_some()) + u32::from(self.up.is_some())
    }
}

/// How steps are timed at this board.
#[derive(Clone, Copy, Debug)]
pub(super) struct Timing {
    /// Ticks a second.
    pub(super) rate: f64,
    /// Farthest a step may lie from its time.
    pub(super) off: Ticks,
    /// Least time between two steps.
    pub(super) apart: Ticks,
    /// Least time between steps that go different ways.
    pub(super) turn: Ticks,
}

/// The ends of a sample, as clocks, and the position there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stretch {
    pub(super) clock: [Ticks; 2],
    pub(super) count: [i64; 2],
    pub(super) fine: [i64; 2],
}

/// The steps of an axis.
#[derive(Clone, Debug)]
pub(super) struct Steps {
    timing: Timing,
    due: VecDeque<Due>,
    /// The newest pulse due.
    newest: Option<Due>,
    /// Clock of the last step compressed; none: the board's step clock must be set.
    last: Option<Ticks>,
    /// Direction the board has been sent.
    up: Option<bool>,
    /// How far the last step compressed lies from its time.
    off: Ticks,
}

impl Steps {
    pub(super) const fn new(timing: Timing) -> Self {
        Self {
            timing,
            due: VecDeque::new(),
            newest: None,
            last: None,
            up: None,
            off: 0,
        }
    }

    /// The board has dropped everything and knows no time and no direction.
    pub(super) fn forget(&mut self) {
        *self = Self::new(self.timing);
    }

    pub(super) fn is_empty(&self) -> bool {
        self.due.is_empty()
    }

    /// When the first pulse is due that is not compressed.
    pub(super) fn first(&self) -> Option<Ticks> {
        self.due.front().map(|due| due.at)
    }

    /// Each pulse of a sample is due where the position, straight in between, passes the
    /// half before it.
    pub(super) fn sample(&mut self, stretch: Stretch) {
        let [from, to] = stretch.count;
        let up = to > from;
        let [fine, fine_end] = stretch.fine;
        let way = (fine_end - fine) as f64;
        let [begin, end] = stretch.clock;
        let duration = (end - begin) as f64;
        for passed in 0..(to - from).abs() {
            let half = if up {
                (from + passed) * FINE + FINE / 2
            } else {
                (from - passed) * FINE - FINE / 2
            };
            // A position that misses its half by rounding has the pulse at the end.
            let share = if way == 0.0 {
                1.0
            } else {
                (half - fine) as f64 / way
            };
            let share = share.clamp(0.0, 1.0);
            let at = begin + (share * duration) as Ticks;
            let least = self.newest.map_or(Ticks::MIN, |newest| {
                let apart = if newest.up == up {
                    self.timing.apart
                } else {
                    self.timing.turn
                };
                newest.at + apart
            });
            let due = Due {
                at: at.max(least),
                up,
            };
            self.newest = Some(due);
            self.due.push_back(due);
        }
    }

    /// All pulses due as runs. `now` is the board's clock, at most a little late; a
    /// step may lie `coarse` times as far from its time as usual.
    pub(super) fn compress(&mut self, now: Ticks, coarse: Ticks, entries: &mut Vec<Entry>) {
        let due: Vec<Due> = self.due.drain(..).collect();
        for same in due.chunk_by(|a, b| a.up == b.up) {
            let times: Vec<Ticks> = same.iter().map(|due| due.at).collect();
            let up = same[0].up;
            let mut rest = times.as_slice();
            let mut turns = self.up.is_some_and(|before| before != up);
            while let Some(&first) = rest.first() {
                let settled = (SETTLED * self.timing.rate) as Ticks;
                let (last, from) = match self.last.filter(|last| now - last < settled) {
                    Some(last) => (last, None),
                    None => {
                        // As if a step had come one interval before.
                        let gap = rest
                            .get(1)
                            .map_or(self.timing.turn, |second| second - first);
                        let gap = gap.clamp(self.timing.turn, self.timing.turn.max(settled));
                        (first - gap, Some(first - gap))
                    }
                };
                let limits = Tolerance {
                    // What lies farther off already is made up for without haste.
                    off: (self.timing.off * coarse).max(self.off),
                    part: (coarse > 1).then_some(FINEST_PART / coarse),
                    apart: self.timing.apart,
                    first: if turns && from.is_none() {
                        self.timing.turn - 2 * self.timing.off
                    } else {
                        self.timing.apart
                    },
                };
                let Some(run) = longest_run(last, rest, limits) else {
                    return;
                };
                let end = last + run.step(run.count.into());
                entries.push(Entry {
                    from,
                    up: (self.up != Some(up)).then_some(up),
                    run,
                    first: last + run.step(1),
                    last: end,
                });
                self.up = Some(up);
                self.off = (end - rest[usize::from(run.count).min(rest.len()) - 1]).abs();
                self.last = Some(end);
                turns = false;
                rest = &rest[usize::from(run.count).min(rest.len())..];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const TIMING: Timing = Timing {
        rate: 16e6,
        off: 80,
        apart: 500,
        turn: 660,
    };

    /// Samples of a millisecond along a path in pulses; every step of every run is
    /// compared with its time, and the pulses counted.
    fn follow(path: &[f64], timing: Timing, flush: usize) -> u64 {
        let mut steps = Steps::new(timing);
        let ms = (timing.rate / 1000.0) as Ticks;
        let count = |place: f64| (place + 0.5).floor() as i64;
        let fine = |place: f64| (place * FINE as f64).round() as i64;
        let (mut entries, mut due) = (Vec::new(), Vec::new());
        for (index, pair) in path.windows(2).enumerate() {
            let begin = 2_000_000 + index as Ticks * ms;
            steps.sample(Stretch {
                clock: [begin, begin + ms],
                count: [count(pair[0]), count(pair[1])],
                fine: [fine(pair[0]), fine(pair[1])],
            });
            if index % flush == 0 {
                due.extend(steps.due.iter().copied());
                steps.compress(begin - 100 * ms, 1, &mut entries);
            }
        }
        due.extend(steps.due.iter().copied());
        steps.compress(path.len() as Ticks * ms + 1_000_000, 1, &mut entries);
        let (mut place, mut wanted, mut made) = (count(path[0]), due.iter(), 0);
        let (mut last, mut up) = (Ticks::MIN, None);
        for entry in &entries {
            let start = entry.from.unwrap_or(last);
            let turned = entry.up.is_some() && up.is_some();
            up = entry.up.or(up);
            for k in 1..=Ticks::from(entry.run.count) {
                let at = start + entry.run.step(k);
                let apart = if turned && k == 1 {
                    timing.turn - 2 * timing.off
                } else {
                    timing.apart
                };
                assert!(
                    last == Ticks::MIN || at - last >= apart,
                    "{entry:?} step {k} at {at} after {last}"
                );
                let due = wanted.next().unwrap();
                assert!(
                    (due.at - at).abs() <= timing.off,
                    "{entry:?} step {k} at {at}: {due:?}"
                );
                assert_eq!(Some(due.up), up);
                place += if due.up { 1 } else { -1 };
                last = at;
                made += 1;
            }
            assert_eq!(entry.last, last);
        }
        assert_eq!((place, wanted.next()), (count(path[path.len() - 1]), None));
        made
    }

    /// Speeds in pulses a millisecond, reached with ramps.
    fn trapezoids(parts: &[(f64, usize, f64)]) -> Vec<f64> {
        let (mut path, mut speed) = (vec![0.0], 0.0_f64);
        let mut place = 0.0;
        for &(target, hold, step) in parts {
            while speed != target {
                speed += (target - speed).clamp(-step, step);
                place += speed;
                path.push(place);
            }
            for _ in 0..hold {
                place += speed;
                path.push(place);
            }
        }
        path
    }

    #[test]
    fn a_step_is_due_where_its_half_is_passed() {
        let mut steps = Steps::new(TIMING);
        steps.sample(Stretch {
            clock: [0, 16_000],
            count: [0, 2],
            fine: [0, 2 * FINE],
        });
        steps.sample(Stretch {
            clock: [16_000, 32_000],
            count: [2, 1],
            fine: [2 * FINE, FINE],
        });
        let due: Vec<(Ticks, bool)> = steps.due.iter().map(|due| (due.at, due.up)).collect();
        assert_eq!(due, [(4000, true), (12_000, true), (24_000, false)]);
    }

    #[test]
    fn the_step_clock_is_set_only_when_the_axis_has_stood() {
        let mut steps = Steps::new(TIMING);
        let mut entries = Vec::new();
        let mut one = |steps: &mut Steps, clock: Ticks, now: Ticks, from: i64| {
            steps.sample(Stretch {
                clock: [clock, clock + 16_000],
                count: [from, from + 1],
                fine: [from * FINE, (from + 1) * FINE],
            });
            entries.clear();
            steps.compress(now, 1, &mut entries);
            entries[0]
        };
        assert!(one(&mut steps, 2_000_000, 400_000, 0).from.is_some());
        // The last step is made only later than now.
        let entry = one(&mut steps, 3_600_000, 2_000_000, 1);
        assert_eq!((entry.from, entry.run.interval), (None, 1_600_000));
        assert!(one(&mut steps, 9_000_000, 7_400_000, 2).from.is_some());
    }

    /// STEPS=1000000 in the environment tries so many steps.
    #[test]
    fn no_step_misses_its_time() {
        let wanted: u64 = std::env::var("STEPS")
            .ok()
            .and_then(|text| text.parse().ok())
            .unwrap_or(100_000);
        let mut seed = 7_u64;
        let mut random = |below: u64| {
            seed = seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (seed >> 33) % below
        };
        let mut made = 0;
        while made < wanted {
            let (avr, flush) = (random(2) == 0, 1 + random(20) as usize);
            let timing = if avr {
                TIMING
            } else {
                Timing {
                    rate: 180e6,
                    off: 360,
                    apart: 900,
                    turn: 3000,
                }
            };
            let path = match random(3) {
                0 => {
                    let top = if avr { 31_000 } else { 190_000 };
                    let parts: Vec<(f64, usize, f64)> = (0..1 + random(6))
                        .map(|_| {
                            let speed = (random(2 * top) as f64 - top as f64) / 1000.0;
                            let ramp = 0.01 + random(2000) as f64 / 1000.0;
                            (speed, random(200) as usize, ramp)
                        })
                        .collect();
                    trapezoids(&parts)
                }
                1 => {
                    // An arc, one axis of it: radius in pulses, a tick turns by an angle.
                    let (radius, turn) = (random(4000) as f64, (1 + random(60)) as f64 * 1e-4);
                    (0..1500)
                        .map(|k| radius * libm::sin(f64::from(k) * turn))
                        .collect()
                }
                _ => {
                    // A taper: very slow beside a fast axis.
                    let speed = random(1000) as f64 * 1e-4;
                    (0..4000).map(|k| speed * f64::from(k)).collect()
                }
            };
            made += follow(&path, timing, flush);
        }
    }

    proptest! {
        #[test]
        fn reversals_keep_their_distance(parts in prop::collection::vec((-20.0f64..20.0, 0usize..8, 0.5f64..20.0), 1..20)) {
            follow(&trapezoids(&parts), TIMING, 10);
        }
    }
}
