//! Connects the control's serial port to a port of the computer: files in frames, or
//! programs as text (manual III-9).

mod memory;
mod wire;

use gsk_messages::{Message, say};
use gsk_panel::emulator::Emulator;
use gsk_panel::pages::Communication;
use gsk_panel::panel::SerialFile;
use gsk_transfer::{
    ControlEvent, ControlPort, FileName, Framing, Partition, PortStatus, PortTime, RemotePath,
    TextLineEnd, TransferFault, TransferFile,
};
use web_time::{Duration, Instant};

pub use memory::SerialFileStore;
use wire::{SerialPortEvent, SerialPortHandle};

/// Longest time the port keeps its rate after a change of parameter 044, until the last
/// bytes have left: the reply to the file that changed it still has the old rate.
const RATE_CHANGE_TIMEOUT: Duration = Duration::from_secs(3);
/// Time that bytes sent by the program need to leave the computer.
const SEND_DELAY: Duration = Duration::from_millis(60);

/// The device or program to which the control's serial port is connected.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SerialEnd {
    /// A port of the computer, or the network port `tcp:HOST:PORT`.
    Port(String),
    /// The port is a new pseudo terminal, whose name a message reports.
    Terminal,
    /// The port is connected to the program that connects to this network address, `HOST:PORT`.
    Listening(String),
}

impl SerialEnd {
    /// Parses a name of the command line: `pty`, `listen:HOST:PORT`, or a port.
    pub fn from_name(name: &str) -> Self {
        match name.strip_prefix("listen:") {
            Some(address) => Self::Listening(address.to_owned()),
            None if name == "pty" => Self::Terminal,
            None => Self::Port(name.to_owned()),
        }
    }
}

/// The control's serial port, with the thread that moves its bytes.
#[derive(Debug)]
pub struct SerialLine {
    wire: SerialPortHandle,
    /// The state of the port; `None` while the control or its port is off.
    port: Option<OpenControlPort>,
    framing: Framing,
    line_end: TextLineEnd,
    /// Name of the port; `None` while it is not open.
    name: Option<String>,
    begun: Instant,
}

/// The state of the serial port of a control that is on.
#[derive(Debug)]
struct OpenControlPort {
    side: ControlPort,
    baud: u32,
    shown_status: PortStatus,
    /// Time since which the rate of the port differs from parameter 044; `None` if it does
    /// not.
    outdated_since: Option<Instant>,
    /// Time at which bytes were last sent to the port.
    last_sent: PortTime,
}

impl SerialLine {
    /// Starts to open a port; [`Self::tick`] reports the result.
    ///
    /// # Errors
    /// The system starts no thread.
    pub fn open(end: SerialEnd, text: Option<TextLineEnd>) -> std::io::Result<Self> {
        Ok(Self {
            wire: SerialPortHandle::open(end)?,
            port: None,
            framing: match text {
                Some(_) => Framing::Text,
                None => Framing::Frames,
            },
            line_end: text.unwrap_or_default(),
            name: None,
            begun: Instant::now(),
        })
    }

    /// Runs the port after a tick of the control; returns messages for the operator.
    pub fn tick(&mut self, emulator: &mut Emulator) -> Vec<Message> {
        let mut messages = Vec::new();
        let rate = emulator.panel().baud_rate(emulator.cnc());
        self.follow_rate(rate, emulator, &mut messages);
        let now = self.begun.elapsed();
        while let Some(event) = self.wire.next_event() {
            self.handle_event(event, now, emulator, &mut messages);
        }
        let broken_off = emulator.take_aborted();
        let to_send = emulator.take_port_files();
        let Some(port) = &mut self.port else {
            return messages;
        };
        if broken_off {
            port.side.abort();
        }
        if !to_send.is_empty() {
            match self.name {
                Some(_) => port
                    .side
                    .send(to_send.into_iter().filter_map(to_transfer_file).collect()),
                None => emulator.show_port_state(Communication::NotConnected),
            }
        }
        let mut memory = SerialFileStore::new(emulator);
        port.side.advance(now, &mut memory);
        let mut why = memory.into_refusal_reason();
        port.side.write(now, |bytes| {
            port.last_sent = now;
            self.wire.send(bytes)
        });
        let status = port.side.status(now);
        if status != port.shown_status {
            port.shown_status = status;
            emulator.show_port_state(match status {
                PortStatus::Idle => Communication::Idle,
                PortStatus::Receiving => Communication::Receiving,
                PortStatus::Sending => Communication::Sending,
            });
        }
        while let Some(event) = port.side.next_event() {
            if let Some(shown) = shown_state(&event) {
                emulator.show_port_state(shown);
            }
            messages.extend(event_message(event, &mut why));
        }
        messages
    }

    /// Breaks off transfers, because the control went back to a past moment.
    pub fn break_off(&mut self, emulator: &mut Emulator) {
        if let Some(port) = &mut self.port {
            port.side = ControlPort::new(port.baud, self.framing, self.line_end);
            port.shown_status = PortStatus::Idle;
        }
        emulator.show_port_state(Communication::Idle);
    }

    /// Applies the rate of parameter 044 to the port, and opens or closes it with the control
    /// and with bit parameter 002.5.
    fn follow_rate(
        &mut self,
        rate: Option<u32>,
        emulator: &mut Emulator,
        messages: &mut Vec<Message>,
    ) {
        let now = self.begun.elapsed();
        match (&mut self.port, rate) {
            (None, None) => {}
            (Some(port), None) => {
                if port.shown_status != PortStatus::Idle {
                    emulator.show_port_state(Communication::Idle);
                }
                self.port = None;
            }
            (Some(port), Some(baud)) if port.baud == baud => port.outdated_since = None,
            (Some(port), Some(baud)) => {
                let since = *port.outdated_since.get_or_insert_with(Instant::now);
                let has_left = port.side.is_drained() && now > port.last_sent + SEND_DELAY;
                if has_left || since.elapsed() > RATE_CHANGE_TIMEOUT {
                    self.open_side(baud, messages);
                }
            }
            (None, Some(baud)) => self.open_side(baud, messages),
        }
    }

    fn open_side(&mut self, baud: u32, messages: &mut Vec<Message>) {
        self.port = Some(OpenControlPort {
            side: ControlPort::new(baud, self.framing, self.line_end),
            baud,
            shown_status: PortStatus::Idle,
            outdated_since: None,
            last_sent: PortTime::ZERO,
        });
        self.wire.set_rate(baud);
        // A pseudo terminal stays open at every rate.
        messages.extend(self.opened_message());
    }

    /// Returns the message that the port is open at the control's rate; `None` if it is not
    /// open.
    fn opened_message(&self) -> Option<Message> {
        let (name, port) = (self.name.as_ref()?, self.port.as_ref()?);
        Some(match port.side.framing() {
            Framing::Frames => say::serial_line_opened(name, port.baud),
            Framing::Text => say::serial_line_text(name, port.baud),
        })
    }

    fn handle_event(
        &mut self,
        event: SerialPortEvent,
        now: PortTime,
        emulator: &mut Emulator,
        messages: &mut Vec<Message>,
    ) {
        match event {
            SerialPortEvent::Opened(name) => {
                let known = self.name.replace(name);
                if known != self.name {
                    messages.extend(self.opened_message());
                }
            }
            SerialPortEvent::Gone(why) => {
                self.name = None;
                if let Some(port) = &mut self.port
                    && port.shown_status != PortStatus::Idle
                {
                    port.shown_status = PortStatus::Idle;
                    port.side = ControlPort::new(port.baud, self.framing, self.line_end);
                    emulator.show_port_state(Communication::Failed);
                }
                messages.push(say::serial_line_not_opened(why));
            }
            SerialPortEvent::Bytes(bytes) => {
                if let Some(port) = &mut self.port {
                    port.side.receive(&bytes, now);
                }
            }
        }
    }
}

/// Makes a transfer of a file that the control sends; `None` if its name is invalid. Data
/// replace existing data; a program never replaces another one (alarm 073 at a control, a
/// question at a PC).
fn to_transfer_file(file: SerialFile) -> Option<TransferFile> {
    // The control's own file names are valid.
    let name = FileName::new(&file.name).ok()?;
    Some(TransferFile {
        overwrite: name.program_number().is_none(),
        remote_path: RemotePath {
            partition: Partition::User,
            name,
        },
        bytes: file.text.into_bytes(),
    })
}

/// Returns the state of the transfer that the LCD shows after an event; `None` leaves it
/// unchanged.
const fn shown_state(event: &ControlEvent) -> Option<Communication> {
    match event {
        // A query whether a file exists starts no transfer; for a text alarm 073 reports
        // it.
        ControlEvent::Received(_)
        | ControlEvent::Sent(_)
        | ControlEvent::Refused(_, TransferFault::Exists) => None,
        ControlEvent::NotConnected => Some(Communication::NotConnected),
        ControlEvent::RejectedByPeer(..)
        | ControlEvent::Refused(..)
        | ControlEvent::InvalidCharacter(..)
        | ControlEvent::OnlyPrograms(_)
        | ControlEvent::Interrupted => Some(Communication::Failed),
    }
}

/// Returns the message for the operator about an event; `None` if there is none. `why` is a
/// longer reason than the wire carries.
fn event_message(event: ControlEvent, why: &mut Option<Message>) -> Option<Message> {
    Some(match event {
        ControlEvent::Received(name) => say::serial_received(name),
        ControlEvent::Sent(name) => say::serial_sent(name),
        ControlEvent::RejectedByPeer(name, fault) => say::serial_not_taken(name, fault.message()),
        ControlEvent::Refused(name, fault) => {
            let why = why.take().unwrap_or_else(|| fault.message());
            say::serial_refused(name, why)
        }
        ControlEvent::InvalidCharacter(name, why) => say::subject_reason(name, why.message()),
        ControlEvent::OnlyPrograms(name) => say::serial_only_programs(name),
        ControlEvent::Interrupted => say::serial_broken(),
        // The LCD shows 串口未连接, as often as there is noise.
        ControlEvent::NotConnected => return None,
    })
}
