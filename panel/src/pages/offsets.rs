//! The offset pages and the macro variables (manual III-2.3).

use gsk_core::cnc::Cnc;
use gsk_core::memory::{OFFSETS, Variables};
use gsk_core::units::Axis;
use gsk_messages::say;

use super::format::Display;
use super::frame;
use super::lists::{self, Column, FIRST_ROW, HEADING_ROW, LIST_ROWS};
use super::table::PageId;
use super::view::View;
use crate::screen::Screen;

/// Variables of one screen.
const VARIABLE_SCREEN: usize = 16;
/// A variable with a value that does not fit (manual I-3.7.3.3).
const TOO_LONG: &str = "******";
/// The greatest value that fits.
const GREATEST_SHOWN: u64 = 9_999_999;

const VARIABLE_COLUMNS: [Column; 2] = [
    Column {
        cursor: 0,
        number: 1,
        value_end: 17,
    },
    Column {
        cursor: 20,
        number: 21,
        value_end: 37,
    },
];

/// 偏置.
pub fn offsets(screen: &mut Screen, view: &View, cnc: &Cnc) {
    let item = view.cursors.get(PageId::Oft).item.min(OFFSETS - 1);
    let display = Display::of(cnc);
    screen.say(HEADING_ROW, 0, &say::lcd_offset_heading());
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

/// 宏变量.
pub fn variables(screen: &mut Screen, view: &View, cnc: &Cnc) {
    let numbers: Vec<u16> = Variables::numbers().collect();
    let item = view.cursors.get(PageId::Macro).item.min(numbers.len() - 1);
    screen.say(HEADING_ROW, 0, &say::lcd_variables_heading());
    let shown = numbers
        .iter()
        .skip(item / VARIABLE_SCREEN * VARIABLE_SCREEN);
    let shown = shown.map(|number| {
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

fn relative_position(screen: &mut Screen, cnc: &Cnc) {
    let display = Display::of(cnc);
    let at = cnc.position_relative();
    screen.say(10, 0, &say::lcd_position_relative_below());
    screen.put(11, 2, "U");
    screen.put_right(11, 13, &display.coordinate(Axis::X, at.x));
    screen.put(11, 20, "W");
    screen.put_right(11, 31, &display.coordinate(Axis::Z, at.z));
}
