//! Finds the beginnings of blocks and lines in a text.

use super::block_head::BlockHead;
use super::block_positions::{BlockPosition, BlockPositions};
use super::lexer::{INVALID_CHARACTER, Lexer};

/// The index of a program text: the positions of its blocks, and the results of the scan.
#[derive(Default)]
pub(super) struct TextIndex {
    pub(super) blocks: BlockPositions,
    /// Positions of the blocks with a program name (O word).
    pub(super) names: Vec<BlockPosition>,
    /// Number of lines in the text.
    pub(super) lines: u32,
    /// The first line with full-width characters outside comments; `None` without any.
    pub(super) full_width: Option<u32>,
    /// The first line with text after the `%` that ends the program; `None` without any.
    pub(super) after_end: Option<u32>,
}

/// The result of scanning one block of the text.
#[derive(Default)]
struct BlockScan {
    words: bool,
    comment: bool,
    end: BlockEnd,
    /// Byte position of the character that ends the block.
    end_at: usize,
}

#[derive(Clone, Copy, Default, PartialEq, Eq)]
enum BlockEnd {
    /// The block ends with `;` or `*`.
    Mark,
    Line,
    Percent,
    #[default]
    Text,
}

impl TextIndex {
    pub(super) fn read(&mut self, text: &str, first_line: u32) {
        let mut lexer = Lexer::new(text);
        let mut line = first_line;
        let mut line_is_open = false;
        let mut ended = None;
        while !lexer.is_at_end() {
            let start = lexer.at;
            let scan = self.scan_block(&mut lexer, line);
            let alone = scan.end == BlockEnd::Mark && !scan.comment;
            if scan.words || alone {
                let position = BlockPosition {
                    byte: start as u32,
                    line,
                };
                self.blocks.push(position);
                if BlockHead::names_program(text.get(start..).unwrap_or("")) {
                    self.names.push(position);
                }
            }
            line_is_open = scan.end != BlockEnd::Line;
            if scan.end == BlockEnd::Line {
                line += 1;
            }
            if scan.end == BlockEnd::Mark && lexer.skip_line_feed() {
                // Most lines have one block.
                line_is_open = false;
                line += 1;
            }
            if scan.end != BlockEnd::Percent {
                continue;
            }
            if self.blocks.len() == 0 {
                // The start of a tape: the rest of the line is a leader.
                let (end, next) = line_end(text, lexer.at);
                line_is_open = next == end;
                line += u32::from(!line_is_open);
                lexer = Lexer::starting_at(text, next);
            } else {
                ended = Some(scan.end_at);
                break;
            }
        }
        if ended.is_some() {
            self.after_end = line_with_text(text, lexer.at, line);
        }
        self.lines = line - first_line + u32::from(line_is_open);
        if ended.is_some() {
            self.lines += lines_after(text, lexer.at);
        }
        self.blocks.finish(ended.unwrap_or(text.len()) as u32);
    }

    /// Scans one block and moves the lexer after its end mark. Records full-width characters.
    #[inline]
    fn scan_block(&mut self, lexer: &mut Lexer<'_>, line: u32) -> BlockScan {
        let mut scan = BlockScan::default();
        let start = *lexer;
        loop {
            scan.words |= lexer.skip_plain();
            let (byte, len) = lexer.peek();
            if len > 1 && byte != INVALID_CHARACTER && byte != b' ' {
                self.full_width.get_or_insert(line);
            }
            match byte {
                b'\n' if len == 0 => return scan,
                b'(' => {
                    scan.comment = true;
                    if lexer.skip_comment().is_err() {
                        // Without its `)` it counts as a block, so that its alarm is raised.
                        scan.words = true;
                    }
                    continue;
                }
                b'\n' => scan.end = BlockEnd::Line,
                b'*' if is_formula(start, lexer.at) => scan.words = true,
                b';' | b'*' => scan.end = BlockEnd::Mark,
                b'%' if !is_end_mark(*lexer) => scan.words = true,
                b'%' => scan.end = BlockEnd::Percent,
                b' ' | b'\t' => {}
                _ => scan.words = true,
            }
            scan.end_at = lexer.at;
            lexer.at += len;
            if scan.end != BlockEnd::Text {
                return scan;
            }
        }
    }
}

/// Whether the `%` at the position ends the text: it begins its line, or only blanks follow
/// it. Within a line, `%` is an invalid character, and its block is refused.
#[cold]
fn is_end_mark(lexer: Lexer<'_>) -> bool {
    let bytes = lexer.moved_to(0).rest();
    let (before, after) = bytes.split_at(lexer.at.min(bytes.len()));
    let blank = |byte: &u8| matches!(byte, b' ' | b'\t' | 0xEF | 0xBB | 0xBF);
    let begins_line = before.iter().rev().find(|byte| !blank(byte));
    let ends = |byte: &u8| byte.is_ascii_whitespace() || *byte == b'%' || *byte < b' ';
    begins_line.is_none_or(|byte| matches!(byte, b'\n' | b'\r')) || after.iter().all(ends)
}

/// The line of the first text after the byte `from`, other than blanks and end marks; `None`
/// without any. `line` is the line of that byte.
fn line_with_text(text: &str, from: usize, line: u32) -> Option<u32> {
    let rest = text.get(from..)?;
    let mark = |letter: char| letter.is_whitespace() || letter.is_control() || letter == '%';
    let at = rest.find(|letter| !mark(letter))?;
    let before = rest.get(..at)?;
    let mut lines = 0;
    let mut here = 0;
    while here < before.len() {
        let (end, next) = line_end(before, here);
        lines += u32::from(next > end);
        here = next.max(here + 1);
    }
    Some(line + lines)
}

/// Whether the `*` at byte `end` means multiplication: the block has `=` or `[` before it, as
/// only formulas of macro B have.
#[cold]
fn is_formula(mut lexer: Lexer<'_>, end: usize) -> bool {
    while lexer.at < end {
        let (byte, len) = lexer.peek();
        match byte {
            b'=' | b'[' => return true,
            b'(' if lexer.skip_comment().is_ok() => {}
            _ => lexer.at += len.max(1),
        }
    }
    false
}

/// Number of lines that begin after the byte position `at`.
fn lines_after(text: &str, mut at: usize) -> u32 {
    let mut lines = 0;
    loop {
        let (end, next) = line_end(text, at);
        if next == end || next >= text.len() {
            return lines;
        }
        lines += 1;
        at = next;
    }
}

/// Byte position of the start of the line that contains the byte `at`.
pub(super) fn line_start(text: &str, at: usize) -> usize {
    let bytes = text.as_bytes();
    let ends_line = |&index: &usize| {
        bytes[index] == b'\n' || bytes[index] == b'\r' && bytes.get(index + 1) != Some(&b'\n')
    };
    (0..at).rev().find(ends_line).map_or(0, |index| index + 1)
}

/// Byte position of the end of the line that begins at `at`, and of the start of the next
/// line.
pub(super) fn line_end(text: &str, at: usize) -> (usize, usize) {
    let bytes = text.as_bytes();
    let rest = bytes.get(at..).unwrap_or(&[]);
    let end = rest
        .iter()
        .position(|byte| matches!(byte, b'\n' | b'\r'))
        .map_or(bytes.len(), |len| at + len);
    let len = match bytes.get(end..) {
        Some([b'\r', b'\n', ..]) => 2,
        Some([_, ..]) => 1,
        _ => 0,
    };
    (end, end + len)
}
