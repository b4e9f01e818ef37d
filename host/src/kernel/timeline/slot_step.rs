//! Steps from one slot of the ladder to the next or the previous one, in the past.

use gsk_core::cnc::SLOT_TICKS;
use gsk_messages::say;

use crate::kernel::{Kernel, Notice};

impl Kernel {
    /// Shows the state after the slot of the ladder before or after the shown moment. With a
    /// board only its stored states can be shown.
    pub(super) fn step_slot(&mut self, back: bool) {
        if self.has_real_slides || self.timeline.has_linked_states {
            return self.notify(Notice::Message(say::timeline_not_with_board()));
        }
        let shown = self.shown_machine();
        let (tick, since) = (shown.ticks(), shown.cnc().ticks_since_ladder_slot());
        let target = match (back, since) {
            (true, 0) => tick.saturating_sub(SLOT_TICKS),
            (true, since) => tick.saturating_sub(since),
            (false, since) => tick + SLOT_TICKS - since,
        };
        self.look_at(target);
    }
}
