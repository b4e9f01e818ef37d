//! Working on a running ladder by hand: forced bits, the scan rung by rung,
//! and where power flows.

use serde::{Deserialize, Serialize};

use crate::address::BitAddress;
use crate::memory::{SIZE, offset};
use crate::network::{Network, Power};
use crate::scan::Plc;

/// A bit held at a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Force {
    /// The bit.
    pub bit: BitAddress,
    /// Its value.
    pub value: bool,
}

/// All forced bits, in address order. They go with the power.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Forces(Vec<Force>);

impl Forces {
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Puts the forced values back after something may have written others.
    pub fn apply(&self, bytes: &mut [u8; SIZE]) {
        for Force { bit, value } in &self.0 {
            if let Some(at) = offset(bit.byte_address()) {
                let mask = 1u8 << (bit.bit & 7);
                let byte = &mut bytes[at];
                *byte = if *value { *byte | mask } else { *byte & !mask };
            }
        }
    }
}

/// Where the scan pauses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stop {
    /// At the end of the slot.
    AtEnd,
    /// After one rung; a called subprogram belongs to it.
    AfterRung,
}

/// A place inside a slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Place {
    /// In level 1, or already in the part of level 2.
    pub level1: bool,
    /// Operation that is next.
    pub at: usize,
    /// Operations of this slot so far, as the watchdog counts them.
    pub executed: usize,
}

impl Place {
    /// The beginning of a slot; a program without level 1 begins with level 2.
    pub const fn first(end1: usize) -> Place {
        Place {
            level1: end1 > 0,
            at: 0,
            executed: 0,
        }
    }
}

impl Plc {
    /// Holds a bit at a value against the ladder and the machine; `None` lets
    /// it go. Bits outside the areas are ignored. Power-off lets all go.
    pub fn force(&mut self, bit: BitAddress, value: Option<bool>) {
        let exists = bit.area.has_bits() && bit.bit < 8 && bit.byte < bit.area.count();
        if !exists {
            return;
        }
        let forces = &mut self.state.forces.0;
        let found = forces.binary_search_by_key(&bit, |force| force.bit);
        match (found, value) {
            (Ok(at), Some(value)) => forces[at].value = value,
            (Ok(at), None) => {
                forces.remove(at);
            }
            (Err(at), Some(value)) => forces.insert(at, Force { bit, value }),
            (Err(_), None) => {}
        }
        self.state.forces.apply(self.memory.bytes_mut());
    }

    /// The forced bits, in address order.
    #[must_use]
    pub fn forces(&self) -> &[Force] {
        &self.state.forces.0
    }

    /// Runs one rung. Before the first one of a slot the timers advance and
    /// level 2 takes its inputs over, as in [`Plc::slot`]; after its last one
    /// the slot is over.
    pub fn step_rung(&mut self) {
        self.advance(Stop::AfterRung);
    }

    /// The rung that [`Plc::step_rung`] runs next; `None` at the end of the
    /// program or after a fault.
    #[must_use]
    pub fn next_rung(&self) -> Option<u32> {
        if self.state.fault.is_some() {
            return None;
        }
        let code = self.ladder.code();
        let place = self.state.place.unwrap_or(Place::first(code.end1));
        let at = if place.level1 {
            place.at
        } else {
            place.at.max(self.part_bounds(code).0)
        };
        self.ladder.statements().get(at).map(|next| next.rung)
    }

    /// Whether a slot has been begun in steps and is not over.
    #[must_use]
    pub const fn within_slot(&self) -> bool {
        self.state.place.is_some()
    }

    /// Where power flows in a rung with memory as it is now, one state for each
    /// statement; level 2 sees X and F as its cycle began.
    #[must_use]
    pub fn power(&self, network: &Network) -> Vec<Power> {
        let level1 = network.first < self.ladder.code().end1;
        network.power(|bit| {
            if level1 {
                self.memory.bit(bit)
            } else {
                self.memory.bit_in_level2(bit)
            }
        })
    }
}
