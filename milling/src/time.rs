//! How long moves take: rapids by the slowest axis, cuts by their feed, with a time
//! constant where they begin or end at a stand.

use crate::memory::{MillMemory, parameter};
use crate::space::{Axis, Each, Position};

/// What the slides can do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rates {
    /// mm/s; of an axis that turns degrees/s.
    rapid: Each<f64>,
    /// s, to the rapid rate.
    rapid_time: f64,
    /// mm/s.
    feed: f64,
    /// s.
    feed_time: f64,
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
            rapid_time: seconds(parameter::RAPID_TIME),
            feed: f64::from(memory.value(parameter::FEED_LIMIT)) / 60.0,
            feed_time: seconds(parameter::FEED_TIME),
        }
    }

    /// Seconds of a rapid from stand to stand: those of the axis that takes longest, whether
    /// the axes arrive together or each by itself.
    pub(crate) fn rapid(&self, way: &Position) -> f64 {
        let axis = |axis: Axis| {
            let (way, rate) = (way.get(axis).abs().mm(), self.rapid.get(axis));
            self.stand_to_stand(way, rate)
        };
        Axis::ALL.map(axis).into_iter().fold(0.0, f64::max)
    }

    /// An even rise and fall of the speed.
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

    /// The speed of a cut, mm/s.
    pub(crate) fn cutting(&self, feed: f64) -> f64 {
        (feed / 60.0).min(self.feed)
    }

    /// Seconds until the slides stand behind a cut.
    pub(crate) const fn settling(&self) -> f64 {
        self.feed_time
    }
}
