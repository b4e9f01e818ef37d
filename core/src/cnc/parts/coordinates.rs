//! Coordinate systems, and the axes whose coordinates are known.

use serde::{Deserialize, Serialize};

use crate::command::Frame;
use crate::operation::ZeroReturnStage;
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
    /// Programmed X minus X of the tip at the end of the last move, mm.
    #[serde(rename = "programmed_ahead")]
    pub programmed_x_lead: f64,
    /// Axes whose PRO an emergency stop or a drive alarm ended, and which have not left the
    /// program zero since.
    #[serde(default)]
    pub program_zero_ended: PerAxis<bool>,
    /// Axes whose reference point is established.
    pub referenced: PerAxis<bool>,
    /// Machine coordinate of the reference point at which an axis is; `None`: elsewhere.
    pub at_reference: PerAxis<Option<f64>>,
    /// Stage of the return under way of each axis.
    pub returns: PerAxis<Option<ZeroReturnStage>>,
}
