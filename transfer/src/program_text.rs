//! Programs as plain text, as DNC software sends them: `%`, lines, `%`, with XON/XOFF flow control
//! and no acknowledgement.

use std::collections::VecDeque;

use gsk_messages::{Message, say};

use crate::PortTime;
use crate::wire_time::WireTime;

/// DC1: the sender may continue.
const XON: u8 = 0x11;
/// DC3: the sender must stop.
const XOFF: u8 = 0x13;
/// Number of unprocessed characters above which the reader sends XOFF. Below [`XON_LEVEL`] the
/// reader sends XON. Beyond [`MAX_BACKLOG_CHARS`] the sender ignores XOFF.
const XOFF_LEVEL: usize = 2048;
const XON_LEVEL: usize = 512;
const MAX_BACKLOG_CHARS: usize = 65_536;
/// Greatest length of a text, bytes; more than the program memory holds.
const MAX_TEXT_BYTES: usize = 1 << 22;
/// Pause after which an unfinished text is interrupted.
const SILENCE_TIMEOUT: PortTime = PortTime::from_secs(15);
/// Greatest processing time that the reader makes up for after a late call.
const MAX_CATCH_UP_TIME: PortTime = PortTime::from_millis(100);
/// Length in characters below which an interrupted text is noise.
const MIN_TEXT_CHARS: usize = 16;

/// The characters that end each line of a sent text.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TextLineEnd {
    /// CR LF: carriage return, line feed.
    #[default]
    CrLf,
    /// LF: line feed only.
    Lf,
    /// CR: carriage return only.
    Cr,
    /// LF CR CR, as on punched tape.
    LfCrCr,
}

impl TextLineEnd {
    const fn bytes(self) -> &'static [u8] {
        match self {
            Self::CrLf => b"\r\n",
            Self::Lf => b"\n",
            Self::Cr => b"\r",
            Self::LfCrCr => b"\n\r\r",
        }
    }
}

/// A character that plain text cannot carry.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub struct InvalidCharacter {
    /// Line in the program, from 1.
    pub line: usize,
    /// The character that cannot be sent.
    pub character: char,
}

impl InvalidCharacter {
    /// Returns the message that names the character and its line.
    pub fn message(&self) -> Message {
        say::in_line(self.line, say::transfer_not_ascii(self.character))
    }
}

/// A result of [`TextReader::advance`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TextEvent {
    /// The start of a text was received.
    Started,
    /// A complete text was received; it has `\n` line ends and no `%`.
    Complete(String),
    /// The received bytes are not text: wrong rate or noise.
    Noise,
    /// A text is incomplete: silence, noise, or a sender that ignores XOFF.
    Interrupted,
}

/// Receives a text at the speed of the line and stops the sender with XOFF.
#[derive(Clone, Debug)]
pub struct TextReader {
    wire: WireTime,
    backlog: VecDeque<u8>,
    /// Time up to which received bytes are processed.
    read_until: PortTime,
    last_byte_at: PortTime,
    /// Whether XOFF was sent and no XON since.
    is_stopped: bool,
    /// XON and XOFF characters that wait to be sent.
    flow_control: Vec<u8>,
    /// The text received so far; `None` before its start.
    text: Option<String>,
    /// The previous received character.
    previous: u8,
}

impl TextReader {
    /// Creates the reader for a line of `baud` bits per second.
    pub fn new(baud: u32) -> Self {
        Self {
            wire: WireTime::new(baud),
            backlog: VecDeque::new(),
            read_until: PortTime::ZERO,
            last_byte_at: PortTime::ZERO,
            is_stopped: false,
            flow_control: Vec::new(),
            text: None,
            previous: 0,
        }
    }

    /// Whether a text has started and is not complete.
    pub const fn is_in_text(&self) -> bool {
        self.text.is_some()
    }

    /// Whether a text has started or received bytes are not processed yet.
    pub fn is_busy(&self) -> bool {
        self.is_in_text() || !self.backlog.is_empty()
    }

    /// Returns the length of the text so far, in characters.
    pub fn received_chars(&self) -> usize {
        self.text.as_ref().map_or(0, String::len)
    }

    /// Takes bytes that the port received at time `now`; [`Self::advance`] processes them.
    pub fn receive(&mut self, bytes: &[u8], now: PortTime) {
        if bytes.is_empty() {
            return;
        }
        self.last_byte_at = now;
        let free = MAX_BACKLOG_CHARS + 1 - self.backlog.len();
        self.backlog.extend(&bytes[..bytes.len().min(free)]);
        if self.backlog.len() > XOFF_LEVEL && !self.is_stopped {
            self.is_stopped = true;
            self.flow_control.push(XOFF);
        }
    }

    /// Removes and returns the XON and XOFF characters that wait to be sent.
    pub fn take_flow_control(&mut self) -> Vec<u8> {
        core::mem::take(&mut self.flow_control)
    }

    /// Drops the text and all unprocessed bytes, and lets the sender continue.
    pub fn reset(&mut self) {
        self.text = None;
        self.previous = 0;
        self.backlog.clear();
        self.resume_partner();
    }

    /// Processes received bytes up to `now`. Returns the next event; `None` without one.
    pub fn advance(&mut self, now: PortTime) -> Option<TextEvent> {
        if self.backlog.len() > MAX_BACKLOG_CHARS {
            return Some(self.interrupt());
        }
        self.read_until = self.read_until.max(now.saturating_sub(MAX_CATCH_UP_TIME));
        while self.read_until < now {
            let Some(byte) = self.backlog.pop_front() else {
                break;
            };
            self.read_until += self.wire.transmission_time(1);
            if self.backlog.len() < XON_LEVEL {
                self.resume_partner();
            }
            // Bit 7 may be a parity bit.
            if let Some(event) = self.accept(byte & 0x7F) {
                return Some(event);
            }
        }
        if self.backlog.is_empty()
            && self.is_in_text()
            && now.saturating_sub(self.last_byte_at) > SILENCE_TIMEOUT
        {
            return Some(self.interrupt());
        }
        None
    }

    fn resume_partner(&mut self) {
        if core::mem::take(&mut self.is_stopped) {
            self.flow_control.push(XON);
        }
    }

    fn interrupt(&mut self) -> TextEvent {
        let is_noise = self.received_chars() < MIN_TEXT_CHARS;
        self.reset();
        match is_noise {
            true => TextEvent::Noise,
            false => TextEvent::Interrupted,
        }
    }

    fn accept(&mut self, byte: u8) -> Option<TextEvent> {
        // Leader, rubout, DC1 to DC4 of a tape reader or punch.
        if matches!(byte, 0 | 0x7F | 0x11..=0x14) {
            return None;
        }
        let previous = core::mem::replace(&mut self.previous, byte);
        let Some(text) = &mut self.text else {
            let is_program_name = byte.is_ascii_digit() && matches!(previous, b'O' | b'o');
            if byte != b'%' && !is_program_name {
                return None;
            }
            let beginning = match is_program_name {
                true => format!("O{}", char::from(byte)),
                false => String::new(),
            };
            self.text = Some(beginning);
            return Some(TextEvent::Started);
        };
        match byte {
            b'%' if text.trim().is_empty() => {}
            b'%' => {
                let text = self
                    .text
                    .take()
                    .map_or_else(String::new, |text| finish_text(&text));
                self.previous = 0;
                return Some(TextEvent::Complete(text));
            }
            b'\n' if previous == b'\r' => {}
            // LF CR and LF CR CR.
            b'\r' if previous == b'\n' => self.previous = b'\n',
            b'\n' | b'\r' => text.push('\n'),
            b'\t' | b' '..=b'~' => text.push(char::from(byte)),
            _ => return Some(self.interrupt()),
        }
        if is_text_too_long(self.text.as_ref()) {
            return Some(self.interrupt());
        }
        None
    }
}

fn is_text_too_long(text: Option<&String>) -> bool {
    text.is_some_and(|text| text.len() > MAX_TEXT_BYTES)
}

/// Returns a received text without the line end after its first `%`, and with one line end at
/// its end. Other characters in the line of that `%` are a leader, unless they are the program
/// number; the line then keeps its `%`.
fn finish_text(text: &str) -> String {
    let leader = !text.starts_with(['\n', 'O', 'o', ':']);
    let percent = if leader { "%" } else { "" };
    let text = text.trim_start_matches('\n').trim_end();
    format!("{percent}{text}\n")
}

/// Returns the program number, 0 to 9999: the first word after empty lines and leaders; `None`
/// without one.
pub fn parse_program_number(text: &str) -> Option<u16> {
    let mut lines = text.lines().map(str::trim);
    let first = lines.find(|line| !line.is_empty() && !line.starts_with('%'))?;
    let digits = first.strip_prefix(['O', 'o', ':'])?;
    let end = digits.find(|next: char| !next.is_ascii_digit());
    let digits = &digits[..end.unwrap_or(digits.len())];
    digits.parse().ok().filter(|number| *number <= 9999)
}

/// Splits a text into programs at the lines that begin with a program number (`O` or `:`).
pub fn split_programs(text: &str) -> Vec<&str> {
    let mut begins = Vec::new();
    let mut at = 0;
    for line in text.split_inclusive('\n') {
        let digits = line.trim_start().strip_prefix(['O', 'o', ':']);
        if digits.is_some_and(|rest| rest.starts_with(|next: char| next.is_ascii_digit())) {
            begins.push(at);
        }
        at += line.len();
    }
    if begins.len() < 2 {
        return vec![text];
    }
    begins[0] = 0;
    let ends = begins[1..].iter().copied().chain([text.len()]);
    begins
        .iter()
        .zip(ends)
        .map(|(&begin, end)| &text[begin..end])
        .collect()
}

/// Sends a text at the speed of the line and obeys XON and XOFF.
#[derive(Clone, Debug)]
pub struct TextWriter {
    wire: WireTime,
    bytes: Vec<u8>,
    sent_bytes: usize,
    is_stopped: bool,
}

impl TextWriter {
    /// Creates the writer for a line of `baud` bits per second. The writer adds `%` before and
    /// after the text.
    ///
    /// # Errors
    /// The first character that is not printable ASCII or a tab, with its line.
    pub fn new(text: &str, end: TextLineEnd, baud: u32) -> Result<Self, InvalidCharacter> {
        let mut bytes = b"%".to_vec();
        bytes.extend(end.bytes());
        let inner = text.trim_end().trim_end_matches('%').trim_end();
        let mut within = false;
        for (at, line) in inner.lines().enumerate() {
            let line = line.trim_end_matches('\r');
            // Skip the `%` that the text already has.
            if !within && matches!(line.trim(), "" | "%") {
                continue;
            }
            within = true;
            let other = line.chars().find(|c| !matches!(c, '\t' | ' '..='~'));
            if let Some(character) = other {
                return Err(InvalidCharacter {
                    line: at + 1,
                    character,
                });
            }
            bytes.extend(line.as_bytes());
            bytes.extend(end.bytes());
        }
        bytes.push(b'%');
        bytes.extend(end.bytes());
        Ok(Self {
            wire: WireTime::new(baud),
            bytes,
            sent_bytes: 0,
            is_stopped: false,
        })
    }

    /// Returns the number of bytes to send in total.
    pub fn total_bytes(&self) -> usize {
        self.bytes.len()
    }

    /// Returns the number of bytes that the port has taken so far.
    pub const fn sent_bytes(&self) -> usize {
        self.sent_bytes
    }

    /// Takes received bytes: XOFF stops sending, XON continues it. Ignores others.
    pub fn receive(&mut self, bytes: &[u8]) {
        for byte in bytes {
            match byte & 0x7F {
                XOFF => self.is_stopped = true,
                XON => self.is_stopped = false,
                _ => {}
            }
        }
    }

    /// Returns the bytes to send now; [`Self::mark_sent`] confirms how many the port has taken.
    pub fn pending_bytes(&self, now: PortTime) -> &[u8] {
        let rest = &self.bytes[self.sent_bytes..];
        if self.is_stopped {
            return &[];
        }
        &rest[..rest.len().min(self.wire.free_bytes(now))]
    }

    /// Counts the next `count` bytes as sent at time `now`: the port has taken them.
    pub fn mark_sent(&mut self, count: usize, now: PortTime) {
        self.sent_bytes += count;
        self.wire.queue(count, now);
    }

    /// Whether the port has taken all bytes and the last bit has left the line by `now`.
    pub fn is_finished(&self, now: PortTime) -> bool {
        self.sent_bytes == self.bytes.len() && self.wire.idle_at() <= now
    }
}

#[cfg(test)]
#[path = "program_text_tests.rs"]
mod tests;
