//! Converts the samples of one axis to times of steps, and these to compressed runs.

use std::collections::VecDeque;

use super::super::FINE;
use super::step_compress::{StepRun, Ticks, Tolerance, longest_run};

/// Time after the last step after which the link may set the board's step clock, s.
const SETTLED: f64 = 0.008;

/// Product of the factor by which the permitted time error is enlarged and
/// [`Tolerance::error_divisor`].
const FINEST_PART: Ticks = 64;

/// A step that is due: its board clock, ticks, and its direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Due {
    at: Ticks,
    up: bool,
}

/// The commands for a run of steps, ready to be sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct QueuedStepRun {
    /// The value to which the board's step clock is set before the run, ticks; `None` to keep it.
    pub(super) from: Option<Ticks>,
    /// The direction that is set before the run, `true` for positive; `None` to keep it.
    pub(super) up: Option<bool>,
    pub(super) run: StepRun,
    /// Board clock of the first step of the run, ticks.
    pub(super) first: Ticks,
    /// Board clock of the last step of the run, ticks.
    pub(super) last: Ticks,
}

impl QueuedStepRun {
    /// Returns the number of messages that the run needs.
    pub(super) fn messages(&self) -> u32 {
        1 + u32::from(self.from.is_some()) + u32::from(self.up.is_some())
    }
}

/// The timing of steps that a board can keep.
#[derive(Clone, Copy, Debug)]
pub(super) struct Timing {
    /// Rate of the board clock, ticks per second.
    pub(super) rate: f64,
    /// Greatest time error of a step, ticks.
    pub(super) max_error: Ticks,
    /// Least interval between two steps, ticks.
    pub(super) min_interval: Ticks,
    /// Least interval between two steps of different directions, ticks.
    pub(super) reversal: Ticks,
}

/// Board clocks, positions in pulses and positions in fine units of an axis, at the start and at
/// the end of a sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stretch {
    pub(super) clock: [Ticks; 2],
    pub(super) count: [i64; 2],
    pub(super) fine: [i64; 2],
}

/// The due steps of one axis, and the last step that was compressed.
#[derive(Clone, Debug)]
pub(super) struct Steps {
    timing: Timing,
    due: VecDeque<Due>,
    /// The newest step added, even if it is compressed already; `None` without one.
    newest: Option<Due>,
    /// Board clock of the last compressed step, ticks; `None` if the board's step clock must be
    /// set.
    last: Option<Ticks>,
    /// The last direction sent to the board, `true` for positive; `None` before the first one.
    up: Option<bool>,
    /// Time error of the last compressed step, ticks.
    last_error: Ticks,
}

impl Steps {
    pub(super) const fn new(timing: Timing) -> Self {
        Self {
            timing,
            due: VecDeque::new(),
            newest: None,
            last: None,
            up: None,
            last_error: 0,
        }
    }

    /// Drops all steps. Before the next step the link sets step clock and direction of the board
    /// again.
    pub(super) fn forget(&mut self) {
        *self = Self::new(self.timing);
    }

    /// Whether the board knows the clock of the axis: it has steps of this link.
    pub(super) const fn is_clock_set(&self) -> bool {
        self.last.is_some()
    }

    pub(super) fn is_empty(&self) -> bool {
        self.due.is_empty()
    }

    /// Returns the board clock of the first step that is not compressed yet, ticks; `None` without
    /// one.
    pub(super) fn first(&self) -> Option<Ticks> {
        self.due.front().map(|due| due.at)
    }

    /// Adds the steps of a sample. A step is due when the linearly interpolated position is
    /// halfway between two pulses.
    pub(super) fn sample(&mut self, stretch: Stretch) {
        let [from, to] = stretch.count;
        let up = to > from;
        let [fine, fine_end] = stretch.fine;
        let distance = (fine_end - fine) as f64;
        let [begin, end] = stretch.clock;
        let duration = (end - begin) as f64;
        for passed in 0..(to - from).abs() {
            let half = if up {
                (from + passed) * FINE + FINE / 2
            } else {
                (from - passed) * FINE - FINE / 2
            };
            // Without any motion in fine units the step is due at the end.
            let share = if distance == 0.0 {
                1.0
            } else {
                (half - fine) as f64 / distance
            };
            let share = share.clamp(0.0, 1.0);
            let at = begin + (share * duration) as Ticks;
            let least = self.newest.map_or(Ticks::MIN, |newest| {
                let interval = if newest.up == up {
                    self.timing.min_interval
                } else {
                    self.timing.reversal
                };
                newest.at + interval
            });
            let due = Due {
                at: at.max(least),
                up,
            };
            self.newest = Some(due);
            self.due.push_back(due);
        }
    }

    /// Compresses all due steps into runs and appends these to `entries`. `now` is the current
    /// board clock or slightly earlier, ticks. Steps may have `coarse` times the usual time error.
    pub(super) fn compress(&mut self, now: Ticks, coarse: Ticks, entries: &mut Vec<QueuedStepRun>) {
        let due: Vec<Due> = self.due.drain(..).collect();
        for same in due.chunk_by(|a, b| a.up == b.up) {
            let times: Vec<Ticks> = same.iter().map(|due| due.at).collect();
            let up = same[0].up;
            let mut rest = times.as_slice();
            let mut reverses = self.up.is_some_and(|before| before != up);
            while let Some(&first) = rest.first() {
                let settled = (SETTLED * self.timing.rate) as Ticks;
                let (last, from) = match self.last.filter(|last| now - last < settled) {
                    Some(last) => (last, None),
                    None => {
                        // Set the step clock one interval before the first step.
                        let gap = rest
                            .get(1)
                            .map_or(self.timing.reversal, |second| second - first);
                        let longest = self.timing.reversal.max(settled);
                        let gap = gap.clamp(self.timing.reversal, longest);
                        (first - gap, Some(first - gap))
                    }
                };
                let limits = Tolerance {
                    // A larger error that exists already may shrink slowly.
                    max_error: (self.timing.max_error * coarse).max(self.last_error),
                    error_divisor: (coarse > 1).then_some(FINEST_PART / coarse),
                    min_interval: self.timing.min_interval,
                    min_first_interval: if reverses && from.is_none() {
                        self.timing.reversal - 2 * self.timing.max_error
                    } else {
                        self.timing.min_interval
                    },
                };
                let Some(run) = longest_run(last, rest, limits) else {
                    return;
                };
                let end = last + run.step(run.count.into());
                entries.push(QueuedStepRun {
                    from,
                    up: (self.up != Some(up)).then_some(up),
                    run,
                    first: last + run.step(1),
                    last: end,
                });
                self.up = Some(up);
                self.last_error = (end - rest[usize::from(run.count).min(rest.len()) - 1]).abs();
                self.last = Some(end);
                reverses = false;
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
        max_error: 80,
        min_interval: 500,
        reversal: 660,
    };

    /// Follows a path, one position in pulses per ms, and compresses its steps every `flush`
    /// samples. Compares each step of each run with its due time, and returns the number of steps.
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
                let interval = if turned && k == 1 {
                    timing.reversal - 2 * timing.max_error
                } else {
                    timing.min_interval
                };
                assert!(
                    last == Ticks::MIN || at - last >= interval,
                    "{entry:?} step {k} at {at} after {last}"
                );
                let due = wanted.next().unwrap();
                assert!(
                    (due.at - at).abs() <= timing.max_error,
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

    /// Returns a path in pulses, one position per ms. Each part has its target speed,
    /// pulses/ms, its duration, ms, and its acceleration, pulses/ms².
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
    fn a_step_is_due_halfway_between_two_pulses() {
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
    fn the_step_clock_is_set_after_a_standstill_only() {
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
        // The last step is not executed yet.
        let entry = one(&mut steps, 3_600_000, 2_000_000, 1);
        assert_eq!((entry.from, entry.run.interval), (None, 1_600_000));
        assert!(one(&mut steps, 9_000_000, 7_400_000, 2).from.is_some());
    }

    /// The environment variable `STEPS` sets the number of steps that the test compares.
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
                    max_error: 360,
                    min_interval: 900,
                    reversal: 3000,
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
                    // An arc, one axis of it: radius in pulses, a tick reverses by an angle.
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
        fn reversals_keep_their_interval(parts in prop::collection::vec((-20.0f64..20.0, 0usize..8, 0.5f64..20.0), 1..20)) {
            follow(&trapezoids(&parts), TIMING, 10);
        }
    }
}
