//! The alarm pages: messages of the machine's ladder and alarms of the control
//! (manual III-2.4).

use gsk_core::alarm::{self, Alarm};
use gsk_core::cnc::Cnc;

use crate::glyphs;
use crate::screen::{COLUMNS, Screen};

/// The rows of the list.
const FIRST_ROW: usize = 2;
const LAST_ROW: usize = 12;

/// 外部信息.
pub fn messages(screen: &mut Screen, cnc: &Cnc) {
    let english = screen.is_english();
    let messages = cnc.plc_messages().map(|(number, text)| {
        let known = alarm::row(number).filter(|_| english);
        let text = known.map_or(text, |row| row.meaning_en);
        format!("{number:04} {text}")
    });
    list(screen, messages);
}

/// 报警信息.
pub fn alarms(screen: &mut Screen, cnc: &Cnc) {
    let english = screen.is_english();
    let lines = cnc.alarms().iter().map(|alarm| line(alarm, english));
    list(screen, lines);
}

/// Alarms of the memory name what was damaged.
const MEMORY_ALARMS: [u16; 2] = [69, 101];

fn line(alarm: &Alarm, english: bool) -> String {
    let line = if english {
        alarm.line_text_en()
    } else {
        alarm.line_text()
    };
    match &alarm.detail {
        Some(detail) if MEMORY_ALARMS.contains(&alarm.number) => {
            format!("{line}({detail})")
        }
        _ => line,
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
