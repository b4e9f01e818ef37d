//! A program: its text and the index of its blocks.

mod names;

pub use names::split_programs;

use std::sync::{Arc, OnceLock, Weak};

use gsk_messages::say;
use serde::{Deserialize, Serialize};

use super::block::ProgramBlock;
use super::block_head::BlockHead;
use super::block_positions::{BlockPosition, BlockPositions};
use super::code_call::{self, CodeCall};
use super::macro_b::uses_macro_b;
use super::parse::read_block;
use super::plain_words::PlainWords;
use super::syntax::{BlockError, Syntax};
use super::text_index::{TextIndex, line_end, line_start};
use crate::alarm::number;
use names::{NAME_SEARCH_BLOCKS, percent_name};

/// A program text with the index of its blocks; cheap to clone.
///
/// The index needs a byte and a half per block if each line has one block, otherwise eight
/// bytes.
#[derive(Clone, Serialize, Deserialize)]
#[serde(into = "Plain", from = "Plain")]
pub struct Program {
    shared: Arc<SharedText>,
}

/// Identifies the text of a program without keeping it in memory.
#[derive(Clone, Default)]
pub(super) struct TextIdentity(Weak<SharedText>);

struct SharedText {
    text: String,
    blocks: BlockPositions,
    /// Positions of the blocks with a program name (O word).
    names: Vec<BlockPosition>,
    first_line: u32,
    lines: u32,
    characters: u32,
    number: Option<u16>,
    full_width: Option<u32>,
    /// The first line, of the file, with text after the `%` that ends the program; `None`
    /// without.
    after_end: Option<u32>,
    /// Whether the program uses macro B; unset until it is first queried.
    macro_b: OnceLock<bool>,
}

#[derive(Serialize, Deserialize)]
#[serde(rename = "Program")]
struct Plain {
    text: String,
    #[serde(default = "one", skip_serializing_if = "is_one")]
    first_line: u32,
}

const fn one() -> u32 {
    1
}

#[expect(
    clippy::trivially_copy_pass_by_ref,
    reason = "the form that serde asks for"
)]
const fn is_one(line: &u32) -> bool {
    *line == 1
}

/// Longer texts are truncated to this many bytes, so that positions fit 32 bits. Files are
/// limited to 256 MB.
const MAX_BYTES: usize = u32::MAX as usize - 16;

impl Program {
    /// Creates a program from a text and finds its blocks. A `String` is not copied.
    pub fn new(text: impl Into<String>) -> Self {
        Self::from_line(text.into(), 1)
    }

    /// Creates a program whose text begins at the line `first_line` of its file, from 1.
    fn from_line(mut text: String, first_line: u32) -> Self {
        if text.len() > MAX_BYTES {
            text.truncate(text.floor_char_boundary(MAX_BYTES));
        }
        let mut index = TextIndex::default();
        index.read(&text, first_line);
        let characters = text.chars().count();
        let mut shared = SharedText {
            blocks: index.blocks,
            names: index.names,
            first_line,
            lines: index.lines,
            characters: characters as u32,
            number: None,
            full_width: index.full_width,
            after_end: index.after_end,
            macro_b: OnceLock::new(),
            text,
        };
        shared.number = (0..shared.blocks.len().min(NAME_SEARCH_BLOCKS))
            .find_map(|block| BlockHead::read(shared.block(block)).o)
            .or_else(|| percent_name(&shared.text).map(|(number, _)| number));
        Self {
            shared: Arc::new(shared),
        }
    }

    /// An identity for comparison with [`Self::has_identity`]; it does not keep the text
    /// alive.
    pub(super) fn identity(&self) -> TextIdentity {
        TextIdentity(Arc::downgrade(&self.shared))
    }

    /// Whether this program shares the text from which `identity` was taken.
    pub(super) fn has_identity(&self, identity: &TextIdentity) -> bool {
        core::ptr::eq(Arc::as_ptr(&self.shared), identity.0.as_ptr())
    }

    /// Number of clones of the program that share the text.
    #[cfg(test)]
    pub(super) fn text_references(&self) -> usize {
        Arc::strong_count(&self.shared)
    }

    /// Returns the whole text, including the text after the final `%`.
    pub fn text(&self) -> &str {
        &self.shared.text
    }

    /// Number of characters of the text, as counted for the capacity of the program memory.
    pub fn characters(&self) -> usize {
        self.shared.characters as usize
    }

    /// The program number: the first O word within the first blocks, or `%P01` at the start
    /// of the text; `None` without one.
    pub fn number(&self) -> Option<u16> {
        self.shared.number
    }

    /// The first line with full-width letters or digits outside comments, which are read as
    /// ASCII; `None` without one.
    pub fn full_width_line(&self) -> Option<u32> {
        self.shared.full_width
    }

    /// The first line with text after the `%` at the end of the program, which the control
    /// does not read; `None` without such text.
    pub(crate) fn line_after_end(&self) -> Option<u32> {
        self.shared.after_end
    }

    /// The line and the number of a program name that begins with `:`, as on other controls;
    /// `None` if the name does not begin with `:`.
    pub(crate) fn colon_name(&self) -> Option<(u32, u16)> {
        let within = self.shared.blocks.len().min(NAME_SEARCH_BLOCKS);
        (0..within).find_map(|index| {
            let head = BlockHead::read(self.shared.block(index));
            let line = self.shared.blocks.line(index)?;
            head.o.filter(|_| head.colon).map(|number| (line, number))
        })
    }

    /// Whether the program has statements, formulas or variables that only macro B has.
    pub(crate) fn uses_macro_b(&self) -> bool {
        let shared = &self.shared;
        *shared.macro_b.get_or_init(|| uses_macro_b(&shared.text))
    }

    /// Reads the program call by the G or M code at the beginning of a block; `None` if the
    /// code calls no program. `program_of` returns the program that a letter and a code number
    /// call.
    ///
    /// # Errors
    /// 114 for an invalid word, 129 for an address that cannot be an argument.
    pub(crate) fn code_call(
        &self,
        index: u32,
        program_of: &dyn Fn(char, u16) -> Option<u16>,
    ) -> Result<Option<CodeCall>, BlockError> {
        code_call::read_code_call(self.block(index), program_of)
    }

    /// Number of lines of the text, including those after the `%`.
    pub fn line_count(&self) -> u32 {
        self.shared.lines
    }

    /// The text of a line without its line end. Lines count in the file, from 1; a line
    /// outside the program is empty.
    pub fn line(&self, line: u32) -> &str {
        self.shared.line(line)
    }

    /// Returns the number of blocks in the program.
    pub fn block_count(&self) -> u32 {
        self.shared.blocks.len() as u32
    }

    /// The text from the block with this index, from 0, up to the next block.
    pub fn block(&self, index: u32) -> &str {
        self.shared.block(index as usize)
    }

    /// Number of bytes of the text from the block with this index, from 0, up to the next
    /// block.
    #[inline]
    pub(super) fn block_length(&self, index: u32) -> usize {
        self.shared.blocks.length(index as usize) as usize
    }

    /// The line in the file, from 1, of the block with this index (from 0); for an index after
    /// the last block the line after that block.
    pub fn block_line(&self, index: u32) -> u32 {
        let blocks = &self.shared.blocks;
        let after_all = || {
            let last = blocks.last();
            last.map_or(self.shared.first_line, |place| place.line + 1)
        };
        blocks.line(index as usize).unwrap_or_else(after_all)
    }

    /// The column at which a block begins in its line, in characters from 1.
    pub(crate) fn block_column(&self, index: u32) -> u32 {
        self.before_block(index).chars().count() as u32 + 1
    }

    /// Whether only a `;` is before a block in its line.
    #[inline]
    pub(crate) fn follows_semicolon(&self, index: u32) -> bool {
        let blocks = &self.shared.blocks;
        let index = index as usize;
        let Some(before) = index
            .checked_sub(1)
            .filter(|_| blocks.continues_line(index))
        else {
            return false;
        };
        !blocks.continues_line(before) && self.shared.block(before).trim() == ";"
    }

    /// The text of the line that is before a block.
    #[cold]
    fn before_block(&self, index: u32) -> &str {
        let shared = &self.shared;
        let at = shared.blocks.get(index as usize);
        let at = at.map_or(0, |place| place.byte as usize);
        let before = shared.text.get(line_start(&shared.text, at)..at);
        before.unwrap_or_default()
    }

    /// Index of the first block in this line of the file or after it; [`Self::block_count`] if
    /// there is none.
    pub fn block_from_line(&self, line: u32) -> u32 {
        self.shared.blocks.first_at(line) as u32
    }

    /// Parses the block with this index (from 0), which may have variables only in G65; G65
    /// words remain unchanged. An index after the last block yields an empty block.
    ///
    /// # Errors
    /// As `parse_block`; 115 if a word has a variable instead of a number.
    pub fn parse(&self, index: u32, syntax: Syntax) -> Result<ProgramBlock, BlockError> {
        let mut block = ProgramBlock::default();
        self.read(index, syntax, &mut block)?;
        if !block.has_variables() {
            return Ok(block);
        }
        let is_count = |_| false;
        block.resolve(syntax, is_count, |variable| {
            let detail = say::variable_without_value(variable.number);
            Err(BlockError {
                alarm: number::BAD_VARIABLE,
                column: 1,
                detail,
            })
        })
    }

    /// Parses a block that may refer to variables. [`ProgramBlock::resolve`] must be called before
    /// its numbers are used.
    ///
    /// # Errors
    /// As `parse_block`.
    pub fn parse_with_variables(
        &self,
        index: u32,
        syntax: Syntax,
    ) -> Result<ProgramBlock, BlockError> {
        let mut block = ProgramBlock::default();
        self.read(index, syntax, &mut block)?;
        Ok(block)
    }

    /// Parses a block into `block`, which avoids moving a large value. Its old content is
    /// lost.
    ///
    /// # Errors
    /// As `parse_block`.
    #[inline]
    pub(crate) fn read(
        &self,
        index: u32,
        syntax: Syntax,
        block: &mut ProgramBlock,
    ) -> Result<(), BlockError> {
        block.clear();
        let shared = &self.shared;
        let Some(place) = shared.blocks.get(index as usize) else {
            block.line = self.block_line(index);
            return Ok(());
        };
        block.line = place.line;
        if index == 0 && !syntax.model.is_main() {
            self.check_percent_name(syntax)?;
        }
        // The block ends where the next one begins.
        let text = shared
            .text
            .get(place.byte as usize..shared.blocks.end() as usize);
        read_block(text.unwrap_or(""), syntax, block)
            .map_err(|error| self.with_line_column(error, index))
    }

    /// The line of a block, and its words as long as they have the common form; `None` after
    /// the last block. `point_required` as in [`Syntax`].
    #[inline]
    pub(crate) fn plain_words(
        &self,
        index: u32,
        point_required: bool,
    ) -> Option<(u32, PlainWords<'_>)> {
        let shared = &self.shared;
        let position = shared.blocks.get(index as usize)?;
        let text = shared.text.as_bytes();
        let text = text.get(position.byte as usize..shared.blocks.end() as usize)?;
        Some((position.line, PlainWords::new(text, point_required)))
    }

    /// Converts the column of an error from the block to the line. Adds a message if a `;` is
    /// before the block: other languages begin a comment with it.
    #[cold]
    fn with_line_column(&self, mut error: BlockError, index: u32) -> BlockError {
        error.column = error.column.saturating_add(self.block_column(index) - 1);
        if self.before_block(index).contains(';') {
            error.detail = say::several([error.detail, say::instead_of_semicolon()]);
        }
        error
    }

    /// The line of the first block with the sequence number `number`, in the line `from_line`
    /// or after it; `None` without such a block. Only an N at the beginning of a block counts
    /// (manual I-2.1).
    pub fn find_sequence(&self, number: u32, from_line: u32) -> Option<u32> {
        let from = self.block_from_line(from_line);
        self.find_sequence_block(number, from..self.block_count())
            .map(|index| self.block_line(index))
    }

    /// Index of the first block with the sequence number `number` within a range of block
    /// indexes; `None` without such a block.
    pub(crate) fn find_sequence_block(
        &self,
        number: u32,
        range: core::ops::Range<u32>,
    ) -> Option<u32> {
        let mut range = range.start..range.end.min(self.block_count());
        range.find(|&index| BlockHead::read(self.block(index)).n == Some(number))
    }

    /// The sequence number (N) at the beginning of a block; `None` without one.
    pub fn sequence(&self, index: u32) -> Option<u32> {
        BlockHead::read(self.block(index)).n
    }

    /// Whether a block begins with the skip mark `/`.
    pub fn has_skip_mark(&self, index: u32) -> bool {
        BlockHead::read(self.block(index)).skip
    }

    /// Index of the block with the program name (O word); `None` without a name.
    pub(super) fn name_block(&self) -> Option<u32> {
        let within = self.shared.blocks.len().min(NAME_SEARCH_BLOCKS);
        (0..within)
            .find(|&block| BlockHead::read(self.shared.block(block)).o.is_some())
            .map(|block| block as u32)
    }

    /// A copy of the program in which `text` replaces the lines from `first` (from 1) up to,
    /// but not including, `end`. Each new line gets a line end.
    pub(super) fn with_lines(&self, first: u32, end: u32, text: &str) -> Self {
        let shared = &self.shared;
        let (start, stop) = (shared.line_byte(first), shared.line_byte(end.max(first)));
        let (before, rest) = shared.text.split_at_checked(start).unwrap_or_default();
        let after = rest.get(stop - start..).unwrap_or("");
        let newline = if shared.text.contains("\r\n") {
            "\r\n"
        } else {
            "\n"
        };
        let mut whole = String::with_capacity(shared.text.len() + text.len() + 4);
        whole.push_str(before);
        if !before.is_empty() && !before.ends_with(['\n', '\r']) {
            whole.push_str(newline);
        }
        for line in text.lines() {
            whole.push_str(line);
            whole.push_str(newline);
        }
        whole.push_str(after);
        Self::from_line(whole, shared.first_line)
    }

    /// A program that consists of the text from the line `first` on and then `more`. The lines
    /// keep their numbers.
    pub(super) fn join_from_line(&self, first: u32, more: &str) -> Self {
        let first = first.max(self.shared.first_line);
        let kept = self.shared.text.get(self.shared.line_byte(first)..);
        let whole = [kept.unwrap_or(""), more].concat();
        Self::from_line(whole, first)
    }
}

impl PartialEq for Program {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.shared, &other.shared)
            || (self.shared.first_line == other.shared.first_line
                && self.shared.text == other.shared.text)
    }
}

impl Eq for Program {}

impl core::fmt::Debug for TextIdentity {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_tuple("Identity").finish()
    }
}

impl core::fmt::Debug for Program {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Program")
            .field("number", &self.number())
            .field("blocks", &self.block_count())
            .finish_non_exhaustive()
    }
}

impl From<Plain> for Program {
    fn from(plain: Plain) -> Self {
        Self::from_line(plain.text, plain.first_line)
    }
}

impl From<Program> for Plain {
    fn from(program: Program) -> Self {
        Self {
            text: program.text().to_owned(),
            first_line: program.shared.first_line,
        }
    }
}

impl SharedText {
    fn block(&self, index: usize) -> &str {
        let Some(place) = self.blocks.get(index) else {
            return "";
        };
        let (start, length) = (place.byte as usize, self.blocks.length(index) as usize);
        self.text.get(start..start + length).unwrap_or("")
    }

    fn line(&self, line: u32) -> &str {
        let Some(below) = line.checked_sub(self.first_line) else {
            return "";
        };
        if below >= self.lines {
            return "";
        }
        let at = self.line_byte(line);
        // The last block of a line is near its end, whatever is before it.
        let last = self.last_block_before(line);
        let last = last.filter(|place| place.line == line);
        let near = last.map_or(at, |place| at.max(place.byte as usize));
        let (end, _) = line_end(&self.text, near);
        self.text.get(at..end).unwrap_or("")
    }

    /// Position of the last block in this line or before it; `None` without such a block.
    fn last_block_before(&self, line: u32) -> Option<BlockPosition> {
        let known = self.blocks.first_at(line.saturating_add(1));
        self.blocks.get(known.checked_sub(1)?)
    }

    /// Byte position of the beginning of a line; the length of the text for a line after the
    /// end. The search begins at the nearest block, since a line may be as long as the
    /// program.
    fn line_byte(&self, line: u32) -> usize {
        let first = self.blocks.first_at(line);
        if let Some(place) = self.blocks.get(first)
            && place.line == line
        {
            return line_start(&self.text, place.byte as usize);
        }
        let before = line
            .checked_sub(1)
            .and_then(|line| self.last_block_before(line));
        let (mut at, mut here) = before.map_or((0, self.first_line), |place| {
            (place.byte as usize, place.line)
        });
        while here < line && at < self.text.len() {
            (at, here) = (line_end(&self.text, at).1, here + 1);
        }
        at
    }
}
