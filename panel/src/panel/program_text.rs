//! The program page: selecting a program, moving through its text
//! (manual III-5.1, III-8.2).

use gsk_core::cnc::{Cnc, Request};
use gsk_core::command::ProgramId;
use gsk_core::operation::Mode;
use gsk_core::program::Program;

use super::Panel;
use crate::keys::Key;
use crate::pages::{PAGE_ROWS, first_line, last_line};

impl Panel {
    /// A cursor key on the program page in EDIT or AUTO: with `O` typed it
    /// selects a program, in search state it searches, in EDIT it moves.
    pub(super) fn program_cursor(&mut self, key: Key, cnc: &Cnc, requests: &mut Vec<Request>) {
        let input = self.view.input.clone();
        if self.view.editor.searching {
            if let Some(number) = numbered(&input, 'N') {
                requests.push(Request::SearchSequence(number));
            }
            return;
        }
        if let Some(rest) = input.strip_prefix('O') {
            match key {
                Key::Down if rest.is_empty() => {
                    // The letter stays, so that the next press goes on.
                    requests.extend(next_program(cnc).map(Request::SelectProgram));
                }
                Key::Down => {
                    requests.extend(numbered(&input, 'O').map(Request::SelectProgram));
                    self.clear_input();
                }
                Key::Up => {
                    requests.push(Request::CursorTo(1));
                    self.clear_input();
                }
                _ => {}
            }
            return;
        }
        if cnc.mode() == Mode::Edit {
            self.move_in_text(key, cnc, requests);
        }
    }

    /// One step of the edit cursor.
    fn move_in_text(&mut self, key: Key, cnc: &Cnc, requests: &mut Vec<Request>) {
        let Some(program) = current(cnc) else {
            return;
        };
        let (first, last) = (first_line(program), last_line(program));
        let (line, column) = self.text_cursor(cnc);
        let end = line_end(program.line(line));
        let place = match key {
            Key::Up if line > first => (line - 1, column.min(line_end(program.line(line - 1)))),
            Key::Down if line < last => (line + 1, column.min(line_end(program.line(line + 1)))),
            Key::Left if column > 0 => (line, column - 1),
            Key::Left if line > first => (line - 1, line_end(program.line(line - 1))),
            Key::Right if column < end => (line, column + 1),
            Key::Right if line < last => (line + 1, 0),
            _ => return,
        };
        self.put_text_cursor(place, requests);
    }

    /// The page keys in EDIT: a screen on or back, to its first character. On
    /// the first screen the name of the program is passed over; the last one
    /// ends at the last row.
    pub(super) fn turn_text(&mut self, forward: bool, cnc: &Cnc, requests: &mut Vec<Request>) {
        let Some(program) = current(cnc) else {
            return;
        };
        let (first, last) = (first_line(program), last_line(program));
        let rows = PAGE_ROWS as u32;
        let shown = (self.text_cursor(cnc).0.max(first) - first) / rows;
        let line = match (forward, shown) {
            (true, _) => first + (shown + 1) * rows,
            (false, 0 | 1) => first + 1,
            (false, _) => first + (shown - 1) * rows,
        };
        self.put_text_cursor((line.min(last), 0), requests);
    }

    /// Line and column of the edit cursor.
    fn text_cursor(&self, cnc: &Cnc) -> (u32, u32) {
        match self.view.editor.line {
            0 => (cnc.cursor().line.max(1), 0),
            line => (line, self.view.editor.column),
        }
    }

    fn put_text_cursor(&mut self, (line, column): (u32, u32), requests: &mut Vec<Request>) {
        self.view.editor.line = line;
        self.view.editor.column = column;
        requests.push(Request::CursorTo(line));
    }

    /// Drops the own cursor when the control's has moved elsewhere: after RESET
    /// or another program.
    pub(super) fn follow_cursor(&mut self, cnc: &Cnc) {
        let editor = &mut self.view.editor;
        if editor.line > 0 && editor.line != cnc.cursor().line {
            editor.line = 0;
            editor.column = 0;
        }
    }
}

/// The selected program.
fn current(cnc: &Cnc) -> Option<&Program> {
    cnc.programs().get(cnc.programs().current()?)
}

/// The stored program after the selected one; after the last the first.
fn next_program(cnc: &Cnc) -> Option<u16> {
    let memory = cnc.programs();
    let numbers: Vec<u16> = memory.iter().map(|(number, _)| number).collect();
    let selected = match memory.current() {
        Some(ProgramId::Stored(selected)) => Some(selected),
        _ => None,
    };
    let after = numbers.iter().find(|number| Some(**number) > selected);
    after.or(numbers.first()).copied()
}

/// The number behind an address letter.
fn numbered(input: &str, address: char) -> Option<u16> {
    let number: u16 = input.strip_prefix(address)?.trim().parse().ok()?;
    (number <= 9999).then_some(number)
}

/// The column of the sign that ends a block.
fn line_end(line: &str) -> u32 {
    let text = line.trim_end().trim_end_matches([';', '*']).trim_end();
    text.chars().count() as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_behind_their_letter() {
        assert_eq!(numbered("O0012", 'O'), Some(12));
        assert_eq!(numbered("O12345", 'O'), None);
        assert_eq!(numbered("O", 'O'), None);
        assert_eq!(numbered("N5", 'O'), None);
    }

    #[test]
    fn a_block_ends_at_its_sign() {
        assert_eq!(line_end("G0 X1; "), 5);
        assert_eq!(line_end("G0 X1"), 5);
        assert_eq!(line_end(""), 0);
    }
}
