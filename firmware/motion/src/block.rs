//! Encodes and decodes blocks, `len seq content crc crc 7E`, and the VLQ integers in them, as
//! Klipper does.

use crate::storage::Vec;

/// Length of a block without content, bytes.
const MIN_LENGTH: usize = 5;
/// Greatest length of a block, bytes.
const MAX_LENGTH: usize = 64;
/// Greatest length of the content of a block, bytes.
pub const MAX_CONTENT: usize = MAX_LENGTH - MIN_LENGTH;
/// The last byte of each block.
const SYNC: u8 = 0x7E;
/// The four high bits of the sequence byte.
const SEQUENCE: u8 = 0x10;

/// The bytes of a block.
pub type BlockBytes = Vec<u8, MAX_LENGTH>;
/// The content of a block.
pub type Content = Vec<u8, MAX_CONTENT>;

/// Computes the CRC-16 of the bytes that precede the CRC in a block.
pub fn crc16(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0xFFFF, |crc: u16, byte| {
        let mut byte = byte ^ crc.to_le_bytes()[0];
        byte ^= byte << 4;
        let wide = u16::from(byte);
        ((wide << 8) | (crc >> 8)) ^ (wide >> 4) ^ (wide << 3)
    })
}

/// Encodes a block from the low four bits of a sequence number and at most [`MAX_CONTENT`]
/// bytes.
pub fn encode_block(sequence: u8, content: &[u8]) -> BlockBytes {
    let content = &content[..content.len().min(MAX_CONTENT)];
    let mut bytes = BlockBytes::new();
    let mut put = |part: &[u8]| bytes.extend(part.iter().copied());
    put(&[
        (content.len() + MIN_LENGTH) as u8,
        SEQUENCE | (sequence & 0x0F),
    ]);
    put(content);
    let crc = crc16(&bytes).to_be_bytes();
    bytes.extend([crc[0], crc[1], SYNC]);
    bytes
}

/// Appends an integer as a VLQ: seven bits per byte, the most significant first.
pub fn encode_vlq(out: &mut Content, value: i64) {
    for bytes in (2_u32..=5).rev() {
        let least = -(1_i64 << (7 * bytes - 9));
        if value < least || value >= -3 * least {
            out.extend([0x80 | (value >> (7 * (bytes - 1)) & 0x7F) as u8]);
        }
    }
    out.extend([(value & 0x7F) as u8]);
}

/// Removes a VLQ from the front of `bytes`; `None` if it is incomplete or too long.
pub fn decode_vlq(bytes: &mut &[u8]) -> Option<u32> {
    let (&first, mut rest) = bytes.split_first()?;
    let mut value = u32::from(first & 0x7F);
    if first & 0x60 == 0x60 {
        value |= !0x1F;
    }
    let mut last = first;
    for _ in 0..4 {
        if last & 0x80 == 0 {
            break;
        }
        let (&next, remaining) = rest.split_first()?;
        value = value << 7 | u32::from(next & 0x7F);
        (last, rest) = (next, remaining);
    }
    if last & 0x80 != 0 {
        return None;
    }
    *bytes = rest;
    Some(value)
}

/// What the reader has found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Received {
    /// A complete block in sequence.
    Content(Content),
    /// A damaged block, or one with another sequence number: the host must repeat.
    Rejected,
}

/// Extracts the blocks from a stream of bytes and counts their sequence numbers.
#[derive(Clone, Debug, Default)]
pub struct BlockReader {
    bytes: BlockBytes,
    is_out_of_step: bool,
    /// The sequence number of the next block, 0 to 15.
    pub expected: u8,
}

impl BlockReader {
    /// Takes one byte; returns what it completes.
    pub fn push(&mut self, byte: u8) -> Option<Received> {
        if self.is_out_of_step {
            self.is_out_of_step = byte != SYNC;
            return (!self.is_out_of_step).then_some(Received::Rejected);
        }
        if self.bytes.is_empty() && byte == SYNC {
            return None;
        }
        self.bytes.extend([byte]);
        let length = usize::from(self.bytes[0]);
        let sequence = self.bytes.get(1).copied().unwrap_or(SEQUENCE);
        if !(MIN_LENGTH..=MAX_LENGTH).contains(&length) || sequence & 0xF0 != SEQUENCE {
            return self.reject(byte);
        }
        if self.bytes.len() < length {
            return None;
        }
        let (body, tail) = self.bytes.split_at(length - 3);
        if tail[2] != SYNC || tail[..2] != crc16(body).to_be_bytes() {
            return self.reject(byte);
        }
        let is_expected = sequence & 0x0F == self.expected;
        let content = Content::from_slice(&body[2..]).unwrap_or_default();
        self.bytes.clear();
        if !is_expected {
            return Some(Received::Rejected);
        }
        self.expected = (self.expected + 1) & 0x0F;
        Some(Received::Content(content))
    }

    fn reject(&mut self, byte: u8) -> Option<Received> {
        self.bytes.clear();
        self.is_out_of_step = byte != SYNC;
        (!self.is_out_of_step).then_some(Received::Rejected)
    }
}
