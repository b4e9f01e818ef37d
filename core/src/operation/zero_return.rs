//! Stages of a reference return (manual III-7, II-2.8.3).

use serde::{Deserialize, Serialize};

/// Stage of the reference return of one axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum ZeroReturnStage {
    /// At rapid to a known position: method A, program zero.
    Straight,
    /// Towards the reference, until the deceleration switch.
    Approach,
    /// On the switch at the low rate, until it is released.
    OnSwitch,
    /// Method B: at the low rate until the zero signal.
    Search,
    /// Method C: past the switch, stopping.
    #[serde(rename = "Turning")]
    Stopping,
    /// Method C: back at the low rate until the switch is met again.
    Back,
    /// With a pulse board whose limit switch is the reference: backing off the switch.
    #[serde(rename = "Leave")]
    LeaveLimit,
    /// With a pulse board: at the low rate past the switch edge to this machine coordinate,
    /// µm.
    #[serde(rename = "Past")]
    PastEdge(i64),
    /// A pulse board homes the axis on its own.
    #[serde(rename = "Board")]
    BoardHoming,
    /// The zero signal has come; the axis waits until its motor has stopped.
    #[serde(rename = "Rest")]
    MotorWait {
        /// Ticks left to wait.
        ticks: u16,
        /// Whether the machine coordinates have been set.
        shifted: bool,
    },
}
