//! The field below a list of the program view, in which the user types another entry.

use egui::{Key, RichText, TextEdit, Ui};
use gsk_messages::{Language, Message};

use crate::theme;

/// Width of the field, points.
const FIELD_WIDTH: f32 = 260.0;
/// Width of a menu with the field and its button, points.
pub const MENU_WIDTH: f32 = FIELD_WIDTH + 80.0;

/// The texts of a field.
pub struct EntryTexts {
    /// Examples of entries, shown in the empty field.
    pub examples: &'static str,
    /// What can be typed.
    pub hint: Message,
    /// The name of the button.
    pub add: Message,
}

/// A field and its button, with the text that is typed and what is wrong with the last one.
#[derive(Default)]
pub struct ListEntry {
    text: String,
    error: Option<Message>,
}

impl ListEntry {
    /// Draws the field. Returns what was entered if `parse` accepts it.
    pub fn show<T>(
        &mut self,
        ui: &mut Ui,
        language: Language,
        texts: &EntryTexts,
        parse: impl FnOnce(&str) -> Result<T, Message>,
    ) -> Option<T> {
        let is_entered = ui
            .horizontal(|ui| {
                let field = TextEdit::singleline(&mut self.text)
                    .hint_text(texts.examples)
                    .desired_width(FIELD_WIDTH);
                let response = ui.add(field).on_hover_text(texts.hint.text(language));
                let has_enter = ui.input(|input| input.key_pressed(Key::Enter));
                let add = ui.button(texts.add.text(language));
                add.clicked() || (response.lost_focus() && has_enter)
            })
            .inner;
        let mut added = None;
        if is_entered {
            match parse(&self.text) {
                Ok(value) => {
                    *self = Self::default();
                    added = Some(value);
                }
                Err(why) => self.error = Some(why),
            }
        }
        if let Some(error) = &self.error {
            ui.label(RichText::new(error.text(language)).color(theme::CODE_ALARM_TEXT));
        }
        added
    }
}
