//! Power-on, reset line and soft reset, and the state that they clear.

use super::block::Modal;
use super::{BOOT_NS, GrblState, GrblTwin, Variant};

impl GrblTwin {
    /// Resets the board with the reset line, as opening the port does on most USB boards.
    /// Everything but the settings is lost, including the position.
    pub fn press_reset(&mut self) {
        self.boots_at = Some(self.now + BOOT_NS);
        self.received.clear();
        self.planner.clear();
        self.waiting_block = None;
        self.homing = None;
        self.pass = None;
        // The spindle output switches off.
        self.spindle_code = 5;
        if self.variant == Variant::FluidNc {
            self.reset_fluid();
        }
    }

    /// Stops the board with an alarm number and sends the alarm. The lower alarms must be
    /// unlocked.
    pub fn raise_alarm(&mut self, number: u8) {
        self.planner.clear();
        self.waiting_block = None;
        self.homing = None;
        if self.variant == Variant::FluidNc {
            return self.push_alarm(number);
        }
        self.state = GrblState::Alarm;
        self.send_text(&format!("ALARM:{number}\r\n"));
    }

    pub(super) fn power_on(&mut self) {
        self.boots_at = None;
        self.position = [0; 3];
        self.position_error = [0; 3];
        self.modal = Modal::default();
        self.state = if self.settings.is_on(22) {
            GrblState::Alarm
        } else {
            GrblState::Idle
        };
        self.restart_firmware();
    }

    /// Restarts the firmware after power-on or a soft reset.
    pub(super) fn restart_firmware(&mut self) {
        self.clear_work();
        self.send_text(self.variant.banner());
        if self.state == GrblState::Alarm {
            self.send_text("[MSG:'$H'|'$X' to unlock]\r\n");
        } else {
            self.state = GrblState::Idle;
        }
    }

    /// Clears received lines and planned motion and switches the outputs off.
    pub(super) fn clear_work(&mut self) {
        self.received.clear();
        self.line.clear();
        let off = core::mem::take(&mut self.position_error);
        for (place, off) in self.position.iter_mut().zip(off) {
            *place += off;
        }
        self.in_comment = false;
        self.too_long = false;
        self.waiting_block = None;
        self.answer_at = None;
        self.planner.clear();
        self.homing = None;
        self.pass = None;
        self.hold_pending = false;
        self.main_loop_blocked = false;
        self.stopped_since = None;
        self.waits_for_reset = false;
        self.error_latch = false;
        self.spindle_code = 5;
        self.coolant = false;
        self.modal = Modal {
            position: self.position_mm(),
            ..Modal::default()
        };
    }

    pub(super) fn soft_reset(&mut self) {
        self.reset_count += 1;
        let moving = matches!(
            self.state,
            GrblState::Run | GrblState::Hold { complete: false }
        );
        if self.state == GrblState::Home {
            self.state = GrblState::Alarm;
            self.send_text("ALARM:6\r\n");
        } else if moving {
            self.state = GrblState::Alarm;
            self.send_text("ALARM:3\r\n");
        } else if self.state == (GrblState::Hold { complete: true })
            || self.state == GrblState::Check
        {
            self.state = GrblState::Idle;
        }
        self.restart_firmware();
    }
}
