//! Coordinate systems, and which of them is known.

use serde::{Deserialize, Serialize};

use crate::command::Frame;
use crate::operation::Return;
use crate::units::{PerAxis, Point};

/// Frames and references.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Coordinates {
    /// Work zero and tool offset in force.
    pub frame: Frame,
    /// Absolute coordinate at which the relative display shows zero.
    pub relative_zero: Point,
    /// Machine coordinate of the program zero point, once a G50 has run.
    pub program_zero: Option<Point>,
    /// Programmed X minus that of the tip, at the end of the last move.
    pub programmed_ahead: f64,
    /// Axes that have not left the program zero point since an emergency stop or an alarm
    /// of the drives ended PRO there.
    #[serde(default)]
    pub program_zero_ended: PerAxis<bool>,
    /// Axes with a reference.
    pub referenced: PerAxis<bool>,
    /// Coordinate of the reference point an axis stands at.
    pub at_reference: PerAxis<Option<f64>>,
    /// Returns to a zero under way.
    pub returns: PerAxis<Option<Return>>,
}
