//! Working on the ladder of a live control: halt and step, forced bits, a new
//! ladder for the next power-on.

use std::sync::Arc;

use gsk_plc::{Ladder, Memory};

use super::Cnc;
use crate::memory::Parameters;

/// How far the halted ladder goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LadderStep {
    /// One rung.
    Rung,
    /// One slot of 8 ms: level 1 and a part of level 2.
    Slot,
}

/// Data parameters that are timer presets of the ladder: (DT entry, parameter).
pub(super) const TIMER_PRESETS: [(u16, u16); 14] = [
    (0, 65),
    (1, 66),
    (2, 69),
    (3, 76),
    (4, 78),
    (5, 80),
    (6, 81),
    (7, 82),
    (8, 83),
    (9, 85),
    (10, 87),
    (11, 89),
    (12, 108),
    (13, 112),
];
/// K9: the mode that the ladder restores at power-on.
const MODE_AT_POWER_ON: u16 = 9;

/// What the control tells the PLC before its first scan: timer presets, and the
/// mode of 174 (manual III-1.3; MDOK = 0: the one at power-off, which K9 holds).
pub(super) fn preset_plc(memory: &mut Memory, parameters: &Parameters) {
    for (entry, parameter) in TIMER_PRESETS {
        memory.set_dt(entry, parameters.value(parameter));
    }
    let mode = parameters.byte(174);
    if mode & 0b1_0000 != 0 {
        memory.set_k(
            MODE_AT_POWER_ON,
            match mode & 0b111 {
                0b001 => 1,
                0b010 => 133,
                0b011 => 3,
                0b100 => 4,
                0b101 => 5,
                _ => 0,
            },
        );
    }
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
}
