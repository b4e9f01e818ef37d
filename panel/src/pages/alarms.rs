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

/// Writes the entries below each other. An entry longer than a row continues in the next one, an
/// English one with a whole word.
fn list(screen: &mut Screen, entries: impl Iterator<Item = String>) {
    let mut row = FIRST_ROW;
    for entry in entries {
        let mut rest = entry.as_str();
        while !rest.is_empty() {
            if row > LAST_ROW {
                return;
            }
            let (shown, next) = rest.split_at(row_end(rest));
            screen.put(row, 0, shown);
            rest = next.trim_start();
            row += 1;
        }
    }
}

/// Returns the length of the part of a text that fits into a row, bytes.
fn row_end(text: &str) -> usize {
    let mut column = 0;
    let beyond = text.char_indices().find(|(_, character)| {
        column += glyphs::columns(*character);
        column > COLUMNS
    });
    let Some((end, next)) = beyond else {
        return text.len();
    };
    let breaks_word = next.is_ascii_alphanumeric();
    let word = text[..end].rfind(' ').filter(|at| breaks_word && *at > 0);
    word.map_or(end, |at| at + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_english_alarm_continues_with_a_whole_word() {
        let text = "E207: Overtravel switch or emergency stop";
        assert_eq!(&text[row_end(text)..], "stop");
        let fits = "207: Overtravel switch or emergency stop";
        assert_eq!(row_end(fits), fits.len());
        let chinese = "超程".repeat(11);
        assert_eq!(row_end(&chinese), 60);
        // A word longer than a row is broken.
        assert_eq!(row_end(&"x".repeat(50)), COLUMNS);
    }
}
