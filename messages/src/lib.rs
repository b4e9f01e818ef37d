//! Every sentence the program says, in Chinese and English.
//!
//! `assets/tables/messages.tsv` has a row a message: its id and its text in both
//! languages. What raises a message names the row and gives the values; whoever
//! shows it chooses the language:
//!
//! ```
//! use gsk_messages::{Language, say};
//!
//! let refusal = say::program_exists(12);
//! assert_eq!(refusal.text(Language::En), "O0012 exists");
//! assert_eq!(refusal.text(Language::Zh), "O0012 已存在");
//! ```

mod template;

use core::fmt;

use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

use template::{Piece, pieces};

include!(concat!(env!("OUT_DIR"), "/messages.rs"));

/// The languages of the program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Language {
    /// Chinese.
    #[default]
    Zh,
    /// English.
    En,
}

impl Language {
    /// The other one.
    pub const fn other(self) -> Self {
        match self {
            Self::Zh => Self::En,
            Self::En => Self::Zh,
        }
    }
}

/// A row of the table.
#[derive(Debug)]
struct Row {
    name: &'static str,
    en: &'static str,
    zh: &'static str,
    /// The placeholders, in the order of a message's values.
    values: &'static [&'static str],
}

/// A message: which one, and its values. [`say`] has a function for each.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Message {
    id: Id,
    values: Vec<Value>,
}

/// What stands in the place of a name.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum Value {
    /// The same in every language: a number, a code, a file name.
    Text(String),
    /// Another message.
    Message(Message),
    /// Several, with "; " between them.
    List(Vec<Message>),
}

impl Message {
    const fn of(id: Id, values: Vec<Value>) -> Self {
        Self { id, values }
    }

    /// Which message it is.
    pub const fn id(&self) -> Id {
        self.id
    }

    /// A value that is the same in every language, as it is shown.
    pub fn plain_value(&self, name: &str) -> Option<&str> {
        let values = self.id.row().values;
        let index = values.iter().position(|known| *known == name)?;
        match self.values.get(index)? {
            Value::Text(text) => Some(text),
            Value::Message(_) | Value::List(_) => None,
        }
    }

    /// The same, also of a message that stands within it: the column within the profile of
    /// a cycle.
    pub fn value_within(&self, name: &str) -> Option<&str> {
        self.plain_value(name).or_else(|| {
            self.values.iter().find_map(|value| match value {
                Value::Text(_) => None,
                Value::Message(message) => message.value_within(name),
                Value::List(messages) => messages.iter().find_map(|it| it.value_within(name)),
            })
        })
    }

    /// Its text in a language.
    pub fn text(&self, language: Language) -> String {
        self.text_by(language, &str::to_owned)
    }

    /// Its text in a language; what is [`say::as_written`] is said as `written` says it.
    pub(crate) fn text_by(&self, language: Language, written: &dyn Fn(&str) -> String) -> String {
        let row = self.id.row();
        let template = match language {
            Language::Zh => row.zh,
            Language::En => row.en,
        };
        // The table is checked when it is compiled.
        let pieces = pieces(template).unwrap_or_default();
        pieces
            .into_iter()
            .map(|piece| match piece {
                Piece::Text(text) => text.to_owned(),
                Piece::Value { name, .. } => self.value(row, name, language, written),
            })
            .collect()
    }

    fn value(
        &self,
        row: &Row,
        name: &str,
        language: Language,
        written: &dyn Fn(&str) -> String,
    ) -> String {
        let index = row.values.iter().position(|known| *known == name);
        match index.and_then(|index| self.values.get(index)) {
            Some(Value::Text(text)) if self.id == Id::AsWritten => written(text),
            Some(Value::Text(text)) => text.clone(),
            Some(Value::Message(message)) => message.text_by(language, written),
            Some(Value::List(messages)) => {
                let texts = messages
                    .iter()
                    .map(|message| message.text_by(language, written));
                texts.collect::<Vec<_>>().join("; ")
            }
            None => String::new(),
        }
    }
}

/// In English.
impl fmt::Display for Message {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text(Language::En))
    }
}

impl Id {
    fn row(self) -> &'static Row {
        // As many rows as ids, in the same order: both are made from the table.
        &ROWS[self as usize]
    }

    /// Its name in the table.
    pub fn name(self) -> &'static str {
        self.row().name
    }

    /// All of them, in the order of the table.
    pub const fn all() -> &'static [Self] {
        &IDS
    }
}

/// English and Chinese of every row, with their placeholders.
pub fn texts() -> impl Iterator<Item = [&'static str; 2]> {
    ROWS.iter().map(|row| [row.en, row.zh])
}

impl Serialize for Id {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl<'de> Deserialize<'de> for Id {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = String::deserialize(deserializer)?;
        let found = Self::all().iter().find(|id| id.name() == name);
        found
            .copied()
            .ok_or_else(|| de::Error::custom(format!("no message `{name}`")))
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn ids_and_rows_are_in_the_same_order() {
        for (index, id) in Id::all().iter().enumerate() {
            assert_eq!(*id as usize, index);
        }
        let names: BTreeSet<_> = Id::all().iter().map(|id| id.name()).collect();
        assert_eq!(names.len(), ROWS.len());
    }

    #[test]
    fn every_row_has_both_texts_with_the_same_values() {
        for row in &ROWS {
            let own = row.name == "window_other_language";
            assert!(own || is_english(row.en), "{row:?}");
            for text in [row.en, row.zh] {
                let mut names: Vec<&str> = pieces(text)
                    .unwrap()
                    .into_iter()
                    .filter_map(|piece| match piece {
                        Piece::Value { name, .. } => Some(name),
                        Piece::Text(_) => None,
                    })
                    .collect();
                names.sort_unstable();
                names.dedup();
                let mut values = row.values.to_vec();
                values.sort_unstable();
                assert_eq!(names, values, "{row:?}");
            }
        }
    }

    /// Lines of the screen, quoted as they stand there.
    const OF_THE_SCREEN: [&str; 3] = ["英制编程", "参数开关", "程序开关"];

    /// What is printed on a key stands in brackets, as it is printed: `[运行]`.
    fn is_english(text: &str) -> bool {
        let quoted = |text: String, line: &&str| text.replace(line, "");
        let text = OF_THE_SCREEN.iter().fold(text.to_owned(), quoted);
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
        assert_eq!(both.text(Language::En), "O0007 exists; x.nc");
        assert_eq!(both.text(Language::Zh), "O0007 已存在; x.nc");
    }
}
