//! Draws the alarm pages: messages of the machine's ladder and alarms of the control (manual
//! III-2.4).

use gsk_core::alarm::{self, Alarm, groups};
use gsk_core::cnc::Cnc;
use gsk_messages::Language;

use crate::glyphs;
use crate::screen::{COLUMNS, Screen};

/// First screen row of the list, from 0.
const FIRST_ROW: usize = 2;
const LAST_ROW: usize = 12;

/// Draws the list of active ladder messages (外部信息).
pub fn messages(screen: &mut Screen, cnc: &Cnc) {
    let english = screen.language() == Language::En;
    let messages = cnc.plc_messages().map(|(number, text)| {
        let known = alarm::row(number).filter(|_| english);
        let text = known.map_or(text, |row| row.meaning_en);
        format!("{number:04} {text}")
    });
    list(screen, messages);
}

/// Draws the list of active alarms of the control (报警信息).
pub fn alarms(screen: &mut Screen, cnc: &Cnc) {
    let language = screen.language();
    let lines = cnc.alarms().iter().map(|alarm| line(alarm, language));
    list(screen, lines);
}

fn line(alarm: &Alarm, language: Language) -> String {
    let line = match language {
        Language::En => alarm.line_text_en(),
        Language::Zh => alarm.line_text(),
    };
    match &alarm.detail {
        Some(detail) if groups::is_memory_alarm(alarm.number) => {
            format!("{line}({})", detail.text(language))
        }
        _ => line,
    }
}

/// Writes the entries below each other. An entry longer than a row continues in the next one.
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
