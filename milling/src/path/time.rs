//! Computes the duration of moves: rapids by the slowest axis, cuts by their feed, with a time
//! constant at stops.

use crate::commissioning::backlash_rate;
use crate::memory::{MillMemory, parameter};
use crate::path::spindle::SpindleSpeeds;
use crate::space::{AxisValues, Length, MillAxis, MillPosition};

/// How the speed of a motion rises and falls: linearly, above the speed at which it begins.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SpeedRamp {
    /// Speed up to which a motion starts and stops without acceleration time, mm/s.
    start: f64,
    /// Time constant, s.
    time_s: f64,
}

impl SpeedRamp {
    /// Returns the additional duration of a stop from `speed` (mm/s), s.
    fn duration_s(&self, speed: f64) -> f64 {
        if speed <= self.start {
            0.0
        } else {
            self.time_s * (1.0 - self.start / speed)
        }
    }
}

/// The rates and time constants of the axes, from which the times of moves are computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MillRates {
    /// Rapid rate of each axis, mm/s or degrees/s.
    rapid: AxisValues<f64>,
    /// Whether all axes of a rapid arrive together (012.7).
    is_straight: bool,
    /// Time in which a rapid reaches its rate, s.
    rapid_time_s: f64,
    /// Greatest feed of cuts, mm/s.
    feed: f64,
    /// Ramp of cuts.
    cut_ramp: SpeedRamp,
    /// Ramp of flexible taps.
    flexible_tap_ramp: SpeedRamp,
    /// Time constants of rigid taps on the way in and out, s.
    tap_times_s: [f64; 2],
    /// The axis that is the spindle as Cs axis, with its time constant, s.
    cs: Option<(MillAxis, f64)>,
    /// Gears and greatest speeds of the spindle.
    spindle: SpindleSpeeds,
    /// Delay of the strobe at a gear change, s.
    gear_strobe_s: f64,
    /// Delay before the speed of the spindle is checked at a cut, s; 0 without the check.
    speed_check_s: f64,
    /// Time in which each axis takes up its backlash at a reversal, s.
    backlash_s: AxisValues<f64>,
}

impl MillRates {
    pub(crate) fn from_memory(memory: &MillMemory) -> Self {
        let seconds = |number| f64::from(memory.value(number)) / 1000.0;
        let index = memory.value(parameter::INDEX);
        Self {
            rapid: AxisValues(MillAxis::ALL.map(|axis| {
                let number = match axis {
                    MillAxis::Fourth if index == 4 => parameter::INDEX_RATE,
                    MillAxis::Fifth if index == 5 => parameter::INDEX_RATE,
                    _ => parameter::axis_parameter(parameter::RAPID_RATE, axis),
                };
                axis_rate(memory, axis, number) / 60.0
            })),
            is_straight: memory.bit(parameter::MOTION, 7),
            rapid_time_s: seconds(parameter::RAPID_TIME),
            feed: memory.speed(parameter::FEED_LIMIT) / 60.0,
            cut_ramp: SpeedRamp {
                start: memory.speed(parameter::FEED_START) / 60.0,
                time_s: seconds(parameter::FEED_TIME),
            },
            flexible_tap_ramp: SpeedRamp {
                start: memory.speed(parameter::FLEXIBLE_TAP_START) / 60.0,
                time_s: seconds(parameter::FLEXIBLE_TAP_TIME),
            },
            tap_times_s: match memory.value(parameter::TAP_TIME_OUT) {
                0 => [seconds(parameter::TAP_TIME); 2],
                _ => [parameter::TAP_TIME, parameter::TAP_TIME_OUT].map(seconds),
            },
            cs: cs_axis(memory).map(|axis| (axis, seconds(parameter::CS_TIME))),
            spindle: SpindleSpeeds::from_memory(memory),
            gear_strobe_s: seconds(parameter::GEAR_STROBE),
            speed_check_s: match memory.bit(parameter::SPINDLE_CHECK, 6) {
                true => seconds(parameter::SPINDLE_DELAY),
                false => 0.0,
            },
            backlash_s: backlash_times(memory),
        }
    }

    /// Returns the fractions of a rapid's duration after which X, Y and Z arrive; `None` if
    /// they arrive together.
    pub(crate) fn arrivals(&self, distance: &MillPosition) -> Option<[f64; 3]> {
        let whole = self.rapid(distance);
        let part = |axis: MillAxis| self.rapid_of_axis(axis, distance) / whole;
        let moves = |axis: &MillAxis| distance.get(*axis) != Length::ZERO;
        let mut moving = MillAxis::BASIC.into_iter().filter(moves).map(part);
        let first = moving.next()?;
        let apart = !self.is_straight && moving.any(|other| (other - first).abs() > 1e-9);
        apart.then(|| MillAxis::BASIC.map(part))
    }

    /// Returns the duration of a rapid over `distance` from stop to stop, s: that of the
    /// slowest axis.
    pub(crate) fn rapid(&self, distance: &MillPosition) -> f64 {
        let axis = |axis: MillAxis| self.rapid_of_axis(axis, distance);
        MillAxis::ALL.map(axis).into_iter().fold(0.0, f64::max)
    }

    /// Returns the duration of a rapid of one axis with a linear rise and fall of the speed, s.
    fn rapid_of_axis(&self, axis: MillAxis, distance: &MillPosition) -> f64 {
        let (distance, rate) = (distance.get(axis).abs().mm(), self.rapid.get(axis));
        if distance <= 0.0 || rate <= 0.0 {
            return 0.0;
        }
        let time_s = match self.cs {
            Some((cs, time_s)) if cs == axis => time_s,
            _ => self.rapid_time_s,
        };
        if distance >= rate * time_s {
            distance / rate + time_s
        } else {
            2.0 * libm::sqrt(distance * time_s / rate)
        }
    }

    /// Returns the speed of a cut at `feed` (mm/min), limited to the greatest feed, mm/s.
    pub(crate) fn cutting(&self, feed: f64) -> f64 {
        (feed / 60.0).min(self.feed)
    }

    /// Returns the additional duration of a stop at the end of a cut over `distance` at `feed`
    /// (mm/min), s. The ramps cover the speed above that at which cuts begin. A Cs axis that moves
    /// has a separate time constant.
    pub(crate) fn settling(&self, feed: f64, distance: &MillPosition) -> f64 {
        let mut ramp = self.cut_ramp;
        if let Some((cs, time_s)) = self.cs
            && distance.get(cs) != Length::ZERO
        {
            ramp.time_s = ramp.time_s.max(time_s);
        }
        ramp.duration_s(self.cutting(feed))
    }

    /// Returns the additional duration of a stop at the end of a flexible tap at `feed` (mm/min),
    /// s.
    pub(crate) fn flexible_tap_settling_s(&self, feed: f64) -> f64 {
        self.flexible_tap_ramp.duration_s(self.cutting(feed))
    }

    /// Returns the speed at which the spindle turns for a programmed one, r/min.
    pub(crate) fn turning(&self, programmed: f64) -> f64 {
        self.spindle.turning(programmed)
    }

    /// Returns the gear, 0 to 3, that a programmed speed selects, with the delay of its change, s.
    /// `None` if S selects no gear.
    pub(crate) fn gear(&self, programmed: f64) -> Option<(usize, f64)> {
        let gear = self.spindle.gear(programmed)?;
        Some((gear, self.gear_strobe_s))
    }

    /// Returns the delay before the first cut after a rapid or at another speed, s.
    pub(crate) const fn speed_check_s(&self) -> f64 {
        self.speed_check_s
    }

    /// Returns the time in which an axis takes up its backlash, s.
    pub(crate) fn backlash_s(&self, axis: MillAxis) -> f64 {
        self.backlash_s.get(axis)
    }

    /// Returns the additional duration of a stop at the end of a rigid tap, s. `out`: whether
    /// it moves out of the hole.
    pub(crate) const fn tap_settling_s(&self, out: bool) -> f64 {
        self.tap_times_s[out as usize]
    }
}

/// Greatest rapid rate in IS-C, mm/min: of any axis, and of the fifth one.
const FINE_RAPID: f64 = 24_000.0;
const FINE_RAPID_FIFTH: f64 = 6000.0;

/// Returns the rapid rate of an axis that parameter `number` gives, mm/min or degrees/min.
fn axis_rate(memory: &MillMemory, axis: MillAxis, number: u16) -> f64 {
    let rate = match memory.is_rotary(axis) {
        true => f64::from(memory.value(number)),
        false => memory.speed(number),
    };
    match (memory.is_fine(), axis) {
        (false, _) => rate,
        (true, MillAxis::Fifth) => rate.min(FINE_RAPID_FIFTH),
        (true, _) => rate.min(FINE_RAPID),
    }
}

/// Returns the axis that the spindle becomes as Cs axis (3760); `None` if it becomes none.
fn cs_axis(memory: &MillMemory) -> Option<MillAxis> {
    let number = usize::try_from(memory.value(parameter::CS_AXIS)).ok()?;
    MillAxis::ALL.get(number.checked_sub(1)?).copied()
}

/// Returns the time in which each axis takes up its backlash, s: 0 in mode B, where the pulses go
/// out during the motion, and without a rate.
fn backlash_times(memory: &MillMemory) -> AxisValues<f64> {
    let bits = u8::try_from(memory.value(parameter::BACKLASH_RATE)).unwrap_or(0);
    let rate = f64::from(backlash_rate(bits, memory.bit(parameter::BACKLASH_MODE, 6)));
    let acts = rate > 0.0 && !memory.bit(parameter::BACKLASH_MODE, 7);
    AxisValues(MillAxis::ALL.map(|axis| {
        let number = parameter::axis_parameter(parameter::BACKLASH, axis);
        match acts {
            true => f64::from(memory.value(number)) / rate,
            false => 0.0,
        }
    }))
}
