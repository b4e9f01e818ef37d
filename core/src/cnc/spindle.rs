//! The part of a tick that concerns the spindle: speed, angle, jog and brake.

use gsk_plc::address::{Area, BitAddress};

use super::Cnc;
use crate::command::Action;
use crate::machine::MachineInputs;
use crate::spindle::SpindleInputs;
use crate::units::Point;

/// Output Y0.7, SPZD: applies the spindle brake.
const BRAKE_OUTPUT: BitAddress = BitAddress::new(Area::Y, 0, 7);

impl Cnc {
    pub(super) fn advance_spindle(&mut self, inputs: &MachineInputs) {
        let at = Point::new(self.surface_x(), 0.0);
        self.spindle.control.set_jog(self.is_spindle_jogging());
        if !self.run.automatic.is_threading() {
            self.spindle.override_percent = self.plc.signals.spindle_override;
        }
        let board = self.drives.board.as_ref().and_then(|board| board.spindle);
        self.spindle.control.tick(&SpindleInputs {
            encoder: inputs.encoder,
            measured_rpm: board.map(|spindle| spindle.rpm),
            radius_mm: self.coordinates.frame.to_program(at).x,
            override_percent: self.spindle.override_percent,
        });
        match board {
            Some(spindle) => self.spindle.angle.set_measured_turn(spindle.turn),
            None => self
                .spindle
                .angle
                .tick(inputs.encoder, inputs.encoder_index),
        }
    }

    /// Whether spindle jog SPHD is active: only with an analog spindle and in manual modes
    /// (manual PLC-II 9.2).
    pub(super) fn is_spindle_jogging(&self) -> bool {
        self.plc.signals.spindle_jog
            && self.run.mode.is_manual()
            && self.memory.parameters.has_analog_spindle()
    }

    /// SPZD: whether the ladder's spindle brake is on.
    pub(crate) fn is_brake_on(&self) -> bool {
        self.plc.engine.memory().bit(BRAKE_OUTPUT)
    }

    /// X that determines the surface speed, machine coordinate in mm: the programmed X, in
    /// a rapid the X of its end point (manual I-2.6.2).
    fn surface_x(&mut self) -> f64 {
        let position = self.position();
        let Some(current) = &self.run.automatic.current else {
            return position.x + self.coordinates.programmed_x_lead;
        };
        let programmed = current.command.programmed_x.as_deref();
        let (x, tip) = match (&current.command.action, programmed) {
            (Action::Rapid { to }, None) => (to.x, to.x),
            (Action::Rapid { to }, Some(programmed)) => (programmed.x_at_end(), to.x),
            (Action::Line { to, .. } | Action::Arc { to, .. }, Some(programmed)) => {
                (programmed.x_at(position, current.from, *to), position.x)
            }
            (Action::Line { .. } | Action::Arc { .. } | Action::Thread { .. }, None) => {
                (position.x, position.x)
            }
            _ => return position.x + self.coordinates.programmed_x_lead,
        };
        self.coordinates.programmed_x_lead = x - tip;
        x
    }
}
