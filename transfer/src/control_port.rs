//! Serial port of the control: frames, and programs as plain text beside them.

use std::collections::VecDeque;

use crate::control_side::{ControlEvent, ControlSide, FileStore, PortStatus};
use crate::file_name::{FileName, Partition};
use crate::frame::RemotePath;
use crate::program_text::{
    TextEvent, TextLineEnd, TextReader, TextWriter, parse_program_number, split_programs,
};
use crate::transfer_fault::TransferFault;
use crate::transfer_file::TransferFile;
use crate::{MIN_FRAME_BAUD, PortTime};

/// The protocol in which the control sends files.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Framing {
    /// Frames. A received plain text that begins with `%` is accepted as well.
    #[default]
    Frames,
    /// Plain text only; frames are not sent.
    Text,
}

/// The serial port of the control: handles frames and plain text on one line.
#[derive(Clone, Debug)]
pub struct ControlPort {
    framing: Framing,
    line_end: TextLineEnd,
    baud: u32,
    frames: ControlSide,
    reader: TextReader,
    /// XON and XOFF characters of the text reader that wait to be sent.
    flow_control: Vec<u8>,
    writer: Option<(FileName, TextWriter)>,
    /// Programs that wait to be sent as text.
    text_queue: VecDeque<TransferFile>,
    events: VecDeque<ControlEvent>,
}

impl ControlPort {
    /// Creates the port for a line of `baud` bits per second. Below [`MIN_FRAME_BAUD`] the
    /// port uses plain text only.
    pub fn new(baud: u32, framing: Framing, line_end: TextLineEnd) -> Self {
        let framing = match baud < MIN_FRAME_BAUD {
            true => Framing::Text,
            false => framing,
        };
        Self {
            framing,
            line_end,
            baud,
            frames: ControlSide::new(baud),
            reader: TextReader::new(baud),
            flow_control: Vec::new(),
            writer: None,
            text_queue: VecDeque::new(),
            events: VecDeque::new(),
        }
    }

    /// Returns the protocol in which the control sends files.
    pub const fn framing(&self) -> Framing {
        self.framing
    }

    /// Whether everything is sent and acknowledged and nothing is being received.
    pub fn is_drained(&self) -> bool {
        self.frames.is_drained()
            && self.flow_control.is_empty()
            && self.writer.is_none()
            && self.text_queue.is_empty()
            && !self.reader.is_in_text()
    }

    /// Queues files for sending in the protocol of [`Self::framing`].
    pub fn send(&mut self, files: Vec<TransferFile>) {
        match self.framing {
            Framing::Frames => self.frames.send(files),
            Framing::Text => self.text_queue.extend(files),
        }
    }

    /// Aborts all transfers on 复位 (reset).
    pub fn abort(&mut self) {
        self.frames.abort();
        self.reader.reset();
        self.writer = None;
        self.text_queue.clear();
    }

    /// Passes bytes that the port received at time `now` to the protocol in use.
    pub fn receive(&mut self, bytes: &[u8], now: PortTime) {
        if let Some((_, writer)) = &mut self.writer {
            writer.receive(bytes);
        } else if self.framing == Framing::Text || self.reader.is_busy() {
            self.reader.receive(bytes, now);
        } else if self.frames.is_connected() || self.frames.is_in_frame() {
            self.frames.receive(bytes, now);
        } else {
            self.receive_first(bytes, now);
        }
    }

    /// Selects the protocol by the first bytes of a new peer: after leader bytes, `%` begins a
    /// text.
    fn receive_first(&mut self, bytes: &[u8], now: PortTime) {
        let is_leader =
            |byte: &&u8| matches!(**byte & 0x7F, 0 | 0x7F | 0x11..=0x14 | b'\r' | b'\n');
        let skipped = bytes.iter().take_while(is_leader).count();
        let rest = &bytes[skipped..];
        match rest.first() {
            None => {}
            Some(byte) if byte & 0x7F == b'%' => self.reader.receive(rest, now),
            Some(_) => self.frames.receive(rest, now),
        }
    }

    /// Passes waiting bytes to the function `port`, which returns the number of bytes taken.
    pub fn write(&mut self, now: PortTime, mut port: impl FnMut(&[u8]) -> usize) {
        self.flow_control.extend(self.reader.take_flow_control());
        if !self.flow_control.is_empty() {
            let taken = port(&self.flow_control);
            self.flow_control
                .drain(..taken.min(self.flow_control.len()));
        } else if let Some((_, writer)) = &mut self.writer {
            let due = writer.pending_bytes(now);
            if !due.is_empty() {
                let taken = port(due);
                writer.mark_sent(taken, now);
            }
        } else {
            let due = self.frames.pending_bytes(now);
            if !due.is_empty() {
                let taken = port(due);
                self.frames.mark_sent(taken);
            }
        }
    }

    /// Removes and returns the oldest event; `None` without one.
    pub fn next_event(&mut self) -> Option<ControlEvent> {
        self.events.pop_front().or_else(|| self.frames.next_event())
    }

    /// Returns the transfer status for the LCD.
    pub fn status(&self, now: PortTime) -> PortStatus {
        if self.writer.is_some() || !self.text_queue.is_empty() {
            PortStatus::Sending
        } else if self.reader.is_in_text() {
            PortStatus::Receiving
        } else {
            self.frames.status(now)
        }
    }

    /// Processes received bytes, timeouts and waiting files up to `now`.
    pub fn advance(&mut self, now: PortTime, store: &mut dyn FileStore) {
        self.frames.advance(now, store);
        while let Some(event) = self.reader.advance(now) {
            match event {
                TextEvent::Started => {}
                TextEvent::Noise => self.events.push_back(ControlEvent::NotConnected),
                TextEvent::Interrupted => self.events.push_back(ControlEvent::Interrupted),
                TextEvent::Complete(text) => self.store_programs(&text, store),
            }
        }
        self.advance_writer(now);
    }

    /// Splits a received text into programs and stores them, up to the first that is refused.
    fn store_programs(&mut self, text: &str, store: &mut dyn FileStore) {
        for program in split_programs(text) {
            let Some(number) = parse_program_number(program) else {
                let name = FileName::from_program(0);
                self.events
                    .push_back(ControlEvent::Refused(name, TransferFault::BadName));
                return;
            };
            let name = FileName::from_program(number);
            let file = TransferFile {
                remote_path: RemotePath {
                    partition: Partition::User,
                    name: name.clone(),
                },
                bytes: program.as_bytes().to_vec(),
                overwrite: false,
            };
            match store.put(&file) {
                Ok(()) => self.events.push_back(ControlEvent::Received(name)),
                Err(fault) => {
                    return self.events.push_back(ControlEvent::Refused(name, fault));
                }
            }
        }
    }

    /// Reports a text that is completely sent, and starts the next one.
    fn advance_writer(&mut self, now: PortTime) {
        if let Some((name, writer)) = &self.writer {
            if !writer.is_finished(now) {
                return;
            }
            self.events.push_back(ControlEvent::Sent(name.clone()));
            self.writer = None;
        }
        if self.reader.is_in_text() {
            return;
        }
        let Some(TransferFile {
            remote_path: path,
            bytes,
            ..
        }) = self.text_queue.pop_front()
        else {
            return;
        };
        let name = path.name;
        if name.program_number().is_none() {
            self.text_queue.clear();
            return self.events.push_back(ControlEvent::OnlyPrograms(name));
        }
        let text = String::from_utf8_lossy(&bytes);
        match TextWriter::new(&text, self.line_end, self.baud) {
            Ok(writer) => self.writer = Some((name, writer)),
            Err(why) => {
                self.text_queue.clear();
                self.events
                    .push_back(ControlEvent::InvalidCharacter(name, why));
            }
        }
    }
}
