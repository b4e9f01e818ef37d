//! The port of the control: frames, and programs as plain text beside them.

use std::collections::VecDeque;

use crate::control_side::{ControlEvent, ControlSide, Status, Store};
use crate::fault::Fault;
use crate::file::NewFile;
use crate::frame::Place;
use crate::name::{FileName, Partition};
use crate::text::{self, LineEnd, TextEvent, TextReader, TextWriter};
use crate::{HostTime, SLOWEST_FRAMES};

/// How the control speaks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Framing {
    /// In frames; a text that begins with `%` is taken as well.
    #[default]
    Frames,
    /// In text only.
    Text,
}

/// The port of the control.
#[derive(Clone, Debug)]
pub struct ControlPort {
    framing: Framing,
    line_end: LineEnd,
    baud: u32,
    frames: ControlSide,
    reader: TextReader,
    /// DC1 and DC3 of the reader.
    replies: Vec<u8>,
    writer: Option<(FileName, TextWriter)>,
    /// Programs that go out as text.
    to_write: VecDeque<NewFile>,
    events: VecDeque<ControlEvent>,
}

impl ControlPort {
    /// At a line of so many bits a second; a slow one carries text only.
    pub fn new(baud: u32, framing: Framing, line_end: LineEnd) -> Self {
        let framing = match baud < SLOWEST_FRAMES {
            true => Framing::Text,
            false => framing,
        };
        Self {
            framing,
            line_end,
            baud,
            frames: ControlSide::new(baud),
            reader: TextReader::new(baud),
            replies: Vec::new(),
            writer: None,
            to_write: VecDeque::new(),
            events: VecDeque::new(),
        }
    }

    /// How it speaks.
    pub const fn framing(&self) -> Framing {
        self.framing
    }

    /// All that was to be said has been said and answered, and nothing comes in.
    pub fn is_quiet(&self) -> bool {
        self.frames.is_quiet()
            && self.replies.is_empty()
            && self.writer.is_none()
            && self.to_write.is_empty()
            && !self.reader.is_within()
    }

    /// Sends files by itself.
    pub fn send(&mut self, files: Vec<NewFile>) {
        match self.framing {
            Framing::Frames => self.frames.send(files),
            Framing::Text => self.to_write.extend(files),
        }
    }

    /// 复位: what is under way is dropped.
    pub fn break_off(&mut self) {
        self.frames.break_off();
        self.reader.reset();
        self.writer = None;
        self.to_write.clear();
    }

    /// Bytes have come.
    pub fn hear(&mut self, bytes: &[u8], now: HostTime) {
        if let Some((_, writer)) = &mut self.writer {
            writer.hear(bytes);
        } else if self.framing == Framing::Text || self.reader.is_busy() {
            self.reader.hear(bytes, now);
        } else if self.frames.is_connected() || self.frames.is_within() {
            self.frames.hear(bytes, now);
        } else {
            self.hear_first(bytes, now);
        }
    }

    /// The first bytes from whoever it is: a leader says nothing, `%` begins a text.
    fn hear_first(&mut self, bytes: &[u8], now: HostTime) {
        let leader = |byte: &&u8| matches!(**byte & 0x7F, 0 | 0x7F | 0x11..=0x14 | b'\r' | b'\n');
        let skipped = bytes.iter().take_while(leader).count();
        let rest = &bytes[skipped..];
        match rest.first() {
            None => {}
            Some(byte) if byte & 0x7F == b'%' => self.reader.hear(rest, now),
            Some(_) => self.frames.hear(rest, now),
        }
    }

    /// Hands bytes to the port, which says how many it takes.
    pub fn write(&mut self, now: HostTime, mut port: impl FnMut(&[u8]) -> usize) {
        self.replies.extend(self.reader.take_replies());
        if !self.replies.is_empty() {
            let taken = port(&self.replies);
            self.replies.drain(..taken.min(self.replies.len()));
        } else if let Some((_, writer)) = &mut self.writer {
            let due = writer.due(now);
            if !due.is_empty() {
                let taken = port(due);
                writer.sent(taken, now);
            }
        } else {
            let due = self.frames.due(now);
            if !due.is_empty() {
                let taken = port(due);
                self.frames.sent(taken);
            }
        }
    }

    /// What has come of something.
    pub fn next_event(&mut self) -> Option<ControlEvent> {
        self.events.pop_front().or_else(|| self.frames.next_event())
    }

    /// What the LCD says.
    pub fn status(&self, now: HostTime) -> Status {
        if self.writer.is_some() || !self.to_write.is_empty() {
            Status::Sending
        } else if self.reader.is_within() {
            Status::Receiving
        } else {
            self.frames.status(now)
        }
    }

    /// Does what is to be done by now.
    pub fn advance(&mut self, now: HostTime, store: &mut dyn Store) {
        self.frames.advance(now, store);
        while let Some(event) = self.reader.advance(now) {
            match event {
                TextEvent::Begun => {}
                TextEvent::Noise => self.events.push_back(ControlEvent::NotConnected),
                TextEvent::Broken => self.events.push_back(ControlEvent::Broken),
                TextEvent::Whole(text) => self.take(&text, store),
            }
        }
        self.go_on(now);
    }

    /// The programs of a text come into the memory; one that is refused keeps out those
    /// after it.
    fn take(&mut self, text: &str, store: &mut dyn Store) {
        for program in text::programs(text) {
            let Some(number) = text::program_number(program) else {
                let name = FileName::of_program(0);
                self.events
                    .push_back(ControlEvent::Refused(name, Fault::BadName));
                return;
            };
            let name = FileName::of_program(number);
            let file = NewFile {
                place: Place {
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

    /// Ends a text that is over and begins the next one.
    fn go_on(&mut self, now: HostTime) {
        if let Some((name, writer)) = &self.writer {
            if !writer.is_over(now) {
                return;
            }
            self.events.push_back(ControlEvent::Sent(name.clone()));
            self.writer = None;
        }
        if self.reader.is_within() {
            return;
        }
        let Some(NewFile { place, bytes, .. }) = self.to_write.pop_front() else {
            return;
        };
        let name = place.name;
        if name.program().is_none() {
            self.to_write.clear();
            return self.events.push_back(ControlEvent::OnlyPrograms(name));
        }
        let text = String::from_utf8_lossy(&bytes);
        match TextWriter::new(&text, self.line_end, self.baud) {
            Ok(writer) => self.writer = Some((name, writer)),
            Err(why) => {
                self.to_write.clear();
                self.events.push_back(ControlEvent::NotText(name, why));
            }
        }
    }
}
