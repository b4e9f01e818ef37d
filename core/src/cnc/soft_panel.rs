//! The keys of the machine panel page (manual III-2.6.2).
//!
//! The ladder sets its latch when a soft switch (F75) goes to 1 and clears it when it goes
//! to 0. The page shows the latch, which the panel's key changes too. A switch that already
//! has the wanted state is therefore first set to the other one.

use gsk_plc::address::{Area, BitAddress};

use super::Cnc;
use super::parts::PlcPort;
use crate::operation::{SoftSwitch, SoftSwitchChange};

/// Time for which a soft switch first has the opposite state, ms: longer than a cycle of level 2 of
/// the ladder.
const PREPARE_MS: u32 = 64;

/// Address of the F bit that reports whether the function of a soft switch is active.
const fn state_bit(switch: SoftSwitch) -> BitAddress {
    let (byte, bit) = match switch {
        SoftSwitch::MachineLock => (4, 1),
        SoftSwitch::AuxiliaryLock => (4, 4),
        SoftSwitch::SingleBlock => (4, 3),
        SoftSwitch::DryRun => (2, 7),
        SoftSwitch::BlockSkip => (4, 0),
    };
    BitAddress::new(Area::F, byte, bit)
}

impl PlcPort {
    const fn is_soft_switch_on(&self, switch: SoftSwitch) -> bool {
        self.soft_switches & switch.mask() != 0
    }

    fn is_soft_switch_active(&self, switch: SoftSwitch) -> bool {
        self.engine.memory().bit(state_bit(switch))
    }

    pub(super) fn set_soft_switch(&mut self, switch: SoftSwitch, on: bool) {
        if on {
            self.soft_switches |= switch.mask();
        } else {
            self.soft_switches &= !switch.mask();
        }
    }

    pub(super) fn toggle_soft_switch(&mut self, switch: SoftSwitch) {
        if self
            .switch_change
            .is_some_and(|change| change.switch == switch)
        {
            return;
        }
        self.finish_switch_change();
        let target = !self.is_soft_switch_active(switch);
        if self.is_soft_switch_on(switch) == target {
            self.set_soft_switch(switch, !target);
            self.switch_change = Some(SoftSwitchChange {
                switch,
                target,
                left_ms: PREPARE_MS,
            });
        } else {
            self.set_soft_switch(switch, target);
        }
    }

    /// Advances the change of a soft switch by one tick (1 ms); does nothing without a change.
    pub(super) fn advance_soft_switch(&mut self) {
        let Some(change) = &mut self.switch_change else {
            return;
        };
        change.left_ms = change.left_ms.saturating_sub(1);
        if change.left_ms == 0 {
            self.finish_switch_change();
        }
    }

    fn finish_switch_change(&mut self) {
        if let Some(change) = self.switch_change.take() {
            self.set_soft_switch(change.switch, change.target);
        }
    }
}

impl Cnc {
    /// Whether a switch of the soft machine panel is on (its bit of F75).
    pub const fn is_soft_switch_on(&self, switch: SoftSwitch) -> bool {
        self.plc.is_soft_switch_on(switch)
    }

    /// Whether the function of a soft switch is active, as the ladder has decided.
    pub fn is_soft_switch_active(&self, switch: SoftSwitch) -> bool {
        self.plc.is_soft_switch_active(switch)
    }
}
