//! The alarm pages: messages of the machine's ladder and alarms of the control
//! (manual III-2.4).

use gsk_core::alarm::Alarm;
use gsk_core::cnc::Cnc;

use crate::glyphs;
use crate::screen::{COLUMNS, Screen};

/// The rows of the list.
const FIRST_ROW: usize = 2;
const LAST_ROW: usize = 12;

/// 外部信息.
pub fn messages(screen: &mut Screen, cnc: &Cnc) {
    list(
        screen,
        cnc.plc_messages()
            .map(|(number, text)| format!("{number:04} {text}")),
    );
}

/// 报警信息.
pub fn alarms(screen: &mut Screen, cnc: &Cnc) {
    list(screen, cnc.alarms().iter().map(line));
}

/// Alarms of the memory name what was damaged.
const MEMORY_ALARMS: [u16; 2] = [69, 101];

fn line(alarm: &Alarm) -> String {
    match &alarm.detail {
        Some(detail) if MEMORY_ALARMS.contains(&alarm.number) => {
            format!("{}({detail})", alarm.line_text())
        }
        _ => alarm.line_text(),
    }
}

/// One entry after the other; a long one goes on in the next row.
fn list(screen: &mut Screen, entries: impl Iterator<Item = String>) {
    let mut row = FIRST_ROW;
    for entry in entries {
        let mut column = 0;
        for character in entry.chars() {
            if column + glyphs::columns(character) > COLUMNS {
                (row, column) = (row + 1, 0);
            }
            if row > LAST_ROW {
                return;
            }
            column = screen.put(row, column, character.encode_utf8(&mut [0; 4]));
        }
        row += 1;
        if row > LAST_ROW {
            return;
        }
    }
}
