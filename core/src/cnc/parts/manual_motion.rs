//! State of manual motion: jog keys and handwheel.

use serde::{Deserialize, Serialize};

use crate::motion::{JogRate, Retrace};
use crate::operation::WheelCounter;
use crate::units::PerAxis;

/// The axis keys that are down, and the manual motion of the axes.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct ManualMotion {
    /// Whether the axis key must be released first, because it was down when its motion was
    /// stopped or refused.
    pub jog_blocked: PerAxis<bool>,
    /// Direction (`true`: plus) and rate of the current jog of each axis; `None` without a jog.
    pub jog: PerAxis<Option<(bool, JogRate)>>,
    /// Axis keys that were down at the last tick.
    pub axis_keys: PerAxis<bool>,
    /// Counts the graduations of the handwheel.
    pub wheel: WheelCounter,
    /// The path that the handwheel retraces in a held run; `None` while this is switched off.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub retrace: Option<Retrace>,
}
