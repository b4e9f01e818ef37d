//! The motion that was commanded to the board.

use crate::units::{PerAxis, Pulses};
use gsk_link::RunTime;

/// The motion that was last passed to the board.
#[derive(Clone, Copy, Debug)]
pub(super) struct CommandedMotion {
    pub(super) pulses: PerAxis<Pulses>,
    /// Kernel time at the end of the last tick that made a pulse.
    pub(super) last_motion_end: RunTime,
    /// Whether any pulse was commanded in the last tick.
    pub(super) moved: bool,
    /// Number of stops since the opening after which the control continued from another
    /// position.
    pub(super) resync_count: u64,
}

impl CommandedMotion {
    pub(super) const fn new(pulses: PerAxis<Pulses>) -> Self {
        Self {
            pulses,
            last_motion_end: RunTime::ZERO,
            moved: false,
            resync_count: 0,
        }
    }

    /// Sets the pulse count without a motion to it.
    pub(super) const fn set_count(&mut self, pulses: PerAxis<Pulses>) {
        self.pulses = pulses;
        self.moved = false;
    }
}
