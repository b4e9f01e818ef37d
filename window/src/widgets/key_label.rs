//! Names a panel key in a text.

use gsk_core::model::ModelId;
use gsk_messages::{Language, add_key_names};
use gsk_panel::face::face_of;
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

/// Formats the legend of a key of a control model as [`key_label`] does. A key that only this model
/// has, or that has another legend on it, is named by its legend: `[PRGRM 程序]` on the Huaxing.
pub fn key_label_on(model: ModelId, key: Key, language: Language) -> String {
    let face = face_of(model);
    let is_own = face_of(ModelId::Gsk980td).key(key).is_none()
        || face.printed.iter().any(|row| row.key == key);
    let Some(row) = face.key(key).filter(|_| is_own) else {
        return key_label(key, language);
    };
    let is_english = |line: &&&str| line.len() > 1 && line.is_ascii();
    let english: Vec<&str> = row.legend.iter().filter(is_english).copied().collect();
    let others = row.legend.iter().filter(|line| !is_english(line));
    let others = others.copied().collect::<Vec<_>>().concat();
    match language {
        _ if others.is_empty() => format!("[{}]", english.join(" ")),
        Language::En if !english.is_empty() => format!("[{} {others}]", english.join(" ")),
        Language::En => add_key_names(&format!("[{others}]")).into_owned(),
        Language::Zh => format!("[{others}]"),
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

    #[test]
    fn keys_of_a_model_have_its_legends() {
        for (model, key, zh, en) in [
            (ModelId::Hx31, Key::MainProgram, "[程序]", "[PRGRM 程序]"),
            (ModelId::Hx31, Key::Soft1, "[F1]", "[F1]"),
            (ModelId::Hx31, Key::Edit, "[编辑]", "[Edit 编辑]"),
            (ModelId::Ncb08, Key::Cancel, "[取消]", "[ESC 取消]"),
            (ModelId::Ncb08, Key::Program, "[程序]", "[PRG 程序]"),
            (ModelId::Gsk980td, Key::Program, "[程序]", "[PRG 程序]"),
        ] {
            assert_eq!(key_label_on(model, key, Language::Zh), zh);
            assert_eq!(key_label_on(model, key, Language::En), en);
        }
    }
}
