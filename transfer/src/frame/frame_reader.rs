//! Finds frames in a stream of bytes that may be damaged.

use super::{BLOCK_BYTES, CRC_BYTES, HEADER_BYTES, START, TransferFrame, compute_crc};

/// A result of [`FrameReader::next`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum ReaderOutput {
    /// A valid frame was received.
    Frame(TransferFrame),
    /// Bytes that are not part of a valid frame were discarded.
    Damaged,
}

/// Buffers received bytes and finds frames. After a wrong checksum the reader searches every
/// following byte for the start of a frame.
#[derive(Clone, Debug, Default)]
pub(crate) struct FrameReader {
    bytes: Vec<u8>,
    /// Whether bytes were discarded since the last frame.
    has_damage: bool,
    /// Number of bytes discarded so far.
    noise: u64,
}

impl FrameReader {
    pub(crate) fn push_bytes(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
    }

    /// Returns the next frame; `None` if more bytes are needed. Damage is reported only if no
    /// frame follows it.
    pub(crate) fn next(&mut self) -> Option<ReaderOutput> {
        let mut at = 0;
        let found = loop {
            let rest = &self.bytes[at..];
            match match_frame(rest) {
                FrameStart::Frame(frame, length) => {
                    at += length;
                    self.has_damage = false;
                    break Some(ReaderOutput::Frame(frame));
                }
                FrameStart::Incomplete => break None,
                FrameStart::NoFrame => {
                    at += 1;
                    self.has_damage = true;
                    self.noise += 1;
                }
            }
        };
        self.bytes.drain(..at);
        if found.is_none() && core::mem::take(&mut self.has_damage) {
            return Some(ReaderOutput::Damaged);
        }
        found
    }

    pub(crate) const fn is_in_frame(&self) -> bool {
        !self.bytes.is_empty()
    }

    /// Discards the first byte of an incomplete frame that has timed out.
    pub(crate) fn skip_byte(&mut self) {
        if !self.bytes.is_empty() {
            self.bytes.remove(0);
            self.has_damage = true;
            self.noise += 1;
        }
    }

    /// Returns the number of bytes discarded so far.
    pub(crate) const fn noise(&self) -> u64 {
        self.noise
    }
}

/// Result of matching the start of the buffer with a frame.
enum FrameStart {
    Frame(TransferFrame, usize),
    /// More bytes are needed to decide whether a frame begins.
    Incomplete,
    NoFrame,
}

fn match_frame(bytes: &[u8]) -> FrameStart {
    match bytes.first() {
        None => return FrameStart::Incomplete,
        Some(&START) => {}
        Some(_) => return FrameStart::NoFrame,
    }
    let Some(head) = bytes.first_chunk::<HEADER_BYTES>() else {
        return FrameStart::Incomplete;
    };
    let length = usize::from(u16::from_le_bytes([head[3], head[4]]));
    if length > BLOCK_BYTES {
        return FrameStart::NoFrame;
    }
    let total = HEADER_BYTES + length + CRC_BYTES;
    let Some(frame) = bytes.get(..total) else {
        return FrameStart::Incomplete;
    };
    let (body, crc_bytes) = frame.split_at(total - CRC_BYTES);
    if compute_crc(&body[1..]).to_le_bytes() != crc_bytes {
        return FrameStart::NoFrame;
    }
    FrameStart::Frame(
        TransferFrame::decode(head[1], head[2], &body[HEADER_BYTES..]),
        total,
    )
}
