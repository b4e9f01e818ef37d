//! Drive settings of a board from the control's parameters.

use gsk_link::Drives;

use crate::axis::pulse_weight;
use crate::board::board_rates;
use crate::memory::Parameters;
use crate::units::{Axis, PerAxis};

/// Pulse weights and rates for opening a board, from 015–018, 022–025 and 027.
pub fn drives(parameters: &Parameters) -> Drives {
    let both = |axis| {
        (
            pulse_weight(axis, parameters),
            board_rates(axis, parameters),
        )
    };
    let (x, z) = (both(Axis::X), both(Axis::Z));
    Drives {
        pulse_weight: PerAxis::new(x.0, z.0),
        rates: PerAxis::new(x.1, z.1),
    }
}
