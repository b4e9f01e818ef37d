//! Working on a running ladder by hand: forced bits, the scan rung by rung,
//! and where power flows.

use crate::address::BitAddress;
use crate::force::Force;
use crate::network::{Network, PowerFlow};
use crate::scan::Plc;
use crate::scan_position::{ScanPosition, ScanStop};

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
        self.skippable.invalidate();
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
        self.run_until(ScanStop::RungEnd);
    }

    /// The rung that [`Plc::step_rung`] runs next; `None` at the end of the
    /// program or after a fault.
    #[must_use]
    pub fn next_rung(&self) -> Option<u32> {
        if self.state.fault.is_some() {
            return None;
        }
        let code = self.ladder.code();
        let position = self
            .state
            .paused_at
            .unwrap_or(ScanPosition::first(code.end1));
        let at = if position.level1 {
            position.next_op
        } else {
            position.next_op.max(self.part_bounds(code).0)
        };
        self.ladder.statements().get(at).map(|next| next.rung)
    }

    /// Whether a slot has been begun in steps and is not over.
    #[must_use]
    pub const fn is_within_slot(&self) -> bool {
        self.state.paused_at.is_some()
    }

    /// Where power flows in a rung with memory as it is now, one state for each
    /// statement; level 2 sees X and F as its cycle began.
    #[must_use]
    pub fn power_flow(&self, network: &Network) -> Vec<PowerFlow> {
        let level1 = network.first < self.ladder.code().end1;
        network.power_flow(|bit| {
            if level1 {
                self.memory.bit(bit)
            } else {
                self.memory.bit_in_level2(bit)
            }
        })
    }
}
