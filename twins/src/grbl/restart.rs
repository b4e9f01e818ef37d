//! Power-on, the reset line, a reset by Ctrl-X, and what they forget.

use super::block::Modal;
use super::{BOOT_NS, GrblTwin, State, Variant};

impl GrblTwin {
    /// The reset line: opening the port does this to boards with the usual USB
    /// chip. Everything but the settings is gone, the position too.
    pub fn press_reset(&mut self) {
        self.boots_at = Some(self.now + BOOT_NS);
        self.received.clear();
        self.planner.clear();
        self.waiting = None;
        self.homing = None;
        self.pass = None;
        // The output that drives the spindle drops.
        self.spindle = 5;
        if self.variant == Variant::FluidNc {
            self.fluid_off();
        }
    }

    /// The board stops itself with this alarm of its firmware; from the smaller numbers
    /// it has to be unlocked.
    pub fn give_up(&mut self, number: u8) {
        self.planner.clear();
        self.waiting = None;
        self.homing = None;
        if self.variant == Variant::FluidNc {
            return self.put_alarm(number);
        }
        self.state = State::Alarm;
        self.say(&format!("ALARM:{number}\r\n"));
    }

    pub(super) fn power_on(&mut self) {
        self.boots_at = None;
        self.position = [0; 3];
        self.miscounted = [0; 3];
        self.modal = Modal::default();
        self.state = if self.settings.is_on(22) {
            State::Alarm
        } else {
            State::Idle
        };
        self.start_firmware();
    }

    /// What power-on and a soft reset have in common.
    pub(super) fn start_firmware(&mut self) {
        self.forget_work();
        self.say(self.variant.banner());
        if self.state == State::Alarm {
            self.say("[MSG:'$H'|'$X' to unlock]\r\n");
        } else {
            self.state = State::Idle;
        }
    }

    /// What was read and what was planned is gone, the outputs are off.
    pub(super) fn forget_work(&mut self) {
        self.received.clear();
        self.line.clear();
        let off = core::mem::take(&mut self.miscounted);
        for (place, off) in self.position.iter_mut().zip(off) {
            *place += off;
        }
        self.in_comment = false;
        self.too_long = false;
        self.waiting = None;
        self.answers_at = None;
        self.planner.clear();
        self.homing = None;
        self.pass = None;
        self.hold_pending = false;
        self.stuck = false;
        self.stands_since = None;
        self.silent = false;
        self.error_latch = false;
        self.spindle = 5;
        self.coolant = false;
        self.modal = Modal {
            position: self.millimetres(),
            ..Modal::default()
        };
    }

    pub(super) fn soft_reset(&mut self) {
        self.resets += 1;
        let moving = matches!(self.state, State::Run | State::Hold { complete: false });
        if self.state == State::Home {
            self.state = State::Alarm;
            self.say("ALARM:6\r\n");
        } else if moving {
            self.state = State::Alarm;
            self.say("ALARM:3\r\n");
        } else if self.state == (State::Hold { complete: true }) || self.state == State::Check {
            self.state = State::Idle;
        }
        self.start_firmware();
    }
}
