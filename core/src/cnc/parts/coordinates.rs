//! Coordinate systems, and the axes whose coordinates are known.

use serde::{Deserialize, Serialize};

use crate::command::Frame;
use crate::operation::ZeroReturnStage;
use crate::units::{PerAxis, Point};

/// Coordinate frame, zero points and reference returns of the axes.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Coordinates {
    /// Work zero and tool offset in force.
    pub frame: Frame,
    /// Absolute coordinates at which the display of relative coordinates shows zero, mm.
    pub relative_zero: Point,
    /// Machine coordinates of the program zero point, mm; `None` until a G50 has run.
    pub program_zero: Option<Point>,
    /// Programmed X minus X of the tool tip at the end of the last move, mm (radius).
    #[serde(rename = "programmed_ahead")]
    pub programmed_x_lead: f64,
    /// Axes whose signal PRO (at the program zero) was ended by an emergency stop or a drive alarm,
    /// and which have not left the program zero since then.
    #[serde(default)]
    pub program_zero_ended: PerAxis<bool>,
    /// Axes whose reference point the control knows.
    pub referenced: PerAxis<bool>,
    /// Machine coordinate of the reference point at which each axis is, mm; `None` if the
    /// axis is elsewhere.
    pub at_reference: PerAxis<Option<f64>>,
    /// Stage of the zero return of each axis; `None` without a return.
    pub returns: PerAxis<Option<ZeroReturnStage>>,
}
