//! Draws the pages of offsets and macro variables (manual III-2.3).

use gsk_core::cnc::Cnc;
use gsk_core::memory::OFFSET_ROWS;
use gsk_core::units::Axis;
use gsk_messages::say;

use super::format::CoordinateFormat;
use super::frame;
use super::lists::{self, FIRST_ROW, HEADING_ROW, LIST_ROWS, ListColumns};
use super::view::PageView;
use crate::face::PageId;
use crate::screen::Screen;

/// Number of macro variables that one screen shows.
const VARIABLE_SCREEN: usize = 16;
/// The text instead of a value with too many digits (manual I-3.7.3.3).
const TOO_LONG: &str = "******";
/// Greatest absolute value of an integer variable that the page can show.
const GREATEST_SHOWN: u64 = 9_999_999;

/// Least and greatest absolute values of a real variable that are shown.
const LEAST_REAL: f64 = 0.000_000_1;
const GREATEST_REAL: f64 = 99_999_999.0;

const VARIABLE_COLUMNS: [ListColumns; 2] = [
    ListColumns {
        cursor: 0,
        number: 1,
        value_end: 17,
    },
    ListColumns {
        cursor: 20,
        number: 21,
        value_end: 37,
    },
];

/// Draws the list of tool offsets (偏置).
pub fn offsets(screen: &mut Screen, view: &PageView, cnc: &Cnc) {
    let item = view.cursors.get(PageId::Oft).item.min(OFFSET_ROWS - 1);
    let display = CoordinateFormat::of(cnc);
    screen.put_message(HEADING_ROW, 0, &say::lcd_offset_heading());
    let first = item / LIST_ROWS * LIST_ROWS;
    let rows = cnc.offsets().iter().skip(first).take(LIST_ROWS);
    for (row, (number, offset)) in (FIRST_ROW..).zip(rows) {
        if usize::from(number) == item {
            screen.put(row, 0, "_");
        }
        screen.put(row, 1, &format!("{number:03}"));
        for (end, value) in [(14, offset.x), (23, offset.z), (32, offset.r)] {
            screen.put_right(row, end, &display.length(value));
        }
        screen.put_right(row, 37, &offset.t.to_string());
    }
    relative_position(screen, cnc);
    frame::input_line(screen, &say::lcd_address_prompt(), view);
}

/// Draws the list of macro variables (宏变量).
pub fn variables(screen: &mut Screen, view: &PageView, cnc: &Cnc) {
    let numbers = cnc.variable_numbers();
    let real = cnc.are_variables_real();
    let item = view.cursors.get(PageId::Macro).item.min(numbers.len() - 1);
    screen.put_message(HEADING_ROW, 0, &say::lcd_variables_heading());
    let shown = numbers
        .iter()
        .skip(item / VARIABLE_SCREEN * VARIABLE_SCREEN);
    let shown = shown.map(|number| {
        if real {
            return (number.to_string(), real_value(cnc.real_variable(*number)));
        }
        let value = cnc.variables().get(*number).unwrap_or(0);
        let text = if value.unsigned_abs() <= GREATEST_SHOWN {
            value.to_string()
        } else {
            TOO_LONG.to_owned()
        };
        (number.to_string(), text)
    });
    lists::draw(screen, &VARIABLE_COLUMNS, shown, item % VARIABLE_SCREEN);
    relative_position(screen, cnc);
    frame::input_line(screen, &say::lcd_address_prompt(), view);
}

/// Formats a real variable with eight digits. `None` (null) is blank, and a value with too
/// many digits is stars (manual of macro B, 2.3).
fn real_value(value: Option<f64>) -> String {
    /// Number of significant digits that a variable stores.
    const DIGITS: i32 = 8;
    const STARS: &str = "********";
    let Some(value) = value else {
        return String::new();
    };
    let size = value.abs();
    if value == 0.0 {
        return "0".to_owned();
    }
    if !(LEAST_REAL..=GREATEST_REAL).contains(&size) {
        return STARS.to_owned();
    }
    let before = (1..DIGITS).take_while(|decimals| size >= 10_f64.powi(*decimals));
    let decimals = DIGITS - 1 - before.count() as i32;
    let text = format!("{value:.0$}", decimals.unsigned_abs() as usize);
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

fn relative_position(screen: &mut Screen, cnc: &Cnc) {
    let display = CoordinateFormat::of(cnc);
    let at = cnc.position_relative();
    screen.put_message(10, 0, &say::lcd_position_relative_below());
    screen.put(11, 2, "U");
    screen.put_right(11, 13, &display.coordinate(Axis::X, at.x));
    screen.put(11, 20, "W");
    screen.put_right(11, 31, &display.coordinate(Axis::Z, at.z));
}

#[cfg(test)]
mod tests {
    use super::real_value;

    #[test]
    fn real_values_keep_eight_digits() {
        for (value, shown) in [
            (None, ""),
            (Some(0.0), "0"),
            (Some(-0.5), "-0.5"),
            (Some(12.345_678), "12.345678"),
            (Some(1234.5), "1234.5"),
            (Some(99_999_999.0), "99999999"),
            (Some(-10_000_000.0), "-10000000"),
            (Some(0.000_000_1), "0.0000001"),
            (Some(100_000_000.0), "********"),
            (Some(0.000_000_05), "********"),
        ] {
            assert_eq!(real_value(value), shown);
        }
    }
}
