//! Stages of a return to the machine zero (manual III-7, II-2.8.3).

use serde::{Deserialize, Serialize};

/// How far the return of one axis has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Return {
    /// At rapid to a known place: method A, program zero.
    Straight,
    /// Towards the zero, until the deceleration switch.
    Approach,
    /// On the switch at the low rate, until it is released.
    OnSwitch,
    /// Method B: at the low rate until the zero signal.
    Search,
    /// Method C: past the switch, coming to rest.
    Turning,
    /// Method C: back at the low rate, until the switch is met again.
    Back,
    /// At a pulse board, the limit switch being the reference: back off it.
    Leave,
    /// At a pulse board: at the low rate to this machine coordinate, µm, past the edge
    /// of the switch.
    Past(i64),
    /// A pulse board seeks its switch by itself.
    Board,
    /// The zero signal has come; stands until its motor has come to rest.
    Rest {
        /// Ticks that are left.
        ticks: u16,
        /// The machine coordinates are others now.
        shifted: bool,
    },
}
