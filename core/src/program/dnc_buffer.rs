//! Buffers a program that arrives while it runs (DNC operation).
//!
//! ```text
//!   bytes ──► partial line ──► whole lines ──► window, read block by block ──► dropped
//! ```
//!
//! The buffer is bounded, whatever the length of the program. It requests no more
//! than the free size from the partner, and drops the lines that were read.

use serde::{Deserialize, Serialize};

use super::block_head::BlockHead;
use super::program_text::Program;

/// Size of the buffer in characters. The blocks of the look-ahead need less, so that further
/// text can always arrive.
const BUFFER_CHARACTERS: usize = 16_384;
/// Greatest length of a line in characters; a longer one is refused.
const MAX_LINE_CHARACTERS: usize = 500;
/// Number of blocks that the window keeps ready after the current one, if they have arrived.
const BLOCKS_AHEAD: u32 = 17;
/// Number of lines kept before the current one, for the display.
const LINES_BEFORE: u32 = 8;

/// Whether a byte is a device control of a punched tape and no text: NUL, DC1 to DC4, DEL.
const fn is_tape_control(byte: u8) -> bool {
    matches!(byte, 0 | 0x11..=0x14 | 0x7f)
}

/// The part of the punched tape whose characters arrive now.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum TapeState {
    /// The leader, before the first line of the program.
    Leader,
    /// The received text is that of the program.
    Text,
    /// After the `%`, or after the last character of the partner: further bytes are ignored.
    #[serde(rename = "Over")]
    Ended,
}

/// A line that is too long for the buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LineTooLong {
    /// Number of the line that is too long, from 1.
    pub line: u32,
    /// Greatest length of a line, characters.
    pub limit: usize,
}

/// The part of an arriving program that has not been read yet, and the last lines read.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DncBuffer {
    window: Program,
    /// Complete lines after the window, and the line number (from 1) of the first of them.
    arrived: String,
    #[serde(rename = "behind")]
    arrived_first_line: u32,
    /// The bytes of the line that is still incomplete, and the number of that line, from 1.
    #[serde(rename = "coming")]
    partial_line: Vec<u8>,
    line: u32,
    /// Whether the last character was a carriage return: a line feed after it is ignored.
    #[serde(rename = "returned")]
    last_was_return: bool,
    number: Option<u16>,
    tape: TapeState,
}

impl Default for DncBuffer {
    fn default() -> Self {
        Self {
            window: Program::new(""),
            arrived: String::new(),
            arrived_first_line: 1,
            partial_line: Vec::new(),
            line: 1,
            last_was_return: false,
            number: None,
            tape: TapeState::Leader,
        }
    }
}

impl DncBuffer {
    /// The text from which blocks are read. Its lines have the numbers of the whole program.
    pub const fn window(&self) -> &Program {
        &self.window
    }

    /// The program number (O word); `None` until it has arrived.
    pub const fn number(&self) -> Option<u16> {
        self.number
    }

    /// Number of characters that the buffer accepts now; 0 after the end of the program.
    pub fn free_characters(&self) -> usize {
        if self.tape == TapeState::Ended {
            return 0;
        }
        let kept = self.window.text().len() + self.arrived.len() + self.partial_line.len();
        BUFFER_CHARACTERS.saturating_sub(kept)
    }

    /// Whether blocks after the last one of the window have arrived or may still arrive.
    pub fn has_more(&self) -> bool {
        self.tape != TapeState::Ended || !self.arrived.is_empty()
    }

    /// Whether it makes sense to wait for a block after the last one of the window. `false` if
    /// the program has ended, or if lines without a block fill the buffer.
    pub(crate) fn can_bring_block(&self) -> bool {
        self.has_more() && (self.free_characters() > 0 || !self.arrived.is_empty())
    }

    /// Accepts a character from the sender of the program.
    ///
    /// # Errors
    /// [`LineTooLong`] if the line already has 500 characters.
    pub fn receive_byte(&mut self, byte: u8) -> Result<(), LineTooLong> {
        let after_return = core::mem::replace(&mut self.last_was_return, byte == b'\r');
        match byte {
            _ if self.tape == TapeState::Ended || is_tape_control(byte) => {}
            b'\n' if after_return => {}
            b'\n' | b'\r' => self.end_line(),
            _ if self.partial_line.len() >= MAX_LINE_CHARACTERS => {
                return Err(LineTooLong {
                    line: self.line,
                    limit: MAX_LINE_CHARACTERS,
                });
            }
            _ => self.partial_line.push(byte),
        }
        Ok(())
    }

    /// Marks the end of the transfer. A last line without a line end is complete.
    pub fn finish(&mut self) {
        if !self.partial_line.is_empty() && self.tape != TapeState::Ended {
            self.end_line();
        }
        self.tape = TapeState::Ended;
    }

    fn end_line(&mut self) {
        let line = core::mem::take(&mut self.partial_line);
        let text = text_from_bytes(line);
        let mut text = text.as_str();
        self.line = self.line.saturating_add(1);
        if let Some(mark) = end_mark_position(text) {
            let before = &text[..mark];
            if self.tape == TapeState::Leader && before.trim().is_empty() {
                // The start of a tape: the rest of the line is a leader.
                text = "";
            } else {
                text = before;
                self.tape = TapeState::Ended;
            }
        }
        if self.tape == TapeState::Leader && !text.trim().is_empty() {
            self.tape = TapeState::Text;
        }
        self.number = self.number.or_else(|| BlockHead::read(text).o);
        self.arrived.push_str(text);
        self.arrived.push('\n');
    }

    /// Moves the window forward before the block with the index `next` (from 0) is read: drops
    /// lines that were read and adds lines that have arrived. Returns the number of blocks
    /// dropped from the start of the window.
    pub(crate) fn advance_window(&mut self, next: u32) -> u32 {
        let ahead = self.window.block_count().saturating_sub(next);
        let read_up = ahead == 0 && self.window.text().len() > BUFFER_CHARACTERS / 2;
        if ahead > BLOCKS_AHEAD || (self.arrived.is_empty() && !read_up) {
            return 0;
        }
        let reading = match ahead {
            0 => self.arrived_first_line,
            _ => self.window.block_line(next),
        };
        let first = reading.saturating_sub(LINES_BEFORE);
        let gone = self.window.block_from_line(first);
        self.window = self.window.join_from_line(first, &self.arrived);
        self.arrived.clear();
        self.arrived_first_line = self.line;
        gone
    }
}

/// Converts a line to text; if it is not valid UTF-8, each non-ASCII byte becomes `?`.
fn text_from_bytes(line: Vec<u8>) -> String {
    String::from_utf8(line).unwrap_or_else(|error| {
        let bytes = error.into_bytes();
        let plain = |byte: u8| if byte.is_ascii() { byte.into() } else { '?' };
        bytes.into_iter().map(plain).collect()
    })
}

/// Byte position of the `%` that ends a tape; `None` without one. A `%` in a comment does not
/// count.
fn end_mark_position(text: &str) -> Option<usize> {
    let mut comment = false;
    text.char_indices().find_map(|(at, character)| {
        match character {
            '(' => comment = true,
            ')' => comment = false,
            '%' if !comment => return Some(at),
            _ => {}
        }
        None
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn receive_text(inflow: &mut DncBuffer, text: &str) {
        for byte in text.bytes() {
            inflow.receive_byte(byte).unwrap();
        }
    }

    fn read_blocks(inflow: &mut DncBuffer, next: &mut u32) -> Vec<(u32, String)> {
        let mut blocks = Vec::new();
        loop {
            *next -= inflow.advance_window(*next);
            if *next >= inflow.window().block_count() {
                return blocks;
            }
            let text = inflow.window().block(*next);
            let text = text.lines().next().unwrap_or_default();
            blocks.push((inflow.window().block_line(*next), text.to_owned()));
            *next += 1;
        }
    }

    #[test]
    fn a_tape_begins_and_ends_with_its_marks() {
        let mut inflow = DncBuffer::default();
        let tape = "\0\0\r\n%\r\n\x11O0012;\r\nG0 X1;\r\n(50 %)\nM30;\n%\nG0 X9;\n";
        receive_text(&mut inflow, tape);
        let blocks = read_blocks(&mut inflow, &mut 0);
        let expected = [(3, "O0012;"), (4, "G0 X1;"), (6, "M30;")];
        assert_eq!(blocks, expected.map(|(line, text)| (line, text.to_owned())));
        assert_eq!(inflow.number(), Some(12));
        assert!(!inflow.has_more());
        assert_eq!(inflow.free_characters(), 0);
    }

    #[test]
    fn the_last_line_needs_no_end_when_the_partner_has_no_more() {
        let mut inflow = DncBuffer::default();
        receive_text(&mut inflow, "M3\rM30");
        assert_eq!(read_blocks(&mut inflow, &mut 0), [(1, "M3".to_owned())]);
        assert!(inflow.has_more());
        inflow.finish();
        assert_eq!(read_blocks(&mut inflow, &mut 1), [(2, "M30".to_owned())]);
        assert!(!inflow.has_more());
    }

    #[test]
    fn an_endless_program_needs_no_more_memory_and_loses_no_block() {
        let mut inflow = DncBuffer::default();
        let mut next = 0;
        let (mut sent, mut seen) = (0_u32, 0_u32);
        let mut left = String::new();
        while seen < 200_000 {
            while inflow.free_characters() > 0 {
                if left.is_empty() {
                    sent += 1;
                    left = format!("N{} G1 X{sent}. (a comment);\n(nothing)\n", sent % 10_000);
                }
                inflow
                    .receive_byte(left.remove(0).try_into().unwrap())
                    .unwrap();
            }
            let kept =
                inflow.window.text().len() + inflow.arrived.len() + inflow.partial_line.len();
            assert!(kept <= BUFFER_CHARACTERS);
            for (line, text) in read_blocks(&mut inflow, &mut next) {
                seen += 1;
                assert_eq!(line, seen * 2 - 1);
                assert!(text.contains(&format!("X{seen}.")), "{line}: {text}");
            }
        }
    }

    #[test]
    fn lines_without_blocks_never_fill_the_buffer() {
        let mut inflow = DncBuffer::default();
        let mut next = 0;
        for _ in 0..40_000 {
            for byte in *b"(nothing at all)\n" {
                assert!(inflow.free_characters() > 0);
                inflow.receive_byte(byte).unwrap();
            }
            assert!(read_blocks(&mut inflow, &mut next).is_empty());
        }
        receive_text(&mut inflow, "M30;\n");
        assert_eq!(
            read_blocks(&mut inflow, &mut next),
            [(40_001, "M30;".to_owned())]
        );
    }

    #[test]
    fn a_line_that_is_too_long_is_refused() {
        let mut inflow = DncBuffer::default();
        let refused = "X".repeat(MAX_LINE_CHARACTERS + 1);
        let mut taken = refused.bytes().map(|byte| inflow.receive_byte(byte));
        assert_eq!(
            taken.find_map(Result::err),
            Some(LineTooLong {
                line: 1,
                limit: MAX_LINE_CHARACTERS
            })
        );
    }
}
