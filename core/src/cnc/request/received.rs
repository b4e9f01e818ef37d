//! Stores data received through the serial port (manual III-9.4, III-9.6).

use super::allowed;
use crate::alarm::Alarm;
use crate::cnc::Cnc;
use crate::command::ProgramId;
use crate::memory::{Offsets, PitchTable};
use crate::program::Program;

/// State of the serial port: F213.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum SerialPort {
    /// No transfer is under way.
    #[default]
    Idle,
    /// Data is being sent.
    Sending,
    /// Data is being received.
    Receiving,
}

/// A complete transfer through the serial port.
#[derive(Clone, Debug, PartialEq)]
pub enum Received {
    /// A program for the memory; its number must be free.
    Program(String),
    /// A program that replaces the one with its number.
    Replacement(String),
    /// Deletes the program with this number.
    Deletion(u16),
    /// Renames a program.
    Renaming {
        /// Present number.
        from: u16,
        /// New number.
        to: u16,
    },
    /// All tool offsets.
    Offsets(Offsets),
    /// The whole pitch error table.
    Pitch(PitchTable),
    /// Parameters as numbers and values.
    Parameters(Vec<(u16, i32)>),
}

impl Cnc {
    /// Stores received data completely, or changes nothing.
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

    /// Makes the next start of the program begin at its head, if it is selected.
    fn changed_from_outside(&mut self, number: u16) {
        if self.is_selected(number) {
            self.void_run();
        }
    }
}
