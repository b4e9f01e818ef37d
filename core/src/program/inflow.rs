//! Buffers a program that arrives while it runs (DNC operation).
//!
//! ```text
//!   bytes ──► partial line ──► whole lines ──► window, read block by block ──► dropped
//! ```
//!
//! The buffer is bounded, whatever the length of the program. It requests no more
//! than the free size from the partner, and drops the lines that were read.

use serde::{Deserialize, Serialize};

use super::head::Head;
use super::text::Program;

/// Size of the buffer in characters. It always has enough free size for the blocks of the
/// look-ahead.
const CAPACITY: usize = 16_384;
/// Greatest length of a line in characters; a longer one is refused.
const LONGEST_LINE: usize = 500;
/// Number of blocks that the window has after the current one, if they have arrived.
const AHEAD: u32 = 17;
/// Number of lines kept before the current one, for the display.
const BEHIND: u32 = 8;

/// Device controls of a punched tape, which are not text: NUL, DC1 to DC4, DEL.
const fn is_fill(byte: u8) -> bool {
    matches!(byte, 0 | 0x11..=0x14 | 0x7f)
}

/// The part of the tape that is arriving.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum Tape {
    /// The leader before the program.
    Leader,
    /// The text of the program.
    Text,
    /// After the `%`, or after the last character of the partner: further bytes are ignored.
    #[serde(rename = "Over")]
    Over,
}

/// A line that is too long for the buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LineTooLong {
    /// Line number, from 1.
    pub line: u32,
    /// Greatest length of a line, characters.
    pub most: usize,
}

/// The part of an arriving program that is still needed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Inflow {
    window: Program,
    /// Whole lines after those of the window, and the line number of the first.
    arrived: String,
    #[serde(rename = "behind")]
    behind: u32,
    /// The line that is arriving, and its number.
    #[serde(rename = "coming")]
    coming: Vec<u8>,
    line: u32,
    /// The last character was a carriage return.
    #[serde(rename = "returned")]
    returned: bool,
    number: Option<u16>,
    tape: Tape,
}

impl Default for Inflow {
    fn default() -> Self {
        Self {
            window: Program::new(""),
            arrived: String::new(),
            behind: 1,
            coming: Vec::new(),
            line: 1,
            returned: false,
            number: None,
            tape: Tape::Leader,
        }
    }
}

impl Inflow {
    /// The text that can be read. Its lines have the numbers of the whole program.
    pub const fn window(&self) -> &Program {
        &self.window
    }

    /// The program number; `None` until it has arrived.
    pub const fn number(&self) -> Option<u16> {
        self.number
    }

    /// Number of characters that the buffer accepts now.
    pub fn room(&self) -> usize {
        if self.tape == Tape::Over {
            return 0;
        }
        let kept = self.window.text().len() + self.arrived.len() + self.coming.len();
        CAPACITY.saturating_sub(kept)
    }

    /// Whether further blocks may follow the last one of the window.
    pub fn goes_on(&self) -> bool {
        self.tape != Tape::Over || !self.arrived.is_empty()
    }

    /// Whether waiting for a block after the last one of the window can succeed. It cannot
    /// when the buffer is full of lines without a block.
    pub(crate) fn may_bring_another(&self) -> bool {
        self.goes_on() && (self.room() > 0 || !self.arrived.is_empty())
    }

    /// Accepts a character from the partner.
    ///
    /// # Errors
    /// The line is too long.
    pub fn take(&mut self, byte: u8) -> Result<(), LineTooLong> {
        let after_return = core::mem::replace(&mut self.returned, byte == b'\r');
        match byte {
            _ if self.tape == Tape::Over || is_fill(byte) => {}
            b'\n' if after_return => {}
            b'\n' | b'\r' => self.end_line(),
            _ if self.coming.len() >= LONGEST_LINE => {
                return Err(LineTooLong {
                    line: self.line,
                    most: LONGEST_LINE,
                });
            }
            _ => self.coming.push(byte),
        }
        Ok(())
    }

    /// Marks the end of the transfer: the last line needs no line end.
    pub fn finish(&mut self) {
        if !self.coming.is_empty() && self.tape != Tape::Over {
            self.end_line();
        }
        self.tape = Tape::Over;
    }

    fn end_line(&mut self) {
        let line = core::mem::take(&mut self.coming);
        let text = plain(line);
        let mut text = text.as_str();
        self.line = self.line.saturating_add(1);
        if let Some(mark) = end_mark(text) {
            let before = &text[..mark];
            if self.tape == Tape::Leader && before.trim().is_empty() {
                // The start of a tape: the rest of the line is a leader.
                text = "";
            } else {
                text = before;
                self.tape = Tape::Over;
            }
        }
        if self.tape == Tape::Leader && !text.trim().is_empty() {
            self.tape = Tape::Text;
        }
        self.number = self.number.or_else(|| Head::read(text).o);
        self.arrived.push_str(text);
        self.arrived.push('\n');
    }

    /// Moves the window forward before the block with this index is read. Drops lines that
    /// were read and adds lines that have arrived. Returns the number of dropped blocks.
    pub(crate) fn move_on(&mut self, next: u32) -> u32 {
        let ahead = self.window.block_count().saturating_sub(next);
        let read_up = ahead == 0 && self.window.text().len() > CAPACITY / 2;
        if ahead > AHEAD || (self.arrived.is_empty() && !read_up) {
            return 0;
        }
        let reading = match ahead {
            0 => self.behind,
            _ => self.window.block_line(next),
        };
        let first = reading.saturating_sub(BEHIND);
        let gone = self.window.block_from_line(first);
        self.window = self.window.moved_on(first, &self.arrived);
        self.arrived.clear();
        self.behind = self.line;
        gone
    }
}

/// Converts a line to text; invalid UTF-8 becomes `?`.
fn plain(line: Vec<u8>) -> String {
    String::from_utf8(line).unwrap_or_else(|error| {
        let bytes = error.into_bytes();
        let plain = |byte: u8| if byte.is_ascii() { byte.into() } else { '?' };
        bytes.into_iter().map(plain).collect()
    })
}

/// Position of the `%` that ends a tape; a `%` in a comment does not.
fn end_mark(text: &str) -> Option<usize> {
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

    fn feed(inflow: &mut Inflow, text: &str) {
        for byte in text.bytes() {
            inflow.take(byte).unwrap();
        }
    }

    /// Reads blocks with their line numbers, as the interpreter does.
    fn read(inflow: &mut Inflow, next: &mut u32) -> Vec<(u32, String)> {
        let mut blocks = Vec::new();
        loop {
            *next -= inflow.move_on(*next);
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
        let mut inflow = Inflow::default();
        let tape = "\0\0\r\n%\r\n\x11O0012;\r\nG0 X1;\r\n(50 %)\nM30;\n%\nG0 X9;\n";
        feed(&mut inflow, tape);
        let blocks = read(&mut inflow, &mut 0);
        let expected = [(3, "O0012;"), (4, "G0 X1;"), (6, "M30;")];
        assert_eq!(blocks, expected.map(|(line, text)| (line, text.to_owned())));
        assert_eq!(inflow.number(), Some(12));
        assert!(!inflow.goes_on());
        assert_eq!(inflow.room(), 0);
    }

    #[test]
    fn the_last_line_needs_no_end_when_the_partner_has_no_more() {
        let mut inflow = Inflow::default();
        feed(&mut inflow, "M3\rM30");
        assert_eq!(read(&mut inflow, &mut 0), [(1, "M3".to_owned())]);
        assert!(inflow.goes_on());
        inflow.finish();
        assert_eq!(read(&mut inflow, &mut 1), [(2, "M30".to_owned())]);
        assert!(!inflow.goes_on());
    }

    #[test]
    fn an_endless_program_needs_no_more_memory_and_loses_no_block() {
        let mut inflow = Inflow::default();
        let mut next = 0;
        let (mut sent, mut seen) = (0_u32, 0_u32);
        let mut left = String::new();
        while seen < 200_000 {
            while inflow.room() > 0 {
                if left.is_empty() {
                    sent += 1;
                    left = format!("N{} G1 X{sent}. (a comment);\n(nothing)\n", sent % 10_000);
                }
                inflow.take(left.remove(0).try_into().unwrap()).unwrap();
            }
            let kept = inflow.window.text().len() + inflow.arrived.len() + inflow.coming.len();
            assert!(kept <= CAPACITY);
            for (line, text) in read(&mut inflow, &mut next) {
                seen += 1;
                assert_eq!(line, seen * 2 - 1);
                assert!(text.contains(&format!("X{seen}.")), "{line}: {text}");
            }
        }
    }

    #[test]
    fn lines_without_blocks_never_fill_it_up() {
        let mut inflow = Inflow::default();
        let mut next = 0;
        for _ in 0..40_000 {
            for byte in *b"(nothing at all)\n" {
                assert!(inflow.room() > 0);
                inflow.take(byte).unwrap();
            }
            assert!(read(&mut inflow, &mut next).is_empty());
        }
        feed(&mut inflow, "M30;\n");
        assert_eq!(read(&mut inflow, &mut next), [(40_001, "M30;".to_owned())]);
    }

    #[test]
    fn a_line_that_is_too_long_is_refused() {
        let mut inflow = Inflow::default();
        let refused = "X".repeat(LONGEST_LINE + 1);
        let mut taken = refused.bytes().map(|byte| inflow.take(byte));
        assert_eq!(
            taken.find_map(Result::err),
            Some(LineTooLong {
                line: 1,
                most: LONGEST_LINE
            })
        );
    }
}
