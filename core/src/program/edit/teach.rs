//! Teach-in: writes the current position of an axis into its word.

use super::ProgramEditor;
use crate::units::Axis;

impl ProgramEditor {
    /// The axis whose letter, X or Z, is at the cursor or directly before it; `None`
    /// otherwise.
    pub fn axis_word(&self) -> Option<Axis> {
        self.axis_letter().map(|(axis, _)| axis)
    }

    /// Replaces the number of the axis word at the cursor by `value` and moves the cursor
    /// after it. Returns `false` if no axis word is at the cursor.
    pub fn teach_axis(&mut self, value: &str) -> bool {
        let Some((_, letter)) = self.axis_letter().filter(|_| self.is_editable()) else {
            return false;
        };
        self.column = letter + 1;
        let (before, after) = self.split_line();
        let number = after.trim_start();
        let rest = number.trim_start_matches(|c: char| matches!(c, '0'..='9' | '.' | '+' | '-'));
        // A blank before the next word is kept.
        let rest = if rest == number { &after } else { rest };
        self.replace_lines(self.line, self.line + 1, &format!("{before}{value}{rest}"));
        self.column += value.chars().count() as u32;
        self.numbered = false;
        true
    }

    /// The axis whose letter, X or Z, is at or directly before the cursor, and the column of
    /// that letter, from 0. `None` without such a letter, in a comment or on the end mark.
    fn axis_letter(&self) -> Option<(Axis, u32)> {
        if self.is_in_comment() || self.is_on_end_mark() {
            return None;
        }
        let at = self.char_at_cursor().map(|letter| (letter, self.column));
        let before = self.char_before_cursor();
        let before = before.map(|letter| (letter, self.column.saturating_sub(1)));
        [at, before]
            .into_iter()
            .flatten()
            .find_map(|(letter, column)| match letter.to_ascii_uppercase() {
                'X' => Some((Axis::X, column)),
                'Z' => Some((Axis::Z, column)),
                _ => None,
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::program::Program;

    fn editing(text: &str, line: u32, column: u32) -> ProgramEditor {
        let mut editing = ProgramEditor::new(Program::new(text), line);
        for _ in 0..column {
            editing.move_right();
        }
        editing
    }

    #[test]
    fn a_word_takes_the_value_after_its_letter() {
        let mut edited = editing("O0001;\nG00 X;\nM30;\n", 2, 5);
        assert_eq!(edited.axis_word(), Some(Axis::X));
        assert!(edited.teach_axis("10.521"));
        assert_eq!(edited.program().line(2), "G00 X10.521;");
        assert_eq!(edited.cursor(), (2, 11));
    }

    #[test]
    fn an_existing_value_is_replaced() {
        let mut edited = editing("O0001;\nG00 X12. Z-3.5;\nM30;\n", 2, 9);
        assert_eq!(edited.axis_word(), Some(Axis::Z));
        assert!(edited.teach_axis("-40.000"));
        assert_eq!(edited.program().line(2), "G00 X12. Z-40.000;");
    }

    #[test]
    fn only_an_axis_word_takes_it() {
        for (line, column) in [(1, 0), (2, 1), (2, 10), (3, 1), (4, 0)] {
            let mut edited = editing("O0001;\nG00 U1.5 (X);\nM30;\n", line, column);
            assert_eq!(edited.axis_word(), None, "{line} {column}");
            assert!(!edited.teach_axis("1.000"));
        }
    }

    #[test]
    fn a_block_that_is_being_typed_stays_open() {
        let mut edited = editing("O0001;\n", 2, 0);
        for character in "G01X".chars() {
            assert!(edited.insert(character));
        }
        assert!(edited.teach_axis("-0.004"));
        assert_eq!(edited.open_line(), Some(2));
        assert_eq!(edited.program().line(2), "G01X-0.004");
    }
}
