//! What came in through the serial port (manual III-9.4, III-9.6).

use super::allowed;
use crate::alarm::Alarm;
use crate::cnc::Cnc;
use crate::command::ProgramId;
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
    /// A program that takes the place of the one with its number.
    Replacement(String),
    /// A program is to be deleted.
    Deletion(u16),
    /// A program is to have another number.
    Renaming {
        /// Its number.
        from: u16,
        /// The new one.
        to: u16,
    },
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
            Received::Replacement(text) => {
                let number = Program::new(text.as_str()).number();
                if allowed(self.rights().receive_program(number.unwrap_or(0)))? {
                    let number = self.memory.programs.store(text)?;
                    self.changed_from_outside(number);
                }
                return Ok(());
            }
            Received::Deletion(number) => {
                if allowed(self.rights().receive_program(number))? {
                    let selected = self.is_selected(number);
                    self.memory.programs.delete(number)?;
                    if selected {
                        self.void_run();
                    }
                }
                return Ok(());
            }
            Received::Renaming { from, to } => {
                let rights = self.rights();
                if allowed(rights.receive_program(from))? && allowed(rights.receive_program(to))? {
                    self.memory.programs.rename(from, to)?;
                    self.changed_from_outside(to);
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

    fn is_selected(&self, number: u16) -> bool {
        self.memory.programs.current() == Some(ProgramId::Stored(number))
    }

    /// The next start of the selected program begins at its head.
    fn changed_from_outside(&mut self, number: u16) {
        if self.is_selected(number) {
            self.void_run();
        }
    }
}
