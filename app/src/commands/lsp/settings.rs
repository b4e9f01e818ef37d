//! Reads the settings that an editor has for this server.

use gsk_language::{Casing, Numbering, Spacing, Style};
use serde::Deserialize;
use serde_json::Value;

/// The section of this program in an editor's settings.
pub const SECTION: &str = "gsk980td";

/// The settings for this server.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ServerSettings {
    /// The style in which programs are formatted.
    pub style: Style,
    /// Whether modal codes in force are shown in the text.
    pub modal_hints: bool,
}

/// The settings as the editor sends them. A missing field has its default.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
struct EditorSettings {
    format: StyleSettings,
    hints: HintSettings,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(default)]
struct HintSettings {
    modal: bool,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(default)]
struct StyleSettings {
    numbers: NumberSetting,
    start: u16,
    step: u16,
    spaces: SpaceSetting,
    uppercase: bool,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
enum NumberSetting {
    #[default]
    Keep,
    Present,
    All,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
enum SpaceSetting {
    Keep,
    #[default]
    One,
    None,
}

impl Default for StyleSettings {
    fn default() -> Self {
        Self {
            numbers: NumberSetting::default(),
            start: 10,
            step: 10,
            spaces: SpaceSetting::default(),
            uppercase: true,
        }
    }
}

/// Reads the settings from the section of this program, or from a value that contains the
/// section. `None` if the settings cannot be parsed.
pub fn read_settings(settings: &Value) -> Option<ServerSettings> {
    let section = settings.get(SECTION).unwrap_or(settings);
    if section.is_null() {
        return None;
    }
    let EditorSettings { format, hints } = EditorSettings::deserialize(section).ok()?;
    let (start, step) = (format.start, format.step.max(1));
    let style = Style {
        numbering: match format.numbers {
            NumberSetting::Keep => Numbering::Unchanged,
            NumberSetting::Present => Numbering::Present { start, step },
            NumberSetting::All => Numbering::All { start, step },
        },
        spacing: match format.spaces {
            SpaceSetting::Keep => Spacing::Unchanged,
            SpaceSetting::One => Spacing::One,
            SpaceSetting::None => Spacing::None,
        },
        casing: match format.uppercase {
            true => Casing::Upper,
            false => Casing::Unchanged,
        },
    };
    Some(ServerSettings {
        style,
        modal_hints: hints.modal,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn settings_are_read_with_their_defaults() {
        let all = json!({ "gsk980td": { "format": { "numbers": "all", "start": 5, "step": 0 } } });
        let style_of = |value: &Value| read_settings(value).expect("settings").style;
        let numbering = Numbering::All { start: 5, step: 1 };
        assert_eq!(
            style_of(&all),
            Style {
                numbering,
                ..Style::default()
            }
        );
        let none = json!({ "format": { "spaces": "none", "uppercase": false } });
        assert_eq!(style_of(&none).spacing, Spacing::None);
        assert_eq!(style_of(&none).casing, Casing::Unchanged);
        assert_eq!(read_settings(&json!({})), Some(ServerSettings::default()));
        let hints = json!({ "hints": { "modal": true } });
        assert!(read_settings(&hints).is_some_and(|it| it.modal_hints));
        for wrong in [
            json!(null),
            json!({ "format": { "numbers": "some" } }),
            json!(7),
        ] {
            assert_eq!(read_settings(&wrong), None, "{wrong}");
        }
    }
}
