//! Edits a program: its text and the cursor (manual III-8.1).
//!
//! The cursor is on a character of a line, on the sign that ends the line, or on the `%`
//! after the last block. Text typed before the `%` is an open block until the end of block
//! is typed; moving the cursor out of it ends it too. The line of the program name and the
//! `%` cannot be edited.

mod cursor;
mod teach;

use serde::{Deserialize, Serialize};

use super::block_head::BlockHead;
use super::decimal_points::append_points;
use super::listing::{end_column, without_end_sign};
use super::program_text::Program;

/// The characters that the editor adds automatically to typed text.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Completion {
    /// 自动序号: increment of the sequence numbers that begin new blocks; `None` if blocks get no
    /// automatic number.
    pub numbering: Option<u16>,
    /// Parameter 013.3 PODI: whether numbers get a decimal point when their block ends.
    pub points: bool,
}

/// The automatic sequence number if no block above the cursor has a sequence number.
const FIRST_NUMBER: u32 = 10;
/// The highest automatic sequence number; the editor numbers no block above it.
const LAST_NUMBER: u32 = 9999;

/// A program that is being edited, and the position of the cursor in it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProgramEditor {
    /// The text in the program memory, for comparison with the edited text.
    stored: Program,
    program: Program,
    line: u32,
    column: u32,
    changed: bool,
    /// Whether the block at the cursor, the last one, still lacks its end sign.
    open: bool,
    /// Whether the open block only has its automatic sequence number.
    numbered: bool,
}

impl ProgramEditor {
    /// Starts editing with the cursor at the beginning of the line `line`, from 1.
    pub fn new(stored: Program, line: u32) -> Self {
        let (first, last) = (stored.first_listed(), stored.last_listed());
        Self {
            program: stored.clone(),
            stored,
            line: line.clamp(first, last),
            column: 0,
            changed: false,
            open: false,
            numbered: false,
        }
    }

    /// Returns the program with the edited text.
    pub const fn program(&self) -> &Program {
        &self.program
    }

    /// Returns the program as it is in the program memory, without the changes.
    pub const fn stored(&self) -> &Program {
        &self.stored
    }

    /// Line and column of the cursor. Lines count from 1, columns count characters from 0.
    pub const fn cursor(&self) -> (u32, u32) {
        (self.line, self.column)
    }

    /// Whether the edited text differs from the stored one.
    pub const fn is_changed(&self) -> bool {
        self.changed
    }

    /// The line, from 1, of the block that still lacks its end sign; `None` without such a
    /// block.
    pub fn open_line(&self) -> Option<u32> {
        self.open.then_some(self.line)
    }

    /// Whether the cursor is after the program name, where text may be changed.
    fn is_editable(&self) -> bool {
        self.line > self.program.name_line()
    }

    fn is_on_end_mark(&self) -> bool {
        !self.open && self.line == self.program.last_listed()
    }

    fn end_column_of(&self, line: u32) -> u32 {
        end_column(self.program.line(line))
    }

    /// The character before the cursor in its line; `None` at the beginning of a line.
    pub fn char_before_cursor(&self) -> Option<char> {
        let column = self.column.checked_sub(1)?;
        self.program.line(self.line).chars().nth(column as usize)
    }

    /// The character at the cursor; `None` at the end of a block.
    pub fn char_at_cursor(&self) -> Option<char> {
        let inside = self.column < self.end_column_of(self.line);
        let here = self.program.line(self.line).chars();
        here.skip(self.column as usize).find(|_| inside)
    }

    /// Whether the cursor is inside a comment.
    pub fn is_in_comment(&self) -> bool {
        let before = self.program.line(self.line).chars();
        let before = before.take(self.column as usize);
        before.fold(false, |inside, c| c == '(' || inside && c != ')')
    }

    /// Whether a letter typed at the cursor continues a statement or a formula of macro B: in
    /// the block, a name, a variable or a bracket is before the cursor.
    pub fn is_in_statement(&self) -> bool {
        let line = self.program.line(self.line);
        let before: String = line.chars().take(self.column as usize).collect();
        let letter = before.ends_with(|c: char| c.is_ascii_alphabetic());
        letter || before.contains(['#', '[', '='])
    }

    // Changes. Each returns whether it changed the text.

    /// Inserts a character before the cursor. Returns whether the text has changed.
    pub fn insert(&mut self, character: char) -> bool {
        if !self.is_editable() {
            return false;
        }
        if self.is_on_end_mark() {
            self.replace_lines(self.line, self.line, &character.to_string());
            (self.column, self.open) = (1, true);
            return true;
        }
        if character.is_ascii_alphabetic() {
            self.complete_point();
        }
        let (before, after) = self.split_line();
        self.replace_lines(
            self.line,
            self.line + 1,
            &format!("{before}{character}{after}"),
        );
        self.column += 1;
        self.numbered = false;
        true
    }

    /// Inserts a character after the one at the cursor and moves the cursor to it; at the end
    /// of a block before the end sign. Returns whether the text has changed.
    pub fn insert_after_cursor(&mut self, character: char) -> bool {
        if self.column >= self.end_column_of(self.line) {
            return self.insert(character);
        }
        self.column += 1;
        let inserted = self.insert(character);
        self.column -= 1;
        inserted
    }

    /// Overwrites the character at the cursor; before the end sign of a block it inserts
    /// instead. With `stay` the cursor does not move. Returns whether the text has changed.
    pub fn overwrite(&mut self, character: char, stay: bool) -> bool {
        if self.column >= self.end_column_of(self.line) || !self.is_editable() {
            let inserted = self.insert(character);
            if inserted && stay {
                self.column -= 1;
            }
            return inserted;
        }
        let (before, after) = self.split_line();
        let after: String = after.chars().skip(1).collect();
        self.replace_lines(
            self.line,
            self.line + 1,
            &format!("{before}{character}{after}"),
        );
        self.column += u32::from(!stay);
        self.numbered = false;
        true
    }

    /// Replaces the character before the cursor. Returns whether the text has changed.
    pub fn replace_before(&mut self, character: char) -> bool {
        if self.column == 0 || !self.is_editable() {
            return false;
        }
        self.column -= 1;
        self.overwrite(character, false)
    }

    /// Writes the end sign `;` at the cursor, moves to the next line and numbers the block
    /// there. Returns whether the text has changed.
    pub fn end_block(&mut self, completion: Completion) -> bool {
        if !self.is_editable() {
            return false;
        }
        if self.is_on_end_mark() {
            self.replace_lines(self.line, self.line, ";");
            self.line += 1;
        } else {
            self.complete_point();
            let (before, after) = self.split_line();
            let before = if completion.points {
                append_points(&before)
            } else {
                before
            };
            let rest_of_line = without_end_sign(&after).to_owned();
            if self.open && rest_of_line.is_empty() {
                self.replace_lines(self.line, self.line + 1, &format!("{};", before.trim_end()));
                self.open = false;
            } else {
                let sign = if self.open { "" } else { ";" };
                let lines = format!("{};\n{rest_of_line}{sign}", before.trim_end());
                self.replace_lines(self.line, self.line + 1, &lines);
            }
            (self.line, self.column) = (self.line + 1, 0);
        }
        self.number_block(completion);
        true
    }

    /// Writes the next sequence number if the cursor is on an empty line and automatic numbers
    /// are on.
    pub fn number_block(&mut self, completion: Completion) {
        let empty = self.is_on_end_mark() || self.end_column_of(self.line) == 0;
        let Some(number) = completion
            .numbering
            .filter(|_| empty)
            .and_then(|step| self.next_number(step))
        else {
            return;
        };
        let text = format!("N{number:04}");
        for character in text.chars() {
            self.insert(character);
        }
        self.numbered = self.open;
    }

    fn next_number(&self, step: u16) -> Option<u32> {
        let first = self.program.first_listed();
        let above = (first..self.line)
            .rev()
            .find_map(|line| BlockHead::read(self.program.line(line)).n);
        let next = above.map_or(FIRST_NUMBER, |number| number.saturating_add(step.into()));
        (next <= LAST_NUMBER).then_some(next)
    }

    /// Removes the character before the cursor; at the beginning of a line the end sign of the
    /// line above. Returns whether the text has changed.
    pub fn backspace(&mut self) -> bool {
        if !self.is_editable() {
            return false;
        }
        if self.column > 0 {
            self.column -= 1;
            return self.remove_here();
        }
        let above = self.line - 1;
        if above <= self.program.name_line() || above < self.program.first_listed() {
            return false;
        }
        let end = self.end_column_of(above);
        let kept = without_end_sign(self.program.line(above)).to_owned();
        if self.is_on_end_mark() {
            self.replace_lines(above, above + 1, &kept);
            self.open = true;
            if kept.is_empty() {
                self.remove_open_block();
                return true;
            }
        } else {
            let joined = format!("{kept}{}", self.program.line(self.line));
            self.replace_lines(above, self.line + 1, &joined);
        }
        (self.line, self.column) = (above, end);
        self.numbered = false;
        true
    }

    /// Removes the character at the cursor; at the end of a block the end sign, which joins
    /// two blocks; on the N of a sequence number the block. Returns whether the text has
    /// changed.
    pub fn delete(&mut self) -> bool {
        if !self.is_editable() || self.is_on_end_mark() {
            return false;
        }
        if self.is_at_block_number() {
            return self.delete_block();
        }
        if self.column < self.end_column_of(self.line) {
            return self.remove_here();
        }
        let below = self.line + 1;
        if self.open || below == self.program.last_listed() {
            let empty = self.end_column_of(self.line) == 0 && !self.open;
            if empty {
                self.replace_lines(self.line, below, "");
            }
            return empty;
        }
        let (before, _) = self.split_line();
        let joined = format!("{before}{}", self.program.line(below));
        self.replace_lines(self.line, below + 1, &joined);
        true
    }

    /// Whether the cursor is on the letter N at the beginning of a line.
    fn is_at_block_number(&self) -> bool {
        let (before, after) = self.split_line();
        // In the first column also before blanks (manual III-8.1.1.6).
        let after = match before.is_empty() {
            true => after.trim_start(),
            false => after.as_str(),
        };
        before.trim().is_empty() && after.starts_with(['N', 'n'])
    }

    /// Removes the first block of the line with the cursor. Returns `true`: the text has
    /// changed.
    fn delete_block(&mut self) -> bool {
        let line = self.program.line(self.line);
        let rest = without_end_sign(line)
            .find([';', '*'])
            .map(|end| &line[end + 1..]);
        let rest = rest.map(str::trim_start).unwrap_or_default().to_owned();
        self.replace_lines(self.line, self.line + 1, &rest);
        self.column = 0;
        (self.open, self.numbered) = (false, false);
        true
    }

    /// Removes the text from the cursor to the end of the next block with the sequence number
    /// `sequence`. Returns `false` if no block from the cursor on has this number.
    pub fn delete_to(&mut self, sequence: u32) -> bool {
        if !self.is_editable() {
            return false;
        }
        let last = self.program.last_listed();
        let is_wanted = |line: &u32| {
            let text = self.program.line(*line);
            let text = if *line == self.line {
                let skipped = text.char_indices().nth(self.column as usize);
                skipped.map_or("", |(byte, _)| &text[byte..])
            } else {
                text
            };
            BlockHead::read(text).n == Some(sequence)
        };
        let Some(end) = (self.line..last).find(is_wanted) else {
            return false;
        };
        let (before, _) = self.split_line();
        let kept = before.trim_end();
        let kept = if kept.is_empty() {
            String::new()
        } else {
            format!("{kept};")
        };
        self.replace_lines(self.line, end + 1, &kept);
        (self.open, self.numbered) = (false, false);
        self.column = self.column.min(self.end_column_of(self.line));
        true
    }

    /// Writes the end sign of an open block and returns the program to be stored.
    pub fn finish(&mut self) -> &Program {
        self.end_open_block();
        &self.program
    }

    /// Records that the program memory has `stored`; it replaces the edited text.
    pub fn mark_saved(&mut self, stored: Program) {
        self.stored = stored.clone();
        self.program = stored;
        self.changed = false;
    }

    // Text.

    /// Splits the line with the cursor into the text before the cursor and the rest.
    fn split_line(&self) -> (String, String) {
        let line = self.program.line(self.line);
        let at = line
            .char_indices()
            .nth(self.column as usize)
            .map_or(line.len(), |(byte, _)| byte);
        (line[..at].to_owned(), line[at..].to_owned())
    }

    /// Completes a number with a trailing point at the cursor, `X10.` to `X10.0`.
    fn complete_point(&mut self) {
        let (before, after) = self.split_line();
        if before.ends_with('.') && !after.starts_with(|c: char| c.is_ascii_digit()) {
            self.replace_lines(self.line, self.line + 1, &format!("{before}0{after}"));
            self.column += 1;
        }
    }

    fn remove_here(&mut self) -> bool {
        let (before, after) = self.split_line();
        let after: String = after.chars().skip(1).collect();
        self.replace_lines(self.line, self.line + 1, &format!("{before}{after}"));
        self.numbered = false;
        if self.open && before.is_empty() && after.trim().is_empty() {
            self.remove_open_block();
        }
        true
    }

    /// Removes the empty line of an open block from which all text was deleted.
    fn remove_open_block(&mut self) {
        self.open = false;
        let line = self.line.min(self.program.last_listed());
        if self.program.line(line).trim().is_empty() && line < self.program.last_listed() {
            self.replace_lines(line, line + 1, "");
        }
        (self.line, self.column) = (self.program.last_listed(), 0);
    }

    /// Writes the end sign of an open block because the cursor leaves it; removes the block if
    /// it only has its automatic sequence number.
    fn end_open_block(&mut self) {
        if !self.open {
            return;
        }
        self.open = false;
        let text = without_end_sign(self.program.line(self.line)).to_owned();
        if core::mem::take(&mut self.numbered) {
            self.replace_lines(self.line, self.line + 1, "");
            self.column = 0;
        } else {
            self.replace_lines(self.line, self.line + 1, &format!("{text};"));
        }
    }

    /// Replaces the lines from `first` (from 1) up to, but not including, `end` by `text`.
    fn replace_lines(&mut self, first: u32, end: u32, text: &str) {
        self.program = self.program.with_lines(first, end, text);
        self.changed = true;
    }
}

#[cfg(test)]
mod tests;
