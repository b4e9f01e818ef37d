//! Supervision of the alarm and ready signals of the drives (manual III-12.3).

use crate::units::PerAxis;
use serde::{Deserialize, Serialize};

/// State of the drives as the control has observed it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct DriveWatch {
    /// Whether all drives have followed their enable without an alarm.
    #[serde(default)]
    pub ready: bool,
    /// Duration for which the ready signal of each drive has differed from its enable, ms.
    #[serde(rename = "disagree")]
    pub disagree_ms: PerAxis<u16>,
}
