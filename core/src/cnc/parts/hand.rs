//! Motion by hand: jog keys and handwheel.

use serde::{Deserialize, Serialize};

use crate::motion::JogRate;
use crate::operation::WheelCounter;
use crate::units::PerAxis;

/// Keys that are down and what the axes make of them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct HandMotion {
    /// A key that was down when its motion was refused: it must be let go first.
    pub jog_blocked: PerAxis<bool>,
    /// Direction (`true`: plus) and rate of the jog under way.
    pub jog: PerAxis<Option<(bool, JogRate)>>,
    /// Axis keys that were down at the last tick.
    pub axis_keys: PerAxis<bool>,
    /// Detents of the handwheel.
    pub wheel: WheelCounter,
}
