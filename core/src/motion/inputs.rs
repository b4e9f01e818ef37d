//! Inputs of the motion besides its command (overrides, spindle, hold), and the speeds that follow
//! from them.

use serde::{Deserialize, Serialize};

use super::limits::MotionLimits;
use crate::spindle::SpindleTurn;
use crate::units::{Axis, Feed, PerAxis, min_not_nan};

/// The override of rapids: F0 or a percentage.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum RapidOverride {
    /// F0: rapids have the lowest rapid rate (032).
    F0,
    /// Rapids have this percentage of the rapid rates, 1–100.
    Percent(u8),
}

impl RapidOverride {
    /// Converts a rapid override from a percentage, where 0 means F0.
    pub(crate) const fn from_percent(percent: u8) -> Self {
        if percent == 0 {
            Self::F0
        } else {
            Self::Percent(percent)
        }
    }
}

/// The rates with which dry run replaces the programmed ones (manual III-5.3.2).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DryRun {
    /// Rate of cuts in dry run, mm/min.
    #[serde(rename = "cutting")]
    pub cutting_mm_per_min: f64,
    /// Rate of rapids in dry run, mm/min; `None`: the usual rapid rates apply.
    #[serde(rename = "rapid")]
    pub rapid_mm_per_min: Option<f64>,
}

/// Inputs of the interpolator in a tick, besides the motion itself.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MotionInputs {
    /// Feed override as a factor, 0.0–1.5.
    pub feed_override: f64,
    /// Override of rapids, in programs and by hand.
    pub rapid_override: RapidOverride,
    /// Measured spindle speed, r/min; negative in reverse.
    pub spindle_rpm: f64,
    /// Measured spindle angle before and after the tick, turns.
    pub spindle: SpindleTurn,
    /// Whether another thread continues in phase from the current thread.
    pub thread_continues: bool,
    /// Whether another cut continues from the current cut without a stop (007.3 = 0).
    pub cut_continues: bool,
    /// Whether feed hold or an interlock stops programmed motion.
    pub hold: bool,
    /// Dry run rates; `None` if dry run is off. The axes stop when it is switched.
    pub dry_run: Option<DryRun>,
}

impl Default for MotionInputs {
    /// Overrides of 100 %, no hold, spindle at standstill.
    fn default() -> Self {
        Self {
            feed_override: 1.0,
            rapid_override: RapidOverride::Percent(100),
            spindle_rpm: 0.0,
            spindle: SpindleTurn::default(),
            thread_continues: false,
            cut_continues: false,
            hold: false,
            dry_run: None,
        }
    }
}

/// Rapid rate of an axis after the rapid override, mm/s.
pub(super) fn rapid_rate(limits: &MotionLimits, rapid_override: RapidOverride, axis: Axis) -> f64 {
    let rate = limits.rapid(axis);
    match rapid_override {
        RapidOverride::F0 => limits.lowest_rapid().min(rate),
        RapidOverride::Percent(percent) => rate * f64::from(percent.min(100)) / 100.0,
    }
}

/// Target speed of each axis in a rapid, mm/s; 0 while the rapid must stop (`stop`).
pub(super) fn rapid_targets(
    limits: &MotionLimits,
    inputs: &MotionInputs,
    stop: bool,
) -> PerAxis<f64> {
    if stop {
        return PerAxis::new(0.0, 0.0);
    }
    PerAxis::new(
        rapid_target(limits, inputs, Axis::X),
        rapid_target(limits, inputs, Axis::Z),
    )
}

fn rapid_target(limits: &MotionLimits, inputs: &MotionInputs, axis: Axis) -> f64 {
    match inputs.dry_run {
        Some(DryRun {
            rapid_mm_per_min: Some(rate),
            ..
        }) => (rate / 60.0).min(limits.rapid(axis)),
        _ => rapid_rate(limits, inputs.rapid_override, axis),
    }
}

/// Target speed of a cut after override, dry run and limits, mm/s.
pub(super) fn cutting_target(limits: &MotionLimits, inputs: &MotionInputs, feed: Feed) -> f64 {
    let per_minute = match (inputs.dry_run, feed) {
        (Some(dry_run), _) => dry_run.cutting_mm_per_min,
        (None, Feed::PerMinute(rate)) => rate * inputs.feed_override,
        (None, Feed::PerRevolution(per_revolution)) => {
            per_revolution * inputs.spindle_rpm.abs() * inputs.feed_override
        }
    };
    min_not_nan(per_minute / 60.0, limits.cutting())
}
