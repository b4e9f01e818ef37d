//! What the settings of the board have to be for the kernel's motion to come out
//! as it was made.

use super::FirmwareFamily;
use crate::drives::Drives;
use crate::{LinkConfig, SettingDifference};

/// Homing cycle; bit 0 turns it on.
const HOMING: u16 = 22;
/// The value of S that stands for 10 V.
const FULL_SPEED: f64 = 1000.0;
/// What a report names; the larger board has a switch for each field.
pub(super) const REPORT: u16 = 10;
const ALL_FIELDS: f64 = 511.0;
/// A value differs when it is off by more than the board's rounding, of three decimals or
/// of a number of 32 bits.
const ROUNDING: f64 = 0.000_6;
const SINGLE: f64 = 1e-7;

/// A setting and the value it must have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// Number behind the `$`.
    pub number: u16,
    /// Value.
    pub value: f64,
}

impl Setting {
    /// The same for a board of this family.
    pub(super) fn of(self, family: FirmwareFamily) -> Self {
        if self.number == REPORT && family == FirmwareFamily::GrblHal {
            return Self {
                value: ALL_FIELDS,
                ..self
            };
        }
        self
    }

    /// Whether the board's value is the wanted one.
    pub(crate) fn is_met_by(self, board: f64) -> bool {
        if self.number == HOMING {
            // The larger boards keep more switches in the same number.
            return board as u32 & 1 == 1;
        }
        (board - self.value).abs() <= ROUNDING.max(self.value.abs() * SINGLE)
    }

    /// The line that writes it.
    pub fn line(self) -> String {
        format!("${}={}", self.number, figure(self.value))
    }
}

/// A setting that is not as it must be, and the line that mends it; none where only the
/// owner can, in the board's own file.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SettingDeviation {
    pub(super) difference: SettingDifference,
    pub(super) line: Option<String>,
}

/// A figure as boards read it.
pub(super) fn figure(value: f64) -> String {
    if value.fract() == 0.0 {
        format!("{value:.0}")
    } else {
        format!("{value:.3}")
    }
}

/// Everything the board must be set to.
#[derive(Clone, Debug, PartialEq)]
pub struct RequiredSettings {
    /// The settings, by number.
    pub settings: Vec<Setting>,
    /// Pulses per mm of slide travel, X and Z.
    pub pulses_per_mm: [f64; 2],
}

impl RequiredSettings {
    /// From the drives and the machine file.
    pub fn new(drives: &Drives, config: &LinkConfig) -> Self {
        let weights = [drives.pulse_weight.x, drives.pulse_weight.z];
        // The board takes three decimals.
        let pulses_per_mm = weights.map(|weight| (1000.0 / weight).round() / 1000.0);
        let rates = [drives.rates.x, drives.rates.z];
        let mask = |x: bool, z: bool| f64::from(u8::from(x) | u8::from(z) << 2);
        let directions = mask(config.x.invert_direction, config.z.invert_direction);
        let on = |set: bool| f64::from(u8::from(set));
        let home = config.line.home;
        let mut settings: Vec<Setting> = [
            (0, f64::from(config.line.step_pulse_us)),
            (1, 255.0),
            (2, on(config.line.invert_step) * 5.0),
            (3, directions),
            (4, on(config.line.invert_enable)),
            (5, on(config.line.invert_limits)),
            (REPORT, 3.0),
            (11, 0.02),
            (13, 0.0),
            (20, 0.0),
            (21, 1.0),
            (HOMING, 1.0),
            (23, mask(config.x.home_negative, config.z.home_negative)),
            (24, f64::from(home.locate)),
            (25, f64::from(home.seek)),
            (26, f64::from(config.line.debounce_ms)),
            (27, f64::from(home.pull_off_um) / 1000.0),
            (30, FULL_SPEED),
            (31, 0.0),
            (32, 0.0),
            (100, pulses_per_mm[0]),
            (102, pulses_per_mm[1]),
            (110, rates[0].rate),
            (112, rates[1].rate),
            (120, rates[0].acceleration),
            (122, rates[1].acceleration),
        ]
        .map(|(number, value)| Setting { number, value })
        .into();
        settings.sort_by_key(|setting| setting.number);
        Self {
            settings,
            pulses_per_mm,
        }
    }
}
