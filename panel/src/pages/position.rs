//! Draws the four position pages (manual III-2.1).

use gsk_core::cnc::Cnc;
use gsk_core::operation::OperatingMode;
use gsk_core::units::{Axis, Point};
use gsk_messages::{Message, say};

use super::format::{self, CoordinateFormat};
use super::frame;
use super::program_text::{self, Listing};
use super::view::PageView;
use crate::face::face_of;
use crate::screen::{CellStyle, Screen};

/// Screen rows of the large coordinates of X and Z.
const BIG_ROWS: [usize; 2] = [3, 6];
/// Columns of the big letters, and end columns of the big figures: in the row's text, and on
/// the picture.
const BIG_LETTER: (usize, usize) = (4, 4);
const BIG_FIGURE_END: (usize, usize) = (24, 34);

/// Draws the page of relative coordinates (U and W) in big figures.
pub fn relative(screen: &mut Screen, view: &PageView, cnc: &Cnc) {
    big_figures(screen, ["U", "W"], cnc.position_relative(), view, cnc);
    state_rows(screen, view, cnc);
}

/// Draws the page of absolute coordinates (X and Z) in big figures.
pub fn absolute(screen: &mut Screen, view: &PageView, cnc: &Cnc) {
    big_figures(screen, ["X", "Z"], cnc.position_absolute(), view, cnc);
    state_rows(screen, view, cnc);
}

fn big_figures(screen: &mut Screen, letters: [&str; 2], at: Point, view: &PageView, cnc: &Cnc) {
    let display = CoordinateFormat::of(cnc);
    for ((letter, row), axis) in letters.into_iter().zip(BIG_ROWS).zip([Axis::X, Axis::Z]) {
        let flashes = view.flashing == Some(axis) && letters == ["U", "W"];
        if flashes && !view.flash_on() {
            screen.put_as(row, BIG_LETTER.0, letter, CellStyle::Dark);
        } else {
            screen.put_big(row, BIG_LETTER.0, BIG_LETTER.1, letter);
        }
        let figure = display.coordinate(axis, at.get(axis));
        let (text_end, drawn_end) = BIG_FIGURE_END;
        let text_at = text_end.saturating_sub(figure.len());
        let drawn_at = drawn_end.saturating_sub(2 * figure.len());
        screen.put_big(row, text_at, drawn_at, &figure);
    }
}

/// Draws rates, overrides, G codes, part count and cutting time.
fn state_rows(screen: &mut Screen, view: &PageView, cnc: &Cnc) {
    let modal = cnc.modal();
    let (programmed_label, programmed) = first_rate(cnc);
    let override_row = if view.spindle_override {
        (
            say::lcd_spindle_override(),
            format!("{}%", cnc.spindle_override()),
        )
    } else {
        (
            say::lcd_rapid_override(),
            format::rapid_override(cnc.rapid_override()),
        )
    };
    let left = [
        (programmed_label, programmed),
        (say::lcd_actual_rate(), actual_rate(cnc)),
        (
            say::lcd_feed_override(),
            format!("{}%", cnc.feed_override()),
        ),
        override_row,
    ];
    for (row, (label, value)) in (10..).zip(left) {
        screen.put_message(row, 0, &label);
        screen.put_right(row, 17, &value);
    }
    let group_3 = if modal.feed_per_revolution { 99 } else { 98 };
    screen.put_message(10, 20, &say::lcd_g_codes(modal.motion.number(), group_3));
    let counters = cnc.counters();
    screen.put_message(11, 20, &say::lcd_parts());
    screen.put_right(11, 36, &counters.parts.to_string());
    screen.put_message(12, 20, &say::lcd_cutting_time());
    screen.put(12, 30, &format::clock(counters.cutting_ms));
}

/// Returns label and value of the first rate row: jog rate, increment or programmed rate, by
/// mode.
fn first_rate(cnc: &Cnc) -> (Message, String) {
    match cnc.mode().motion_mode() {
        OperatingMode::Jog => (say::lcd_jog_rate(), format::jog_rate(cnc.jog_rate())),
        OperatingMode::Step => (say::lcd_step_size(), increment(cnc)),
        OperatingMode::Handwheel => (say::lcd_handwheel_step(), increment(cnc)),
        _ => (say::lcd_programmed_rate(), feed(cnc, 1.0)),
    }
}

/// Returns the increment of step and handwheel, mm, that the ladder selects with MP1 and MP2
/// (G19.4, G19.5).
fn increment(cnc: &Cnc) -> String {
    const INCREMENTS: [&str; 4] = ["0.001", "0.01", "0.1", "1"];
    let code = cnc.plc().memory().g(19) >> 4 & 0b11;
    INCREMENTS[usize::from(code)].to_owned()
}

/// Returns the actual rate: F with the feed override; in manual modes the speed of motion.
fn actual_rate(cnc: &Cnc) -> String {
    match cnc.mode().motion_mode() {
        OperatingMode::Jog | OperatingMode::Step | OperatingMode::Handwheel => {
            format!("{:.0}", cnc.feed_actual())
        }
        _ => {
            let factor = if cnc.modal().motion.is_thread() {
                1.0
            } else {
                cnc.feed_override_factor()
            };
            feed(cnc, factor)
        }
    }
}

fn feed(cnc: &Cnc, factor: f64) -> String {
    let rate = cnc.feed_commanded();
    if cnc.modal().motion.is_thread() {
        format::per_revolution(cnc.thread_lead())
    } else if cnc.modal().feed_per_revolution {
        format::per_revolution(rate * factor)
    } else {
        format::per_minute(rate * factor)
    }
}

/// Draws the page of all coordinates: relative, absolute, machine, and distance to go.
pub(crate) fn overall(screen: &mut Screen, cnc: &Cnc) {
    group(screen, 2, 2, RELATIVE, cnc.position_relative(), cnc);
    group(screen, 2, 22, ABSOLUTE, cnc.position_absolute(), cnc);
    group(screen, 7, 2, MACHINE, cnc.position_machine(), cnc);
    if cnc.mode().runs_programs() {
        group(screen, 7, 22, remaining(cnc), cnc.distance_to_go(), cnc);
        if let Some(seconds) = cnc.displayed_dwell_s() {
            screen.put_right(8, 36, &format!("{seconds:.3}"));
        }
    }
}

/// The heading of a group of coordinates, and the letters of its two axes.
type Heading = (fn() -> Message, [&'static str; 2]);
const RELATIVE: Heading = (say::lcd_coordinates_relative, ["U", "W"]);
const ABSOLUTE: Heading = (say::lcd_coordinates_absolute, ["X", "Z"]);
const MACHINE: Heading = (say::lcd_coordinates_machine, ["X", "Z"]);

/// The group of distances to go, with the heading of the control model.
fn remaining(cnc: &Cnc) -> Heading {
    (face_of(cnc.model().id()).to_go, ["X", "Z"])
}

fn group(screen: &mut Screen, row: usize, column: usize, what: Heading, at: Point, cnc: &Cnc) {
    let (heading, letters) = what;
    let display = CoordinateFormat::of(cnc);
    screen.put_message(row, column, &heading());
    for ((row, letter), axis) in (row + 1..).zip(letters).zip([Axis::X, Axis::Z]) {
        screen.put(row, column, letter);
        screen.put_right(row, column + 14, &display.coordinate(axis, at.get(axis)));
    }
}

/// Draws the page of coordinates and program. With 180.0 SPOS it shows the distance to go
/// instead of the relative coordinates.
pub fn with_program(screen: &mut Screen, cnc: &Cnc) {
    let (what, at) = if cnc.parameters().shows_remaining() {
        (remaining(cnc), cnc.distance_to_go())
    } else {
        (RELATIVE, cnc.position_relative())
    };
    group(screen, 1, 2, what, at, cnc);
    group(screen, 1, 22, ABSOLUTE, cnc.position_absolute(), cnc);
    let program = frame::current_program(cnc).filter(|_| !frame::program_is_hidden(cnc));
    let Some(program) = program else {
        return;
    };
    let line = cnc.cursor().line.max(1);
    let listing = Listing {
        top: 5,
        rows: 8,
        first: line,
        skip: 0,
    };
    program_text::draw(
        screen,
        program,
        listing,
        program_text::ListingMark::Block(line),
        cnc,
    );
}
