//! Stages of a reference return (manual III-7, II-2.8.3).

use serde::{Deserialize, Serialize};

/// Stage of the reference return of one axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum ZeroReturnStage {
    /// The axis moves at rapid to a known position (method A, program zero).
    Straight,
    /// The axis moves towards the reference, until the deceleration switch is pressed.
    Approach,
    /// The axis moves at the low rate until the pressed switch is released.
    OnSwitch,
    /// Method B: the axis moves at the low rate until the zero signal comes.
    Search,
    /// Method C: the axis is past the switch and stops.
    #[serde(rename = "Turning")]
    Stopping,
    /// Method C: the axis moves back at the low rate until the switch is pressed again.
    Back,
    /// Limit switch of a pulse board as the reference: the axis moves off the switch.
    #[serde(rename = "Leave")]
    LeaveLimit,
    /// With a pulse board: the axis moves at the low rate past the edge of its switch to
    /// this machine coordinate, µm (X as a radius).
    #[serde(rename = "Past")]
    PastEdge(i64),
    /// A pulse board homes the axis, without motion commands of the control.
    #[serde(rename = "Board")]
    BoardHoming,
    /// The zero signal has come; the axis waits until its motor has stopped.
    #[serde(rename = "Rest")]
    MotorWait {
        /// Number of ticks for which the motor must still wait.
        ticks: u16,
        /// Whether the machine coordinates have been set at the reference point.
        shifted: bool,
    },
}
