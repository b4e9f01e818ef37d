//! Connects the control's serial port to a port of the computer: files in frames, or
//! programs as text (manual III-9).

mod memory;
mod wire;

use gsk_messages::{Message, say};
use gsk_panel::emulator::Emulator;
use gsk_panel::pages::Communication;
use gsk_panel::panel::SerialFile;
use gsk_transfer::{
    ControlEvent, ControlPort, FileName, Framing, HostTime, Partition, PortStatus, RemotePath,
    TextLineEnd, TransferFault, TransferFile,
};
use web_time::{Duration, Instant};

use memory::Memory;
use wire::{Heard, Wire};

/// Longest time the port keeps its rate after a change of parameter 044, until the last
/// bytes have left: the reply to the file that changed it still has the old rate.
const LAST_WORDS: Duration = Duration::from_secs(3);
/// Time for bytes that have left the program to leave the computer.
const LEAVES: Duration = Duration::from_millis(60);

/// The other end of the line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum End {
    /// A port of the computer, or `tcp:HOST:PORT`.
    Port(String),
    /// A new pseudo terminal; a message reports its name.
    Terminal,
    /// The program that connects with this address, `HOST:PORT`.
    Listening(String),
}

impl End {
    /// Parses a name of the command line: `pty`, `listen:HOST:PORT`, or a port.
    pub fn of(name: &str) -> Self {
        match name.strip_prefix("listen:") {
            Some(address) => Self::Listening(address.to_owned()),
            None if name == "pty" => Self::Terminal,
            None => Self::Port(name.to_owned()),
        }
    }
}

/// The control's serial port at its line.
#[derive(Debug)]
pub struct SerialLine {
    wire: Wire,
    /// None while the control or its port is off.
    port: Option<Open>,
    framing: Framing,
    line_end: TextLineEnd,
    /// Name of the port while it is open.
    name: Option<String>,
    begun: Instant,
}

/// The port of a control that is on.
#[derive(Debug)]
struct Open {
    side: ControlPort,
    baud: u32,
    shown: PortStatus,
    /// Start of a difference between the rate and parameter 044.
    outdated: Option<Instant>,
    /// When bytes were last sent.
    spoken: HostTime,
}

impl SerialLine {
    /// Starts to open a port; [`Self::tick`] reports the result.
    ///
    /// # Errors
    /// The system starts no thread.
    pub fn open(end: End, text: Option<TextLineEnd>) -> std::io::Result<Self> {
        Ok(Self {
            wire: Wire::open(end)?,
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
        let mut said = Vec::new();
        let rate = emulator.panel.baud_rate(&emulator.simulation.cnc);
        self.follow_rate(rate, emulator, &mut said);
        let now = self.begun.elapsed();
        while let Some(heard) = self.wire.heard() {
            self.heard(heard, now, emulator, &mut said);
        }
        let broken_off = emulator.panel.take_aborted();
        let to_send = emulator.panel.take_port_files();
        let Some(port) = &mut self.port else {
            return said;
        };
        if broken_off {
            port.side.abort();
        }
        if !to_send.is_empty() {
            match self.name {
                Some(_) => port
                    .side
                    .send(to_send.into_iter().filter_map(pushed).collect()),
                None => emulator.show_port_state(Communication::NotConnected),
            }
        }
        let mut memory = Memory::of(emulator);
        port.side.advance(now, &mut memory);
        let mut why = memory.into_why();
        port.side.write(now, |bytes| {
            port.spoken = now;
            self.wire.give(bytes)
        });
        let status = port.side.status(now);
        if status != port.shown {
            port.shown = status;
            emulator.show_port_state(match status {
                PortStatus::Idle => Communication::Idle,
                PortStatus::Receiving => Communication::Receiving,
                PortStatus::Sending => Communication::Sending,
            });
        }
        while let Some(event) = port.side.next_event() {
            if let Some(shown) = word(&event) {
                emulator.show_port_state(shown);
            }
            said.extend(sentence(event, &mut why));
        }
        said
    }

    /// Follows parameters 044 and 002.5 and the power of the control.
    fn follow_rate(&mut self, rate: Option<u32>, emulator: &mut Emulator, said: &mut Vec<Message>) {
        let now = self.begun.elapsed();
        match (&mut self.port, rate) {
            (None, None) => {}
            (Some(port), None) => {
                if port.shown != PortStatus::Idle {
                    emulator.show_port_state(Communication::Idle);
                }
                self.port = None;
            }
            (Some(port), Some(baud)) if port.baud == baud => port.outdated = None,
            (Some(port), Some(baud)) => {
                let since = *port.outdated.get_or_insert_with(Instant::now);
                let leaves = port.side.is_drained() && now > port.spoken + LEAVES;
                if leaves || since.elapsed() > LAST_WORDS {
                    self.begin(baud, said);
                }
            }
            (None, Some(baud)) => self.begin(baud, said),
        }
    }

    fn begin(&mut self, baud: u32, said: &mut Vec<Message>) {
        self.port = Some(Open {
            side: ControlPort::new(baud, self.framing, self.line_end),
            baud,
            shown: PortStatus::Idle,
            outdated: None,
            spoken: HostTime::ZERO,
        });
        self.wire.set_rate(baud);
        // A pseudo terminal stays open at every rate.
        said.extend(self.opened());
    }

    /// Returns the message that the port is open at the control's rate.
    fn opened(&self) -> Option<Message> {
        let (name, port) = (self.name.as_ref()?, self.port.as_ref()?);
        Some(match port.side.framing() {
            Framing::Frames => say::serial_line_opened(name, port.baud),
            Framing::Text => say::serial_line_text(name, port.baud),
        })
    }

    fn heard(
        &mut self,
        heard: Heard,
        now: HostTime,
        emulator: &mut Emulator,
        said: &mut Vec<Message>,
    ) {
        match heard {
            Heard::Opened(name) => {
                let known = self.name.replace(name);
                if known != self.name {
                    said.extend(self.opened());
                }
            }
            Heard::Gone(why) => {
                self.name = None;
                if let Some(port) = &mut self.port
                    && port.shown != PortStatus::Idle
                {
                    port.shown = PortStatus::Idle;
                    port.side = ControlPort::new(port.baud, self.framing, self.line_end);
                    emulator.show_port_state(Communication::Failed);
                }
                said.push(say::serial_line_not_opened(why));
            }
            Heard::Bytes(bytes) => {
                if let Some(port) = &mut self.port {
                    port.side.receive(&bytes, now);
                }
            }
        }
    }
}

/// Makes a transfer of a file that the control sends. Data replace data; a program never
/// replaces another one (alarm 073 at a control, a question at a PC).
fn pushed(file: SerialFile) -> Option<TransferFile> {
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

/// Returns the state to show on the LCD.
const fn word(event: &ControlEvent) -> Option<Communication> {
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

/// Returns the message for an event; `why`: a longer reason than the wire carries.
fn sentence(event: ControlEvent, why: &mut Option<Message>) -> Option<Message> {
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
