//! Selects the lines of a text that the operator sees, and finds the ends of blocks in them.

use super::program_text::Program;

/// Greatest number of empty lines at the end of a file that are skipped.
const MAX_BLANK_LINES: u32 = 1000;

impl Program {
    /// The number of the first line of the listing, from 1. A program from the middle of a
    /// file keeps the line numbers of the file.
    pub fn first_listed(&self) -> u32 {
        let mut first = match self.block_count() {
            0 => 1,
            _ => self.block_line(0).max(1),
        };
        let limit = first.saturating_sub(MAX_BLANK_LINES).max(1);
        while first > limit && !self.line(first - 1).trim().is_empty() {
            first -= 1;
        }
        first
    }

    /// The number of the last line of the listing, which shows the `%`: the line of the `%`,
    /// or the line after the last line that is not empty.
    pub fn last_listed(&self) -> u32 {
        let (last, closed) = self.last_line();
        last + u32::from(!closed)
    }

    /// The number of the last line that is not empty, and whether this line is the `%`.
    fn last_line(&self) -> (u32, bool) {
        let first = self.first_listed();
        let mut last = first.saturating_add(self.line_count());
        let limit = last.saturating_sub(MAX_BLANK_LINES + first).max(first - 1);
        while last > limit && self.line(last).trim().is_empty() {
            last -= 1;
        }
        (last, last > first && self.line(last).trim() == "%")
    }

    /// The number of the line with the program name, which the editor protects; 0 without a
    /// name.
    pub(crate) fn name_line(&self) -> u32 {
        self.name_block().map_or(0, |block| self.block_line(block))
    }
}

/// Removes the end sign (`;` or `*`) and blanks from the end of a line.
pub fn without_end_sign(line: &str) -> &str {
    let text = line.trim_end();
    if text == "%" {
        return "";
    }
    text.trim_end_matches([';', '*', '；']).trim_end()
}

/// The column of the end sign of a line, in characters from 0; the length without a sign.
pub(crate) fn end_column(line: &str) -> u32 {
    without_end_sign(line).chars().count() as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::program::split_programs;

    #[test]
    fn a_block_ends_at_its_sign() {
        assert_eq!(end_column("G0 X1; "), 5);
        assert_eq!(end_column("G0 X1"), 5);
        assert_eq!(end_column(""), 0);
        assert_eq!(end_column("%"), 0);
    }

    #[test]
    fn the_listing_ends_with_a_percent_sign() {
        let program = Program::new("O0001;\nM30;\n\n");
        assert_eq!((program.first_listed(), program.last_listed()), (1, 3));
        let closed = Program::new("O0001;\nM30;\n%\n");
        assert_eq!(closed.last_listed(), 3);
        assert_eq!(closed.name_line(), 1);
        assert_eq!(Program::new("G0 X1\n").name_line(), 0);
    }

    #[test]
    fn a_program_from_the_middle_of_a_file_begins_at_its_own_line() {
        let parts = split_programs("O0001;\nM30;\n\n\nO0002;\nG0 X1;\nM30;\n");
        let second = &parts[1];
        assert_eq!((second.first_listed(), second.last_listed()), (5, 8));
        assert_eq!(second.name_line(), 5);
    }
}
