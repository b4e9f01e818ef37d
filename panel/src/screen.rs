//! Stores what the LCD shows: 40x15 cells of 8x16 dots, double-size texts and a 320x240 graphic
//! layer. Drawing a page resolves flashing: in the dark phase a flashing text is not drawn, but
//! stays in the text of the screen.

use gsk_messages::{Language, Message};

use crate::bitmap::Bitmap;
use crate::glyphs;

use crate::lcd::LcdColours;
pub use crate::lcd::{COLUMNS, HEIGHT, ROWS, WIDTH};

/// Character that is stored in the right half of a full-width character.
const TAIL: char = '\0';

/// The colours and underline with which a cell of the LCD is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CellStyle {
    /// The cell has pale text on blue.
    #[default]
    Plain,
    /// The cell has blue text on pale.
    Inverse,
    /// The cell has pale text on blue with a bar below.
    Underline,
    /// Keeps the character in the row's text, but draws it elsewhere at double size.
    Big,
    /// Keeps the character in the row's text, but does not draw it: the dark phase of
    /// flashing.
    Dark,
}

/// One of the 40x15 character cells of the LCD.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell {
    /// The character in the cell, or NUL in the right half of a full-width one.
    pub character: char,
    /// The colours and underline with which the cell is drawn.
    pub style: CellStyle,
}

/// A cell that contains a blank.
const BLANK: Cell = Cell {
    character: ' ',
    style: CellStyle::Plain,
};

/// A text that is drawn at double size over two rows of cells.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BigText {
    /// Upper one of the two rows that the text takes, from 0.
    pub row: usize,
    /// Column of the text's left edge, from 0. A half-width character takes two columns.
    pub column: usize,
    /// The characters that are drawn large.
    pub text: String,
}

/// The contents of the LCD at one moment.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Screen {
    cells: [[Cell; COLUMNS]; ROWS],
    big: Vec<BigText>,
    graphic: Option<Bitmap>,
    language: Language,
    colours: LcdColours,
}

impl Default for Screen {
    fn default() -> Self {
        Self::new()
    }
}

impl Screen {
    /// Creates an empty screen in Chinese.
    pub const fn new() -> Self {
        Self {
            cells: [[BLANK; COLUMNS]; ROWS],
            big: Vec::new(),
            graphic: None,
            language: Language::Zh,
            colours: LcdColours::BLUE,
        }
    }

    /// Creates an empty screen for texts in a language (184.0 CH_EN = 1: English), on an LCD
    /// with these colours.
    pub(crate) const fn in_language(language: Language, colours: LcdColours) -> Self {
        let mut screen = Self::new();
        screen.language = language;
        screen.colours = colours;
        screen
    }

    /// Returns the colours of the LCD at full brightness.
    pub const fn colours(&self) -> LcdColours {
        self.colours
    }

    /// Returns the language in which messages are written to the screen.
    pub const fn language(&self) -> Language {
        self.language
    }

    /// Writes a message in the screen's language. Returns the column after the Chinese text,
    /// for English as well, because every page has one layout.
    pub fn put_message(&mut self, row: usize, column: usize, message: &Message) -> usize {
        self.put(row, column, &message.text(self.language));
        let width = glyphs::text_columns(&message.text(Language::Zh));
        (column + width).min(COLUMNS)
    }

    /// Writes a flashing message. The row's text always contains it, but it is drawn only
    /// while `lit`.
    pub(crate) fn put_flashing_message(
        &mut self,
        row: usize,
        column: usize,
        message: &Message,
        lit: bool,
    ) {
        let style = if lit {
            CellStyle::Plain
        } else {
            CellStyle::Dark
        };
        self.put_as(row, column, &message.text(self.language), style);
    }

    /// Writes a text from cell (`row`, `column`) on, cut at the end of the row. Returns the
    /// column after the text.
    pub fn put(&mut self, row: usize, column: usize, text: &str) -> usize {
        self.put_as(row, column, text, CellStyle::Plain)
    }

    /// Writes a text in a cell style, cut at the end of the row. Returns the column after the
    /// text.
    pub(crate) fn put_as(
        &mut self,
        row: usize,
        column: usize,
        text: &str,
        style: CellStyle,
    ) -> usize {
        let mut column = column;
        for character in text.chars() {
            let character = if character.is_control() {
                ' '
            } else {
                character
            };
            let width = glyphs::columns(character);
            if row >= ROWS || column + width > COLUMNS {
                return column;
            }
            self.erase(row, column);
            self.cells[row][column] = Cell { character, style };
            if width == 2 {
                self.erase(row, column + 1);
                self.cells[row][column + 1] = Cell {
                    character: TAIL,
                    style,
                };
            }
            column += width;
        }
        column
    }

    /// Writes a text that ends before column `end`.
    pub(crate) fn put_right(&mut self, row: usize, end: usize, text: &str) {
        let width = glyphs::text_columns(text);
        self.put(row, end.saturating_sub(width), text);
    }

    /// Writes a text at `column` of the row's text and draws it at double size from cell column
    /// `drawn_at`, two rows high.
    pub(crate) fn put_big(&mut self, row: usize, column: usize, drawn_at: usize, text: &str) {
        self.put_as(row, column, text, CellStyle::Big);
        self.big.push(BigText {
            row,
            column: drawn_at,
            text: text.to_owned(),
        });
    }

    /// Changes the cell style of a range of columns in a row.
    pub(crate) fn set_style(
        &mut self,
        row: usize,
        columns: core::ops::Range<usize>,
        style: CellStyle,
    ) {
        let Some(cells) = self.cells.get_mut(row) else {
            return;
        };
        let end = columns.end.min(COLUMNS);
        for cell in cells.get_mut(columns.start..end).unwrap_or_default() {
            cell.style = style;
        }
    }

    /// Blanks a full-width character of which the cell at `column` is one half, before it is
    /// overwritten.
    fn erase(&mut self, row: usize, column: usize) {
        let cells = &mut self.cells[row];
        if cells[column].character == TAIL && column > 0 {
            cells[column - 1] = BLANK;
        }
        if column + 1 < COLUMNS && cells[column + 1].character == TAIL {
            cells[column + 1] = BLANK;
        }
        cells[column] = BLANK;
    }

    /// Returns the cell at `row` and `column`, from 0; a blank one outside the screen.
    pub fn cell(&self, row: usize, column: usize) -> Cell {
        self.cells
            .get(row)
            .and_then(|cells| cells.get(column))
            .copied()
            .unwrap_or(BLANK)
    }

    /// Returns the texts that are drawn at double size.
    pub(crate) fn big_texts(&self) -> &[BigText] {
        &self.big
    }

    /// Returns the graphic layer; `None` if nothing was drawn.
    pub const fn graphic(&self) -> Option<&Bitmap> {
        self.graphic.as_ref()
    }

    /// Returns the graphic layer for drawing, created if necessary.
    pub(crate) fn graphic_mut(&mut self) -> &mut Bitmap {
        self.graphic.get_or_insert_default()
    }

    /// Returns the text of row `row` (from 0): 40 columns, of which a full-width character
    /// takes two.
    pub fn row(&self, row: usize) -> String {
        let Some(cells) = self.cells.get(row) else {
            return String::new();
        };
        cells
            .iter()
            .map(|cell| cell.character)
            .filter(|character| *character != TAIL)
            .collect()
    }

    /// Returns the text of the screen: 15 lines of 40 columns.
    pub fn text(&self) -> String {
        let rows: Vec<String> = (0..ROWS).map(|row| self.row(row)).collect();
        rows.join("\n")
    }
}

impl core::fmt::Display for Screen {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(&self.text())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_is_forty_columns_wide() {
        let mut screen = Screen::new();
        screen.put(0, 0, "现在位置(相对坐标)");
        screen.put(1, 38, "超出");
        screen.put(2, 39, "宽");
        for row in 0..ROWS {
            assert_eq!(glyphs::text_columns(&screen.row(row)), COLUMNS);
        }
        assert_eq!(screen.text().lines().count(), ROWS);
        assert!(screen.row(1).ends_with('超'));
        assert!(screen.row(2).trim().is_empty());
    }

    #[test]
    fn writing_over_half_a_character_removes_the_other_half() {
        let mut screen = Screen::new();
        screen.put(0, 0, "报警");
        screen.put(0, 1, "X");
        assert!(screen.row(0).starts_with(" X警"));
        screen.put(0, 2, "YZ");
        assert!(screen.row(0).starts_with(" XYZ "));
        screen.put(0, 0, "暂停");
        screen.put(0, 0, "1");
        assert!(screen.row(0).starts_with("1 停"));
    }

    #[test]
    fn right_aligned_text_ends_in_front_of_its_column() {
        let mut screen = Screen::new();
        screen.put_right(3, 10, "16.000");
        assert!(screen.row(3).starts_with("    16.000 "));
    }

    #[test]
    fn outside_the_screen_nothing_happens() {
        let mut screen = Screen::new();
        screen.put(ROWS, 0, "X");
        screen.put(0, COLUMNS, "X");
        screen.set_style(ROWS, 0..4, CellStyle::Inverse);
        screen.set_style(0, 60..70, CellStyle::Inverse);
        assert_eq!(screen, Screen::new());
    }
}
