//! Input pins: limit switches and emergency stop.

use super::{GrblState, GrblTwin, Variant};

/// The input pins of a Grbl board; true while a switch is operated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GrblPins {
    /// Whether the X limit switch is operated.
    pub limit_x: bool,
    /// Whether the Z limit switch is operated.
    pub limit_z: bool,
    /// Whether the safety door input is operated.
    pub door: bool,
    /// Whether the probe contact is operated.
    pub probe: bool,
    /// Whether the emergency stop input is operated; on Grbl 1.1h it is the reset input.
    pub emergency: bool,
}

impl GrblTwin {
    /// Returns whether the limit switches of X and Z are operated.
    pub fn limits(&self) -> [bool; 2] {
        let at = |place: i64, switch: i64| place * switch.signum() >= switch.abs();
        let [x, z] = self.switch_pulses;
        [
            self.pins.limit_x || at(self.pulses[0], x),
            self.pins.limit_z || at(self.pulses[2], z),
        ]
    }

    /// Places the limit switches of X and Z at distances, mm, from the slides at power-on. The
    /// switches are operated there and beyond.
    pub fn place_switches(&mut self, switches: [f64; 2]) {
        self.switches = switches;
        self.update_switch_pulses();
    }

    pub(super) fn update_switch_pulses(&mut self) {
        let [x, _, z] = self.settings.axis_values(100);
        let [at_x, at_z] = self.switches;
        self.switch_pulses = [(at_x * x).round() as i64, (at_z * z).round() as i64];
    }

    /// Checks the edges of the limit and emergency inputs. Grbl 1.1h ignores levels, so
    /// that releasing a switch is an edge too.
    pub(super) fn check_pins(&mut self) {
        let pressed = self.pins.emergency && !self.previous_emergency;
        self.previous_emergency = self.pins.emergency;
        match self.variant {
            Variant::Grbl if pressed => self.soft_reset(),
            Variant::GrblHal if pressed => {
                self.state = GrblState::Alarm;
                self.send_text("ALARM:10\r\n");
                self.restart_firmware();
            }
            _ => {}
        }
        let limits = self.limits();
        let were = core::mem::replace(&mut self.previous_limits, limits);
        let edge = (0..2).any(|axis| match self.variant {
            Variant::Grbl => limits[axis] != were[axis],
            Variant::GrblHal | Variant::FluidNc => limits[axis] && !were[axis],
        });
        let watched = !matches!(self.state, GrblState::Alarm | GrblState::Home);
        if edge && watched && self.settings.is_on(21) && !self.waits_for_reset {
            self.planner.clear();
            self.waiting_block = None;
            self.pass = None;
            self.state = GrblState::Alarm;
            self.send_text("ALARM:1\r\n[MSG:Reset to continue]\r\n");
            self.waits_for_reset = true;
        }
    }
}
