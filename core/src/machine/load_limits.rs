//! Limits of a lathe under the load of a cut, from its machine file.

use core::f64::consts::PI;

use serde::{Deserialize, Serialize};

/// What spindle, slides, chuck and bars bear. The check of the load reads it. With `events` a
/// cut above a limit also stalls the simulated spindle or loosens the stock.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LoadLimits {
    /// Rated power at the spindle, kW; `None`: neither power nor torque is checked.
    pub power_kw: Option<f64>,
    /// Speed above which the spindle has its rated power, r/min; below it the torque is constant.
    /// `None`: the rated power at every speed.
    pub base_rpm: Option<f64>,
    /// Greatest overhang of stock without a tailstock, in diameters; `None`: not checked.
    pub stock_overhang: Option<f64>,
    /// Greatest overhang of a boring bar, in diameters. The default holds for steel bars (Widia,
    /// general catalogue 2017, p. 456).
    pub bar_overhang: f64,
    /// Greatest change of a diameter because boring bar and stock give way, mm.
    #[serde(skip_serializing_if = "is_default_size_error")]
    pub size_error_mm: f64,
    /// Greatest force of a slide against the feed, N; `None`: not checked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub axis_force_n: Option<f64>,
    /// Greatest torque that the chuck holds, N·m; `None`: not checked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub grip_nm: Option<f64>,
    /// Whether a cut above a limit breaks the insert, stalls the spindle, or loosens the stock of
    /// the simulated lathe.
    #[serde(skip_serializing_if = "is_false")]
    pub events: bool,
}

/// Greatest change of a diameter without another value in the machine file, mm.
const DEFAULT_SIZE_ERROR_MM: f64 = 0.1;

/// Rated power, kW, and base speed, r/min, to which a load is compared if the machine file names no
/// power.
const USUAL_POWER_KW: f64 = 5.5;
const USUAL_BASE_RPM: f64 = 1000.0;
/// Force of a slide, N, to which a load is compared if the machine file names none.
const USUAL_AXIS_FORCE_N: f64 = 5000.0;

// The state of a lathe without these fields has the hash of recordings made before them.
const fn is_default_size_error(value: &f64) -> bool {
    value.to_bits() == DEFAULT_SIZE_ERROR_MM.to_bits()
}

const fn is_false(value: &bool) -> bool {
    !*value
}

impl Default for LoadLimits {
    fn default() -> Self {
        Self {
            power_kw: None,
            base_rpm: None,
            stock_overhang: None,
            bar_overhang: 4.0,
            size_error_mm: DEFAULT_SIZE_ERROR_MM,
            axis_force_n: None,
            grip_nm: None,
            events: false,
        }
    }
}

impl LoadLimits {
    /// The torque of the spindle below its base speed, N·m; `None` without power or base speed.
    pub fn rated_torque_nm(&self) -> Option<f64> {
        let (power, base) = (self.power_kw?, self.base_rpm?);
        Some(power * 30_000.0 / (PI * base))
    }

    /// The torque of the spindle at a speed, r/min, N·m; `None` without a rated power.
    pub fn torque_at(&self, rpm: f64) -> Option<f64> {
        let from_power = self.power_kw? * 30_000.0 / (PI * rpm.max(1e-3));
        let greatest = self.rated_torque_nm().unwrap_or(f64::INFINITY);
        Some(from_power.min(greatest))
    }

    /// The torque of a cut, N·m, as a percentage of that of the spindle at a speed, r/min. Without a
    /// rated power it is compared to a spindle of 5.5 kW from 1000 r/min.
    pub fn spindle_load_percent(&self, torque_nm: f64, rpm: f64) -> f64 {
        let usual = Self {
            power_kw: Some(USUAL_POWER_KW),
            base_rpm: Some(USUAL_BASE_RPM),
            ..Self::default()
        };
        let rated = self.torque_at(rpm).or_else(|| usual.torque_at(rpm));
        rated.map_or(0.0, |rated| 100.0 * torque_nm / rated)
    }

    /// A force along a slide, N, as a percentage of the greatest one; without that of 5000 N.
    pub fn axis_load_percent(&self, force_n: f64) -> f64 {
        100.0 * force_n.abs() / self.axis_force_n.unwrap_or(USUAL_AXIS_FORCE_N)
    }

    /// Whether the torque limits the spindle at a speed, r/min, and not its power.
    pub fn is_torque_limited(&self, rpm: f64) -> bool {
        self.base_rpm.is_some_and(|base| rpm < base)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rated_torque_is_that_of_the_base_speed() {
        let limits = LoadLimits {
            power_kw: Some(7.5),
            base_rpm: Some(1500.0),
            ..LoadLimits::default()
        };
        // 9550 · 7.5 / 1500
        let torque = limits.rated_torque_nm().expect("both are given");
        assert!((torque - 47.75).abs() < 0.01, "{torque}");
        assert!(limits.is_torque_limited(1499.0) && !limits.is_torque_limited(1500.0));
        assert_eq!(LoadLimits::default().rated_torque_nm(), None);
    }

    #[test]
    fn a_load_is_compared_to_the_machine_file_or_to_a_usual_lathe() {
        let limits = LoadLimits {
            power_kw: Some(7.5),
            base_rpm: Some(1500.0),
            axis_force_n: Some(2000.0),
            ..LoadLimits::default()
        };
        let percent = |limits: &LoadLimits, rpm| limits.spindle_load_percent(47.75, rpm).round();
        assert_eq!(
            (percent(&limits, 300.0), percent(&limits, 3000.0)),
            (100.0, 200.0)
        );
        assert_eq!(limits.axis_load_percent(-500.0), 25.0);
        // 9550 · 5.5 / 1000 = 52.5 N·m
        let usual = LoadLimits::default();
        assert_eq!(
            (percent(&usual, 300.0), percent(&usual, 2000.0)),
            (91.0, 182.0)
        );
        assert_eq!(usual.axis_load_percent(500.0), 10.0);
    }
}
