//! Debugging functions for a running ladder: forced bits, single-rung steps and power flow.

use crate::address::BitAddress;
use crate::force::Force;
use crate::network::{Network, PowerFlow};
use crate::scan::Plc;
use crate::scan_position::{ScanPosition, ScanStop};

impl Plc {
    /// Forces a bit to a value that neither the ladder nor the machine can change; `None`
    /// releases the bit.
    ///
    /// Bits outside the areas are ignored. Power-off releases all bits.
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

    /// Returns the forced bits, in address order.
    #[must_use]
    pub fn forces(&self) -> &[Force] {
        &self.state.forces.0
    }

    /// Runs the next rung.
    ///
    /// Before the first rung of a slot the timers advance and level 2 latches its inputs,
    /// as in [`Plc::run_slot`]. After the last rung the slot is complete.
    pub fn step_rung(&mut self) {
        self.run_until(ScanStop::RungEnd);
    }

    /// Returns the number of the rung that [`Plc::step_rung`] runs next, or `None` at the
    /// end of the program and after a fault.
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

    /// Returns whether [`Plc::step_rung`] has started a slot that is not complete.
    #[must_use]
    pub const fn is_within_slot(&self) -> bool {
        self.state.paused_at.is_some()
    }

    /// Returns the power flow of a rung for the current memory, one state for each
    /// statement. Rungs of level 2 use X and F as latched at the start of their cycle.
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
