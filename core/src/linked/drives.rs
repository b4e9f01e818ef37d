//! Drive settings of a board from the control's parameters.

use gsk_link::Drives;

use crate::axis::pulse_weight;
use crate::board::board_rates;
use crate::memory::ControlParameters;
use crate::units::{Axis, PerAxis};

/// Pulse weights and rates of both axes for the board, from 015–018, 022–025 and 027.
pub fn drives_from_parameters(parameters: &ControlParameters) -> Drives {
    let axis_settings = |axis| {
        (
            pulse_weight(axis, parameters),
            board_rates(axis, parameters),
        )
    };
    let (x, z) = (axis_settings(Axis::X), axis_settings(Axis::Z));
    Drives {
        pulse_weight: PerAxis::new(x.0, z.0),
        rates: PerAxis::new(x.1, z.1),
    }
}
