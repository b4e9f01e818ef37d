//! A recording: a session as bytes that are only appended.
//!
//! ```text
//! recording = magic, frame*
//! frame     = length u32, check u32, content       (little endian)
//! content   = 0, UTF-8 text                        a text, numbered from 0
//!           | 1, event in MessagePack              texts in it by their numbers
//! ```
//!
//! The check is the CRC-32 of length and content, continued from the frame before: a changed,
//! missing or exchanged frame is noticed. A process that is killed leaves at most an incomplete
//! last frame.

mod exchange_events;
mod frame;
mod long_texts;
mod session;
mod value_reader;

use gsk_messages::{Message, say};
use gsk_panel::emulator::Emulator;
use serde::{Deserialize, Serialize};

use crate::board_exchange::BoardStep;
use crate::machine_part::PartInput;
use crate::moment::RecordedInput;
pub use exchange_events::join_exchange;
use frame::{FrameEncoder, FrameReader};
use long_texts::{TextNumbers, restore_texts};
pub use session::encode_session;
use value_reader::read_value;

/// Version of the format; a reader refuses newer ones.
pub const FORMAT: u32 = 2;

/// First byte of the content of a frame.
const TEXT_CONTENT: u8 = 0;
const EVENT_CONTENT: u8 = 1;

/// One event of a recording.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum RecordingEvent {
    /// The recording starts; always the first event.
    Start {
        /// Version of the format, see [`FORMAT`].
        format: u32,
        /// Version of the program that has recorded.
        program: String,
    },
    /// The whole machine. What follows starts from it.
    State {
        /// State of control, panel and lathe.
        emulator: Box<Emulator>,
        /// Inputs that give the part its job. The part itself begins uncut.
        part: Vec<PartInput>,
    },
    /// An input of the machine or the part.
    Input(Box<RecordedInput>),
    /// The machine has reached this tick without further inputs.
    Reached(u64),
    /// Hash of the machine's state at a tick, after the events before this one.
    Hash {
        /// Tick of the machine since power-on.
        tick: u64,
        /// [`crate::moment::state_hash`] at this tick.
        hash: u64,
    },
    /// A pulse board was connected at this tick, and from here on its exchange is not recorded.
    BoardLinked(u64),
    /// A step of the exchange with a pulse board, at the tick that the machine has reached.
    Board(Box<BoardStep>),
    /// The program has ended the recording.
    End(u64),
}

/// Encodes the events of one recording.
#[derive(Debug, Default)]
pub struct RecordingEncoder {
    frames: FrameEncoder,
    texts: TextNumbers,
}

impl RecordingEncoder {
    /// Starts a recording: `out` receives its first bytes.
    pub fn new(out: &mut Vec<u8>) -> Self {
        out.extend_from_slice(frame::MAGIC);
        Self::default()
    }

    /// Appends the frames of an event to `out`. Long texts are stored only once in a
    /// recording.
    ///
    /// # Errors
    /// The event cannot be represented in MessagePack; then `out` is unchanged.
    pub fn encode(
        &mut self,
        event: &RecordingEvent,
        out: &mut Vec<u8>,
    ) -> Result<(), rmp_serde::encode::Error> {
        let packed = rmp_serde::to_vec_named(event)?;
        let (packed, new_texts) = self.texts.number_texts(&packed);
        for text in new_texts {
            self.frames.append(TEXT_CONTENT, text.as_bytes(), out);
        }
        self.frames.append(EVENT_CONTENT, &packed, out);
        Ok(())
    }
}

/// The reason for which the rest of a recording cannot be read. Offsets count bytes from the start
/// of the file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub enum RecordingError {
    /// The file does not begin as a recording.
    NotRecording,
    /// The recording has a newer format.
    NewerFormat(u32),
    /// The last frame is incomplete: the program was killed while it wrote, or the length of
    /// the frame is damaged.
    Incomplete(usize),
    /// The check of a frame does not match its content.
    CheckFailed(usize),
    /// The content of a frame is invalid.
    InvalidContent(usize),
    /// An event is out of order: before the start, before a state, with an earlier tick, or with
    /// one far ahead.
    OutOfOrder(usize),
}

impl RecordingError {
    /// Returns the message: the position and the violated rule.
    pub fn message(&self) -> Message {
        match self {
            Self::NotRecording => say::recording_not_one(),
            Self::NewerFormat(format) => say::recording_newer_format(format, FORMAT),
            Self::Incomplete(offset) => say::recording_incomplete(offset),
            Self::CheckFailed(offset) => say::recording_check_failed(offset),
            Self::InvalidContent(offset) => say::recording_invalid_content(offset),
            Self::OutOfOrder(offset) => say::recording_out_of_order(offset),
        }
    }
}

/// Reads the events of a recording one after the other.
#[derive(Debug)]
pub struct RecordingReader<'a> {
    frames: FrameReader<'a>,
    texts: Vec<&'a str>,
    has_started: bool,
}

impl<'a> RecordingReader<'a> {
    /// Starts to read a recording.
    ///
    /// # Errors
    /// The bytes are no recording.
    pub fn new(bytes: &'a [u8]) -> Result<Self, RecordingError> {
        Ok(Self {
            frames: FrameReader::new(bytes).ok_or(RecordingError::NotRecording)?,
            texts: Vec::new(),
            has_started: false,
        })
    }

    /// Returns the offset of the next frame.
    pub const fn offset(&self) -> usize {
        self.frames.offset()
    }

    /// Returns the next event; `None` at the end of the bytes.
    ///
    /// # Errors
    /// The next frame cannot be read. No later call returns an event.
    pub fn next_event(&mut self) -> Result<Option<RecordingEvent>, RecordingError> {
        loop {
            let offset = self.frames.offset();
            let Some(content) = self.frames.next_frame()? else {
                return Ok(None);
            };
            let invalid = || RecordingError::InvalidContent(offset);
            let (kind, content) = content.split_first().ok_or_else(invalid)?;
            match *kind {
                TEXT_CONTENT => {
                    let text = core::str::from_utf8(content).map_err(|_| invalid())?;
                    self.texts.push(text);
                }
                EVENT_CONTENT => {
                    let packed = restore_texts(content, &self.texts).ok_or_else(invalid)?;
                    let event = read_value(&packed).map_err(|_| invalid())?;
                    self.check_start(&event, offset)?;
                    return Ok(Some(event));
                }
                _ => return Err(invalid()),
            }
        }
    }

    fn check_start(&mut self, event: &RecordingEvent, offset: usize) -> Result<(), RecordingError> {
        let starts = match event {
            RecordingEvent::Start { format, .. } if *format > FORMAT => {
                return Err(RecordingError::NewerFormat(*format));
            }
            RecordingEvent::Start { .. } => true,
            _ => false,
        };
        if starts == self.has_started {
            return Err(RecordingError::OutOfOrder(offset));
        }
        self.has_started = true;
        Ok(())
    }
}
