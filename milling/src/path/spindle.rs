//! Computes the speeds of a spindle with gears: the gear that S selects, its clamps and limits.

use crate::memory::{MillMemory, parameter};

/// Number of gears of a spindle.
const GEARS: usize = 4;
/// The greatest value of a motor speed as a code of 12 bits.
const FULL_CODE: f64 = 4095.0;

/// Which speeds the spindle can have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum SpindleSpeeds {
    /// The speeds are switched (3712 = 0): S is the speed.
    Switched,
    /// The ladder selects the gear (600.1 = 0): the greatest speed of all gears, r/min.
    LadderGears(f64),
    /// S selects the gear (600.1 = 1).
    SelectedGears(GearTable),
}

/// The gears among which S selects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct GearTable {
    /// Speed of the spindle in each gear at the full speed of the motor (3741 to 3744), r/min.
    full_speeds: [f64; GEARS],
    /// Motor speed up to which each gear is selected, a fraction of the full one.
    selected_to: [f64; GEARS],
    /// Least and greatest motor speed (3735, 3736), fractions of the full one.
    clamps: [f64; 2],
}

impl SpindleSpeeds {
    pub(crate) fn from_memory(memory: &MillMemory) -> Self {
        if memory.value(parameter::SPINDLE_TYPE) == 0 {
            return Self::Switched;
        }
        let mut full_speeds = [0.0; GEARS];
        for (speed, number) in full_speeds.iter_mut().zip(parameter::GEAR_SPEEDS) {
            *speed = f64::from(memory.value(number));
        }
        if !memory.bit(parameter::GEAR_TYPE, 1) {
            return Self::LadderGears(full_speeds.into_iter().fold(0.0, f64::max));
        }
        let fraction = |number| f64::from(memory.value(number)) / FULL_CODE;
        let greatest = fraction(parameter::MOTOR_GREATEST);
        let mut selected_to = [greatest; GEARS];
        if memory.bit(parameter::GEAR_TYPE, 0) {
            for (to, number) in selected_to.iter_mut().zip(parameter::GEAR_CHANGES) {
                *to = fraction(number);
            }
        }
        Self::SelectedGears(GearTable {
            full_speeds,
            selected_to,
            clamps: [fraction(parameter::MOTOR_LEAST), greatest],
        })
    }

    /// Returns the speed at which the spindle turns for a programmed one, r/min.
    pub(crate) fn turning(&self, programmed: f64) -> f64 {
        match self {
            Self::Switched => programmed,
            Self::LadderGears(greatest) => programmed.min(*greatest),
            Self::SelectedGears(_) if programmed <= 0.0 => 0.0,
            Self::SelectedGears(gears) => {
                let full = gears.full_speeds[gears.select(programmed)];
                let [least, greatest] = gears.clamps.map(|clamp| clamp * full);
                programmed.max(least).min(greatest)
            }
        }
    }

    /// Returns the gear, 0 to 3, that a programmed speed selects; `None` if S selects none.
    pub(crate) fn gear(&self, programmed: f64) -> Option<usize> {
        match self {
            Self::SelectedGears(gears) if programmed > 0.0 => Some(gears.select(programmed)),
            _ => None,
        }
    }
}

impl GearTable {
    /// Returns the first gear that reaches the speed, or the fastest one.
    fn select(&self, speed: f64) -> usize {
        let tops = self.full_speeds.iter().zip(self.selected_to);
        let reaches = |(full, to): (&f64, f64)| speed <= full * to;
        let mut fastest = 0;
        for (gear, full) in self.full_speeds.iter().enumerate() {
            if *full > self.full_speeds[fastest] {
                fastest = gear;
            }
        }
        tops.map(reaches).position(|it| it).unwrap_or(fastest)
    }
}
