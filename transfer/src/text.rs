//! Programs as plain text, as DNC programs of the shop send and take them: `%`, lines,
//! `%`, with DC1 and DC3 (XON, XOFF) against the stream and no answer to anything.

use std::collections::VecDeque;

use gsk_messages::{Message, say};

use crate::HostTime;
use crate::wire_time::WireTime;

/// Go on: DC1, XON.
const GO_ON: u8 = 0x11;
/// Stop: DC3, XOFF.
const STOP: u8 = 0x13;
/// Characters that wait: at so many the partner is stopped, at so few it goes on, and at
/// so many it has not stopped.
const STOP_AT: usize = 2048;
const GO_ON_AT: usize = 512;
const OVERRUN: usize = 65_536;
/// The longest text: more than any memory of the control holds.
const LONGEST: usize = 1 << 22;
/// A text that stops for so long has no end.
const SILENCE: HostTime = HostTime::from_secs(15);
/// The reader catches up for so long at most.
const CATCH_UP: HostTime = HostTime::from_millis(100);
/// A first stretch shorter than this, and then noise, was never a text.
const NEVER_A_TEXT: usize = 16;

/// How lines end that go out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LineEnd {
    /// CR LF.
    #[default]
    CrLf,
    /// LF.
    Lf,
    /// CR.
    Cr,
    /// LF CR CR, as on a punched tape.
    LfCrCr,
}

impl LineEnd {
    const fn bytes(self) -> &'static [u8] {
        match self {
            Self::CrLf => b"\r\n",
            Self::Lf => b"\n",
            Self::Cr => b"\r",
            Self::LfCrCr => b"\n\r\r",
        }
    }
}

/// A text that cannot go over the line.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub struct NotText {
    /// The line, from 1.
    pub line: usize,
    /// The character.
    pub character: char,
}

impl NotText {
    /// What is said of it.
    pub fn message(&self) -> Message {
        say::in_line(self.line, say::transfer_not_ascii(self.character))
    }
}

/// What a reader has found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TextEvent {
    /// A text has begun.
    Begun,
    /// All of a text, with `\n` at the end of its lines and without its `%`.
    Whole(String),
    /// What came is no text and never was: a wrong rate, noise.
    Noise,
    /// A text ended in the middle: silence, noise, no stop when it was asked to.
    Broken,
}

/// Takes a text from the line, at the speed of the line.
#[derive(Clone, Debug)]
pub struct TextReader {
    wire: WireTime,
    backlog: VecDeque<u8>,
    /// Up to when what has come has been looked at.
    read_until: HostTime,
    heard_at: HostTime,
    /// The partner has been asked to stop.
    stopped: bool,
    /// DC1 and DC3 for the partner.
    out: Vec<u8>,
    /// The text so far; none before its beginning.
    text: Option<String>,
    /// The control character or the letter before.
    before: u8,
}

impl TextReader {
    /// At a line of so many bits a second.
    pub fn new(baud: u32) -> Self {
        Self {
            wire: WireTime::new(baud),
            backlog: VecDeque::new(),
            read_until: HostTime::ZERO,
            heard_at: HostTime::ZERO,
            stopped: false,
            out: Vec::new(),
            text: None,
            before: 0,
        }
    }

    /// A text has begun and not ended.
    pub const fn is_within(&self) -> bool {
        self.text.is_some()
    }

    /// Something has come that has not been looked at, or a text has begun.
    pub fn is_busy(&self) -> bool {
        self.is_within() || !self.backlog.is_empty()
    }

    /// Characters of the text so far.
    pub fn length(&self) -> usize {
        self.text.as_ref().map_or(0, String::len)
    }

    /// Bytes have come.
    pub fn hear(&mut self, bytes: &[u8], now: HostTime) {
        if bytes.is_empty() {
            return;
        }
        self.heard_at = now;
        let room = OVERRUN + 1 - self.backlog.len();
        self.backlog.extend(&bytes[..bytes.len().min(room)]);
        if self.backlog.len() > STOP_AT && !self.stopped {
            self.stopped = true;
            self.out.push(STOP);
        }
    }

    /// DC1 and DC3 for the port.
    pub fn take_replies(&mut self) -> Vec<u8> {
        core::mem::take(&mut self.out)
    }

    /// What is under way is dropped, and the partner may send again.
    pub fn reset(&mut self) {
        self.text = None;
        self.before = 0;
        self.backlog.clear();
        self.let_go();
    }

    /// Looks at what the line has brought by now.
    pub fn advance(&mut self, now: HostTime) -> Option<TextEvent> {
        if self.backlog.len() > OVERRUN {
            return Some(self.broken());
        }
        self.read_until = self.read_until.max(now.saturating_sub(CATCH_UP));
        while self.read_until < now {
            let Some(byte) = self.backlog.pop_front() else {
                break;
            };
            self.read_until += self.wire.bytes(1);
            if self.backlog.len() < GO_ON_AT {
                self.let_go();
            }
            // Bit 7 may be a parity.
            if let Some(event) = self.take(byte & 0x7F) {
                return Some(event);
            }
        }
        if self.backlog.is_empty()
            && self.is_within()
            && now.saturating_sub(self.heard_at) > SILENCE
        {
            return Some(self.broken());
        }
        None
    }

    fn let_go(&mut self) {
        if core::mem::take(&mut self.stopped) {
            self.out.push(GO_ON);
        }
    }

    fn broken(&mut self) -> TextEvent {
        let short = self.length() < NEVER_A_TEXT;
        self.reset();
        match short {
            true => TextEvent::Noise,
            false => TextEvent::Broken,
        }
    }

    fn take(&mut self, byte: u8) -> Option<TextEvent> {
        // Leader, rubbed out characters, DC1 to DC4 of a reader or punch.
        if matches!(byte, 0 | 0x7F | 0x11..=0x14) {
            return None;
        }
        let before = core::mem::replace(&mut self.before, byte);
        let Some(text) = &mut self.text else {
            let named = byte.is_ascii_digit() && matches!(before, b'O' | b'o');
            if byte != b'%' && !named {
                return None;
            }
            let beginning = match named {
                true => format!("O{}", char::from(byte)),
                false => String::new(),
            };
            self.text = Some(beginning);
            return Some(TextEvent::Begun);
        };
        match byte {
            b'%' if text.trim().is_empty() => {}
            b'%' => {
                let text = self
                    .text
                    .take()
                    .map_or_else(String::new, |text| ended(&text));
                self.before = 0;
                return Some(TextEvent::Whole(text));
            }
            b'\n' if before == b'\r' => {}
            // LF CR, LF CR CR.
            b'\r' if before == b'\n' => self.before = b'\n',
            b'\n' | b'\r' => text.push('\n'),
            b'\t' | b' '..=b'~' => text.push(char::from(byte)),
            _ => return Some(self.broken()),
        }
        if text_is_too_long(self.text.as_ref()) {
            return Some(self.broken());
        }
        None
    }
}

fn text_is_too_long(text: Option<&String>) -> bool {
    text.is_some_and(|text| text.len() > LONGEST)
}

/// A text without the line end after its `%` and with one at its own end. What stands
/// beside that `%` is a leader, unless it is the number itself.
fn ended(text: &str) -> String {
    let leader = !text.starts_with(['\n', 'O', 'o', ':']);
    let percent = if leader { "%" } else { "" };
    let text = text.trim_start_matches('\n').trim_end();
    format!("{percent}{text}\n")
}

/// The number of a program: its first word, after a leader.
pub fn program_number(text: &str) -> Option<u16> {
    let mut lines = text.lines().map(str::trim);
    let first = lines.find(|line| !line.is_empty() && !line.starts_with('%'))?;
    let digits = first.strip_prefix(['O', 'o', ':'])?;
    let end = digits.find(|next: char| !next.is_ascii_digit());
    let digits = &digits[..end.unwrap_or(digits.len())];
    digits.parse().ok().filter(|number| *number <= 9999)
}

/// The programs of a text: each begins with the line of its O number.
pub fn programs(text: &str) -> Vec<&str> {
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

/// Sends a text at the speed of the line, and rests when it is asked to.
#[derive(Clone, Debug)]
pub struct TextWriter {
    wire: WireTime,
    bytes: Vec<u8>,
    given: usize,
    stopped: bool,
}

impl TextWriter {
    /// A text for a line of so many bits a second; a `%` is put before and after it.
    ///
    /// # Errors
    /// A character that is none of ASCII, with its line.
    pub fn new(text: &str, end: LineEnd, baud: u32) -> Result<Self, NotText> {
        let mut bytes = b"%".to_vec();
        bytes.extend(end.bytes());
        let inner = text.trim_end().trim_end_matches('%').trim_end();
        let mut within = false;
        for (at, line) in inner.lines().enumerate() {
            let line = line.trim_end_matches('\r');
            // The one of the text itself.
            if !within && matches!(line.trim(), "" | "%") {
                continue;
            }
            within = true;
            let other = line.chars().find(|c| !matches!(c, '\t' | ' '..='~'));
            if let Some(character) = other {
                return Err(NotText {
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
            given: 0,
            stopped: false,
        })
    }

    /// Bytes of it, all in all.
    pub fn length(&self) -> usize {
        self.bytes.len()
    }

    /// Bytes that the port has taken.
    pub const fn given(&self) -> usize {
        self.given
    }

    /// Bytes have come: DC3 stops, DC1 goes on.
    pub fn hear(&mut self, bytes: &[u8]) {
        for byte in bytes {
            match byte & 0x7F {
                STOP => self.stopped = true,
                GO_ON => self.stopped = false,
                _ => {}
            }
        }
    }

    /// Bytes for the port; [`Self::sent`] says how many it has taken.
    pub fn due(&self, now: HostTime) -> &[u8] {
        let rest = &self.bytes[self.given..];
        if self.stopped {
            return &[];
        }
        &rest[..rest.len().min(self.wire.room(now))]
    }

    /// The port has taken so many.
    pub fn sent(&mut self, count: usize, now: HostTime) {
        self.given += count;
        self.wire.give(count, now);
    }

    /// The last bit has left.
    pub fn is_over(&self, now: HostTime) -> bool {
        self.given == self.bytes.len() && self.wire.free_at() <= now
    }
}

#[cfg(test)]
#[path = "text_tests.rs"]
mod tests;
