//! A program being edited: its text and the cursor in it (manual III-8.1).
//!
//! The cursor stands on a character of a line, on the sign that ends the line, or
//! on the `%` behind the last block. What is typed in front of the `%` is an open
//! block until the end of block is keyed in; leaving it ends it too. The line of
//! the program name and the `%` stay as they are.

mod cursor;
mod teach;

use serde::{Deserialize, Serialize};

use super::head::Head;
use super::listing::{end_column, without_end};
use super::points::with_points;
use super::text::Program;

/// How the editor completes what is typed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Completion {
    /// 自动序号: each new block begins with a sequence number so much higher.
    pub numbering: Option<u16>,
    /// 013.3 PODI: numbers get their decimal point.
    pub points: bool,
}

/// The first automatic sequence number.
const FIRST_NUMBER: u32 = 10;
/// The highest sequence number.
const LAST_NUMBER: u32 = 9999;

/// A program being edited.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Editing {
    /// The program as it is stored.
    stored: Program,
    program: Program,
    line: u32,
    column: u32,
    changed: bool,
    /// The block at the cursor, the last one, is not ended yet.
    open: bool,
    /// All that stands in the open block is its automatic number.
    numbered: bool,
}

impl Editing {
    /// Begins with the cursor at the start of a line.
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

    /// The text as it is now.
    pub const fn program(&self) -> &Program {
        &self.program
    }

    /// The program as it was when the editing began.
    pub const fn stored(&self) -> &Program {
        &self.stored
    }

    /// Line and column of the cursor; columns count characters from 0.
    pub const fn cursor(&self) -> (u32, u32) {
        (self.line, self.column)
    }

    /// Whether the text differs from what is stored.
    pub const fn changed(&self) -> bool {
        self.changed
    }

    /// The line of the block that is not ended yet.
    pub fn open_line(&self) -> Option<u32> {
        self.open.then_some(self.line)
    }

    /// Whether what stands at the cursor may be changed: not the program name.
    fn editable(&self) -> bool {
        self.line > self.program.name_line()
    }

    fn on_end_mark(&self) -> bool {
        !self.open && self.line == self.program.last_listed()
    }

    fn end_of(&self, line: u32) -> u32 {
        end_column(self.program.line(line))
    }

    /// The character in front of the cursor.
    pub fn before_cursor(&self) -> Option<char> {
        let column = self.column.checked_sub(1)?;
        self.program.line(self.line).chars().nth(column as usize)
    }

    /// The character at the cursor; none at the end of a block.
    pub fn at_cursor(&self) -> Option<char> {
        let inside = self.column < self.end_of(self.line);
        let here = self.program.line(self.line).chars();
        here.skip(self.column as usize).find(|_| inside)
    }

    /// Whether the cursor stands inside a comment.
    pub fn in_comment(&self) -> bool {
        let before = self.program.line(self.line).chars();
        let before = before.take(self.column as usize);
        before.fold(false, |inside, c| c == '(' || inside && c != ')')
    }

    /// Whether a letter typed here goes on with a statement or a formula of macro B: a
    /// name, a variable or a bracket stands before it in its block.
    pub fn in_statement(&self) -> bool {
        let line = self.program.line(self.line);
        let before: String = line.chars().take(self.column as usize).collect();
        let letter = before.ends_with(|c: char| c.is_ascii_alphabetic());
        letter || before.contains(['#', '[', '='])
    }

    // Changes. Each tells whether it did anything.

    /// Puts a character in front of the cursor.
    pub fn insert(&mut self, character: char) -> bool {
        if !self.editable() {
            return false;
        }
        if self.on_end_mark() {
            self.put(self.line, self.line, &character.to_string());
            (self.column, self.open) = (1, true);
            return true;
        }
        if character.is_ascii_alphabetic() {
            self.complete_point();
        }
        let (before, after) = self.split_line();
        self.put(
            self.line,
            self.line + 1,
            &format!("{before}{character}{after}"),
        );
        self.column += 1;
        self.numbered = false;
        true
    }

    /// Puts a character behind the one at the cursor, and the cursor on it; at the end
    /// of a block in front of its sign.
    pub fn insert_after_cursor(&mut self, character: char) -> bool {
        if self.column >= self.end_of(self.line) {
            return self.insert(character);
        }
        self.column += 1;
        let inserted = self.insert(character);
        self.column -= 1;
        inserted
    }

    /// Writes a character over the one at the cursor; the sign that ends a block
    /// is not overwritten. `stay` leaves the cursor where it is.
    pub fn overwrite(&mut self, character: char, stay: bool) -> bool {
        if self.column >= self.end_of(self.line) || !self.editable() {
            let inserted = self.insert(character);
            if inserted && stay {
                self.column -= 1;
            }
            return inserted;
        }
        let (before, after) = self.split_line();
        let after: String = after.chars().skip(1).collect();
        self.put(
            self.line,
            self.line + 1,
            &format!("{before}{character}{after}"),
        );
        self.column += u32::from(!stay);
        self.numbered = false;
        true
    }

    /// Replaces the character in front of the cursor.
    pub fn replace_before(&mut self, character: char) -> bool {
        if self.column == 0 || !self.editable() {
            return false;
        }
        self.column -= 1;
        self.overwrite(character, false)
    }

    /// Ends the block in front of the cursor.
    pub fn end_block(&mut self, completion: Completion) -> bool {
        if !self.editable() {
            return false;
        }
        if self.on_end_mark() {
            self.put(self.line, self.line, ";");
            self.line += 1;
        } else {
            self.complete_point();
            let (before, after) = self.split_line();
            let before = if completion.points {
                with_points(&before)
            } else {
                before
            };
            let behind = without_end(&after).to_owned();
            if self.open && behind.is_empty() {
                self.put(self.line, self.line + 1, &format!("{};", before.trim_end()));
                self.open = false;
            } else {
                let sign = if self.open { "" } else { ";" };
                let lines = format!("{};\n{behind}{sign}", before.trim_end());
                self.put(self.line, self.line + 1, &lines);
            }
            (self.line, self.column) = (self.line + 1, 0);
        }
        self.number_block(completion);
        true
    }

    /// Begins an empty block with the next sequence number, when they are automatic.
    pub fn number_block(&mut self, completion: Completion) {
        let empty = self.on_end_mark() || self.end_of(self.line) == 0;
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
            .find_map(|line| Head::read(self.program.line(line)).n);
        let next = above.map_or(FIRST_NUMBER, |number| number.saturating_add(step.into()));
        (next <= LAST_NUMBER).then_some(next)
    }

    /// Removes the character in front of the cursor: at the start of a line the
    /// end of the block above.
    pub fn backspace(&mut self) -> bool {
        if !self.editable() {
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
        let end = self.end_of(above);
        let kept = without_end(self.program.line(above)).to_owned();
        if self.on_end_mark() {
            self.put(above, above + 1, &kept);
            self.open = true;
            if kept.is_empty() {
                self.drop_open();
                return true;
            }
        } else {
            let joined = format!("{kept}{}", self.program.line(self.line));
            self.put(above, self.line + 1, &joined);
        }
        (self.line, self.column) = (above, end);
        self.numbered = false;
        true
    }

    /// Removes the character at the cursor; at the end of a block its sign, which
    /// joins it with the next one.
    pub fn delete(&mut self) -> bool {
        if !self.editable() || self.on_end_mark() {
            return false;
        }
        if self.at_block_number() {
            return self.delete_block();
        }
        if self.column < self.end_of(self.line) {
            return self.remove_here();
        }
        let below = self.line + 1;
        if self.open || below == self.program.last_listed() {
            let empty = self.end_of(self.line) == 0 && !self.open;
            if empty {
                self.put(self.line, below, "");
            }
            return empty;
        }
        let (before, _) = self.split_line();
        let joined = format!("{before}{}", self.program.line(below));
        self.put(self.line, below + 1, &joined);
        true
    }

    /// Whether the cursor stands on the N that begins a line.
    fn at_block_number(&self) -> bool {
        let (before, after) = self.split_line();
        before.trim().is_empty() && after.starts_with(['N', 'n'])
    }

    /// Removes the block at the cursor.
    fn delete_block(&mut self) -> bool {
        let line = self.program.line(self.line);
        let rest = without_end(line)
            .find([';', '*'])
            .map(|end| &line[end + 1..]);
        let rest = rest.map(str::trim_start).unwrap_or_default().to_owned();
        self.put(self.line, self.line + 1, &rest);
        self.column = 0;
        (self.open, self.numbered) = (false, false);
        true
    }

    /// Removes everything from the cursor to the end of the next block with a
    /// sequence number. `false` when there is none.
    pub fn delete_to(&mut self, sequence: u32) -> bool {
        if !self.editable() {
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
            Head::read(text).n == Some(sequence)
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
        self.put(self.line, end + 1, &kept);
        (self.open, self.numbered) = (false, false);
        self.column = self.column.min(self.end_of(self.line));
        true
    }

    /// Ends an open block and gives the text that is to be stored.
    pub fn finish(&mut self) -> &Program {
        self.leave();
        &self.program
    }

    /// The text has been stored.
    pub fn saved(&mut self, stored: Program) {
        self.stored = stored.clone();
        self.program = stored;
        self.changed = false;
    }

    // Text.

    /// The line in front of the cursor and behind it.
    fn split_line(&self) -> (String, String) {
        let line = self.program.line(self.line);
        let at = line
            .char_indices()
            .nth(self.column as usize)
            .map_or(line.len(), |(byte, _)| byte);
        (line[..at].to_owned(), line[at..].to_owned())
    }

    /// `X10.` becomes `X10.0` when something else follows.
    fn complete_point(&mut self) {
        let (before, after) = self.split_line();
        if before.ends_with('.') && !after.starts_with(|c: char| c.is_ascii_digit()) {
            self.put(self.line, self.line + 1, &format!("{before}0{after}"));
            self.column += 1;
        }
    }

    fn remove_here(&mut self) -> bool {
        let (before, after) = self.split_line();
        let after: String = after.chars().skip(1).collect();
        self.put(self.line, self.line + 1, &format!("{before}{after}"));
        self.numbered = false;
        if self.open && before.is_empty() && after.trim().is_empty() {
            self.drop_open();
        }
        true
    }

    /// Takes an open block away that nothing is left of.
    fn drop_open(&mut self) {
        self.open = false;
        let line = self.line.min(self.program.last_listed());
        if self.program.line(line).trim().is_empty() && line < self.program.last_listed() {
            self.put(line, line + 1, "");
        }
        (self.line, self.column) = (self.program.last_listed(), 0);
    }

    /// The cursor leaves an open block: it ends here.
    fn leave(&mut self) {
        if !self.open {
            return;
        }
        self.open = false;
        let text = without_end(self.program.line(self.line)).to_owned();
        if core::mem::take(&mut self.numbered) {
            self.put(self.line, self.line + 1, "");
            self.column = 0;
        } else {
            self.put(self.line, self.line + 1, &format!("{text};"));
        }
    }

    /// Puts text in the place of the lines from `first` up to `end`.
    fn put(&mut self, first: u32, end: u32, text: &str) {
        self.program = self.program.with_lines(first, end, text);
        self.changed = true;
    }
}

#[cfg(test)]
#[path = "edit_tests.rs"]
mod tests;
