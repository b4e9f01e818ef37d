//! What came in through the serial port (manual III-9.4, III-9.6).

use super::allowed;
use crate::alarm::Alarm;
use crate::cnc::Cnc;
use crate::memory::{Offsets, PitchTable};
use crate::program::Program;

/// What the port is doing: F213.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum SerialPort {
    /// Nothing.
    #[default]
    Idle,
    /// Something goes out.
    Sending,
    /// Something comes in.
    Receiving,
}

/// What came in, as a whole.
#[derive(Clone, Debug, PartialEq)]
pub enum Received {
    /// A program for the memory.
    Program(String),
    /// All tool offsets.
    Offsets(Offsets),
    /// The pitch error table.
    Pitch(PitchTable),
    /// Parameters: numbers and values.
    Parameters(Vec<(u16, i32)>),
}

impl Cnc {
    /// Takes it, or leaves everything as it was.
    pub(super) fn take_received(&mut self, received: Received) -> Result<(), Alarm> {
        match received {
            Received::Program(text) => {
                let number = Program::new(text.as_str()).number();
                if allowed(self.rights().receive_program(number.unwrap_or(0)))? {
                    self.memory.programs.receive(text)?;
                }
                return Ok(());
            }
            _ if self.rights().receive_data().is_err() => {}
            Received::Offsets(offsets) => self.memory.offsets = offsets,
            Received::Pitch(pitch) => {
                self.memory.pitch = pitch;
                let in_force = self.memory.parameters.in_force(&self.at_power_on);
                self.drives.chain.reconfigure(&in_force, &self.memory.pitch);
            }
            Received::Parameters(values) => {
                let mut changed = self.memory.parameters.clone();
                for (number, value) in values {
                    changed.set(number, value)?;
                }
                self.take_parameters(changed);
            }
        }
        Ok(())
    }
}
