//! Moves the cursor by lines and characters, and searches for text.

use super::ProgramEditor;
use crate::program::block_head::BlockHead;

impl ProgramEditor {
    /// Moves the cursor to the first line of the program.
    pub fn move_to_head(&mut self) {
        self.end_open_block();
        (self.line, self.column) = (self.program.first_listed(), 0);
    }

    /// Moves the cursor to a line, from 1; a line outside the program means its first or last
    /// one.
    pub fn move_to_line(&mut self, line: u32) {
        self.end_open_block();
        let (first, last) = (self.program.first_listed(), self.program.last_listed());
        (self.line, self.column) = (line.clamp(first, last), 0);
    }

    /// Moves the cursor one line up.
    pub fn move_up(&mut self) {
        if self.line > self.program.first_listed() {
            self.end_open_block();
            self.line -= 1;
            self.column = self.column.min(self.end_column_of(self.line));
        }
    }

    /// Moves the cursor one line down.
    pub fn move_down(&mut self) {
        let open = self.open;
        self.end_open_block();
        if open {
            self.column = 0;
        }
        if self.line < self.program.last_listed() {
            self.line += 1;
            self.column = self.column.min(self.end_column_of(self.line));
        }
    }

    /// Moves the cursor one character to the left; from the beginning of a line to the end of
    /// the line above.
    pub fn move_left(&mut self) {
        if self.column > 0 {
            self.column -= 1;
        } else if self.line > self.program.first_listed() {
            self.end_open_block();
            self.line -= 1;
            self.column = self.end_column_of(self.line);
        }
    }

    /// Moves the cursor one character to the right; from the end of a line to the beginning of
    /// the next line.
    pub fn move_right(&mut self) {
        if self.column < self.end_column_of(self.line) {
            self.column += 1;
            return;
        }
        self.end_open_block();
        if self.line < self.program.last_listed() {
            (self.line, self.column) = (self.line + 1, 0);
        }
    }

    /// Moves the cursor to the next occurrence of a text after or before it. A sequence number
    /// is searched in the whole program. Returns `false` if the text does not occur.
    pub fn move_to_text(&mut self, wanted: &str, forward: bool) -> bool {
        let Some(position) = self.find_position(wanted, forward) else {
            return false;
        };
        self.end_open_block();
        (self.line, self.column) = position;
        true
    }

    fn find_position(&self, wanted: &str, forward: bool) -> Option<(u32, u32)> {
        if wanted.is_empty() {
            return None;
        }
        let (first, last) = (self.program.first_listed(), self.program.last_listed());
        let here = (self.line, self.column);
        let on_line = |line: u32| {
            let columns = find_columns(self.program.line(line), wanted);
            let matches = columns.into_iter().map(move |column| (line, column));
            if forward {
                matches.filter(|place| *place > here).min()
            } else {
                matches.filter(|place| *place < here).max()
            }
        };
        let found = if forward {
            (self.line..=last).find_map(on_line)
        } else {
            (first..=self.line).rev().find_map(on_line)
        };
        found.or_else(|| {
            sequence_number(wanted)?;
            let mut lines = first..=last;
            lines.find_map(|line| {
                Some((
                    line,
                    *find_columns(self.program.line(line), wanted).first()?,
                ))
            })
        })
    }
}

/// The sequence number in a searched text such as `N10`; `None` for another text.
fn sequence_number(wanted: &str) -> Option<u32> {
    wanted.strip_prefix('N')?.parse().ok()
}

/// The columns, in characters from 0, at which a text occurs in a line. A sequence number,
/// with or without leading zeros, occurs only at the beginning of a block.
fn find_columns(line: &str, wanted: &str) -> Vec<u32> {
    if let Some(number) = sequence_number(wanted) {
        let blank = line.chars().take_while(|c| *c == '/' || c.is_whitespace());
        let column = blank.count() as u32;
        return if BlockHead::read(line).n == Some(number) {
            vec![column]
        } else {
            Vec::new()
        };
    }
    let line: Vec<char> = line.chars().map(|c| c.to_ascii_uppercase()).collect();
    let wanted: Vec<char> = wanted.chars().collect();
    (0..line.len())
        .filter(|&at| line[at..].starts_with(&wanted))
        .map(|at| at as u32)
        .collect()
}
