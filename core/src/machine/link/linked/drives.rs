//! What a board is set up for, beside what the control wants now.

use super::Linked;
use crate::axis::pulse_weight;
use crate::memory::Parameters;
use crate::units::Axis;

/// The parameters that a board is set up for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Drives {
    /// Gears 015–018, as travel of a pulse.
    weights: [f64; 2],
    /// Rapids 022, 023 and their time constants 024, 025.
    rapids: [[f64; 2]; 2],
    /// Fastest cut 027.
    cut: f64,
}

impl Drives {
    pub(super) fn of(parameters: &Parameters) -> Self {
        let axes = [Axis::X, Axis::Z];
        Self {
            weights: axes.map(|axis| pulse_weight(axis, parameters)),
            rapids: axes.map(|axis| [parameters.rapid_rate(axis), parameters.rapid_time(axis)]),
            cut: parameters.feed_limit(),
        }
    }
}

impl Linked {
    /// Whether the board would have to be set up anew for parameters that were changed.
    pub(super) fn is_outdated(&mut self, parameters: &Parameters) -> bool {
        let drives = Drives::of(parameters);
        if drives == self.drives {
            return false;
        }
        let fits = self.link.fits(&self.config, parameters);
        if fits {
            self.drives = drives;
        }
        !fits
    }
}
