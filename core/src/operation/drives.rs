//! What the alarm and ready signals of the drives have led to (manual III-12.3).

use crate::units::PerAxis;
use serde::{Deserialize, Serialize};

/// What the control has seen of the drives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct DriveWatch {
    /// All drives have answered their enable and have no alarm.
    #[serde(default)]
    pub ready: bool,
    /// How long the ready signals have disagreed with the enable, ms.
    pub disagree: PerAxis<u16>,
}
