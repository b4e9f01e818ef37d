//! Frames out of a stream of bytes, some of which are damaged.

use super::{BLOCK, Frame, HEAD, START, TAIL, crc};

/// What is next in the stream.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Piece {
    /// A frame.
    Frame(Frame),
    /// Something that is none.
    Damaged,
}

/// Collects bytes and finds the frames among them, also behind damage: where a checksum is
/// wrong, the next frame may have begun inside.
#[derive(Clone, Debug, Default)]
pub(crate) struct Reader {
    bytes: Vec<u8>,
    /// Something was thrown away since the last frame.
    damaged: bool,
    /// Bytes thrown away so far.
    noise: u64,
}

impl Reader {
    pub(crate) fn give(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
    }

    /// The next frame; damage is told when no frame follows it so far.
    pub(crate) fn next(&mut self) -> Option<Piece> {
        let mut at = 0;
        let found = loop {
            let rest = &self.bytes[at..];
            match first(rest) {
                First::Frame(frame, length) => {
                    at += length;
                    self.damaged = false;
                    break Some(Piece::Frame(frame));
                }
                First::Unfinished => break None,
                First::Nothing => {
                    at += 1;
                    self.damaged = true;
                    self.noise += 1;
                }
            }
        };
        self.bytes.drain(..at);
        if found.is_none() && core::mem::take(&mut self.damaged) {
            return Some(Piece::Damaged);
        }
        found
    }

    /// Whether a frame has begun and not ended.
    pub(crate) const fn is_within(&self) -> bool {
        !self.bytes.is_empty()
    }

    /// What has begun will not end: look for another beginning inside.
    pub(crate) fn give_up(&mut self) {
        if !self.bytes.is_empty() {
            self.bytes.remove(0);
            self.damaged = true;
            self.noise += 1;
        }
    }

    /// Bytes that were part of no frame, so far.
    pub(crate) const fn noise(&self) -> u64 {
        self.noise
    }
}

/// What a stream begins with.
enum First {
    Frame(Frame, usize),
    /// Perhaps a frame, when more has come.
    Unfinished,
    /// No frame begins here.
    Nothing,
}

fn first(bytes: &[u8]) -> First {
    match bytes.first() {
        None => return First::Unfinished,
        Some(&START) => {}
        Some(_) => return First::Nothing,
    }
    let Some(head) = bytes.first_chunk::<HEAD>() else {
        return First::Unfinished;
    };
    let length = usize::from(u16::from_le_bytes([head[3], head[4]]));
    if length > BLOCK {
        return First::Nothing;
    }
    let total = HEAD + length + TAIL;
    let Some(frame) = bytes.get(..total) else {
        return First::Unfinished;
    };
    let (body, sum) = frame.split_at(total - TAIL);
    if crc(&body[1..]).to_le_bytes() != sum {
        return First::Nothing;
    }
    First::Frame(Frame::decode(head[1], head[2], &body[HEAD..]), total)
}
