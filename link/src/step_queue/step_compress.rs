//! Step compression (Klipper's `step_compress`): packs the times of steps into runs
//! `interval, count, add`. The k-th step of a run is `interval·k + add·k(k−1)/2` after the
//! last step before the run.

/// A time or a duration on the board clock, ticks.
pub(super) type Ticks = i64;

/// Greatest number of steps in one `queue_step` command.
const MOST_STEPS: usize = 65_535;
/// Numbers of steps from which the change of the interval from step to step is estimated.
const HORIZONS: [usize; 12] = [2, 3, 4, 6, 8, 12, 16, 32, 64, 128, 256, 1024];

/// The steps of one `queue_step` command: interval, count and change of the interval.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct StepRun {
    pub(super) interval: u32,
    pub(super) count: u16,
    pub(super) add: i16,
}

impl StepRun {
    /// Returns the time from the last step before the run to the k-th step of the run, ticks.
    pub(super) const fn step(self, k: Ticks) -> Ticks {
        self.interval as Ticks * k + self.add as Ticks * (k * (k - 1) / 2)
    }
}

/// The limits within which the compressed steps may differ from the exact ones.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tolerance {
    /// Greatest time error of a compressed step, ticks.
    pub(super) max_error: Ticks,
    /// Divisor of the interval before a step; a step may also have the quotient as time error.
    /// `None`: it may not.
    pub(super) error_divisor: Option<Ticks>,
    /// Least interval between two steps of a run, ticks.
    pub(super) min_interval: Ticks,
    /// Least interval between the last step before the run and its first step, ticks.
    pub(super) min_first_interval: Ticks,
}

/// Finds the run that makes the most of the due steps, from the first on, within the tolerance.
/// `last` is the board clock of the step before, ticks. The due steps are at least
/// [`Tolerance::min_interval`] apart. The first step may be late if the tolerance requires it.
/// `None` without due steps, or if the first interval does not fit into 32 bits.
pub(super) fn longest_run(last: Ticks, due: &[Ticks], tolerance: Tolerance) -> Option<StepRun> {
    let first = due.first()? - last;
    let mut best = StepRun {
        interval: u32::try_from(first.max(tolerance.min_first_interval).max(1)).ok()?,
        count: 1,
        add: 0,
    };
    let mut tried = [Ticks::MAX; 2 * HORIZONS.len() + 1];
    let mut adds = 0;
    for horizon in HORIZONS
        .iter()
        .copied()
        .filter(|horizon| *horizon <= due.len())
    {
        // Compare the mean intervals up to the middle and up to the horizon.
        let half = horizon / 2;
        let (n, m) = (horizon as f64, half as f64);
        let far = (due[horizon - 1] - last) as f64 / n;
        let near = (due[half.max(1) - 1] - last) as f64 / m.max(1.0);
        let add = if half == 0 {
            0.0
        } else {
            2.0 * (far - near) / (n - m)
        };
        for add in [libm::floor(add) as Ticks, libm::ceil(add) as Ticks, 0] {
            if !tried[..adds].contains(&add) && adds < tried.len() && i16::try_from(add).is_ok() {
                tried[adds] = add;
                adds += 1;
            }
        }
    }
    for &add in &tried[..adds] {
        if let Some(run) = longest_run_with_add(last, due, tolerance, add)
            && run.count > best.count
        {
            best = run;
        }
    }
    Some(best)
}

/// Finds the longest run in which the interval changes by `add` ticks from step to step; `None` if
/// even the first step exceeds the tolerance.
fn longest_run_with_add(
    last: Ticks,
    due: &[Ticks],
    tolerance: Tolerance,
    add: Ticks,
) -> Option<StepRun> {
    // Bounds of the interval; each step narrows them.
    let mut least = tolerance.min_first_interval;
    let mut most = Ticks::from(u32::MAX >> 1);
    let mut found = None;
    let mut before = last;
    for (k, due) in (1..).zip(due.iter().take(MOST_STEPS)) {
        let bend = add * (k * (k - 1) / 2);
        let away = due - last - bend;
        let share = tolerance
            .error_divisor
            .map_or(0, |divisor| (due - before) / divisor);
        let max_error = tolerance.max_error.max(share);
        before = *due;
        let at_least = div_up(away - max_error, k).max(tolerance.min_interval - add * (k - 1));
        least = least.max(at_least);
        most = most.min((away + max_error).div_euclid(k));
        if least > most {
            break;
        }
        // The middle of the bounds has the least errors.
        found = Some((k, least + (most - least) / 2));
    }
    let (count, interval) = found?;
    Some(StepRun {
        interval: u32::try_from(interval).ok()?,
        count: u16::try_from(count).ok()?,
        add: i16::try_from(add).ok()?,
    })
}

const fn div_up(value: Ticks, by: Ticks) -> Ticks {
    -(-value).div_euclid(by)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const TOLERANCE: Tolerance = Tolerance {
        max_error: 80,
        error_divisor: None,
        min_interval: 500,
        min_first_interval: 500,
    };

    /// Compresses the steps due at the clocks `due`, checks each against the tolerance, and returns
    /// the number of runs.
    fn compressed(due: &[Ticks], tolerance: Tolerance) -> usize {
        let (mut last, mut done, mut runs) = (0, 0, 0);
        while done < due.len() {
            let run = longest_run(last, &due[done..], tolerance).unwrap();
            let mut before = last;
            for k in 1..=Ticks::from(run.count) {
                let at = last + run.step(k);
                let wanted = due[done + k as usize - 1];
                assert!(
                    (at - wanted).abs() <= tolerance.max_error,
                    "{run:?} step {k}: {at} {wanted}"
                );
                assert!(at - before >= tolerance.min_interval, "{run:?} step {k}");
                before = at;
            }
            last = before;
            done += usize::from(run.count);
            runs += 1;
        }
        runs
    }

    #[test]
    fn steps_at_constant_speed_need_two_runs() {
        let due: Vec<Ticks> = (1..=40_000).map(|k| 10_000 + k * 1600).collect();
        assert_eq!(compressed(&due, TOLERANCE), 2, "the first interval differs");
    }

    #[test]
    fn an_acceleration_needs_few_runs() {
        // 400 steps from rest with constant acceleration.
        let due: Vec<Ticks> = (1..=400)
            .map(|k| (libm::sqrt(f64::from(k) / 2000.0) * 16e6) as Ticks + 20_000)
            .collect();
        let runs = compressed(&due, TOLERANCE);
        assert!(runs <= 40, "{runs}");
    }

    proptest! {
        #[test]
        fn every_step_is_in_time(
            gaps in prop::collection::vec((500i64..60_000, 1usize..60, -40i64..40), 1..30),
            max_error in 4i64..200,
        ) {
            let mut due = Vec::new();
            let mut at = 0;
            for (mut gap, count, change) in gaps {
                for _ in 0..count {
                    gap = (gap + change).max(500);
                    at += gap;
                    due.push(at);
                }
            }
            compressed(&due, Tolerance { max_error, ..TOLERANCE });
        }
    }
}
