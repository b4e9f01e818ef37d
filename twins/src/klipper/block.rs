//! Encodes and parses message blocks: `len seq content crc crc 7E`.

/// Least length of a message block, bytes.
const MIN_BLOCK_BYTES: usize = 5;
const MAX_BLOCK_BYTES: usize = 64;
const SYNC: u8 = 0x7E;

/// What the bytes at the start of the receive buffer are.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum BufferFront {
    /// The start of the buffer is not a whole block yet.
    Incomplete,
    /// This number of bytes at the start must be dropped without a reply.
    Skip(usize),
    /// The block is invalid. The bytes up to the next 7E must be dropped.
    Invalid,
    /// The start of the buffer is a valid block with this length, bytes, and this sequence number.
    Block(usize, u8),
}

pub(super) fn compute_crc(bytes: &[u8]) -> u16 {
    let mut crc = 0xFFFF_u16;
    for &byte in bytes {
        let mut low = byte ^ (crc & 0xFF) as u8;
        low ^= (low & 0x0F) << 4;
        let low = u16::from(low);
        crc = ((low << 8) | (crc >> 8)) ^ (low >> 4) ^ (low << 3);
    }
    crc
}

pub(super) fn parse_front(buffer: &[u8]) -> BufferFront {
    let Some(&first) = buffer.first() else {
        return BufferFront::Incomplete;
    };
    if first == SYNC {
        return BufferFront::Skip(1);
    }
    let length = usize::from(first);
    if !(MIN_BLOCK_BYTES..=MAX_BLOCK_BYTES).contains(&length) {
        return BufferFront::Invalid;
    }
    let Some(&sequence) = buffer.get(1) else {
        return BufferFront::Incomplete;
    };
    if sequence >> 4 != 1 {
        return BufferFront::Invalid;
    }
    let Some(block) = buffer.get(..length) else {
        return BufferFront::Incomplete;
    };
    let received_crc = u16::from_be_bytes([block[length - 3], block[length - 2]]);
    if block[length - 1] != SYNC || received_crc != compute_crc(&block[..length - 3]) {
        return BufferFront::Invalid;
    }
    BufferFront::Block(length, sequence & 0x0F)
}

/// Encodes `content` as a block with a sequence number.
pub fn encode_block(sequence: u8, content: &[u8]) -> Vec<u8> {
    let mut block = vec![
        (content.len() + MIN_BLOCK_BYTES) as u8,
        0x10 | sequence & 0x0F,
    ];
    block.extend_from_slice(content);
    let crc = compute_crc(&block);
    block.extend_from_slice(&[(crc >> 8) as u8, crc as u8, SYNC]);
    block
}

/// Appends an integer of up to 32 bits in Klipper's variable-length encoding (VLQ).
pub(super) fn encode_vlq(out: &mut Vec<u8>, value: i64) {
    if !(-0x0400_0000..0x0C00_0000).contains(&value) {
        out.push((value >> 28 & 0x7F) as u8 | 0x80);
    }
    if !(-0x8_0000..0x18_0000).contains(&value) {
        out.push((value >> 21 & 0x7F) as u8 | 0x80);
    }
    if !(-0x1000..0x3000).contains(&value) {
        out.push((value >> 14 & 0x7F) as u8 | 0x80);
    }
    if !(-0x20..0x60).contains(&value) {
        out.push((value >> 7 & 0x7F) as u8 | 0x80);
    }
    out.push((value & 0x7F) as u8);
}

/// Decodes a variable-length integer (VLQ) and removes it from `content`; `None` if it is
/// incomplete.
pub(super) fn decode_vlq(content: &mut &[u8]) -> Option<u32> {
    let mut value = 0_u32;
    for index in 0..5 {
        let (&byte, rest) = content.split_first()?;
        *content = rest;
        value = value << 7 | u32::from(byte & 0x7F);
        if index == 0 && byte & 0x60 == 0x60 {
            value |= 0xFFFF_FFE0;
        }
        if byte & 0x80 == 0 {
            return Some(value);
        }
    }
    None
}
