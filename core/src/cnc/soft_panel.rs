//! The keys of the machine panel page (manual III-2.6.2).
//!
//! The ladder sets its latch when a soft switch (F75) goes up and clears it when it
//! goes down. The page shows the latch, which the panel's own key moves as well; so
//! a switch that already stands where it is wanted first goes the other way.

use gsk_plc::address::{Area, BitAddress};

use super::Cnc;
use super::parts::PlcPort;
use crate::operation::{SoftSwitch, Turning};

/// How long a switch stands the other way first: more than a cycle of level 2.
const TURN_MS: u32 = 64;

/// The F bit that reports what a switch asks for.
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

    /// Once a millisecond.
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

    /// Whether what a soft switch asks for is in force.
    pub fn soft_switch_state(&self, switch: SoftSwitch) -> bool {
        self.plc.soft_switch_state(switch)
    }
}
