//! Draws the parameter pages (manual III-2.6): the values, and the meaning of the one at the
//! cursor.

use gsk_core::cnc::Cnc;
use gsk_core::memory::{self, ParameterRow};
use gsk_core::units::Axis;
use gsk_messages::{Language, Message, say};

use super::format;
use super::frame;
use super::lists::{self, HEADING_ROW, ListColumns};
use super::view::PageView;
use crate::face::PageId;
use crate::glyphs;
use crate::screen::Screen;

/// Number of parameters that one screen shows.
const SCREEN: usize = 16;
/// Number of points in the pitch error table, and of those on one of its screens.
pub(crate) const PITCH_POINTS: usize = 256;
const PITCH_SCREEN: usize = 8;

/// LCD columns of a list whose values have eight binary digits.
pub const BITS: [ListColumns; 2] = [
    ListColumns {
        cursor: 0,
        number: 1,
        value_end: 15,
    },
    ListColumns {
        cursor: 20,
        number: 21,
        value_end: 35,
    },
];

/// Returns the numbers of the state parameters, ascending.
pub(crate) fn state_numbers() -> impl Iterator<Item = u16> {
    numbers(true)
}

/// Returns the numbers of the data parameters, ascending.
pub(crate) fn data_numbers() -> impl Iterator<Item = u16> {
    numbers(false)
}

fn numbers(state: bool) -> impl Iterator<Item = u16> {
    let whole = |row: &&ParameterRow| row.bit.is_none();
    memory::parameter_rows()
        .iter()
        .filter(whole)
        .filter(move |row| row.state == state)
        .map(|row| row.number)
}

/// Draws the list of state parameters (状态参数).
pub fn states(screen: &mut Screen, view: &PageView, cnc: &Cnc) {
    let cursor = view.cursors.get(PageId::ParBit);
    let values: Vec<u16> = state_numbers().collect();
    let item = cursor.item.min(values.len().saturating_sub(1));
    heading(screen);
    let shown = values.iter().skip(item / SCREEN * SCREEN);
    let shown = shown.map(|number| {
        let byte = cnc.parameters().byte(*number);
        (format!("{number:03}"), format::byte(byte))
    });
    lists::draw(screen, &BITS, shown, item % SCREEN);
    let Some(number) = values.get(item) else {
        return;
    };
    let bit = cursor.bit.min(7);
    let row = memory::parameter_row(*number, Some(bit));
    let meaning = row.map_or("", |row| meaning(screen, row));
    screen.put(10, 0, &format!("BIT{bit}:{meaning}"));
    let language = screen.language();
    lists::bit_names(screen, 11, |bit| name(*number, bit, language));
    let prompt = say::lcd_number_prompt(format!("{number:03}"));
    frame::input_line(screen, &prompt, view);
}

/// Returns the meaning of a parameter in the screen's language, short enough for its row.
pub(super) const fn meaning(screen: &Screen, row: &ParameterRow) -> &'static str {
    match screen.language() {
        Language::En if row.lcd_en.is_empty() => row.meaning_en,
        Language::En => row.lcd_en,
        Language::Zh => row.meaning_zh,
    }
}

/// Returns the short name of a parameter bit, padded to the width of the Chinese one.
fn name(number: u16, bit: u8, language: Language) -> String {
    if let Some(name) = chinese_name(number, bit) {
        let width = glyphs::text_columns(&name.text(Language::Zh));
        return match language {
            Language::Zh => name.text(language),
            Language::En => format!("{:width$}", name.text(language)),
        };
    }
    let symbol = memory::parameter_row(number, Some(bit)).map_or("", |row| row.symbol);
    if symbol.is_empty() { "**" } else { symbol }.to_owned()
}

/// Returns the short name of a bit that has a Chinese one, otherwise `None`.
fn chinese_name(number: u16, bit: u8) -> Option<Message> {
    Some(match (number, bit) {
        (1, 4) => say::lcd_bit_analog_spindle(),
        (1, 3) => say::lcd_bit_handwheel(),
        (1, 2) => say::lcd_bit_radius(),
        (2, 1) => say::lcd_bit_nose_radius(),
        (3, 5) => say::lcd_bit_pitch_errors(),
        (3, 4) => say::lcd_bit_offset_mode(),
        _ => return None,
    })
}

/// Draws the list of data parameters (数据参数).
pub fn data(screen: &mut Screen, view: &PageView, cnc: &Cnc) {
    let values: Vec<u16> = data_numbers().collect();
    let item = view.cursors.get(PageId::ParData).item;
    let item = item.min(values.len().saturating_sub(1));
    heading(screen);
    let shown = values.iter().skip(item / SCREEN * SCREEN);
    let shown = shown.map(|number| {
        let value = cnc.parameters().value(*number);
        (format!("{number:03}"), value.to_string())
    });
    lists::draw(screen, &lists::NUMBERED, shown, item % SCREEN);
    let Some(number) = values.get(item) else {
        return;
    };
    if let Some(row) = memory::parameter_row(*number, None) {
        let meaning = meaning(screen, row);
        screen.put(10, 0, meaning);
    }
    let prompt = say::lcd_number_prompt(format!("{number:03}"));
    frame::input_line(screen, &prompt, view);
}

fn heading(screen: &mut Screen) {
    screen.put_message(HEADING_ROW, 0, &say::lcd_parameters_heading());
}

/// Draws the list of the pitch error table (螺距补偿参数).
pub fn pitch(screen: &mut Screen, view: &PageView, cnc: &Cnc) {
    let item = view.cursors.get(PageId::Pitch).item.min(PITCH_POINTS - 1);
    screen.put_message(HEADING_ROW, 0, &say::lcd_pitch_heading());
    let first = item / PITCH_SCREEN * PITCH_SCREEN;
    let points = (first..PITCH_POINTS).take(PITCH_SCREEN);
    for (row, point) in (lists::FIRST_ROW..).zip(points) {
        if point == item {
            screen.put(row, 0, "_");
        }
        screen.put(row, 1, &format!("{point:03}"));
        for (end, axis) in [(15, Axis::X), (29, Axis::Z)] {
            let value = cnc.pitch().value(axis, point as u8);
            screen.put_right(row, end, &value.to_string());
        }
    }
    let prompt = say::lcd_number_prompt(format!("{item:03}"));
    frame::input_line(screen, &prompt, view);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lcd::LcdColours;
    use crate::screen::COLUMNS;

    /// The Chinese texts are the manual's; three of them are longer than the row.
    #[test]
    fn every_english_meaning_fits_into_its_row() {
        let screen = Screen::in_language(Language::En, LcdColours::BLUE);
        for row in memory::parameter_rows() {
            let prefix = match (row.bit, row.state) {
                (Some(_), _) => "BITn:",
                (None, false) => "",
                // The page shows the bits of this row, one at a time.
                (None, true) => continue,
            };
            let text = format!("{prefix}{}", meaning(&screen, row));
            let width = glyphs::text_columns(&text);
            assert!(width <= COLUMNS, "{}: {text}", row.number);
        }
    }

    #[test]
    fn the_chinese_names_of_bits_are_those_of_the_table() {
        for row in memory::parameter_rows() {
            let Some(bit) = row.bit else { continue };
            let name = chinese_name(row.number, bit).map(|name| name.text(Language::Zh));
            let symbol = Some(row.symbol).filter(|symbol| !symbol.is_ascii());
            assert_eq!(name.as_deref(), symbol, "{}.{bit}", row.number);
        }
    }
}
