//! Stores data received through the serial port (manual III-9.4, III-9.6).

use super::check_allowed;
use crate::alarm::Alarm;
use crate::cnc::Cnc;
use crate::command::ProgramId;
use crate::memory::{Offsets, PitchTable};
use crate::program::Program;

/// State of the serial port, which the ladder reads in F213.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum SerialPort {
    /// No transfer through the serial port is in progress.
    #[default]
    Idle,
    /// The control is sending data through the serial port.
    Sending,
    /// The control is receiving data through the serial port.
    Receiving,
}

/// The content of a complete transfer through the serial port.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum ReceivedData {
    /// Text of a program for the memory; its O number must be free.
    Program(String),
    /// Text of a program that replaces the program with its O number.
    Replacement(String),
    /// Deletion of the program with this O number.
    Deletion(u16),
    /// A request to rename a program.
    Renaming {
        /// Current O number of the program.
        from: u16,
        /// New O number of the program.
        to: u16,
    },
    /// Values that replace all tool offsets.
    Offsets(Offsets),
    /// Values that replace the whole pitch error table.
    Pitch(PitchTable),
    /// Parameters as pairs of number and value.
    Parameters(Vec<(u16, i32)>),
}

impl Cnc {
    /// Stores received data completely, or changes nothing and returns the alarm as error; data
    /// that the operator may not change is ignored.
    pub(super) fn store_received(&mut self, received: ReceivedData) -> Result<(), Alarm> {
        match received {
            ReceivedData::Program(text) => {
                let number = Program::new(text.as_str()).number();
                if check_allowed(self.rights().check_receive_program(number.unwrap_or(0)))? {
                    self.memory.programs.receive(text)?;
                }
                return Ok(());
            }
            ReceivedData::Replacement(text) => {
                let number = Program::new(text.as_str()).number();
                if check_allowed(self.rights().check_receive_program(number.unwrap_or(0)))? {
                    let number = self.memory.programs.store(text)?;
                    self.note_replaced_program(number);
                }
                return Ok(());
            }
            ReceivedData::Deletion(number) => {
                if check_allowed(self.rights().check_receive_program(number))? {
                    let selected = self.is_selected(number);
                    self.memory.programs.delete(number)?;
                    if selected {
                        self.invalidate_run();
                    }
                }
                return Ok(());
            }
            ReceivedData::Renaming { from, to } => {
                let rights = self.rights();
                if check_allowed(rights.check_receive_program(from))?
                    && check_allowed(rights.check_receive_program(to))?
                {
                    self.memory.programs.rename(from, to)?;
                    self.note_replaced_program(to);
                }
                return Ok(());
            }
            _ if self.rights().check_receive_data().is_err() => {}
            ReceivedData::Offsets(offsets) => self.memory.offsets = offsets,
            ReceivedData::Pitch(pitch) => {
                self.memory.pitch = pitch;
                let in_force = self.memory.parameters.active_values(&self.at_power_on);
                self.drives
                    .axis_chain
                    .reconfigure(&in_force, &self.memory.pitch);
            }
            ReceivedData::Parameters(values) => {
                let mut changed = self.memory.parameters.clone();
                for (number, value) in values {
                    changed.set(number, value)?;
                }
                self.apply_parameters(changed);
            }
        }
        Ok(())
    }

    fn is_selected(&self, number: u16) -> bool {
        self.memory.programs.selected() == Some(ProgramId::Stored(number))
    }

    /// If the program with this O number is selected, drops its run: the next start begins at its
    /// first line.
    fn note_replaced_program(&mut self, number: u16) {
        if self.is_selected(number) {
            self.invalidate_run();
        }
    }
}
