//! Finds the topic at a position on the LCD.

mod field;
mod program;

use gsk_core::model::ModelId;
use gsk_panel::lcd::COLUMNS;
use gsk_panel::pages::PageId;
use gsk_panel::screen::Screen;

use crate::models::topic_of;
use crate::subject::Subject;
use crate::table::{Topic, topic};

pub use program::address_topic;

/// Number of bits of a byte, and of digits of a state parameter.
const BITS: usize = 8;

/// Returns the model's topic about the word or field at a row and column of a page, from 0. If
/// there is none, returns the topic about the page, or `None` without one.
pub fn topic_at(
    model: ModelId,
    page: PageId,
    screen: &Screen,
    row: usize,
    column: usize,
) -> Option<&'static Topic> {
    let listed = LIST_ROWS.contains(&row);
    let pointed = match page {
        PageId::ParBit | PageId::ParData if listed => parameter(screen, row, column),
        PageId::Dgn if listed => diagnosis(screen, row, column),
        PageId::PlcBits if listed => signal(screen, row, column),
        PageId::Alm | PageId::Msg => alarm(screen, row),
        _ => None,
    };
    pointed
        .or_else(|| program::word_topic(model, page, screen, row, column))
        .or_else(|| field::field_topic(page, screen, row, column))
        .or_else(|| topic_of(model, Subject::Page(page.name())))
}

/// A word on the LCD with its first column, from 0.
struct Word {
    at: usize,
    text: String,
}

/// Returns the words in a range of columns of an LCD row. A wide character takes two columns.
fn words(screen: &Screen, row: usize, columns: core::ops::Range<usize>) -> Vec<Word> {
    let mut words: Vec<Word> = Vec::new();
    let mut inside = false;
    for column in columns {
        match screen.cell(row, column).character {
            // The second half of a wide character.
            '\0' => {}
            ' ' | '_' => inside = false,
            character if inside => {
                if let Some(word) = words.last_mut() {
                    word.text.push(character);
                }
            }
            character => {
                inside = true;
                words.push(Word {
                    at: column,
                    text: character.to_string(),
                });
            }
        }
    }
    words
}

/// Returns the columns of the list that contains `column`. A list page has a left and a right
/// list.
fn list_half(column: usize) -> core::ops::Range<usize> {
    let middle = COLUMNS / 2;
    match column < middle {
        true => 0..middle,
        false => middle..COLUMNS,
    }
}

/// Returns the first word of the list entry at a column. If the column is in the entry's eight
/// binary digits, also returns their bit. `None` if there is no entry.
fn list_entry(screen: &Screen, row: usize, column: usize) -> Option<(String, Option<u8>)> {
    let mut words = words(screen, row, list_half(column)).into_iter();
    let name = words.next()?;
    let bit = words.next().and_then(|digits| {
        let of_bits =
            digits.text.len() == BITS && digits.text.bytes().all(|it| b"01".contains(&it));
        let from_left = column.checked_sub(digits.at)?;
        (of_bits && from_left < BITS).then(|| (BITS - 1 - from_left) as u8)
    });
    Some((name.text, bit))
}

/// Returns the number selected in the list, and the bit whose name is at a column of a row
/// with the names of eight bits. `None` if the row is no such row.
fn named_bit(screen: &Screen, row: usize, column: usize) -> Option<(String, u8)> {
    let names = words(screen, row, 0..COLUMNS);
    if names.len() != BITS {
        return None;
    }
    let from_left = names.iter().rposition(|word| word.at <= column)?;
    // 序号 004
    let mut chosen = words(screen, SELECTED_ROW, 0..COLUMNS / 2).into_iter();
    let number = chosen.nth(1)?.text;
    Some((number, (BITS - 1 - from_left) as u8))
}

/// LCD row, from 0, that shows the number selected in a list.
const SELECTED_ROW: usize = 13;
/// LCD rows, from 0, of the lists and of the description of the selected number.
const LIST_ROWS: core::ops::RangeInclusive<usize> = 2..=12;
/// First LCD row, from 0, of the description of the selected number.
const DESCRIPTION_ROW: usize = 10;

/// Returns the number selected in a list, and its bit if the description begins with one
/// (`BIT3: …`). Returns `None` if `row` is above the description.
fn selected_entry(screen: &Screen, row: usize) -> Option<(String, Option<u8>)> {
    if row < DESCRIPTION_ROW {
        return None;
    }
    let number = words(screen, SELECTED_ROW, 0..COLUMNS / 2)
        .into_iter()
        .nth(1)?
        .text;
    let named = words(screen, DESCRIPTION_ROW, 0..COLUMNS)
        .into_iter()
        .next();
    let bit = named.and_then(|word| {
        let word = word.text.to_ascii_uppercase();
        let digit = word.strip_prefix("BIT")?.bytes().next()?;
        (b'0'..=b'7').contains(&digit).then(|| digit - b'0')
    });
    Some((number, bit))
}

fn parameter(screen: &Screen, row: usize, column: usize) -> Option<&'static Topic> {
    let (number, bit) = match named_bit(screen, row, column) {
        Some((number, bit)) => (number, Some(bit)),
        None => selected_entry(screen, row).or_else(|| list_entry(screen, row, column))?,
    };
    let number = number.parse().ok()?;
    bit.and_then(|bit| topic(Subject::Bit(number, bit)))
        .or_else(|| topic(Subject::Parameter(number)))
}

fn diagnosis(screen: &Screen, row: usize, column: usize) -> Option<&'static Topic> {
    let (number, _) = selected_entry(screen, row).or_else(|| list_entry(screen, row, column))?;
    topic(Subject::Diagnosis(number.parse().ok()?))
}

fn signal(screen: &Screen, row: usize, column: usize) -> Option<&'static Topic> {
    let (byte, bit) = match named_bit(screen, row, column) {
        Some((byte, bit)) => (byte, bit),
        None => {
            let (byte, bit) =
                selected_entry(screen, row).or_else(|| list_entry(screen, row, column))?;
            (byte, bit?)
        }
    };
    let (area, number) = byte.split_at_checked(1)?;
    let number: u16 = number.parse().ok()?;
    topic(Subject::Signal(&format!("{area}{number}.{bit}")))
}

/// Returns the topic of the alarm that a row shows: `P/S 013: …`, `207: …`, `1016 …`. `None`
/// if the row shows no known alarm.
fn alarm(screen: &Screen, row: usize) -> Option<&'static Topic> {
    let words = words(screen, row, 0..COLUMNS);
    let number = words.iter().take(2).find_map(|word| {
        let digits = word.text.split(':').next()?;
        digits.parse().ok()
    })?;
    let row = gsk_core::alarm::row(number)?;
    topic(Subject::Alarm(row.number))
}
