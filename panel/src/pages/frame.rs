//! Draws the frame of every page: title and program number above, spindle, tool, state and mode
//! below (manual III-1.3).

use gsk_core::cnc::Cnc;
use gsk_core::command::ProgramId;
use gsk_core::operation::OperatingMode;
use gsk_core::program::{DncBuffer, Program};
use gsk_messages::{Message, say};

use super::format::four_digits;
use super::view::{Communication, PageView};
use crate::face::PageId;
use crate::face::{SoftAction, face_of};
use crate::glyphs;
use crate::screen::{CellStyle, Screen};

/// Screen row of the input line, and of the S and T display.
pub(crate) const INPUT_ROW: usize = 13;
/// Screen row of the run state and the operating mode, from 0.
const STATUS_ROW: usize = 14;
/// Columns of the program number and the sequence number in the title row.
const PROGRAM_COLUMN: usize = 28;
const SEQUENCE_COLUMN: usize = 34;
/// LCD column before which the input line ends.
const INPUT_END: usize = 27;

/// Columns in the status row: alarm, feed hold, mode, serial communication.
const ALARM_COLUMN: usize = 0;
const HOLD_COLUMN: usize = 5;
const MODE_COLUMN: usize = 20;
const COMMUNICATION_COLUMN: usize = 30;

/// Width of a soft key label with the space after it, and columns of state and mode on a model
/// with soft keys.
const SOFT_WIDTH: usize = 7;
const SOFT_STATE_COLUMN: usize = 36;
const SOFT_MODE_COLUMN: usize = 19;

/// Returns the name of a program with this number, as the control model writes it.
pub(super) fn program_name(cnc: &Cnc, number: u16) -> String {
    cnc.model().record().program_naming().name(number)
}

/// Draws the parts that all pages have: title, program and sequence number, spindle, tool, run
/// state, mode.
pub fn draw(screen: &mut Screen, page: PageId, view: &PageView, cnc: &Cnc) {
    screen.put_message(0, 0, &page.title());
    let name = program_name(cnc, program_number(cnc));
    screen.put(0, PROGRAM_COLUMN, &name);
    screen.put(0, SEQUENCE_COLUMN, &format!("N{:04}", sequence(view, cnc)));

    let spindle = format!("S{}", four_digits(spindle_speed(cnc)));
    screen.put(INPUT_ROW, PROGRAM_COLUMN, &spindle);
    let (tool, offset) = cnc.tool();
    let tool = format!("T{tool:02}{offset:02}");
    screen.put(INPUT_ROW, SEQUENCE_COLUMN, &tool);

    let face = face_of(cnc.model().id());
    if face.soft_keys.is_empty() {
        draw_state(screen, view, cnc);
        screen.put_message(STATUS_ROW, MODE_COLUMN, &mode_message(cnc.mode()));
        draw_communication(screen, view);
        return;
    }
    // The soft keys take the status row. Mode and state are in the title row.
    screen.put_message(0, SOFT_MODE_COLUMN, &mode_message(cnc.mode()));
    draw_soft_state(screen, view, cnc);
    if let Some(row) = face.page(page) {
        for key in face.soft_bar(row.key, view.soft_bar) {
            let column = usize::from(key.position) * SOFT_WIDTH;
            let active = matches!(key.action, SoftAction::Open(opened)
                if face.page(opened).is_some_and(|it| it.display == row.display));
            draw_soft_label(screen, column, &(key.label)(), active);
        }
    }
}

/// Draws the label of a soft key in inverse cells; plain on the page that it has opened. A bar
/// below would cover the lowest dots of a Chinese label, which fills its cells.
fn draw_soft_label(screen: &mut Screen, column: usize, label: &Message, active: bool) {
    let text = label.text(screen.language());
    let width = glyphs::text_columns(&text);
    let left = (SOFT_WIDTH - 1).saturating_sub(width) / 2;
    screen.put(STATUS_ROW, column + left, &text);
    let cells = column..column + SOFT_WIDTH - 1;
    if !active {
        screen.set_style(STATUS_ROW, cells, CellStyle::Inverse);
    }
}

/// Draws alarm, feed hold or communication at the end of the status row, after the soft keys.
fn draw_soft_state(screen: &mut Screen, view: &PageView, cnc: &Cnc) {
    let lit = view.flash_on();
    if cnc.is_shown_not_ready() || cnc.is_in_alarm() {
        screen.put_flashing_message(STATUS_ROW, SOFT_STATE_COLUMN, &say::lcd_alarm(), lit);
    } else if cnc.is_in_feed_hold() {
        screen.put_message(STATUS_ROW, SOFT_STATE_COLUMN, &say::lcd_hold());
    } else if view.communication != Communication::Idle {
        screen.put_flashing_message(
            STATUS_ROW,
            SOFT_STATE_COLUMN,
            &say::lcd_soft_transfer(),
            lit,
        );
    }
}

/// Draws alarm and feed hold in the status row. 准备未绪 replaces both 报警 and 暂停.
fn draw_state(screen: &mut Screen, view: &PageView, cnc: &Cnc) {
    let lit = view.flash_on();
    if cnc.is_shown_not_ready() {
        screen.put_flashing_message(STATUS_ROW, ALARM_COLUMN, &say::lcd_not_ready(), lit);
        return;
    }
    if cnc.is_in_alarm() {
        screen.put_flashing_message(STATUS_ROW, ALARM_COLUMN, &say::lcd_alarm(), lit);
    }
    if cnc.is_in_feed_hold() {
        screen.put_message(STATUS_ROW, HOLD_COLUMN, &say::lcd_hold());
    }
}

/// Returns the text of an operating mode for the status row.
pub fn mode_message(mode: OperatingMode) -> Message {
    match mode {
        OperatingMode::Edit => say::lcd_mode_edit(),
        OperatingMode::Auto => say::lcd_mode_auto(),
        OperatingMode::Mdi => say::lcd_mode_mdi(),
        OperatingMode::Step => say::lcd_mode_step(),
        OperatingMode::Handwheel => say::lcd_mode_handwheel(),
        OperatingMode::Jog => say::lcd_mode_jog(),
        OperatingMode::MachineZero => say::lcd_mode_machine_zero(),
        OperatingMode::ProgramZero => say::lcd_mode_program_zero(),
        OperatingMode::Dnc => say::lcd_mode_dnc(),
        OperatingMode::TeachJog => say::lcd_mode_teach_jog(),
        OperatingMode::TeachStep => say::lcd_mode_teach_step(),
        OperatingMode::TeachHandwheel => say::lcd_mode_teach_handwheel(),
    }
}

fn draw_communication(screen: &mut Screen, view: &PageView) {
    let text = match view.communication {
        Communication::Idle => return,
        Communication::Receiving => say::lcd_receiving(),
        Communication::Sending => say::lcd_sending(),
        Communication::NotConnected => say::lcd_no_port(),
        Communication::Failed => say::lcd_transfer_failed(),
    };
    let lit = view.communication != Communication::Sending || view.flash_on();
    screen.put_flashing_message(STATUS_ROW, COMMUNICATION_COLUMN, &text, lit);
}

/// Draws the input line: the prompt and, one column after it, the typed text.
pub(crate) fn input_line(screen: &mut Screen, prompt: &Message, view: &PageView) {
    let end = screen.put_message(INPUT_ROW, 0, prompt);
    keyed_in(screen, end + 1, view);
}

/// Draws the input line of a setting: `序号ISO=`, and the typed text.
pub(crate) fn setting_line(screen: &mut Screen, name: &str, view: &PageView) {
    let end = screen.put_message(INPUT_ROW, 0, &say::lcd_setting_prompt(name));
    keyed_in(screen, end, view);
}

/// Draws the typed text from a column on; of a long text its end. A trailing address letter
/// flashes until its number follows.
fn keyed_in(screen: &mut Screen, start: usize, view: &PageView) {
    let width_left = INPUT_END.saturating_sub(start);
    let length = view.input.chars().count();
    let shown: String = view
        .input
        .chars()
        .skip(length.saturating_sub(width_left))
        .collect();
    let end = screen.put(INPUT_ROW, start, &shown);
    if shown.ends_with(|last: char| last.is_ascii_alphabetic()) && !view.flash_on() {
        screen.set_style(INPUT_ROW, end - 1..end, CellStyle::Dark);
    }
}

/// Returns the text of the selected program; `None` if none is selected.
pub(crate) fn current_program(cnc: &Cnc) -> Option<&Program> {
    cnc.programs().get(selected(cnc)?)
}

/// Returns whether 012.4 PRG9 hides the selected program.
pub(crate) fn program_is_hidden(cnc: &Cnc) -> bool {
    matches!(selected(cnc), Some(ProgramId::Stored(number)) if cnc.rights().is_hidden(number))
}

/// Returns the selected program, also while an MDI block runs; `None` if none is selected.
fn selected(cnc: &Cnc) -> Option<ProgramId> {
    match cnc.cursor().program {
        Some(ProgramId::Mdi) | None => cnc.programs().selected(),
        program => program,
    }
}

fn program_number(cnc: &Cnc) -> u16 {
    match selected(cnc) {
        Some(ProgramId::Stored(number)) => number,
        Some(ProgramId::Dnc) => {
            let inflow = cnc.programs().dnc_buffer();
            inflow.and_then(DncBuffer::number).unwrap_or(0)
        }
        Some(program) => cnc
            .programs()
            .get(program)
            .and_then(Program::number)
            .unwrap_or(0),
        None => 0,
    }
}

/// Returns the sequence number of the block in execution, or of the block at the cursor.
fn sequence(view: &PageView, cnc: &Cnc) -> u32 {
    let cursor = cnc.cursor();
    if let Some(sequence) = cursor.sequence {
        return sequence;
    }
    let (program, line) = match &view.editor.editing {
        Some(editing) if cnc.mode().edits() => (Some(editing.program()), editing.cursor().0),
        _ => (current_program(cnc), cursor.line),
    };
    program
        .and_then(|program| sequence_of(program.line(line)))
        .unwrap_or(0)
}

/// Returns the number of the N word at the start of a block; `None` if it has none.
fn sequence_of(line: &str) -> Option<u32> {
    let head = line.trim_start_matches(|c: char| c == '/' || c.is_whitespace());
    let digits = head.strip_prefix(['N', 'n'])?.trim_start();
    let end = digits
        .find(|c: char| !c.is_ascii_digit())
        .unwrap_or(digits.len());
    digits[..end].parse().ok()
}

/// Returns the spindle speed to show, r/min: measured if the spindle has an encoder, otherwise
/// commanded. With stepped speeds (001.4 = 0) it is the number of the step.
pub fn spindle_speed(cnc: &Cnc) -> f64 {
    if let Some(measured) = cnc.spindle_measured() {
        return measured;
    }
    if cnc.parameters().has_analog_spindle() {
        cnc.spindle_commanded()
    } else {
        cnc.modal().spindle
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_messages::Language;

    #[test]
    fn a_mode_is_called_as_the_control_calls_it() {
        for mode in OperatingMode::ALL {
            assert_eq!(mode_message(mode).text(Language::Zh), mode.text());
        }
    }

    #[test]
    fn the_sequence_number_of_a_block() {
        assert_eq!(sequence_of("N0050 G71 U2"), Some(50));
        assert_eq!(sequence_of("  /N7G0"), Some(7));
        assert_eq!(sequence_of("G0 X1 (N5)"), None);
        assert_eq!(sequence_of("N"), None);
        assert_eq!(sequence_of("N99999999999"), None);
    }
}
