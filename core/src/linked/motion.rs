//! What was commanded of the board.

use crate::units::{PerAxis, Pulses};
use gsk_link::RunTime;

/// Motion of the control that the board was given.
#[derive(Clone, Copy, Debug)]
pub(super) struct Commanded {
    pub(super) pulses: PerAxis<Pulses>,
    /// End of the last tick that made a pulse.
    pub(super) last: RunTime,
    /// The last tick made one.
    pub(super) moved: bool,
    /// Stops since the opening behind which the control went on from another position.
    pub(super) stops: u64,
}

impl Commanded {
    pub(super) const fn new(pulses: PerAxis<Pulses>) -> Self {
        Self {
            pulses,
            last: RunTime::ZERO,
            moved: false,
            stops: 0,
        }
    }

    /// The control stands here, without having moved there.
    pub(super) const fn stand_at(&mut self, pulses: PerAxis<Pulses>) {
        self.pulses = pulses;
        self.moved = false;
    }
}
