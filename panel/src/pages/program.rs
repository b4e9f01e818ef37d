//! Draws the program page and the directory (manual III-2.2).

use gsk_core::cnc::Cnc;
use gsk_core::operation::OperatingMode;
use gsk_messages::say;

use super::frame;
use super::program_text::{self, ListingMark};
use super::view::PageView;
use crate::face::face_of;
use crate::screen::Screen;

/// Number of programs on one screen of the directory, and in one of its rows.
pub(crate) const DIRECTORY_SCREEN: usize = 36;
const DIRECTORY_ROW: usize = 6;

/// Draws the program page: the editor in EDIT, otherwise the block in execution.
pub fn text(screen: &mut Screen, view: &PageView, cnc: &Cnc) {
    let mode = cnc.mode();
    if mode.edits() || mode == OperatingMode::Auto {
        let searching = view.editor.searching;
        let prompt = match searching {
            true => say::lcd_search_prompt(),
            false => say::lcd_address_prompt(),
        };
        frame::input_line(screen, &prompt, view);
    }
    let editing = match &view.editor.editing {
        Some(editing) if mode.edits() => Some(editing),
        _ => None,
    };
    let hidden = frame::program_is_hidden(cnc);
    let program = match editing {
        Some(editing) => Some(editing.program()),
        None => frame::current_program(cnc),
    };
    let Some(program) = program.filter(|_| !hidden) else {
        return;
    };
    let (line, column) = match editing {
        Some(editing) => editing.cursor(),
        None => (cnc.cursor().line.max(1), 0),
    };
    let mark = if mode.edits() {
        ListingMark::Edit {
            line,
            column,
            alter: view.editor.alter,
            open: editing.is_some_and(|editing| editing.open_line() == Some(line)),
        }
    } else {
        ListingMark::Block(line)
    };
    let listing = program_text::page_of(program, line, column);
    program_text::draw(screen, program, listing, mark, cnc);
}

/// Returns the number of screens of the program directory, at least 1.
pub(crate) fn directory_screens(cnc: &Cnc) -> usize {
    listed(cnc).count().div_ceil(DIRECTORY_SCREEN).max(1)
}

/// Returns the program numbers in the directory, ascending; without those that 012.4 PRG9
/// hides.
fn listed(cnc: &Cnc) -> impl Iterator<Item = u16> {
    let rights = cnc.rights();
    cnc.programs()
        .iter()
        .map(|(number, _)| number)
        .filter(move |number| !rights.is_hidden(*number))
}

/// Draws the program directory: version, memory used, and the numbers of the programs.
pub fn directory(screen: &mut Screen, view: &PageView, cnc: &Cnc) {
    let memory = cnc.programs();
    let (stored, free_programs) = (memory.count(), memory.free_count());
    let (used, free) = (memory.characters(), memory.free_characters());
    screen.put_message(
        1,
        0,
        &say::lcd_control_version(face_of(cnc.model().id()).version),
    );
    screen.put_message(2, 0, &say::lcd_programs_stored(stored, free_programs));
    screen.put_message(3, 0, &say::lcd_memory_used(used, free));
    screen.put_message(4, 0, &say::lcd_directory());
    let first = view.directory_screen % directory_screens(cnc) * DIRECTORY_SCREEN;
    for (index, number) in listed(cnc).skip(first).take(DIRECTORY_SCREEN).enumerate() {
        let (row, column) = (index / DIRECTORY_ROW, index % DIRECTORY_ROW);
        screen.put(5 + row, column * 6, &frame::program_name(cnc, number));
    }
}
