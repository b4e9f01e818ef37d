//! Tool tips of the panel: the legend in the other language, and the direction of an axis key
//! (WINDOW-18).

use egui::{RichText, Ui};
use gsk_help::{article, topic_at};
use gsk_host::kernel::{KeysReversed, PanelSnapshot};
use gsk_panel::keys::{Key, KeyRow, StripLamp};
use gsk_panel::screen::Screen;

use crate::input::held_keys::can_be_latched;
use crate::input::key_map::pc_name;
use gsk_messages::{Language, Message, say};

/// The direction in which an axis key moves the tool; `None` for other keys.
pub fn axis_direction(key: Key, reversed: KeysReversed) -> Option<Message> {
    let (is_positive, [minus, plus]): (bool, [fn() -> Message; 2]) = match key {
        Key::XUp => (reversed.x, [say::tip_x_minus, say::tip_x_plus]),
        Key::XDown => (!reversed.x, [say::tip_x_minus, say::tip_x_plus]),
        Key::ZLeft => (reversed.z, [say::tip_z_minus, say::tip_z_plus]),
        Key::ZRight => (!reversed.z, [say::tip_z_minus, say::tip_z_plus]),
        _ => return None,
    };
    Some(if is_positive { plus() } else { minus() })
}

/// Joins both names of a part of the panel, the one in `language` first.
fn both_names(language: Language, zh: &str, en: &str) -> String {
    match language {
        Language::Zh => format!("{zh}   {en}"),
        Language::En => format!("{en}   {zh}"),
    }
}

/// Draws the hover text of a key.
pub fn show_key_tip(ui: &mut Ui, language: Language, row: &KeyRow, reversed: KeysReversed) {
    let mut text = both_names(language, row.name_zh, row.name_en);
    if !row.pc.is_empty() {
        text = format!("{text}   [{}]", pc_name(row.pc));
    }
    ui.label(text);
    if let Some(direction) = axis_direction(row.key, reversed) {
        ui.label(RichText::new(direction.text(language)).strong());
    }
}

/// Draws the hover text of a lamp.
pub fn show_lamp_tip(ui: &mut Ui, language: Language, lamp: &StripLamp, lit: bool) {
    let state = match lit {
        true => say::window_lamp_on(),
        false => say::window_lamp_off(),
    };
    let names = both_names(language, lamp.name_zh, lamp.name_en);
    ui.label(format!("{names}   {}", state.text(language)));
    ui.weak(say::window_lamp_why().text(language));
}

/// The text of a row of the LCD without the frame and extra spaces; empty if there is only a
/// frame.
fn row_text(screen: &Screen, row: usize) -> String {
    let text = screen.row(row);
    let text = text.trim_matches(|it: char| it.is_whitespace() || it == '_' || it == '|');
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The lines of the tip of a cell of the LCD: the row in the other language, and the heading
/// of the help topic about the cell; the one in `language` comes first. Empty if the row has
/// no text.
pub fn lcd_tip(
    snapshot: &PanelSnapshot,
    row: usize,
    column: usize,
    language: Language,
) -> Vec<String> {
    let mut lines = Vec::new();
    if row_text(&snapshot.screen, row).is_empty() {
        return lines;
    }
    if let Some(translated) = &snapshot.translated {
        let [shown, other] = [&snapshot.screen, &**translated].map(|it| row_text(it, row));
        if shown != other && !other.is_empty() {
            lines.push(other);
        }
    }
    let (model, page) = (snapshot.model, snapshot.page);
    if let Some(topic) = topic_at(model, page, &snapshot.screen, row, column) {
        let heading = article(topic, language).heading;
        if !lines.contains(&heading) {
            let is_foreign = snapshot.screen.language() == language;
            lines.insert(if is_foreign { 0 } else { lines.len() }, heading);
        }
    }
    lines
}

/// Whether a long press on the key opens help. It does not for keys that are held down in
/// normal use, or that start or stop the machine.
pub const fn has_long_press_help(key: Key) -> bool {
    can_be_latched(key)
        && !matches!(
            key,
            Key::Rapid
                | Key::Reset
                | Key::Cancel
                | Key::FeedHold
                | Key::OvertravelRelease
                | Key::SpindleStop
                | Key::SpindleOverrideUp
                | Key::SpindleOverrideDown
                | Key::RapidOverrideUp
                | Key::RapidOverrideDown
                | Key::FeedOverrideUp
                | Key::FeedOverrideDown
                | Key::Up
                | Key::Down
                | Key::Left
                | Key::Right
                | Key::PageUp
                | Key::PageDown
        )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axis_keys_report_their_direction() {
        let tip = |key, x, z| {
            let direction = axis_direction(key, KeysReversed { x, z });
            direction
                .map(|direction| direction.text(Language::En))
                .unwrap_or_default()
        };
        assert!(tip(Key::XUp, false, false).starts_with("X-"));
        assert!(tip(Key::XUp, true, false).starts_with("X+"));
        assert!(tip(Key::XDown, true, false).starts_with("X-"));
        assert!(tip(Key::ZLeft, false, false).starts_with("Z-"));
        assert!(tip(Key::ZRight, false, true).starts_with("Z-"));
        assert_eq!(tip(Key::Rapid, false, false), "");
    }
}
