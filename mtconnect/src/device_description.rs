//! What the machine file says about a lathe.

use gsk_core::cnc::Cnc;
use gsk_core::machine::{AxisConfig, LatheConfig};
use gsk_core::units::Axis;

/// The properties of a lathe that the probe document states besides its data items.
#[derive(Clone, Debug, PartialEq)]
pub struct DeviceDescription {
    /// Name of the lathe in its machine file.
    pub lathe_name: String,
    /// Name of the control model, such as `GSK980TD`.
    pub control_model: String,
    /// Greatest spindle speed of the current gear, r/min.
    pub max_speed_rpm: f64,
    /// Ends of the travel of X and Z in machine coordinates, mm (X as a diameter).
    pub travel: [(f64, f64); 2],
}

impl DeviceDescription {
    /// Describes a lathe by its machine file and the control that drives it.
    pub fn new(config: &LatheConfig, cnc: &Cnc) -> Self {
        let travel = |axis, slide: &AxisConfig| match slide.limits {
            Some(limits) => (limits.minus, limits.plus),
            None => {
                let ends = slide.slide_ends(axis);
                (ends.minus, ends.plus)
            }
        };
        Self {
            lathe_name: config.name.clone(),
            control_model: cnc.model().id().plate_name().to_owned(),
            max_speed_rpm: cnc.spindle().top_speed(),
            travel: [travel(Axis::X, &config.x), travel(Axis::Z, &config.z)],
        }
    }
}
