//! The PLC's part of a tick: contacts in, its slot, and what passes between it and
//! the control.

use super::{Cnc, SerialPort};
use crate::alarm::Alarm;
use crate::command::Action;
use crate::machine::Inputs;
use crate::operation::{FromPlc, InputFilter, Mode, RunState, ToPlc};
use crate::units::{Axis, PerAxis};

impl Cnc {
    pub(super) fn sample_contacts(&mut self, inputs: &Inputs) {
        let mut contacts = inputs.x;
        for (contact, key) in contacts.iter_mut().zip(self.panel_keys) {
            *contact |= key;
        }
        if self.ticks == 1 {
            self.filter = InputFilter::standing(&contacts);
        }
        self.filter.sample(&contacts, self.parameters.value(20));
        for (index, byte) in self.filter.accepted().iter().enumerate() {
            self.plc.memory_mut().set_x(index as u16, *byte);
        }
        for (index, byte) in self.y.iter_mut().enumerate() {
            *byte = self.plc.memory().y(index as u16);
        }
    }

    pub(super) fn plc_slot(&mut self) {
        let was = self.from_plc.clone();
        self.tell_plc(&was);
        if !self.plc_halted {
            self.plc.slot();
            self.hear_plc(&was);
        }
    }

    /// What the ladder has decided acts.
    pub(super) fn hear_plc(&mut self, was: &FromPlc) {
        self.from_plc = FromPlc::read(self.plc.memory());
        if self.parameters.override_code_is_inverted() {
            self.from_plc.feed_override = 150 - self.from_plc.feed_override;
        }
        self.plc_message = self.plc.active_messages().next().is_some();
        if let Some(fault) = self.plc.fault() {
            let detail = fault.to_string();
            self.raise(Alarm::new(0).because(detail));
        }
        self.follow_mode();
        self.follow_tool(was.current_tool);
        if self.from_plc.feed_hold || self.plc_message {
            self.feed_hold();
        }
        if was.start && !self.from_plc.start {
            self.cycle_start();
        }
        if self.from_plc.next_tool && !was.next_tool {
            self.index_tool();
        }
    }

    fn tell_plc(&mut self, g: &FromPlc) {
        let velocity = self.interpolator.velocity();
        let moving = PerAxis::new(velocity.x != 0.0, velocity.z != 0.0);
        for axis in [Axis::X, Axis::Z] {
            if *moving.get(axis) {
                *self.negative.get_mut(axis) = velocity.get(axis) < 0.0;
            }
        }
        let state = self.automatic.state;
        let rapid = self
            .automatic
            .action()
            .map(|action| matches!(action, Action::Rapid { .. }));
        self.last_rapid = rapid.unwrap_or(self.last_rapid && !self.automatic.operating());
        let cutting = matches!(
            self.automatic.action(),
            Some(
                Action::Line { .. }
                    | Action::Arc { .. }
                    | Action::Thread { .. }
                    | Action::Tap { .. }
            )
        );
        let message = ToPlc {
            mode: self.mode,
            started: state == RunState::Run,
            holding: state == RunState::Hold,
            operating: self.automatic.operating(),
            alarm: self.alarm_state(),
            reset: self.resetting(),
            distribution_end: self.automatic.distribution_end(),
            servo_ready: !self.emergency_stop && self.board.is_none_or(|board| board.known),
            rapid: self.last_rapid,
            cutting: cutting && state == RunState::Run,
            dwelling: self.automatic.dwelling(),
            tapping: matches!(self.automatic.action(), Some(Action::Tap { .. })),
            decoded_m00: self.automatic.decoded == Some(0),
            decoded_m30: self.automatic.decoded == Some(30),
            handshake: &self.handshake,
            gear: self.spindle.selected_gear(),
            at_reference: PerAxis::new(
                self.at_reference.x.is_some(),
                self.at_reference.z.is_some(),
            ),
            referenced: self.referenced,
            at_program_zero: self.at_program_zero(),
            moving,
            negative: self.negative,
            output_key: self.output_key,
            sending: self.serial_port == SerialPort::Sending,
            receiving: self.serial_port == SerialPort::Receiving,
            soft_switches: self.soft_switches,
            ready: !self.alarms.contains(0),
            spindle_jog: self.spindle_jog(),
            parameters: &self.parameters,
        };
        message.write(self.plc.memory_mut(), g);
    }

    /// Follows the mode that the ladder commands.
    fn follow_mode(&mut self) {
        let handwheel = self.parameters.handwheel();
        let Some(mode) = Mode::from_code(self.from_plc.mode_code, handwheel) else {
            return;
        };
        if mode == self.mode {
            return;
        }
        let left = core::mem::replace(&mut self.mode, mode);
        if left.is_manual() {
            self.manual_mode_left();
        }
        if mode.is_manual() {
            self.feed_hold();
        } else if self.automatic.operating() && self.automatic.mdi != (mode == Mode::Mdi)
            || mode == Mode::Edit
        {
            self.automatic.request_stop();
        }
    }
}
