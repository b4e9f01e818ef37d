//! The settings that a line board needs to execute the kernel's motion unchanged.

use super::FirmwareFamily;
use crate::drives::Drives;
use crate::{LinkConfig, SettingDifference};

/// Number of the setting for the homing cycle; its bit 0 enables homing.
const HOMING: u16 = 22;
/// Value of S at which the analog spindle output is 10 V.
const FULL_SPEED: f64 = 1000.0;
/// Number of the setting for the fields of a status report; grblHAL has a bit for each field.
pub(super) const REPORT: u16 = 10;
const ALL_FIELDS: f64 = 511.0;
/// Tolerance, in the unit of the setting, for values that the board rounds to three decimals.
const ROUNDING: f64 = 0.000_6;
/// Relative tolerance of values that the board stores as 32-bit floating-point numbers.
const SINGLE: f64 = 1e-7;

/// A numbered setting and its required value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// Grbl's number of the setting, written after `$`.
    pub number: u16,
    /// The required value, in Grbl's unit.
    pub value: f64,
}

impl Setting {
    /// Returns the setting with its value adapted to this firmware.
    pub(super) fn adapted_to(self, family: FirmwareFamily) -> Self {
        if self.number == REPORT && family == FirmwareFamily::GrblHal {
            return Self {
                value: ALL_FIELDS,
                ..self
            };
        }
        self
    }

    /// Whether the value `board`, read from the board, meets the requirement.
    pub(crate) fn is_met_by(self, board: f64) -> bool {
        if self.number == HOMING {
            // grblHAL has more bits in this setting.
            return board as u32 & 1 == 1;
        }
        (board - self.value).abs() <= ROUNDING.max(self.value.abs() * SINGLE)
    }

    /// Returns the line that writes the setting to the board, for instance `$11=0.020`.
    pub fn line(self) -> String {
        format!("${}={}", self.number, figure(self.value))
    }
}

/// A setting that differs from the required one, with the line that corrects it. Without such a
/// line only the owner can correct the setting, in the configuration file of the board.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SettingDeviation {
    pub(super) difference: SettingDifference,
    pub(super) line: Option<String>,
}

/// Formats a number for the board: without decimals if it is an integer, otherwise with three.
pub(super) fn figure(value: f64) -> String {
    if value.fract() == 0.0 {
        format!("{value:.0}")
    } else {
        format!("{value:.3}")
    }
}

/// All settings that a board must have for the control.
#[derive(Clone, Debug, PartialEq)]
pub struct RequiredSettings {
    /// The required settings, sorted by number.
    pub settings: Vec<Setting>,
    /// Number of pulses per mm of slide travel, for X and Z.
    pub pulses_per_mm: [f64; 2],
}

impl RequiredSettings {
    /// Computes the required settings from the drives and the section `link` of the machine file.
    pub fn new(drives: &Drives, config: &LinkConfig) -> Self {
        let weights = [drives.pulse_weight.x, drives.pulse_weight.z];
        // The board rounds to three decimals.
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
