//! Encodes and decodes blocks, `len seq content crc crc 7E`, and the VLQ integers in them.

/// Length of a message block without content, bytes.
pub(super) const LEAST: usize = 5;
/// Greatest length of a message block, bytes.
const MOST: usize = 64;
/// Greatest length of the content of a message block, bytes.
pub(super) const CONTENT: usize = MOST - LEAST;
/// Value of the last byte of each message block.
const SYNC: u8 = 0x7E;
/// Value of the four high bits in the sequence byte of each message block.
const SEQUENCE: u8 = 0x10;
/// Number of different sequence numbers on the wire.
pub(super) const NUMBERS: u64 = 16;
/// Bytes that end any incomplete block: a board that has received them expects a new block.
pub(super) const ENDS: [u8; MOST] = [SYNC; MOST];

/// Computes the CRC-16 of the bytes that precede the CRC in a block.
fn crc16(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0xFFFF, |crc: u16, byte| {
        let mut byte = byte ^ crc.to_le_bytes()[0];
        byte ^= byte << 4;
        let wide = u16::from(byte);
        ((wide << 8) | (crc >> 8)) ^ (wide >> 4) ^ (wide << 3)
    })
}

/// Encodes a block from the low four bits of a sequence number and the content.
pub(super) fn encode_block(sequence: u64, content: &[u8]) -> Vec<u8> {
    let length = u8::try_from(content.len() + LEAST).unwrap_or(u8::MAX);
    let mut bytes = Vec::with_capacity(content.len() + LEAST);
    bytes.push(length);
    bytes.push(SEQUENCE | (sequence & 0x0F) as u8);
    bytes.extend_from_slice(content);
    bytes.extend_from_slice(&crc16(&bytes).to_be_bytes());
    bytes.push(SYNC);
    bytes
}

/// Appends an integer as a variable-length quantity (VLQ): seven bits per byte, the most
/// significant first.
pub(super) fn encode_vlq(out: &mut Vec<u8>, value: i64) {
    for bytes in (2_u32..=5).rev() {
        let least = -(1_i64 << (7 * bytes - 9));
        if value < least || value >= -3 * least {
            out.push(0x80 | (value >> (7 * (bytes - 1)) & 0x7F) as u8);
        }
    }
    out.push((value & 0x7F) as u8);
}

/// Removes a VLQ from the front of `bytes` and returns 32 bits, signed or unsigned; `None` if
/// the VLQ is incomplete or too long.
pub(super) fn decode_vlq(bytes: &mut &[u8]) -> Option<u32> {
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

/// A complete and undamaged message block.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Block {
    /// The low four bits of the block's sequence number.
    pub(super) sequence: u8,
    /// The content of the block; empty in an acknowledgement or a NAK.
    pub(super) content: Vec<u8>,
}

/// Extracts the message blocks from a stream of bytes.
#[derive(Clone, Debug, Default)]
pub(super) struct Reader {
    bytes: Vec<u8>,
    out_of_step: bool,
    /// Number of damaged blocks that were received.
    pub(super) garbage: u64,
}

impl Reader {
    /// Discards all bytes that were received but not returned as a block.
    pub(super) fn forget(&mut self) {
        self.bytes.clear();
        self.out_of_step = false;
    }

    pub(super) fn give(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
    }

    /// Removes and returns the next block; `None` without a complete one. Keeps no more than
    /// one incomplete block.
    pub(super) fn next(&mut self) -> Option<Block> {
        loop {
            if self.out_of_step {
                let Some(end) = self.bytes.iter().position(|&byte| byte == SYNC) else {
                    self.bytes.clear();
                    return None;
                };
                self.bytes.drain(..=end);
                self.out_of_step = false;
            }
            let length = usize::from(*self.bytes.first()?);
            if length == usize::from(SYNC) {
                self.bytes.remove(0);
                continue;
            }
            let in_range = (LEAST..=MOST).contains(&length);
            let sequence = self.bytes.get(1).copied().unwrap_or(SEQUENCE);
            if in_range && sequence & 0xF0 == SEQUENCE {
                if self.bytes.len() < length {
                    return None;
                }
                let whole: Vec<u8> = self.bytes[..length].to_vec();
                let (body, tail) = whole.split_at(length - 3);
                if tail[2] == SYNC && tail[..2] == crc16(body).to_be_bytes() {
                    self.bytes.drain(..length);
                    return Some(Block {
                        sequence: sequence & 0x0F,
                        content: body[2..].to_vec(),
                    });
                }
            }
            self.garbage += 1;
            self.out_of_step = true;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn integer(value: i64) -> Vec<u8> {
        let mut out = Vec::new();
        encode_vlq(&mut out, value);
        out
    }

    #[test]
    fn integers_are_encoded_as_in_klipper() {
        let table: [(i64, &[u8]); 9] = [
            (95, &[0x5f]),
            (96, &[0x80, 0x60]),
            (-32, &[0x60]),
            (-33, &[0xff, 0x5f]),
            (12_287, &[0xdf, 0x7f]),
            (12_288, &[0x80, 0xe0, 0x00]),
            (1_572_863, &[0xdf, 0xff, 0x7f]),
            (1_572_864, &[0x80, 0xe0, 0x80, 0x00]),
            (2_147_483_648, &[0x88, 0x80, 0x80, 0x80, 0x00]),
        ];
        for (value, bytes) in table {
            assert_eq!(integer(value), bytes, "{value}");
        }
    }

    #[test]
    fn sizes_change_at_their_boundaries() {
        let table = [
            (-32, 95, 1),
            (-4096, 12_287, 2),
            (-524_288, 1_572_863, 3),
            (-67_108_864, 201_326_591, 4),
            (i64::from(i32::MIN), i64::from(u32::MAX), 5),
        ];
        for (least, most, size) in table {
            for value in [least, most] {
                assert_eq!(integer(value).len(), size, "{value}");
            }
        }
        for window in table.windows(2) {
            assert_eq!(integer(window[0].0 - 1).len(), window[1].2);
            assert_eq!(integer(window[0].1 + 1).len(), window[1].2);
        }
    }

    #[test]
    fn blocks_are_encoded_as_in_klipper() {
        let identify = [integer(1), integer(0), integer(40)].concat();
        assert_eq!(
            encode_block(1, &identify),
            [0x08, 0x11, 0x01, 0x00, 0x28, 0x42, 0x24, 0x7e]
        );
        let queue_step: Vec<u8> = [22, 1, 1600, 100, -3]
            .into_iter()
            .flat_map(integer)
            .collect();
        assert_eq!(
            encode_block(3, &queue_step),
            [
                0x0c, 0x13, 0x16, 0x01, 0x8c, 0x40, 0x80, 0x64, 0x7d, 0x7b, 0xd9, 0x7e
            ]
        );
        assert_eq!(encode_block(0, &[]), [0x05, 0x10, 0x9e, 0x81, 0x7e]);
    }

    #[test]
    fn endless_integers_are_refused() {
        assert_eq!(decode_vlq(&mut &[0x80_u8, 0x80][..]), None);
        assert_eq!(
            decode_vlq(&mut &[0x80_u8, 0x80, 0x80, 0x80, 0x80, 0x00][..]),
            None
        );
        assert_eq!(decode_vlq(&mut &[][..]), None);
    }

    #[test]
    fn the_block_after_a_bad_one_is_found() {
        let mut reader = Reader::default();
        let mut bad = encode_block(1, &[1, 2, 3]);
        bad[3] ^= 0x40;
        reader.give(&[0x7E]);
        reader.give(&bad);
        reader.give(&encode_block(2, &[4]));
        let found = reader.next().map(|block| (block.sequence, block.content));
        assert_eq!(found, Some((2, vec![4])));
        assert_eq!((reader.next(), reader.garbage), (None, 1));
    }

    proptest! {
        #[test]
        fn encoded_integers_are_decoded(value in i64::from(i32::MIN)..=i64::from(u32::MAX)) {
            let bytes = integer(value);
            let mut rest = bytes.as_slice();
            prop_assert_eq!(decode_vlq(&mut rest), Some(value as u32));
            prop_assert!(rest.is_empty());
        }

        #[test]
        fn blocks_survive_any_chunking(
            contents in prop::collection::vec(prop::collection::vec(any::<u8>(), 0..=CONTENT), 1..20),
            piece in 1usize..30,
        ) {
            let stream: Vec<u8> = contents.iter().enumerate()
                .flat_map(|(count, content)| encode_block(count as u64, content)).collect();
            let mut reader = Reader::default();
            let mut found = Vec::new();
            for bytes in stream.chunks(piece) {
                reader.give(bytes);
                while let Some(block) = reader.next() {
                    found.push(block.content);
                }
            }
            prop_assert_eq!(found, contents);
            prop_assert_eq!(reader.garbage, 0);
        }

        #[test]
        fn the_reader_never_keeps_more_than_a_block(bytes in prop::collection::vec(any::<u8>(), 0..2000)) {
            let mut reader = Reader::default();
            for byte in bytes {
                reader.give(&[byte]);
                while reader.next().is_some() {}
                prop_assert!(reader.bytes.len() <= MOST);
            }
        }
    }
}
