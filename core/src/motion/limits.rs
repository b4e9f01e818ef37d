//! Speed and acceleration limits from the parameters, in mm and seconds.

use serde::{Deserialize, Serialize};

use super::gear::{GearLaw, gear_law};
use super::ramp::SpeedLaw;
use crate::axis::gear_speed_limit;
use crate::memory::ControlParameters;
use crate::model::{ControlModel, ncb08};
use crate::units::{Axis, PerAxis, Point};

/// Lowest start and end speed of the exponential law, mm/min. With 030 or 041 = 0 the
/// exponential tail would never end.
const MIN_LOWEST_MM_PER_MIN: f64 = 1.0;

/// Rates and accelerations from the parameters; computed again when a parameter
/// changes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MotionLimits {
    rapid: PerAxis<f64>,
    rapid_law: PerAxis<SpeedLaw>,
    lowest_rapid: f64,
    /// Highest speed of straight rapids with an S-shaped speed profile, mm/s; `None`: each
    /// axis moves at its own rate.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    straight_rapid: Option<f64>,
    /// Whether the speed of straight rapids rises and falls linearly instead of in an S-curve.
    #[serde(default, skip_serializing_if = "core::ops::Not::not")]
    linear_rapid: bool,
    cutting: f64,
    cutting_law: SpeedLaw,
    exact_corners: bool,
    /// Whether a macro B program has switched exact corners off.
    #[serde(default)]
    #[serde(rename = "corners_passed")]
    exact_corners_off: bool,
    jog_law: SpeedLaw,
    gear_law: GearLaw,
    #[serde(rename = "tail_rate")]
    run_out_rate: f64,
    #[serde(rename = "tail_time")]
    run_out_time: f64,
    pulse_limit: PerAxis<Option<f64>>,
}

impl From<&ControlParameters> for MotionLimits {
    fn from(parameters: &ControlParameters) -> Self {
        let per_second = |rate: f64| rate.max(1.0) / 60.0;
        let rapid = |axis| per_second(parameters.rapid_rate(axis));
        let law = |axis| SpeedLaw::linear(rapid(axis), parameters.rapid_time(axis) / 1000.0);
        let time = parameters.feed_time() / 1000.0;
        let lowest = |rate: f64| rate.max(MIN_LOWEST_MM_PER_MIN) / 60.0;
        Self {
            rapid: PerAxis::new(rapid(Axis::X), rapid(Axis::Z)),
            rapid_law: PerAxis::new(law(Axis::X), law(Axis::Z)),
            lowest_rapid: per_second(parameters.lowest_rapid_rate()),
            straight_rapid: None,
            linear_rapid: false,
            cutting: per_second(parameters.feed_limit()),
            cutting_law: SpeedLaw::exponential(time, lowest(parameters.feed_start_speed())),
            exact_corners: parameters.has_exact_corners(),
            exact_corners_off: false,
            jog_law: SpeedLaw::exponential(time, lowest(parameters.jog_start_speed())),
            gear_law: gear_law(parameters),
            run_out_rate: parameters.run_out_rate() / 60.0,
            run_out_time: parameters.run_out_time() / 1000.0,
            pulse_limit: PerAxis::new(
                gear_speed_limit(Axis::X, parameters),
                gear_speed_limit(Axis::Z, parameters),
            ),
        }
    }
}

impl MotionLimits {
    /// Computes the limits of a control model from its parameters; unlike `From`, it includes the
    /// straight rapids of models that have them.
    pub fn from_model(parameters: &ControlParameters, model: &ControlModel) -> Self {
        let limits = Self::from(parameters);
        if !model.record().are_rapids_straight() {
            return limits;
        }
        let limit = f64::from(model.parameter(ncb08::RAPID_LIMIT)) / 60.0;
        Self {
            straight_rapid: Some(limit),
            linear_rapid: model.parameter(ncb08::RAPID_PROFILE) == 1,
            ..limits
        }
    }

    /// Whether a rapid moves in a straight line, so that both axes arrive together.
    pub(super) const fn rapids_are_straight(&self) -> bool {
        self.straight_rapid.is_some()
    }

    /// Highest speed along a straight rapid, mm/s; infinite if the model sets no limit.
    pub(super) fn straight_rapid(&self) -> f64 {
        self.straight_rapid.unwrap_or(f64::INFINITY)
    }

    /// Whether the speed of straight rapids rises and falls linearly instead of in an S-curve.
    pub(super) const fn has_linear_rapids(&self) -> bool {
        self.linear_rapid
    }

    /// Rapid rate of an axis at 100 % (022, 023; X as a radius), mm/min.
    pub const fn rapid_rate(&self, axis: Axis) -> f64 {
        *self.rapid.get(axis) * 60.0
    }

    /// Returns the upper limit of the cutting feed (027), mm/min.
    pub(crate) const fn cutting_rate(&self) -> f64 {
        self.cutting * 60.0
    }

    /// Whether the gear ratio of an axis limits its speed (CMR > CMD).
    pub(crate) const fn gear_limits_speed(&self) -> bool {
        self.pulse_limit.x.is_some() || self.pulse_limit.z.is_some()
    }

    /// The first axis that exceeds the speed limit of its electronic gear (alarm 097), with that
    /// limit in mm/min; `None` if none does. `speed` is in mm/min.
    pub(crate) fn exceeded_gear_limit(&self, speed: Point) -> Option<(Axis, f64)> {
        [Axis::X, Axis::Z].into_iter().find_map(|axis| {
            let limit = (*self.pulse_limit.get(axis))?;
            (speed.get(axis).abs() > limit + 1e-6).then_some((axis, limit))
        })
    }

    /// Highest speed of an axis in a thread, mm/min, and the number of the parameter that
    /// limits it: rapid rate (022, 023) or cutting feed limit (027).
    pub(crate) fn thread_limit(&self, axis: Axis) -> (f64, u16) {
        let (rapid, cutting) = (self.rapid_rate(axis), self.cutting_rate());
        match axis {
            _ if cutting < rapid => (cutting, 27),
            Axis::X => (rapid, 22),
            Axis::Z => (rapid, 23),
        }
    }

    pub(super) const fn rapid(&self, axis: Axis) -> f64 {
        *self.rapid.get(axis)
    }

    pub(super) const fn rapid_law(&self, axis: Axis) -> &SpeedLaw {
        self.rapid_law.get(axis)
    }

    /// Returns the lowest rapid rate F0 (032), mm/s.
    pub(super) const fn lowest_rapid(&self) -> f64 {
        self.lowest_rapid
    }

    pub(super) const fn cutting(&self) -> f64 {
        self.cutting
    }

    pub(super) const fn cutting_law(&self) -> &SpeedLaw {
        &self.cutting_law
    }

    /// Sets whether a macro B program has switched exact corners off (#3004).
    pub(crate) const fn set_exact_corners_off(&mut self, off: bool) {
        self.exact_corners_off = off;
    }

    /// Whether each cut ends at its end point before the next begins (007.3).
    pub(crate) const fn has_exact_corners(&self) -> bool {
        self.exact_corners && !self.exact_corners_off
    }

    /// The law by which the electronic gear of threads changes its rate in lead-in and lead-out
    /// (028, 029, 175.4).
    pub(crate) const fn gear_law(&self) -> &GearLaw {
        &self.gear_law
    }

    /// Speed of X in the run-out of a thread (107), mm/s; 0: the run-out has the speed of
    /// the thread.
    pub(super) const fn run_out_rate(&self) -> f64 {
        self.run_out_rate
    }

    /// Time constant of X in the run-out of a thread (026), s.
    pub(super) const fn run_out_time(&self) -> f64 {
        self.run_out_time
    }

    pub(super) const fn jog_law(&self) -> &SpeedLaw {
        &self.jog_law
    }
}
