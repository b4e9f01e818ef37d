//! Operations on the ladder of a running control: halt and step, forced bits, a new ladder
//! for the next power-on.

use std::sync::Arc;

use gsk_plc::{Ladder, PlcMemory};

use super::Cnc;
use super::parts::PlcPort;
use crate::memory::{ControlParameters, parameter};

/// Length of a step of the halted ladder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum LadderStep {
    /// The step executes one rung of the ladder.
    Rung,
    /// One slot of 8 ms: level 1 and a portion of level 2.
    Slot,
}

/// Data parameters that preset timers of the ladder: (DT entry, parameter).
pub(super) const TIMER_PRESETS: [(u16, u16); 14] = [
    (0, parameter::GEAR_TIME_1),
    (1, parameter::GEAR_TIME_2),
    (2, parameter::PRESSURE_TIME),
    (3, parameter::STATION_TIME),
    (4, parameter::TURRET_TIME),
    (5, parameter::M_TIME),
    (6, parameter::S_TIME),
    (7, parameter::CLAMP_DELAY),
    (8, parameter::CLAMP_LIMIT),
    (9, parameter::CLAMP_TIME),
    (10, parameter::BRAKE_DELAY),
    (11, parameter::BRAKE_TIME),
    (12, parameter::JOG_TIME),
    (13, parameter::LUBRICATION_TIME),
];
/// Number of the K byte with the operating mode that the ladder restores at power-on.
const MODE_AT_POWER_ON: u16 = 9;

/// Sets the PLC memory before the first scan: timer presets, and the mode of 174
/// (manual III-1.3). With MDOK = 0 it is the mode at power-off, which K9 contains.
pub(super) fn preset_plc(memory: &mut PlcMemory, parameters: &ControlParameters) {
    for (entry, parameter) in TIMER_PRESETS {
        memory.set_dt(entry, parameters.timer_ms(parameter));
    }
    if let Some(mode) = parameters.mode_at_power_on() {
        memory.set_k(
            MODE_AT_POWER_ON,
            match mode {
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

impl PlcPort {
    /// Returns the ladder that runs after the next power-on: the one loaded for it, or else the
    /// current one.
    pub(super) fn ladder_at_power_on(&self) -> Arc<Ladder> {
        Arc::clone(self.next_ladder.as_ref().unwrap_or(self.engine.ladder()))
    }
}

impl Cnc {
    /// Executes one step of the halted ladder and applies its signals at once; does nothing if the
    /// ladder is not halted.
    pub(super) fn step_ladder(&mut self, step: LadderStep) {
        if !self.plc.halted {
            return;
        }
        let before = self.plc.signals.clone();
        match step {
            LadderStep::Rung => self.plc.engine.step_rung(),
            LadderStep::Slot => self.plc.engine.run_slot(),
        }
        self.read_signals(&before);
    }

    /// Whether the ladder is halted, to be executed in single steps.
    pub const fn is_ladder_halted(&self) -> bool {
        self.plc.halted
    }

    /// Returns the ladder in the memory of the control, which runs after the next power-on.
    pub fn stored_ladder(&self) -> Arc<Ladder> {
        self.plc.ladder_at_power_on()
    }

    /// The ladder that was loaded for the next power-on; `None` without one.
    pub const fn next_ladder(&self) -> Option<&Arc<Ladder>> {
        self.plc.next_ladder.as_ref()
    }
}
