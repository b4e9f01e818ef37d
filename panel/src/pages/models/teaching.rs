//! Draws the teaching page: points that the operator moves the axes to become a program
//! (NC-B08, key 示教).

use gsk_core::cnc::Cnc;
use gsk_core::operation::OperatingMode;
use gsk_core::units::Axis;
use gsk_messages::say;

use crate::pages::format::CoordinateFormat;
use crate::pages::frame;
use crate::pages::taught::TaughtProgram;
use crate::pages::view::PageView;
use crate::screen::Screen;

/// First screen row and number of rows that show taught blocks.
const FIRST_ROW: usize = 2;
const ROWS: usize = 8;
/// Screen rows of the position, and of the words for the next point.
const POSITION_ROW: usize = 11;
const NEXT_ROW: usize = 12;

/// Returns whether the teaching page stores taught points now: the model supports it, and the
/// mode is jog, step or handwheel.
pub fn teaches(cnc: &Cnc) -> bool {
    let by_hand = matches!(
        cnc.mode(),
        OperatingMode::Jog | OperatingMode::Step | OperatingMode::Handwheel
    );
    by_hand && cnc.model().record().teaches
}

/// Draws the teaching page: taught blocks, position, and the words for the next point.
pub fn draw(screen: &mut Screen, view: &PageView, cnc: &Cnc) {
    let teaching = &view.teaching;
    let blocks = teaching.blocks();
    let first = match teaching.from_first {
        true => 0,
        false => blocks.len().saturating_sub(ROWS),
    };
    for (row, block) in (FIRST_ROW..).zip(blocks.iter().skip(first).take(ROWS)) {
        screen.put(row, 1, block);
    }
    let display = CoordinateFormat::of(cnc);
    let at = cnc.position_absolute();
    screen.put(POSITION_ROW, 1, "X");
    screen.put_right(POSITION_ROW, 12, &display.coordinate(Axis::X, at.x));
    screen.put(POSITION_ROW, 20, "Z");
    screen.put_right(POSITION_ROW, 31, &display.coordinate(Axis::Z, at.z));
    let code = if teaching.rapid { "G0" } else { "G1" };
    let TaughtProgram { program, feed, .. } = teaching;
    screen.put(NEXT_ROW, 1, &format!("P{program:04}  {code}  F{feed}"));
    if teaches(cnc) {
        frame::input_line(screen, &say::lcd_address_prompt(), view);
    } else {
        screen.put_message(frame::INPUT_ROW, 0, &say::lcd_teach_by_hand());
    }
}
