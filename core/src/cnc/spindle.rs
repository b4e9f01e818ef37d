//! The spindle's part of a tick.

use gsk_plc::address::{Area, BitAddress};

use super::Cnc;
use crate::command::Action;
use crate::machine::Inputs;
use crate::spindle::SpindleInputs;
use crate::units::Point;

/// Y0.7, SPZD: spindle brake.
const BRAKE_OUTPUT: BitAddress = BitAddress::new(Area::Y, 0, 7);

impl Cnc {
    pub(super) fn spindle_tick(&mut self, inputs: &Inputs) {
        let at = Point::new(self.surface_x(), 0.0);
        self.spindle.control.set_jog(self.spindle_jog());
        if !self.run.automatic.threading() {
            self.spindle.override_percent = self.plc.signals.spindle_override;
        }
        let board = self.drives.board.as_ref().and_then(|board| board.spindle);
        self.spindle.control.tick(&SpindleInputs {
            encoder: inputs.encoder,
            measured: board.map(|spindle| spindle.rpm),
            radius: self.coordinates.frame.program(at).x,
            override_percent: self.spindle.override_percent,
        });
        match board {
            Some(spindle) => self.spindle.angle.tell(spindle.turn),
            None => self
                .spindle
                .angle
                .tick(inputs.encoder, inputs.encoder_index),
        }
    }

    /// Whether spindle jog SPHD is active: only with an analog spindle and in manual modes
    /// (manual PLC-II 9.2).
    pub(super) fn spindle_jog(&self) -> bool {
        self.plc.signals.spindle_jog
            && self.run.mode.is_manual()
            && self.memory.parameters.analog_spindle()
    }

    /// SPZD: whether the ladder brakes the spindle.
    pub(crate) fn brake_output(&self) -> bool {
        self.plc.engine.memory().bit(BRAKE_OUTPUT)
    }

    /// The X for the surface speed, machine coordinate: the programmed X; in a rapid the X
    /// of its end point (manual I-2.6.2).
    fn surface_x(&mut self) -> f64 {
        let position = self.position();
        let Some(current) = &self.run.automatic.current else {
            return position.x + self.coordinates.programmed_ahead;
        };
        let programmed = current.command.programmed_x.as_deref();
        let (x, tip) = match (&current.command.action, programmed) {
            (Action::Rapid { to }, None) => (to.x, to.x),
            (Action::Rapid { to }, Some(programmed)) => (programmed.end(), to.x),
            (Action::Line { to, .. } | Action::Arc { to, .. }, Some(programmed)) => {
                (programmed.at(position, current.from, *to), position.x)
            }
            (Action::Line { .. } | Action::Arc { .. } | Action::Thread { .. }, None) => {
                (position.x, position.x)
            }
            _ => return position.x + self.coordinates.programmed_ahead,
        };
        self.coordinates.programmed_ahead = x - tip;
        x
    }
}
