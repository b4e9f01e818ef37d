//! Defines the files of the memory for a client at a port of the computer, and its access
//! rights (manual III-9.8.2, V-3.5).

use gsk_core::alarm::{Alarm, number};
use gsk_core::cnc::{Cnc, ControlRequest, ReceivedData, SerialPort};
use gsk_core::memory::WriteRefusal;
use gsk_core::plc::CompileError;
use gsk_messages::{Message, say};

use super::{DataLineError, Panel, SerialCable, SerialFile, files, reason};
use crate::pages::Communication;

/// Name of the file that holds the ladder. GSKCC gives its ladder files the extension `.ldx`.
pub const LADDER_FILE: &str = "Main.ldx";

/// Names a file of the control that a client can read or write.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum FileId {
    /// A program in memory, with this number.
    Program(u16),
    /// The file that contains all tool offsets.
    Offsets,
    /// The file that contains the pitch error table.
    Pitch,
    /// The file that contains all parameters.
    Parameters,
    /// The ladder that runs after the next power-on, as an instruction list.
    Ladder,
}

impl FileId {
    /// The files with data: offsets, pitch errors, parameters and the ladder.
    pub const DATA: [Self; 4] = [Self::Offsets, Self::Pitch, Self::Parameters, Self::Ladder];

    /// Returns the file with a name, ignoring case; `None` for a name that the control does
    /// not use.
    pub fn of(name: &str) -> Option<Self> {
        let data = [
            (files::OFFSETS, Self::Offsets),
            (files::PITCH, Self::Pitch),
            (files::PARAMETERS, Self::Parameters),
            (LADDER_FILE, Self::Ladder),
        ];
        let known = data
            .into_iter()
            .find(|(known, _)| known.eq_ignore_ascii_case(name));
        let program = || {
            let (_, ending) = name.split_once('.')?;
            let number = number_of_name(name)?;
            ending
                .eq_ignore_ascii_case("CNC")
                .then_some(Self::Program(number))
        };
        known.map(|(_, id)| id).or_else(program)
    }
}

/// The reason why the control refuses a client's request about a file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}", self.message())]
pub enum FileRefusal {
    /// A right, a switch or a mode of the control forbids it.
    Refused(WriteRefusal),
    /// The request is refused because the file does not exist.
    Missing,
    /// The request is refused because the file exists and must not be replaced.
    Exists,
    /// The request renames or deletes a data file, which only programs permit.
    OnlyPrograms,
    /// The content of the received file is invalid in a line.
    Unreadable(DataLineError),
    /// The received ladder does not compile; the first error of the compiler.
    Ladder(CompileError),
    /// The control refuses the request with this alarm.
    Alarm(Box<Alarm>),
}

impl FileRefusal {
    /// Returns the message to a client: why its request was refused.
    pub fn message(&self) -> Message {
        match self {
            Self::Refused(refusal) => reason(*refusal),
            Self::Missing => say::transfer_fault_not_found(),
            Self::Exists => say::transfer_fault_exists(),
            Self::OnlyPrograms => say::transfer_only_programs(),
            Self::Unreadable(error) => error.message(),
            Self::Ladder(error) => {
                say::ladder_rule_broken(error.line, error.rung, error.code, error.message.clone())
            }
            Self::Alarm(alarm) => say::as_written(alarm),
        }
    }

    /// Returns whether the reason is that the program memory is full.
    pub fn is_memory_full(&self) -> bool {
        match self {
            Self::Alarm(alarm) => {
                [number::MEMORY_FULL, number::TOO_MANY_PROGRAMS].contains(&alarm.number)
            }
            _ => false,
        }
    }
}

/// Parses a received data file by the extension of its name.
///
/// # Errors
///
/// Returns the first invalid line of the file.
pub fn read_data(file: &SerialFile) -> Result<ReceivedData, DataLineError> {
    files::read(file)
}

/// Returns a file of the memory with name and text; `None` for a missing program.
pub fn file_of(id: FileId, cnc: &Cnc) -> Option<SerialFile> {
    files::file_of(id, cnc)
}

/// Returns the program number in the name of a file (`O0001`, `o12.nc`); `None` if it has
/// none.
pub fn number_of_name(name: &str) -> Option<u16> {
    let stem = name.rsplit(['/', '\\']).next()?;
    let stem = stem.split_once('.').map_or(stem, |(stem, _)| stem);
    let digits = stem.strip_prefix(['O', 'o'])?;
    let number: u16 = digits.parse().ok()?;
    (digits.len() <= 4).then_some(number)
}

impl From<WriteRefusal> for FileRefusal {
    fn from(refusal: WriteRefusal) -> Self {
        Self::Refused(refusal)
    }
}

impl Panel {
    /// Returns whether 输出 has files to send through the port of the computer.
    pub(crate) const fn has_port_files(&self) -> bool {
        !self.transfer.for_line.is_empty()
    }

    /// Takes the files that 输出 sends, for the port of the computer.
    pub(crate) fn take_port_files(&mut self) -> Vec<SerialFile> {
        core::mem::take(&mut self.transfer.for_line)
    }

    /// Returns whether 复位 has aborted a transfer through the computer's port.
    pub(crate) const fn is_aborted(&self) -> bool {
        self.transfer.broken_off
    }

    /// Clears the record that a transfer was aborted.
    pub(crate) const fn clear_aborted(&mut self) {
        self.transfer.broken_off = false;
    }

    /// Returns the control's baud rate, bit/s; `None` while the control or its port (002.5) is
    /// off.
    pub fn baud_rate(&self, cnc: &Cnc) -> Option<u32> {
        let on = self.is_awake() && cnc.parameters().has_serial_port();
        on.then(|| cnc.parameters().baud())
    }

    /// Sets the state of the serial port: shows it in the LCD's status row and puts it into
    /// the PLC signals F213.
    pub fn show_port_state(&mut self, shown: Communication, requests: &mut Vec<ControlRequest>) {
        let port = match shown {
            Communication::Sending => SerialPort::Sending,
            Communication::Receiving => SerialPort::Receiving,
            _ => SerialPort::Idle,
        };
        self.show_transfer(shown, port, requests);
    }

    /// Returns whether a port of the computer is sending or receiving a file.
    pub(super) fn client_port_is_busy(&self) -> bool {
        self.transfer.partner == SerialCable::Line
            && self.transfer.incoming.is_none()
            && matches!(
                self.view.communication,
                Communication::Sending | Communication::Receiving
            )
    }
}
