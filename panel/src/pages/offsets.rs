//! The offset pages and the macro variables (manual III-2.3).

use gsk_core::cnc::Cnc;
use gsk_core::memory::{OFFSETS, Variables};
use gsk_core::units::Axis;

use super::format::Display;
use super::frame;
use super::lists::{self, Column, FIRST_ROW, HEADING_ROW, LIST_ROWS};
use super::table::PageId;
use super::view::View;
use crate::screen::Screen;

/// Variables of one screen.
const VARIABLE_SCREEN: usize = 16;
/// A variable without a value, or with one that does not fit.
const VACANT: &str = "******";
/// The greatest value that fits.
const GREATEST_SHOWN: u64 = 99_999_999;

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
    screen.put(HEADING_ROW, 0, "序号       X        Z        R      T");
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
    frame::input_line(screen, "地址 ", view);
}

/// 宏变量.
pub fn variables(screen: &mut Screen, view: &View, cnc: &Cnc) {
    let numbers: Vec<u16> = Variables::numbers().collect();
    let item = view.cursors.get(PageId::Macro).item.min(numbers.len() - 1);
    screen.put(HEADING_ROW, 0, "序号      数 据     序号      数 据");
    let shown = numbers
        .iter()
        .skip(item / VARIABLE_SCREEN * VARIABLE_SCREEN);
    let shown = shown.map(|number| {
        let value = cnc.variables().get(*number);
        let value = value.filter(|value| value.unsigned_abs() <= GREATEST_SHOWN);
        let value = value.map_or_else(|| VACANT.to_owned(), |value| value.to_string());
        (number.to_string(), value)
    });
    lists::draw(screen, &VARIABLE_COLUMNS, shown, item % VARIABLE_SCREEN);
    relative_position(screen, cnc);
    frame::input_line(screen, "地址 ", view);
}

fn relative_position(screen: &mut Screen, cnc: &Cnc) {
    let display = Display::of(cnc);
    let at = cnc.position_relative();
    screen.put(10, 0, "现在位置(相对位置)");
    screen.put(11, 2, "U");
    screen.put_right(11, 13, &display.coordinate(Axis::X, at.x));
    screen.put(11, 20, "W");
    screen.put_right(11, 31, &display.coordinate(Axis::Z, at.z));
}
