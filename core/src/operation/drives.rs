//! What the alarm and ready signals of the drives have led to (manual III-12.3).

use crate::units::PerAxis;
use serde::{Deserialize, Serialize};

/// How long the ready signals have disagreed with the enable, ms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct DriveWatch {
    pub disagree: PerAxis<u16>,
}
