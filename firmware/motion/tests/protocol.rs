//! The protocol at the bytes: the same blocks as Klipper's, and a dictionary that names all.

mod support;

use gsk_motion::messages::{COMMANDS, Command, RESPONSES, Response};
use gsk_motion::{BlockBytes, DICTIONARY, Engine, Session, encode_block};
use support::TestPort;

/// A board at the bytes.
#[derive(Default)]
struct ByteBoard {
    session: Session,
    engine: Engine,
    port: TestPort,
}

impl ByteBoard {
    /// Sends bytes; returns the blocks of the board.
    fn send(&mut self, bytes: &[u8]) -> Vec<BlockBytes> {
        let mut blocks = Vec::new();
        for byte in bytes {
            let (engine, port) = (&mut self.engine, &mut self.port);
            let execute = |request| engine.execute(&request, port);
            self.session
                .push(*byte, |block| blocks.push(block), execute);
        }
        while let Some(event) = self.engine.next_event() {
            blocks.push(self.session.encode(&event));
        }
        blocks
    }
}

#[test]
fn blocks_are_those_of_klipper() {
    assert_eq!(
        encode_block(3, &[22, 1, 0x8c, 0x40, 0x80, 0x64, 0x7d])[..],
        [
            0x0c, 0x13, 0x16, 0x01, 0x8c, 0x40, 0x80, 0x64, 0x7d, 0x7b, 0xd9, 0x7e
        ]
    );
    assert_eq!(encode_block(0, &[])[..], [0x05, 0x10, 0x9e, 0x81, 0x7e]);
}

#[test]
fn a_block_is_acknowledged_and_one_out_of_sequence_is_not_executed() {
    let mut board = ByteBoard::default();
    let uptime = [Command::GetUptime as u8 + 1];
    let blocks = board.send(&encode_block(0, &uptime));
    assert_eq!(blocks.len(), 2);
    assert_eq!(blocks[0], encode_block(1, &[]));
    // The same block again, and one too far: only the expected number.
    for sequence in [0, 2] {
        let blocks = board.send(&encode_block(sequence, &uptime));
        assert_eq!(blocks, [encode_block(1, &[])]);
    }
    assert_eq!(board.send(&encode_block(1, &uptime)).len(), 2);
}

#[test]
fn a_damaged_block_is_rejected_once_and_the_next_is_read() {
    let uptime = encode_block(0, &[Command::GetUptime as u8 + 1]);
    for index in 0..uptime.len() {
        for bit in 0..8 {
            let mut board = ByteBoard::default();
            let mut damaged = uptime.clone();
            damaged[index] ^= 1 << bit;
            let mut bytes = damaged.to_vec();
            bytes.extend([0x7E; 64]);
            let blocks = board.send(&bytes);
            let has_answer = blocks.iter().any(|block| block.len() > 5);
            assert!(!has_answer, "byte {index}, bit {bit}");
            assert_eq!(board.send(&uptime).len(), 2, "byte {index}, bit {bit}");
        }
    }
}

#[test]
fn the_dictionary_names_all_messages() {
    let text = miniz_oxide::inflate::decompress_to_vec_zlib(DICTIONARY).unwrap();
    let text = String::from_utf8(text).unwrap();
    let formats = COMMANDS
        .iter()
        .map(|row| row.1)
        .chain(RESPONSES.iter().map(|row| row.1));
    for format in formats {
        assert!(text.contains(&format!("\"{format}\":")), "{format}");
    }
    // The host reads it in pieces.
    let mut board = ByteBoard::default();
    let mut read = Vec::new();
    for sequence in 0_u8.. {
        let offset = read.len();
        let content = [1, 0x80 | (offset >> 7) as u8, (offset & 0x7F) as u8, 40];
        let blocks = board.send(&encode_block(sequence & 0x0F, &content));
        let content = &blocks[0][2..blocks[0].len() - 3];
        let start = if offset < 96 { 2 } else { 3 };
        let length = usize::from(content[start]);
        assert_eq!(content.len(), start + 1 + length);
        if length == 0 {
            break;
        }
        read.extend_from_slice(&content[start + 1..]);
    }
    assert_eq!(read, DICTIONARY);
}

#[test]
fn an_unknown_command_and_a_short_one_shut_down() {
    for content in [&[120][..], &[Command::ResetStepClock as u8 + 1, 1][..]] {
        let mut board = ByteBoard::default();
        let blocks = board.send(&encode_block(0, content));
        let id = COMMANDS.len() + Response::Shutdown as usize;
        assert_eq!(usize::from(blocks[1][2]), id);
    }
}
