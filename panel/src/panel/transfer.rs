//! Handles the serial port: 输出 in EDIT sends programs and data, files from the partner are
//! received, and the status row shows the state (manual III-9).

mod files;
mod line;

use gsk_core::cnc::{Cnc, ControlRequest, ReceivedData, SerialPort};
use gsk_core::memory::WriteRefusal;
use gsk_core::operation::OperatingMode;
use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

use super::Panel;
use super::program_text::{is_all_programs, number};
use crate::pages::{Communication, PageId};
pub use files::DataLineError;
pub use line::{FileId, FileRefusal, LADDER_FILE, file_of, number_of_name, read_data};

/// Least baud rate at which a PC connection works, bit/s (manual III-9.3).
const MIN_BAUD: u64 = 4800;
/// Bits of a character on the line: start bit, eight data bits, stop bit.
const CHARACTER_BITS: u64 = 10;
/// Number of ticks in a second.
const SECOND: u64 = 1000;

/// The reason why the control does not receive a file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}", self.message())]
pub enum ReceiveError {
    /// The serial port is off (parameter 002.5).
    PortOff,
    /// Another transfer through the serial port is in progress.
    Busy,
    /// The baud rate of the port is too low for the partner.
    TooSlow,
    /// The content of the received file is invalid.
    Unreadable {
        /// The name of the received file.
        name: String,
        /// The invalid line and the reason.
        cause: DataLineError,
    },
    /// The control refuses the file in its current mode, switch setting or level.
    Refused {
        /// The name of the refused file.
        name: String,
        /// The operation level, switch or mode that forbids receiving the file.
        why: WriteRefusal,
    },
}

impl ReceiveError {
    /// Returns the message to the sender: why the control does not receive a file.
    pub fn message(&self) -> Message {
        match self {
            Self::PortOff => say::transfer_port_off(),
            Self::Busy => say::transfer_busy(),
            Self::TooSlow => say::baud_rate_too_low(MIN_BAUD),
            Self::Unreadable { name, cause } => say::subject_reason(name, cause.message()),
            Self::Refused { name, why } => say::subject_reason(name, reason(*why)),
        }
    }
}

/// A text file that is sent or received through the serial port.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SerialFile {
    /// Name of the file with its extension.
    pub name: String,
    /// Text that the file contains.
    pub text: String,
}

/// The kind of programs or data that the key 输出 sends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum Wanted {
    Program(u16),
    Programs,
    Offsets,
    Pitch,
    Parameters,
}

/// The device at the other end of the serial port's cable.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum SerialCable {
    /// No cable is connected to the serial port.
    #[default]
    #[serde(rename = "Nobody")]
    Disconnected,
    /// A simulated partner that accepts every file, without a port of the computer.
    #[serde(rename = "Imagined")]
    Simulated,
    /// The cable leads to a port of the computer.
    Line,
}

/// The state of the serial port and of its transfers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Transfer {
    partner: SerialCable,
    /// The files that the key 输出 has requested; `None` without a request. The transfer starts at
    /// the next tick, after the editor has stored its text.
    wanted: Option<Wanted>,
    /// Outgoing files, incoming file, and the clock tick at which the transfer ends.
    files: Vec<SerialFile>,
    incoming: Option<SerialFile>,
    until: u64,
    /// Files that the simulated partner has received.
    sent: Vec<SerialFile>,
    /// Files that wait to be sent through a port of the computer.
    for_line: Vec<SerialFile>,
    /// Whether 复位 has aborted a transfer through a port of the computer.
    broken_off: bool,
}

impl Transfer {
    /// Returns the state that power-on leaves: no transfer runs, the cable remains connected.
    pub(super) fn after_power_on(&self) -> Self {
        Self {
            partner: self.partner,
            sent: self.sent.clone(),
            ..Self::default()
        }
    }
}

impl Panel {
    /// Connects another device to the serial port.
    pub(crate) const fn connect_cable(&mut self, cable: SerialCable) {
        self.transfer.partner = cable;
    }

    /// Returns whether the simulated partner has received files.
    pub(crate) const fn has_sent(&self) -> bool {
        !self.transfer.sent.is_empty()
    }

    /// Removes and returns the files that the simulated partner has received.
    pub(crate) fn take_sent(&mut self) -> Vec<SerialFile> {
        core::mem::take(&mut self.transfer.sent)
    }

    /// Shows in the status row that the partner could not receive the files.
    pub(crate) const fn transfer_failed(&mut self) {
        self.view.communication = Communication::Failed;
    }

    /// Clears the error of the last transfer from the status row, after a key press.
    pub(super) const fn clear_transfer_error(&mut self) {
        if matches!(
            self.view.communication,
            Communication::NotConnected | Communication::Failed
        ) {
            self.view.communication = Communication::Idle;
        }
    }

    /// Aborts the current transfer, because 复位 was pressed.
    pub(super) fn abort_transfer(&mut self, requests: &mut Vec<ControlRequest>) {
        self.transfer.wanted = None;
        if self.client_port_is_busy() {
            self.transfer.for_line.clear();
            self.transfer.broken_off = true;
            self.show_transfer(Communication::Idle, SerialPort::Idle, requests);
        }
        let incoming = self.transfer.incoming.take().is_some();
        if incoming || !self.transfer.files.is_empty() {
            self.transfer.files.clear();
            self.show_transfer(Communication::Idle, SerialPort::Idle, requests);
        }
    }

    fn show_transfer(
        &mut self,
        shown: Communication,
        port: SerialPort,
        requests: &mut Vec<ControlRequest>,
    ) {
        self.view.communication = shown;
        requests.push(ControlRequest::SetSerialPort(port));
    }

    fn port_is_busy(&self) -> bool {
        let transfer = &self.transfer;
        transfer.wanted.is_some()
            || transfer.incoming.is_some()
            || !transfer.files.is_empty()
            || self.client_port_is_busy()
    }

    /// Returns the time that a number of characters takes on the line, ticks (ms).
    fn line_time(characters: usize, cnc: &Cnc) -> u64 {
        let bits = characters as u64 * CHARACTER_BITS;
        (bits * SECOND).div_ceil(baud_rate_of(cnc).max(1))
    }

    /// Starts receiving a file from the partner. It needs no action of the operator.
    ///
    /// # Errors
    ///
    /// Returns the reason why the control does not receive the file.
    pub fn receive(
        &mut self,
        file: SerialFile,
        cnc: &Cnc,
        requests: &mut Vec<ControlRequest>,
    ) -> Result<(), ReceiveError> {
        if !self.is_awake() || !cnc.parameters().has_serial_port() {
            return Err(ReceiveError::PortOff);
        }
        if self.port_is_busy() {
            return Err(ReceiveError::Busy);
        }
        if baud_rate_of(cnc) < MIN_BAUD {
            self.view.communication = Communication::NotConnected;
            return Err(ReceiveError::TooSlow);
        }
        let received = match files::read(&file) {
            Ok(received) => received,
            Err(error) => {
                self.view.communication = Communication::Failed;
                return Err(ReceiveError::Unreadable {
                    name: file.name,
                    cause: error,
                });
            }
        };
        let rights = cnc.rights();
        let allowed = match &received {
            ReceivedData::Program(text) => rights.check_receive_program(files::number_of(text)),
            _ => rights.check_receive_data(),
        };
        if let Err(refusal) = allowed {
            if refusal == WriteRefusal::Level && matches!(received, ReceivedData::Program(_)) {
                // The control raises its alarm.
                requests.push(ControlRequest::StoreReceived(received));
            }
            return Err(ReceiveError::Refused {
                name: file.name,
                why: refusal,
            });
        }
        self.transfer.until = self.clock + Self::line_time(file.text.len(), cnc);
        self.transfer.incoming = Some(file);
        self.show_transfer(Communication::Receiving, SerialPort::Receiving, requests);
        Ok(())
    }

    /// Handles 输出 in EDIT: sends the programs or data that the page shows.
    pub(super) fn output(&mut self, cnc: &Cnc, requests: &mut Vec<ControlRequest>) {
        requests.push(ControlRequest::SetOutputKey(true));
        if cnc.mode() != OperatingMode::Edit || self.port_is_busy() {
            return;
        }
        let Some(wanted) = self.wanted() else {
            return;
        };
        if self.page == PageId::Prg {
            self.clear_input();
        }
        if !cnc.parameters().has_serial_port() || !self.may_send(wanted, cnc, requests) {
            return;
        }
        let answers = match self.transfer.partner {
            SerialCable::Disconnected => false,
            SerialCable::Simulated => baud_rate_of(cnc) >= MIN_BAUD,
            // The port finds out whether a partner is connected.
            SerialCable::Line => true,
        };
        if !answers {
            self.view.communication = Communication::NotConnected;
            return;
        }
        self.store_edited(requests);
        self.transfer.wanted = Some(wanted);
    }

    fn wanted(&self) -> Option<Wanted> {
        Some(match self.page {
            PageId::Prg => {
                let digits = self.view.input.strip_prefix('O')?;
                if is_all_programs(digits) {
                    Wanted::Programs
                } else {
                    Wanted::Program(number(digits)?)
                }
            }
            PageId::Oft => Wanted::Offsets,
            PageId::Pitch => Wanted::Pitch,
            PageId::ParBit | PageId::ParData => Wanted::Parameters,
            _ => return None,
        })
    }

    fn may_send(&self, wanted: Wanted, cnc: &Cnc, requests: &mut Vec<ControlRequest>) -> bool {
        let rights = cnc.rights();
        let allowed = match wanted {
            Wanted::Program(number) => rights.check_send_program(number),
            Wanted::Programs => rights.check_send_program(0),
            Wanted::Offsets | Wanted::Pitch | Wanted::Parameters => rights.check_send_data(),
        };
        match (allowed, wanted) {
            (Ok(()), Wanted::Program(number)) if cnc.programs().stored(number).is_none() => {
                requests.push(ControlRequest::NotFound { sequence: false });
                false
            }
            (Ok(()), _) => true,
            (Err(WriteRefusal::Level), Wanted::Program(number)) => {
                requests.push(ControlRequest::CheckSend(number));
                false
            }
            (Err(WriteRefusal::Level), Wanted::Programs) => {
                requests.push(ControlRequest::CheckSend(0));
                false
            }
            (Err(_), _) => false,
        }
    }

    /// Starts or ends a transfer that is due at this tick.
    pub(super) fn follow_transfer(&mut self, cnc: &Cnc, requests: &mut Vec<ControlRequest>) {
        if let Some(wanted) = self.transfer.wanted.take() {
            let files = files::files_to_send(wanted, cnc);
            if self.transfer.partner == SerialCable::Line {
                self.transfer.for_line = files;
                self.show_transfer(Communication::Sending, SerialPort::Sending, requests);
                return;
            }
            let characters = files.iter().map(|file| file.text.len()).sum();
            self.transfer.until = self.clock + Self::line_time(characters, cnc);
            self.transfer.files = files;
            self.show_transfer(Communication::Sending, SerialPort::Sending, requests);
            return;
        }
        if self.clock < self.transfer.until {
            return;
        }
        if let Some(file) = self.transfer.incoming.take() {
            requests.extend(files::read(&file).ok().map(ControlRequest::StoreReceived));
        } else if self.transfer.files.is_empty() {
            return;
        }
        let mut files = core::mem::take(&mut self.transfer.files);
        self.transfer.sent.append(&mut files);
        self.show_transfer(Communication::Idle, SerialPort::Idle, requests);
    }
}

/// Returns the message about a refusal that is sent to the partner.
fn reason(refusal: WriteRefusal) -> Message {
    match refusal {
        WriteRefusal::Mode => say::refusal_mode(),
        WriteRefusal::Running => say::refusal_running(),
        WriteRefusal::Alarm => say::refusal_alarm(),
        WriteRefusal::ParameterSwitch => say::refusal_parameter_switch(),
        WriteRefusal::ProgramSwitch => say::refusal_program_switch(),
        WriteRefusal::Level => say::level_too_low(),
        WriteRefusal::Locked => say::refusal_locked(),
    }
}

fn baud_rate_of(cnc: &Cnc) -> u64 {
    cnc.parameters().baud().into()
}
