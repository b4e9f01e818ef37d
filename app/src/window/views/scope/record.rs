//! Stores the samples of the scope and computes the values of traces from them.

use std::collections::VecDeque;
use std::sync::Arc;

use crossbeam::queue::ArrayQueue;
use gsk_core::units::{Axis, Point};

use super::trace::{Of, Quantity, Trace};
use crate::kernel::probe::{SAMPLES, Sample};

/// Greatest motion per tick, mm. A larger change is a new coordinate: the axis has taken its
/// reference.
const JUMP: f64 = 1.0;

/// The samples of the last minute, one a tick without a gap.
#[derive(Debug)]
pub struct Record {
    queue: Arc<ArrayQueue<Sample>>,
    samples: VecDeque<Sample>,
}

impl Record {
    /// Creates an empty record.
    pub fn new() -> Self {
        Self {
            queue: Arc::new(ArrayQueue::new(SAMPLES)),
            samples: VecDeque::with_capacity(SAMPLES),
        }
    }

    /// The queue into which the kernel puts the samples.
    pub fn queue(&self) -> Arc<ArrayQueue<Sample>> {
        Arc::clone(&self.queue)
    }

    /// Takes the samples from the queue. Returns the number of new samples in the record.
    pub fn take(&mut self) -> usize {
        let mut count = 0;
        while let Some(sample) = self.queue.pop() {
            self.push(sample);
            count += 1;
        }
        count.min(self.samples.len())
    }

    fn push(&mut self, sample: Sample) {
        let follows = self
            .samples
            .back()
            .is_none_or(|last| last.tick + 1 == sample.tick);
        if !follows {
            // The window did not run for more than the minute that the queue holds.
            self.samples.clear();
        }
        if self.samples.len() == SAMPLES {
            self.samples.pop_front();
        }
        self.samples.push_back(sample);
    }

    /// The first and last tick of the record.
    pub fn ticks(&self) -> Option<(u64, u64)> {
        Some((self.samples.front()?.tick, self.samples.back()?.tick))
    }

    /// The sample of a tick, if it is in the record.
    pub fn at(&self, tick: u64) -> Option<&Sample> {
        let first = self.samples.front()?.tick;
        let index = usize::try_from(tick.checked_sub(first)?).ok()?;
        self.samples.get(index)
    }

    /// The last `count` samples.
    pub fn last(&self, count: usize) -> impl Iterator<Item = &Sample> {
        let from = self.samples.len().saturating_sub(count);
        self.samples.range(from..)
    }

    /// A copy of the samples from `first` to `last`, for another thread.
    pub fn excerpt(&self, first: u64, last: u64) -> Self {
        let wanted = |sample: &&Sample| (first..=last).contains(&sample.tick);
        Self {
            queue: Arc::new(ArrayQueue::new(1)),
            samples: self.samples.iter().filter(wanted).copied().collect(),
        }
    }

    /// The value of a trace at a tick. Speed and acceleration are differences over `over`
    /// ticks. `None`: a sample is missing, or an axis has taken its reference.
    pub fn value(&self, trace: &Trace, tick: u64, over: u64) -> Option<f64> {
        let now = self.at(tick)?;
        match (trace.quantity, trace.of) {
            (Quantity::Position, Of::Axis(axis)) => Some(place(now, trace).get(axis)),
            (Quantity::Following, Of::Axis(axis)) => Some(now.following?.get(axis)),
            (Quantity::Spindle, _) if trace.commanded => Some(now.spindle_commanded),
            (Quantity::Spindle, _) => now.spindle,
            (Quantity::Speed, of) => self.speed(trace, of, tick, over),
            (Quantity::Acceleration, Of::Axis(axis)) => {
                let middle = tick.checked_sub(over)?;
                let later = self.way(trace, axis, middle, tick)?;
                let earlier = self.way(trace, axis, middle.checked_sub(over)?, middle)?;
                // mm/ms² are 1000 m/s².
                Some((later - earlier) * 1000.0 / (over * over) as f64)
            }
            (_, Of::Path) => None,
        }
    }

    /// Speed of an axis or along the path, mm/min.
    fn speed(&self, trace: &Trace, of: Of, tick: u64, over: u64) -> Option<f64> {
        let before = tick.checked_sub(over)?;
        let way = match of {
            Of::Axis(axis) => self.way(trace, axis, before, tick)?,
            Of::Path => {
                let x = self.way(trace, Axis::X, before, tick)?;
                let z = self.way(trace, Axis::Z, before, tick)?;
                Point::new(x, z).length()
            }
        };
        Some(way * 60_000.0 / over as f64)
    }

    /// Distance of an axis between two ticks, mm; `None` if it has taken its reference.
    fn way(&self, trace: &Trace, axis: Axis, from: u64, to: u64) -> Option<f64> {
        let from_place = place(self.at(from)?, trace).get(axis);
        let way = place(self.at(to)?, trace).get(axis) - from_place;
        (way.abs() <= JUMP * (to - from) as f64).then_some(way)
    }
}

const fn place(sample: &Sample, trace: &Trace) -> Point {
    if trace.commanded {
        sample.commanded
    } else {
        sample.actual
    }
}

#[cfg(test)]
mod tests {
    use super::super::trace::TRACES;
    use super::*;

    fn record(place: impl Fn(f64) -> f64) -> Record {
        let mut record = Record::new();
        for tick in 1..=100 {
            let z = place(tick as f64);
            record.push(Sample {
                tick,
                commanded: Point::new(0.0, z),
                actual: Point::new(0.0, z - 0.25),
                following: Some(Point::new(0.0, 0.25)),
                ..Sample::default()
            });
        }
        record
    }

    fn trace(quantity: Quantity) -> &'static Trace {
        let wanted = |trace: &&Trace| {
            trace.quantity == quantity && trace.of == Of::Axis(Axis::Z) && !trace.commanded
        };
        TRACES.iter().find(wanted).unwrap()
    }

    #[test]
    fn even_motion_has_a_speed_and_no_acceleration() {
        // 0.05 mm/ms are 3000 mm/min.
        let record = record(|tick| 0.05 * tick);
        let value = |quantity| record.value(trace(quantity), 80, 8).unwrap();
        assert!((value(Quantity::Speed) - 3000.0).abs() < 1e-6);
        assert!(value(Quantity::Acceleration).abs() < 1e-9);
        assert!((value(Quantity::Following) - 0.25).abs() < 1e-12);
    }

    #[test]
    fn acceleration_is_in_metres() {
        // s = a/2 t² with a = 1.25 m/s² = 0.00125 mm/ms².
        let record = record(|tick| 0.000_625 * tick * tick);
        for over in [1, 8] {
            let found = record
                .value(trace(Quantity::Acceleration), 60, over)
                .unwrap();
            assert!((found - 1.25).abs() < 1e-6, "over {over} ms: {found}");
        }
    }

    #[test]
    fn another_coordinate_is_no_motion() {
        let record = record(|tick| if tick < 50.0 { 0.0 } else { 200.0 });
        assert_eq!(record.value(trace(Quantity::Speed), 50, 1), None);
        assert_eq!(record.value(trace(Quantity::Speed), 80, 1), Some(0.0));
    }

    #[test]
    fn the_last_minute_is_kept_and_a_gap_begins_anew() {
        let mut record = Record::new();
        let sample = |tick| Sample {
            tick,
            ..Sample::default()
        };
        for tick in 1..=SAMPLES as u64 + 5 {
            record.push(sample(tick));
        }
        assert_eq!(record.ticks(), Some((6, SAMPLES as u64 + 5)));
        assert_eq!(record.at(5), None);
        assert_eq!(record.at(6).map(|sample| sample.tick), Some(6));
        record.push(sample(100_000));
        assert_eq!(record.ticks(), Some((100_000, 100_000)));
    }
}
