//! Working on the ladder of a live control: halt and step, forced bits, a new
//! ladder for the next power-on.

use std::sync::Arc;

use gsk_plc::Ladder;

use super::Cnc;
use crate::operation::SoftSwitch;

/// How far the halted ladder goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LadderStep {
    /// One rung.
    Rung,
    /// One slot of 8 ms: level 1 and a part of level 2.
    Slot,
}

impl Cnc {
    /// Lets the halted ladder go on by a step; what it decides acts at once.
    pub(super) fn step_ladder(&mut self, step: LadderStep) {
        if !self.plc_halted {
            return;
        }
        let was = self.from_plc.clone();
        match step {
            LadderStep::Rung => self.plc.step_rung(),
            LadderStep::Slot => self.plc.slot(),
        }
        self.hear_plc(&was);
    }

    /// Whether the ladder is halted for stepping.
    pub const fn ladder_halted(&self) -> bool {
        self.plc_halted
    }

    /// The ladder that was loaded and waits for the next power-on.
    pub const fn next_ladder(&self) -> Option<&Arc<Ladder>> {
        self.next_ladder.as_ref()
    }

    /// The ladder that power-on finds.
    pub(super) fn ladder_at_power_on(&self) -> Arc<Ladder> {
        Arc::clone(self.next_ladder.as_ref().unwrap_or(self.plc.ladder()))
    }

    /// Whether a switch of the soft machine panel is on.
    pub const fn soft_switch(&self, switch: SoftSwitch) -> bool {
        self.soft_switches & switch.mask() != 0
    }

    /// KEY1, G46.3: the ladder forbids changes of programs, offsets and parameters.
    pub const fn memory_protected(&self) -> bool {
        self.from_plc.memory_protect
    }
}
