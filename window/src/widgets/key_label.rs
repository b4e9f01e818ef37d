//! Names a panel key in a text.

use gsk_messages::{Language, add_key_names};
use gsk_panel::keys::Key;

/// Formats the Chinese legend of a key in brackets: `[X 手轮]`. In English its name precedes the
/// legend: `[Handwheel X 手轮]`. A key without Chinese has its whole legend.
pub fn key_label(key: Key, language: Language) -> String {
    let legend = key.row().legend;
    let english = |line: &str| line.len() > 1 && line.is_ascii();
    let is_ascii_only = legend.iter().all(|line| line.is_ascii());
    let lines = legend
        .iter()
        .filter(|line| is_ascii_only || !english(line))
        .map(|line| line.trim_end_matches(" //"));
    let lines: Vec<&str> = lines.collect();
    let needs_blank = lines.iter().any(|line| line.len() == 1);
    let label = format!("[{}]", lines.join(if needs_blank { " " } else { "" }));
    match language {
        Language::Zh => label,
        Language::En => add_key_names(&label).into_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_panel::keys::all_rows;

    #[test]
    fn every_chinese_legend_has_an_english_name() {
        for row in all_rows() {
            let [zh, en] = [Language::Zh, Language::En].map(|it| key_label(row.key, it));
            let is_chinese = zh.chars().any(|letter| ('一'..='鿿').contains(&letter));
            assert_eq!(is_chinese, zh != en, "{zh} {en}");
        }
        assert_eq!(key_label(Key::Reset, Language::En), "[RESET 复位]");
        assert_eq!(key_label(Key::WheelX, Language::En), "[Handwheel X 手轮]");
        assert_eq!(key_label(Key::U, Language::En), "[D U]");
    }
}
