//! Every message that the program shows, in Chinese and English.
//!
//! `assets/tables/messages.tsv` has a row for each message: its id and its text in both
//! languages. The code that raises a message names the row and gives the values. The code that
//! shows it chooses the language. Only a program embeds the texts ([`install_texts`]); the
//! packages below it know names and placeholders, from `src/rows.rs`, which `cargo xtask
//! tables` writes.
//!
//! ```
//! use gsk_messages::{Language, say};
//!
//! let refusal = say::program_exists(12);
//! assert_eq!(refusal.text(Language::En), "program 0012 exists");
//! assert_eq!(refusal.text(Language::Zh), "程序 0012 已存在");
//! ```

mod help_columns;
#[macro_use]
mod ids;
mod key_names;
mod rows;
mod template;
mod texts;

use core::fmt;

use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

pub use help_columns::HelpColumns;
pub use key_names::add_key_names;
use rows::{IDS, ROWS};
pub use rows::{Id, say};
use template::{TemplatePiece, split_template};
pub use texts::{MessageTable, install_texts};

/// A language of the program's messages.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Language {
    /// Chinese, the language of the LCD as delivered.
    #[default]
    Zh,
    /// English.
    En,
}

impl Language {
    /// Returns the other one of the two languages.
    pub const fn other(self) -> Self {
        match self {
            Self::Zh => Self::En,
            Self::En => Self::Zh,
        }
    }
}

/// A message to the user: its row in the message table and the values of its placeholders.
/// [`say`] has a constructor for each row. The message stores no text until [`Message::text`]
/// chooses a language.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Message {
    id: Id,
    values: Vec<Value>,
}

/// The value of a placeholder in a message.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum Value {
    /// A text that is the same in both languages: a number, a code, a file name.
    Text(String),
    /// Another message, shown in the same language.
    Message(Message),
    /// Several messages, shown in the same language and joined with a semicolon.
    List(Vec<Message>),
}

impl Message {
    const fn of(id: Id, values: Vec<Value>) -> Self {
        Self { id, values }
    }

    /// Returns the row of the message table that this message comes from.
    pub const fn id(&self) -> Id {
        self.id
    }

    /// Returns the value of the placeholder `name` as text. Returns `None` if the message has
    /// no such placeholder, or if its value is another message.
    pub fn plain_value(&self, name: &str) -> Option<&str> {
        match self.value(name)? {
            Value::Text(text) => Some(text),
            Value::Message(_) | Value::List(_) => None,
        }
    }

    fn value(&self, name: &str) -> Option<&Value> {
        let index = self.id.values().position(|known| known == name)?;
        self.values.get(index)
    }

    /// Returns the value of the placeholder `name` as text, searching nested messages too: the
    /// column within the profile of a cycle, for example. `None` if no placeholder with this
    /// name has a text.
    pub fn find_value(&self, name: &str) -> Option<&str> {
        self.plain_value(name).or_else(|| {
            self.values.iter().find_map(|value| match value {
                Value::Text(_) => None,
                Value::Message(message) => message.find_value(name),
                Value::List(messages) => messages.iter().find_map(|it| it.find_value(name)),
            })
        })
    }

    /// Returns the text of the message in a language, with all values filled in.
    pub fn text(&self, language: Language) -> String {
        self.text_with(language, &str::to_owned)
    }

    /// Returns the text of the message in a language. `written` translates the text of a
    /// [`say::as_written`].
    pub(crate) fn text_with(&self, language: Language, written: &dyn Fn(&str) -> String) -> String {
        let template = self.id.template(language);
        // A test checks the texts, so this one has no error.
        let pieces = split_template(&template).unwrap_or_default();
        pieces
            .into_iter()
            .map(|piece| match piece {
                TemplatePiece::Text(text) if language == Language::En => {
                    add_key_names(text).into_owned()
                }
                TemplatePiece::Text(text) => text.to_owned(),
                TemplatePiece::Value { name, .. } => self.value_text(name, language, written),
            })
            .collect()
    }

    fn value_text(
        &self,
        name: &str,
        language: Language,
        written: &dyn Fn(&str) -> String,
    ) -> String {
        match self.value(name) {
            Some(Value::Text(text)) if self.id == Id::AsWritten => written(text),
            Some(Value::Text(text)) => text.clone(),
            Some(Value::Message(message)) => message.text_with(language, written),
            Some(Value::List(messages)) => {
                let texts = messages
                    .iter()
                    .map(|message| message.text_with(language, written));
                let separator = match language {
                    Language::Zh => "；",
                    Language::En => "; ",
                };
                texts.collect::<Vec<_>>().join(separator)
            }
            None => String::new(),
        }
    }
}

/// Writes the English text of the message.
impl fmt::Display for Message {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text(Language::En))
    }
}

impl Id {
    /// Names of the placeholders, in the order in which a message stores their values.
    fn values(self) -> impl Iterator<Item = &'static str> {
        ROWS.line(self).split(' ').skip(1)
    }

    /// Returns the text of the row in a language, with its placeholders unfilled.
    pub fn template(self, language: Language) -> String {
        texts::template(self, language)
    }

    /// Returns the name of the message's row in the table; serialized messages contain it.
    pub fn name(self) -> &'static str {
        let row = ROWS.line(self);
        row.split_once(' ').map_or(row, |(name, _)| name)
    }

    /// Returns the ids of all messages, in the order of the table.
    pub fn all() -> &'static [Self] {
        IDS
    }
}

/// Writes the name of the row: a derived `Debug` has an arm for each row, which every package
/// that shows a message would compile again.
impl fmt::Debug for Id {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl Serialize for Id {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl<'de> Deserialize<'de> for Id {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = String::deserialize(deserializer)?;
        // The rows are in alphabetical order.
        Self::all()
            .binary_search_by_key(&&*name, |id| id.name())
            .map(|index| Self::all()[index])
            .map_err(|_| de::Error::custom(format!("no message `{name}`")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_and_rows_are_in_the_same_order() {
        for (index, id) in Id::all().iter().enumerate() {
            assert_eq!(*id as usize, index);
        }
        let names: Vec<&str> = Id::all().iter().map(|id| id.name()).collect();
        assert!(names.is_sorted_by(|a, b| a < b));
        assert!(!names.iter().any(|name| name.is_empty()));
    }

    #[test]
    fn every_row_has_both_texts_with_the_same_values() {
        for id in Id::all() {
            let [en, zh] = [Language::En, Language::Zh].map(|language| id.template(language));
            let own = id.name() == "window_other_language";
            assert!(own || is_english(&en), "{id:?} {en}");
            for text in [&en, &zh] {
                let mut names: Vec<&str> = split_template(text)
                    .unwrap()
                    .into_iter()
                    .filter_map(|piece| match piece {
                        TemplatePiece::Value { name, .. } => Some(name),
                        TemplatePiece::Text(_) => None,
                    })
                    .collect();
                names.sort_unstable();
                names.dedup();
                let mut values: Vec<&str> = id.values().collect();
                values.sort_unstable();
                assert_eq!(names, values, "{id:?}");
            }
        }
    }

    /// Chinese texts that English messages quote from the LCD.
    const SCREEN_TEXTS: [&str; 3] = ["英制编程", "参数开关", "程序开关"];

    /// Whether a text has no Chinese outside key names in brackets, as printed on the key:
    /// `[运行]`.
    fn is_english(text: &str) -> bool {
        let quoted = |text: String, line: &&str| text.replace(line, "");
        let text = SCREEN_TEXTS.iter().fold(text.to_owned(), quoted);
        let outside = text.split('[').map(|piece| {
            let (key, rest) = piece.split_once(']').unwrap_or(("", piece));
            if key.is_empty() { piece } else { rest }
        });
        outside.flat_map(str::chars).all(|c| !is_chinese(c))
    }

    fn is_chinese(letter: char) -> bool {
        ('\u{4e00}'..='\u{9fff}').contains(&letter)
    }

    #[test]
    fn a_message_in_a_message_speaks_its_language() {
        let inner = say::program_exists(7);
        let both = say::several([inner.clone(), say::as_written("x.nc")]);
        assert_eq!(inner.plain_value("program"), Some("0007"));
        assert_eq!(both.plain_value("messages"), None);
        assert_eq!(both.text(Language::En), "program 0007 exists; x.nc");
        assert_eq!(both.text(Language::Zh), "程序 0007 已存在；x.nc");
    }
}
