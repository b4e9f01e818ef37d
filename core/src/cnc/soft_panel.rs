//! The keys of the machine panel page (manual III-2.6.2).
//!
//! The ladder sets its latch when a soft switch (F75) goes to 1 and clears it when it goes
//! to 0. The page shows the latch, which the panel's key changes too. A switch that already
//! has the wanted state is therefore first set to the other one.

use gsk_plc::address::{Area, BitAddress};

use super::Cnc;
use super::parts::PlcPort;
use crate::operation::{SoftSwitch, Turning};

/// Time for which a switch first has the other state: more than a cycle of level 2.
const TURN_MS: u32 = 64;

/// The F bit that reports the state of a switch's function.
const fn state(switch: SoftSwitch) -> BitAddress {
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
    const fn soft_switch(&self, switch: SoftSwitch) -> bool {
        self.soft_switches & switch.mask() != 0
    }

    fn soft_switch_state(&self, switch: SoftSwitch) -> bool {
        self.engine.memory().bit(state(switch))
    }

    pub(super) fn set_soft_switch(&mut self, switch: SoftSwitch, on: bool) {
        if on {
            self.soft_switches |= switch.mask();
        } else {
            self.soft_switches &= !switch.mask();
        }
    }

    pub(super) fn toggle_soft_switch(&mut self, switch: SoftSwitch) {
        if self.turning.is_some_and(|turning| turning.switch == switch) {
            return;
        }
        self.finish_turning();
        let to = !self.soft_switch_state(switch);
        if self.soft_switch(switch) == to {
            self.set_soft_switch(switch, !to);
            self.turning = Some(Turning {
                switch,
                to,
                left_ms: TURN_MS,
            });
        } else {
            self.set_soft_switch(switch, to);
        }
    }

    /// Advances the change of a switch by one tick (1 ms).
    pub(super) fn soft_switch_tick(&mut self) {
        let Some(turning) = &mut self.turning else {
            return;
        };
        turning.left_ms = turning.left_ms.saturating_sub(1);
        if turning.left_ms == 0 {
            self.finish_turning();
        }
    }

    fn finish_turning(&mut self) {
        if let Some(turning) = self.turning.take() {
            self.set_soft_switch(turning.switch, turning.to);
        }
    }
}

impl Cnc {
    /// Whether a switch of the soft machine panel is on.
    pub const fn soft_switch(&self, switch: SoftSwitch) -> bool {
        self.plc.soft_switch(switch)
    }

    /// Whether the function of a soft switch is in force.
    pub fn soft_switch_state(&self, switch: SoftSwitch) -> bool {
        self.plc.soft_switch_state(switch)
    }
}
