//! Computes the duration of moves: rapids by the slowest axis, cuts by their feed, with a time
//! constant at stops.

use crate::memory::{MillMemory, parameter};
use crate::space::{Axis, Each, Length, Position};

/// The rates and time constants of the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rates {
    /// Rapid rates, mm/s or degrees/s.
    rapid: Each<f64>,
    /// Whether the axes of a rapid arrive together.
    straight: bool,
    /// Time to reach the rapid rate, s.
    rapid_time: f64,
    /// Greatest feed, mm/s.
    feed: f64,
    /// Feed that needs no ramp, mm/s.
    feed_start: f64,
    /// Time constant of cuts, s.
    feed_time: f64,
    /// Time constants of rigid taps in and out, s.
    tap_times: [f64; 2],
}

impl Rates {
    pub(crate) fn of(memory: &MillMemory) -> Self {
        let seconds = |number| f64::from(memory.value(number)) / 1000.0;
        let index = memory.value(parameter::INDEX);
        Self {
            rapid: Each(Axis::ALL.map(|axis| {
                let number = match axis {
                    Axis::Fourth if index == 4 => parameter::INDEX_RATE,
                    Axis::Fifth if index == 5 => parameter::INDEX_RATE,
                    _ => parameter::of(parameter::RAPID_RATE, axis),
                };
                f64::from(memory.value(number)) / 60.0
            })),
            straight: memory.bit(parameter::MOTION, 7),
            rapid_time: seconds(parameter::RAPID_TIME),
            feed: f64::from(memory.value(parameter::FEED_LIMIT)) / 60.0,
            feed_start: f64::from(memory.value(parameter::FEED_START)) / 60.0,
            feed_time: seconds(parameter::FEED_TIME),
            tap_times: match memory.value(parameter::TAP_TIME_OUT) {
                0 => [seconds(parameter::TAP_TIME); 2],
                _ => [parameter::TAP_TIME, parameter::TAP_TIME_OUT].map(seconds),
            },
        }
    }

    /// Returns the shares of a rapid's duration after which X, Y and Z arrive. `None` if they
    /// arrive together.
    pub(crate) fn arrivals(&self, way: &Position) -> Option<[f64; 3]> {
        let whole = self.rapid(way);
        let part = |axis: Axis| {
            let (way, rate) = (way.get(axis).abs().mm(), self.rapid.get(axis));
            self.stand_to_stand(way, rate) / whole
        };
        let moves = |axis: &Axis| way.get(*axis) != Length::ZERO;
        let mut moving = Axis::BASIC.into_iter().filter(moves).map(part);
        let first = moving.next()?;
        let apart = !self.straight && moving.any(|other| (other - first).abs() > 1e-9);
        apart.then(|| Axis::BASIC.map(part))
    }

    /// Returns the duration of a rapid from stop to stop, s: that of the slowest axis.
    pub(crate) fn rapid(&self, way: &Position) -> f64 {
        let axis = |axis: Axis| {
            let (way, rate) = (way.get(axis).abs().mm(), self.rapid.get(axis));
            self.stand_to_stand(way, rate)
        };
        Axis::ALL.map(axis).into_iter().fold(0.0, f64::max)
    }

    /// Duration with a linear rise and fall of the speed.
    fn stand_to_stand(&self, way: f64, rate: f64) -> f64 {
        if way <= 0.0 || rate <= 0.0 {
            return 0.0;
        }
        let ramp = rate * self.rapid_time;
        if way >= ramp {
            way / rate + self.rapid_time
        } else {
            2.0 * libm::sqrt(way * self.rapid_time / rate)
        }
    }

    /// Returns the speed of a cut, mm/s.
    pub(crate) fn cutting(&self, feed: f64) -> f64 {
        (feed / 60.0).min(self.feed)
    }

    /// Returns the additional duration of a stop at the end of a cut, s. The ramps cover the
    /// speed above that at which cuts begin.
    pub(crate) fn settling(&self, feed: f64) -> f64 {
        let speed = self.cutting(feed);
        if speed <= self.feed_start {
            0.0
        } else {
            self.feed_time * (1.0 - self.feed_start / speed)
        }
    }

    /// Returns the additional duration of a stop at the end of a rigid tap, s.
    pub(crate) const fn settling_of_tap(&self, out: bool) -> f64 {
        self.tap_times[out as usize]
    }
}
