//! Draws the page of the zero offset (坐标修调): absolute and machine coordinates, work zero and
//! tool offset.

use gsk_core::cnc::Cnc;
use gsk_core::units::{Axis, Point};
use gsk_messages::{Message, say};

use crate::pages::format::CoordinateFormat;
use crate::pages::frame;
use crate::pages::view::PageView;
use crate::screen::Screen;

/// Draws the page. A typed X or Z value becomes the coordinate of the tool.
pub fn draw(screen: &mut Screen, view: &PageView, cnc: &Cnc) {
    let frame_of_work = cnc.frame();
    let groups: [(usize, usize, Message, Point); 4] = [
        (
            2,
            2,
            say::lcd_coordinates_absolute(),
            cnc.position_absolute(),
        ),
        (
            2,
            22,
            say::lcd_coordinates_machine(),
            cnc.position_machine(),
        ),
        (7, 2, say::lcd_work_zero(), frame_of_work.zero),
        (7, 22, say::lcd_tool_offset(), frame_of_work.offset),
    ];
    let display = CoordinateFormat::of(cnc);
    for (row, column, heading, at) in groups {
        screen.put_message(row, column, &heading);
        for (line, (letter, axis)) in [("X", Axis::X), ("Z", Axis::Z)].into_iter().enumerate() {
            let row = row + 1 + line;
            screen.put(row, column, letter);
            screen.put_right(row, column + 14, &display.coordinate(axis, at.get(axis)));
        }
    }
    frame::input_line(screen, &say::lcd_address_prompt(), view);
}
