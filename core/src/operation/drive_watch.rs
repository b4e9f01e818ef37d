//! Supervision of the alarm and ready signals of the drives (manual III-12.3).

use crate::units::PerAxis;
use serde::{Deserialize, Serialize};

/// What the control has observed of the drives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct DriveWatch {
    /// Whether all drives have answered their enable without an alarm.
    #[serde(default)]
    pub ready: bool,
    /// Duration of the disagreement between ready signal and enable, ms.
    #[serde(rename = "disagree")]
    pub disagree_ms: PerAxis<u16>,
}
