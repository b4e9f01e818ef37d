//! The program page and the directory (manual III-2.2).

use gsk_core::cnc::Cnc;
use gsk_core::operation::Mode;

use super::frame;
use super::program_text::{self, Mark};
use super::view::View;
use crate::screen::Screen;

/// Programs of one screen of the directory, and of one of its rows.
pub const DIRECTORY_SCREEN: usize = 36;
const DIRECTORY_ROW: usize = 6;
/// The version string the directory shows.
const VERSION: &str = "Gsk-980TD V05.05.12";

/// The program page: editor in EDIT, else the block in execution.
pub fn text(screen: &mut Screen, view: &View, cnc: &Cnc) {
    let mode = cnc.mode();
    if matches!(mode, Mode::Edit | Mode::Auto) {
        let searching = view.editor.searching;
        let prompt = if searching { "检索 " } else { "地址 " };
        frame::input_line(screen, prompt, view);
    }
    let editing = match &view.editor.editing {
        Some(editing) if mode == Mode::Edit => Some(editing),
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
    let mark = if mode == Mode::Edit {
        Mark::Edit {
            line,
            column,
            alter: view.editor.alter,
            open: editing.is_some_and(|editing| editing.open_line() == Some(line)),
        }
    } else {
        Mark::Block(line)
    };
    let listing = program_text::page_of(program, line, column);
    program_text::draw(screen, program, listing, mark, cnc);
}

/// How many screens the directory has.
pub fn directory_screens(cnc: &Cnc) -> usize {
    listed(cnc).count().div_ceil(DIRECTORY_SCREEN).max(1)
}

/// The numbers the directory lists, ascending.
fn listed(cnc: &Cnc) -> impl Iterator<Item = u16> {
    let rights = cnc.rights();
    cnc.programs()
        .iter()
        .map(|(number, _)| number)
        .filter(move |number| !rights.hides(*number))
}

/// The directory.
pub fn directory(screen: &mut Screen, view: &View, cnc: &Cnc) {
    let memory = cnc.programs();
    let (stored, room) = (memory.count(), memory.free_count());
    let (used, free) = (memory.characters(), memory.free_characters());
    screen.put(1, 0, &format!("系统版本号: {VERSION}"));
    screen.put(2, 0, &format!("已存程序数: {stored:04}  剩余: {room:04}"));
    screen.put(3, 0, &format!("已用存储量: {used}  剩余: {free}"));
    screen.put(4, 0, "程序目录表:");
    let first = view.directory_screen % directory_screens(cnc) * DIRECTORY_SCREEN;
    for (index, number) in listed(cnc).skip(first).take(DIRECTORY_SCREEN).enumerate() {
        let (row, column) = (index / DIRECTORY_ROW, index % DIRECTORY_ROW);
        screen.put(5 + row, column * 6, &format!("O{number:04}"));
    }
}
