//! Draws program text in rows of 40 columns with wrapping, end-of-block sign and cursor.

use core::ops::Range;

use gsk_core::cnc::Cnc;
use gsk_core::program::{Program, without_end_sign};

use crate::glyphs;
use crate::screen::{COLUMNS, CellStyle, Screen};

/// Number of screen rows in which the program page lists text.
const PAGE_ROWS: usize = 12;

/// Which part of a program is listed, and in which rows of the screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Listing {
    /// First screen row of the listing, from 0.
    pub top: usize,
    /// Number of screen rows of the listing.
    pub rows: usize,
    /// Program line at the top of the listing, from 1.
    pub first: u32,
    /// Number of rows of the first line that are left out at the top, because the line is too
    /// long for the screen.
    pub skip: usize,
}

/// The mark in the listing of a program: the running block or the edit cursor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ListingMark {
    /// The block in execution, by its line (from 1). It is drawn inverse.
    Block(u32),
    /// The mark is the edit cursor, at a character of a line.
    Edit {
        /// Line of the edit cursor, from 1.
        line: u32,
        /// Character in the line at which the cursor is, from 0.
        column: u32,
        /// Whether alter mode is on. The cursor is then an inverse character, otherwise a bar.
        alter: bool,
        /// Whether the block at the cursor has not ended yet. It is then shown without its end
        /// sign.
        open: bool,
    },
}

impl ListingMark {
    fn leaves_open(self, here: u32) -> bool {
        matches!(self, Self::Edit { line, open: true, .. } if line == here)
    }
}

/// Returns a block as the control writes it: without trailing blanks, with the end-of-block
/// sign.
fn shown(line: &str, end_of_block: char) -> String {
    let text = line.trim_end();
    if text == "%" {
        return text.to_owned();
    }
    let text = without_end_sign(text);
    let mut block = String::with_capacity(text.len() + 1);
    block.push_str(text);
    block.push(end_of_block);
    block
}

/// Returns the character that ends blocks: `;` or `*` by parameter 012.1 EBCL.
fn end_of_block(cnc: &Cnc) -> char {
    if cnc.parameters().semicolon_ends_blocks() {
        ';'
    } else {
        '*'
    }
}

/// Returns the text of a line (from 1) in the listing; `None` outside the program. The last
/// line is `%`.
fn listed(program: &Program, line: u32, end_of_block: char) -> Option<String> {
    let last = program.last_listed();
    if line < last {
        return Some(shown(program.line(line), end_of_block));
    }
    (line == last).then(|| "%".to_owned())
}

/// Returns the byte ranges of the screen rows that a text takes, at most `most`.
fn wrap(text: &str, most: usize) -> Vec<Range<usize>> {
    let mut rows = Vec::new();
    let (mut start, mut column) = (0, 0);
    for (at, character) in text.char_indices() {
        let width = glyphs::columns(character);
        if column + width > COLUMNS {
            rows.push(start..at);
            if rows.len() == most {
                return rows;
            }
            (start, column) = (at, 0);
        }
        column += width;
    }
    rows.push(start..text.len());
    rows
}

/// Returns the listing of the screen that contains a position (line from 1, column from 0).
pub(crate) fn page_of(program: &Program, line: u32, column: u32) -> Listing {
    let line = line.max(program.first_listed());
    let row = listed(program, line, ';').map_or(0, |text| row_of(&text, column));
    let first = screen_start(program, line);
    let above: usize = (first..line).map(|line| rows_of(program, line)).sum();
    Listing {
        top: 1,
        rows: PAGE_ROWS,
        first,
        skip: (above + row + 1).saturating_sub(PAGE_ROWS),
    }
}

/// Returns the line to which a page key moves the cursor from `line`: the first one of the next or
/// of the previous screen. The first screen begins after the program name.
pub(crate) fn turned_page(program: &Program, line: u32, forward: bool) -> u32 {
    let (top, last) = (program.first_listed(), program.last_listed());
    let shown = screen_start(program, line.clamp(top, last));
    if forward {
        let mut others = (shown..=last).skip_while(|line| screen_start(program, *line) == shown);
        return others.next().unwrap_or(last);
    }
    match shown.checked_sub(1).filter(|above| *above >= top) {
        Some(above) => screen_start(program, above).max(top + 1),
        None => (top + 1).min(last),
    }
}

/// Returns the first line of the screen that shows a line. Screens are a fixed twelve lines; lines
/// of more than one row divide them.
fn screen_start(program: &Program, line: u32) -> u32 {
    let top = program.first_listed();
    let page = (line - top) / PAGE_ROWS as u32 * PAGE_ROWS as u32 + top;
    let (mut start, mut rows) = (page, 0);
    for each in page..=line {
        rows += rows_of(program, each);
        if rows > PAGE_ROWS && each > start {
            (start, rows) = (each, rows_of(program, each));
        }
    }
    start
}

/// Returns the number of screen rows of a line.
fn rows_of(program: &Program, line: u32) -> usize {
    listed(program, line, ';').map_or(0, |text| wrap(&text, usize::MAX).len())
}

/// Returns the screen row, from 0, of a text's character at `column` (from 0).
fn row_of(text: &str, column: u32) -> usize {
    let at = byte_of(text, column);
    wrap(text, usize::MAX)
        .iter()
        .position(|row| at < row.end)
        .unwrap_or(0)
}

/// Returns the byte offset of the character at `column` (from 0); that of the last character
/// if the text is shorter.
fn byte_of(text: &str, column: u32) -> usize {
    let mut last = 0;
    for (index, (at, _)) in text.char_indices().enumerate() {
        if index > column as usize {
            break;
        }
        last = at;
    }
    last
}

/// Draws the listing of a program with its cursor or current block.
pub fn draw(
    screen: &mut Screen,
    program: &Program,
    listing: Listing,
    mark: ListingMark,
    cnc: &Cnc,
) {
    let sign = end_of_block(cnc);
    let end = listing.top + listing.rows;
    let (mut row, mut line, mut skip) = (listing.top, listing.first.max(1), listing.skip);
    while row < end {
        let sign = if mark.leaves_open(line) { ' ' } else { sign };
        let Some(text) = listed(program, line, sign) else {
            return;
        };
        for range in wrap(&text, skip + end - row).into_iter().skip(skip) {
            draw_row(screen, row, &text, range, line, mark);
            row += 1;
        }
        skip = 0;
        line += 1;
    }
}

fn draw_row(
    screen: &mut Screen,
    row: usize,
    text: &str,
    range: Range<usize>,
    line: u32,
    mark: ListingMark,
) {
    let part = text.get(range.clone()).unwrap_or_default();
    match mark {
        ListingMark::Block(marked) if marked == line => {
            screen.put_as(row, 0, part, CellStyle::Inverse);
        }
        ListingMark::Edit {
            line: marked,
            column,
            alter,
            ..
        } if marked == line => {
            screen.put(row, 0, part);
            let at = byte_of(text, column);
            if range.contains(&at) {
                let start = glyphs::text_columns(text.get(range.start..at).unwrap_or_default());
                let width = text[at..].chars().next().map_or(1, glyphs::columns);
                let style = if alter {
                    CellStyle::Inverse
                } else {
                    CellStyle::Underline
                };
                screen.set_style(row, start..start + width, style);
            }
        }
        ListingMark::Block(_) | ListingMark::Edit { .. } => {
            screen.put(row, 0, part);
        }
    }
}

#[cfg(test)]
mod tests {
    use gsk_core::program::split_programs;

    use super::*;

    #[test]
    fn a_block_ends_with_one_sign() {
        assert_eq!(shown("G0 X1", ';'), "G0 X1;");
        assert_eq!(shown("G0 X1 ; ", ';'), "G0 X1;");
        assert_eq!(shown("G0 X1;", '*'), "G0 X1*");
        assert_eq!(shown("", ';'), ";");
        assert_eq!(shown("%", ';'), "%");
        let program = Program::new("O0001;\nM30;\n\n");
        assert_eq!(listed(&program, 3, ';').as_deref(), Some("%"));
        assert_eq!(listed(&program, 4, ';'), None);
    }

    #[test]
    fn long_blocks_wrap_and_wide_characters_stay_whole() {
        let text = "X".repeat(39) + "中文";
        let rows = wrap(&text, usize::MAX);
        assert_eq!(rows, [0..39, 39..45]);
        assert_eq!(wrap(&"Y".repeat(200), 2), [0..40, 40..80]);
        assert_eq!(row_of(&text, 39), 1);
        assert_eq!(row_of(&text, 900), 1);
    }

    #[test]
    fn pages_hold_twelve_lines() {
        let program = Program::new("G1 X1\n".repeat(30));
        assert_eq!(page_of(&program, 12, 0).first, 1);
        assert_eq!(page_of(&program, 13, 0).first, 13);
        assert_eq!(page_of(&program, 31, 0).first, 25);
    }

    #[test]
    fn page_keys_pass_over_no_line() {
        let long = "G1 X1 (".to_owned() + &"A".repeat(60) + ")\n";
        for text in [long.repeat(30), ("G1 X1\n".repeat(5) + &long).repeat(9)] {
            let program = Program::new(&*text);
            let mut line = 1;
            while line < program.last_listed() {
                let first = page_of(&program, line, 0).first;
                let next = turned_page(&program, line, true);
                let rows: usize = (first..next).map(|line| rows_of(&program, line)).sum();
                assert!(next > line && rows <= PAGE_ROWS, "{line} {next}");
                let back = turned_page(&program, next, false);
                assert!(next == program.last_listed() || back == first.max(2));
                line = next;
            }
        }
    }

    #[test]
    fn a_program_from_the_middle_of_a_file_begins_at_its_own_line() {
        let parts = split_programs("O0001;\nM30;\n\n\nO0002;\nG0 X1;\nM30;\n");
        let second = &parts[1];
        assert_eq!(page_of(second, 6, 0).first, 5);
        assert_eq!(listed(second, 7, ';').as_deref(), Some("M30;"));
    }

    #[test]
    fn wrapped_lines_never_push_the_cursor_off_the_page() {
        let long = "G1 X1 (".to_owned() + &"A".repeat(60) + ")\n";
        let program = Program::new(long.repeat(30));
        for line in 1..=30 {
            for column in [0, 50, 900] {
                let listing = page_of(&program, line, column);
                let above = (line - listing.first) as usize * 2;
                assert!(above + usize::from(column > 0) < PAGE_ROWS);
            }
        }
        let one = Program::new("A".repeat(4000));
        let listing = page_of(&one, 1, 3999);
        assert_eq!((listing.first, listing.skip), (1, 88));
    }
}
