//! Draws the lists that pages share: numbered rows in one or two columns, a cursor before a
//! number, screens of eight or sixteen.

use crate::glyphs;
use crate::screen::{COLUMNS, Screen};

/// Number of list rows that one screen shows.
pub(crate) const LIST_ROWS: usize = 8;
/// Screen row of a list's column headings.
pub(crate) const HEADING_ROW: usize = 1;
/// Screen row of the first item of a list.
pub(crate) const FIRST_ROW: usize = 2;

/// The LCD columns of the left or right half of a list, from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ListColumns {
    /// Column in which the cursor is drawn.
    pub cursor: usize,
    /// First column of the item's number.
    pub number: usize,
    /// Column before which the item's value ends.
    pub value_end: usize,
}

/// The halves of a list of three-digit numbers or addresses with their values.
pub(crate) const NUMBERED: [ListColumns; 2] = [
    ListColumns {
        cursor: 0,
        number: 1,
        value_end: 16,
    },
    ListColumns {
        cursor: 20,
        number: 21,
        value_end: 36,
    },
];

/// An item of a list: its number as shown, and its value.
pub type ListItem = (String, String);

/// Returns the screen row of an item and its half of the list, both from 0. `index` counts
/// from the screen's first item.
fn row_and_half(index: usize) -> (usize, usize) {
    (FIRST_ROW + index % LIST_ROWS, index / LIST_ROWS)
}

/// Writes the items of one screen, the first half before the second. `cursor` is the index of
/// the item at the cursor, from 0.
pub fn draw(
    screen: &mut Screen,
    halves: &[ListColumns],
    items: impl Iterator<Item = ListItem>,
    cursor: usize,
) {
    for (index, (number, value)) in items.take(LIST_ROWS * halves.len()).enumerate() {
        let (row, half) = row_and_half(index);
        let Some(column) = halves.get(half) else {
            return;
        };
        if index == cursor {
            screen.put(row, column.cursor, "_");
        }
        screen.put(row, column.number, &number);
        screen.put_right(row, column.value_end, &value);
    }
}

/// Writes the names of eight bits in a row, bit 7 first. `name` gives the name of a bit. If
/// they do not fit in the row, the longest ones are cut.
pub(crate) fn bit_names<N: AsRef<str>>(screen: &mut Screen, row: usize, name: impl Fn(u8) -> N) {
    let names: Vec<N> = (0..8).rev().map(name).collect();
    let cut = |width: usize| {
        let cut: Vec<&str> = names
            .iter()
            .map(|name| head(name.as_ref(), width))
            .collect();
        cut.join(" ")
    };
    let text = (4..=COLUMNS)
        .rev()
        .map(cut)
        .find(|text| glyphs::text_columns(text) <= COLUMNS);
    screen.put(row, 0, &text.unwrap_or_default());
}

/// Returns the start of a text, at most `width` columns wide.
fn head(text: &str, width: usize) -> &str {
    let mut column = 0;
    for (at, character) in text.char_indices() {
        column += glyphs::columns(character);
        if column > width {
            return &text[..at];
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_cut_only_as_far_as_needed() {
        let mut screen = Screen::new();
        bit_names(&mut screen, 0, |bit| if bit == 3 { "*DECX" } else { "T01" });
        assert_eq!(
            screen.row(0).trim_end(),
            "T01 T01 T01 T01 *DECX T01 T01 T01"
        );
        bit_names(&mut screen, 0, |bit| {
            if bit == 3 { "模拟主轴" } else { "DOFSI" }
        });
        assert_eq!(
            screen.row(0).trim_end(),
            "DOFS DOFS DOFS DOFS 模拟 DOFS DOFS DOFS"
        );
    }
}
