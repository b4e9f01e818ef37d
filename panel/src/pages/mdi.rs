//! Draws the MDI page: the words of a block and the modal values (manual III-2.2.2).

use gsk_core::cnc::Cnc;
use gsk_core::operation::{OperatingMode, RunState};
use gsk_core::program::{ProgramBlock, Syntax};
use gsk_messages::say;

use super::format::{CoordinateFormat, four_digits};
use super::frame;
use super::view::PageView;
use crate::screen::Screen;

/// Addresses of the words on the left side, one a screen row from row 2 on.
const WORDS: &[u8] = b"XZUWRFMSTPQ";
/// Address letters of the words that are lengths, which are shown with decimals.
const LENGTHS: &[u8] = b"XZUWR";
/// Screen row of the first word of the MDI block.
const FIRST_ROW: usize = 2;
/// Columns: address and end of the value on the left; codes, address and end of the value on
/// the right.
const WORD_COLUMN: usize = 5;
const WORD_END: usize = 18;
const CODE_COLUMN: usize = 24;
const MODAL_COLUMN: usize = 30;
const MODAL_END: usize = 39;
/// Screen row of a macro B statement, which has no words.
const STATEMENT_ROW: usize = 1;
/// Greatest spindle speed limit, r/min; the control then has no limit.
const NO_LIMIT: f64 = 9999.0;

/// Draws the MDI page: the words of the block and the modal values.
pub fn draw(screen: &mut Screen, view: &PageView, cnc: &Cnc) {
    screen.put_message(1, 4, &say::lcd_block_and_modal());
    if let Some((block, text)) = shown_block(cnc) {
        draw_words(screen, &block, &text, cnc);
    }
    for (row, address) in (FIRST_ROW..).zip(WORDS) {
        screen.put(row, WORD_COLUMN, &char::from(*address).to_string());
    }
    draw_modal(screen, cnc);
    if let Some(statement) = cnc.mdi_block().statement()
        && cnc.mode() == OperatingMode::Mdi
    {
        screen.put(STATEMENT_ROW, 0, &format!("{statement:<22}"));
    }
    if cnc.mode() == OperatingMode::Mdi {
        frame::input_line(screen, &say::lcd_address_prompt(), view);
    }
}

/// Returns the MDI block, or in AUTO the block in execution, with its text; `None` if there is
/// no such block.
fn shown_block(cnc: &Cnc) -> Option<(ProgramBlock, String)> {
    let syntax = Syntax::from(cnc.parameters());
    if !matches!(cnc.mode(), OperatingMode::Auto | OperatingMode::Dnc) {
        let block = cnc.mdi_block().block(cnc.parameters()).ok()?;
        return Some((block, cnc.mdi_block().text()));
    }
    if cnc.run_state() == RunState::Reset {
        return None;
    }
    let program = frame::current_program(cnc)?;
    let index = program.block_from_line(cnc.cursor().line);
    let block = program.parse(index, syntax).ok()?;
    Some((block, program.block(index).to_owned()))
}

fn draw_words(screen: &mut Screen, block: &ProgramBlock, text: &str, cnc: &Cnc) {
    if let Some(code) = block.g_codes().last() {
        screen.put(FIRST_ROW, 0, &format!("G{code:02}"));
    }
    let display = CoordinateFormat::of(cnc);
    for (row, address) in (FIRST_ROW..).zip(WORDS) {
        let Some(word) = block.word(*address) else {
            continue;
        };
        let keyed = || {
            let (start, end) = word.span;
            text.get(usize::from(start) + 1..usize::from(end))
                .unwrap_or_default()
                .trim()
                .to_owned()
        };
        let length = LENGTHS.contains(address) && word.value.variable().is_none();
        let value = if length {
            display.length(word.value.mm())
        } else {
            keyed()
        };
        screen.put_right(row, WORD_END, &value);
    }
}

fn draw_modal(screen: &mut Screen, cnc: &Cnc) {
    let modal = cnc.modal();
    let spindle = cnc.spindle();
    let (tool, offset) = cnc.tool();
    let surface = if modal.surface_speed { 96 } else { 97 };
    let feed = if modal.feed_per_revolution { 99 } else { 98 };
    let units = if modal.inch { 20 } else { 21 };
    let codes = [
        (3, modal.motion.number()),
        (4, surface),
        (6, modal.nose_compensation),
        (7, feed),
        (8, units),
    ];
    for (row, code) in codes {
        screen.put(row, CODE_COLUMN, &format!("G{code:02}"));
    }
    let some = |value: f64| {
        if value == 0.0 {
            String::new()
        } else {
            format!("{value}")
        }
    };
    let modals = [
        ("F", some(modal.feed)),
        ("M", modal.m.map_or(String::new(), |m| format!("{m:02}"))),
        ("S", some(modal.spindle)),
        ("T", format!("{tool:02}{offset:02}")),
    ];
    for (row, (address, value)) in (FIRST_ROW..).zip(modals) {
        screen.put(row, MODAL_COLUMN, address);
        screen.put_right(row, MODAL_END, &value);
    }
    let per_surface = if spindle.is_surface_mode() {
        spindle.s_word()
    } else {
        0.0
    };
    let speeds = [
        ("SRPM", cnc.spindle_commanded()),
        ("SSPM", per_surface),
        ("SMAX", spindle.limit().unwrap_or(NO_LIMIT)),
        ("SACT", cnc.spindle_actual()),
    ];
    for (row, (name, value)) in (9..).zip(speeds) {
        screen.put(row, CODE_COLUMN, name);
        screen.put(row, MODAL_COLUMN, &four_digits(value));
    }
}
