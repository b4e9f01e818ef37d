//! Stores the samples of the scope and computes the values of traces from them.

use std::collections::VecDeque;
use std::sync::Arc;

use crossbeam::queue::ArrayQueue;
use gsk_core::units::{Axis, Point};
use gsk_host::kernel::probe::{MAX_SAMPLES, ScopeSample};

use super::trace::{Quantity, Trace, TraceSubject};

/// Maximum motion per tick, mm. A larger change is a new coordinate, because the axis has
/// taken its reference.
const MAX_STEP_MM: f64 = 1.0;

/// The samples of the last minute, one per tick without a gap.
#[derive(Debug)]
pub struct SampleRecord {
    queue: Arc<ArrayQueue<ScopeSample>>,
    samples: VecDeque<ScopeSample>,
}

impl SampleRecord {
    /// Creates an empty record and the queue from which it takes samples.
    pub fn new() -> Self {
        Self {
            queue: Arc::new(ArrayQueue::new(MAX_SAMPLES)),
            samples: VecDeque::with_capacity(MAX_SAMPLES),
        }
    }

    /// Returns the queue into which the kernel puts the samples.
    pub fn queue(&self) -> Arc<ArrayQueue<ScopeSample>> {
        Arc::clone(&self.queue)
    }

    /// Moves the samples from the queue into the record; returns the number of new samples in it.
    pub fn take_samples(&mut self) -> usize {
        let mut count = 0;
        while let Some(sample) = self.queue.pop() {
            self.push_sample(sample);
            count += 1;
        }
        count.min(self.samples.len())
    }

    fn push_sample(&mut self, sample: ScopeSample) {
        let is_next = self
            .samples
            .back()
            .is_none_or(|last| last.tick + 1 == sample.tick);
        if !is_next {
            // The window did not run for more than the minute that the queue holds.
            self.samples.clear();
        }
        if self.samples.len() == MAX_SAMPLES {
            self.samples.pop_front();
        }
        self.samples.push_back(sample);
    }

    /// The first and last tick of the record; `None` if it is empty.
    pub fn tick_range(&self) -> Option<(u64, u64)> {
        Some((self.samples.front()?.tick, self.samples.back()?.tick))
    }

    /// The sample of a tick; `None` if it is not in the record.
    pub fn sample_at(&self, tick: u64) -> Option<&ScopeSample> {
        let first = self.samples.front()?.tick;
        let index = usize::try_from(tick.checked_sub(first)?).ok()?;
        self.samples.get(index)
    }

    /// Returns the last `count` samples, the oldest first.
    pub fn last_samples(&self, count: usize) -> impl Iterator<Item = &ScopeSample> {
        let from = self.samples.len().saturating_sub(count);
        self.samples.range(from..)
    }

    /// Whether the last `count` samples are equal, apart from their ticks.
    pub fn is_level(&self, count: usize) -> bool {
        let Some(last) = self.samples.back() else {
            return true;
        };
        self.last_samples(count).all(|sample| {
            let tick = last.tick;
            ScopeSample { tick, ..*sample } == *last
        })
    }

    /// Copies the samples from tick `first` to tick `last`, for another thread.
    pub fn excerpt(&self, first: u64, last: u64) -> Self {
        let wanted = |sample: &&ScopeSample| (first..=last).contains(&sample.tick);
        Self {
            queue: Arc::new(ArrayQueue::new(1)),
            samples: self.samples.iter().filter(wanted).copied().collect(),
        }
    }

    /// The value of a trace at a tick, in the unit of its quantity. Speed and acceleration are
    /// differences over `average_ticks` ticks. `None` if a sample is missing, or an axis has
    /// taken its reference meanwhile.
    pub fn trace_value(&self, trace: &Trace, tick: u64, average_ticks: u64) -> Option<f64> {
        let now = self.sample_at(tick)?;
        match (trace.quantity, trace.subject) {
            (Quantity::Position, TraceSubject::Axis(axis)) => Some(position(now, trace).get(axis)),
            (Quantity::FollowingError, TraceSubject::Axis(axis)) => {
                Some(now.following_error?.get(axis))
            }
            (Quantity::Spindle, _) if trace.is_commanded => Some(now.commanded_spindle_rpm),
            (Quantity::Spindle, _) => now.spindle_rpm,
            (Quantity::Speed, of) => self.speed_mm_per_min(trace, of, tick, average_ticks),
            (Quantity::Acceleration, TraceSubject::Axis(axis)) => {
                let middle = tick.checked_sub(average_ticks)?;
                let later = self.distance_mm(trace, axis, middle, tick)?;
                let earlier =
                    self.distance_mm(trace, axis, middle.checked_sub(average_ticks)?, middle)?;
                // mm/ms² are 1000 m/s².
                Some((later - earlier) * 1000.0 / (average_ticks * average_ticks) as f64)
            }
            (_, TraceSubject::Path) => None,
        }
    }

    /// Speed of an axis or along the path, averaged over `average_ticks` ticks before `tick`,
    /// mm/min.
    fn speed_mm_per_min(
        &self,
        trace: &Trace,
        of: TraceSubject,
        tick: u64,
        average_ticks: u64,
    ) -> Option<f64> {
        let before = tick.checked_sub(average_ticks)?;
        let distance = match of {
            TraceSubject::Axis(axis) => self.distance_mm(trace, axis, before, tick)?,
            TraceSubject::Path => {
                let x = self.distance_mm(trace, Axis::X, before, tick)?;
                let z = self.distance_mm(trace, Axis::Z, before, tick)?;
                Point::new(x, z).length()
            }
        };
        Some(distance * 60_000.0 / average_ticks as f64)
    }

    /// Distance of an axis between two ticks, mm; `None` if a sample is missing or the axis
    /// has taken its reference meanwhile.
    fn distance_mm(&self, trace: &Trace, axis: Axis, from: u64, to: u64) -> Option<f64> {
        let start = position(self.sample_at(from)?, trace).get(axis);
        let distance = position(self.sample_at(to)?, trace).get(axis) - start;
        (distance.abs() <= MAX_STEP_MM * (to - from) as f64).then_some(distance)
    }
}

const fn position(sample: &ScopeSample, trace: &Trace) -> Point {
    if trace.is_commanded {
        sample.commanded
    } else {
        sample.actual
    }
}

#[cfg(test)]
mod tests {
    use super::super::trace::TRACES;
    use super::*;

    fn record(place: impl Fn(f64) -> f64) -> SampleRecord {
        let mut record = SampleRecord::new();
        for tick in 1..=100 {
            let z = place(tick as f64);
            record.push_sample(ScopeSample {
                tick,
                commanded: Point::new(0.0, z),
                actual: Point::new(0.0, z - 0.25),
                following_error: Some(Point::new(0.0, 0.25)),
                ..ScopeSample::default()
            });
        }
        record
    }

    fn trace(quantity: Quantity) -> &'static Trace {
        let wanted = |trace: &&Trace| {
            trace.quantity == quantity
                && trace.subject == TraceSubject::Axis(Axis::Z)
                && !trace.is_commanded
        };
        TRACES.iter().find(wanted).unwrap()
    }

    #[test]
    fn even_motion_has_a_speed_and_no_acceleration() {
        // 0.05 mm/ms are 3000 mm/min.
        let record = record(|tick| 0.05 * tick);
        let value = |quantity| record.trace_value(trace(quantity), 80, 8).unwrap();
        assert!((value(Quantity::Speed) - 3000.0).abs() < 1e-6);
        assert!(value(Quantity::Acceleration).abs() < 1e-9);
        assert!((value(Quantity::FollowingError) - 0.25).abs() < 1e-12);
    }

    #[test]
    fn acceleration_is_in_metres() {
        // s = a/2 t² with a = 1.25 m/s² = 0.00125 mm/ms².
        let record = record(|tick| 0.000_625 * tick * tick);
        for over in [1, 8] {
            let found = record
                .trace_value(trace(Quantity::Acceleration), 60, over)
                .unwrap();
            assert!((found - 1.25).abs() < 1e-6, "over {over} ms: {found}");
        }
    }

    #[test]
    fn another_coordinate_is_no_motion() {
        let record = record(|tick| if tick < 50.0 { 0.0 } else { 200.0 });
        assert_eq!(record.trace_value(trace(Quantity::Speed), 50, 1), None);
        assert_eq!(record.trace_value(trace(Quantity::Speed), 80, 1), Some(0.0));
    }

    #[test]
    fn the_last_minute_is_kept_and_a_gap_begins_anew() {
        let mut record = SampleRecord::new();
        let sample = |tick| ScopeSample {
            tick,
            ..ScopeSample::default()
        };
        for tick in 1..=MAX_SAMPLES as u64 + 5 {
            record.push_sample(sample(tick));
        }
        assert_eq!(record.tick_range(), Some((6, MAX_SAMPLES as u64 + 5)));
        assert_eq!(record.sample_at(5), None);
        assert_eq!(record.sample_at(6).map(|sample| sample.tick), Some(6));
        record.push_sample(sample(100_000));
        assert_eq!(record.tick_range(), Some((100_000, 100_000)));
    }
}
