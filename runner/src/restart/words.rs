//! Words that the operator puts in place of those of the program, for a restart.

use gsk_messages::{Message, say};

/// Greatest S and F of a restart; every speed and feed of a lathe is below it.
const MAX_VALUE: f64 = 99_999.0;

/// A word of the state before a block that the operator can change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RestartWord {
    /// F, in the unit of the feed mode.
    Feed,
    /// The tool number of T; the offset number stays.
    Tool,
    /// S: r/min, or m/min under G96.
    Speed,
    /// M03, M04 or M05.
    Spindle,
    /// M08 or M09.
    Coolant,
}

impl RestartWord {
    /// The word with a value as the list of differences writes it: `S800`, `M05`.
    pub fn with_value(self, value: &str) -> String {
        let letter = match self {
            Self::Feed => "F",
            Self::Tool => "T",
            Self::Speed => "S",
            Self::Spindle | Self::Coolant => "",
        };
        format!("{letter}{value}")
    }
}

/// The words that the operator has changed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RestartWords {
    pub(super) feed: Option<f64>,
    /// Tool number, and the offset number if it was written.
    pub(super) tool: Option<(u8, Option<u8>)>,
    pub(super) speed: Option<f64>,
    /// M03, M04 or M05.
    pub(super) spindle: Option<u8>,
    /// M08 or M09.
    pub(super) coolant: Option<u8>,
}

impl RestartWords {
    /// Sets a word: `S800`, `F120`, `T03`, `T0301`, `M03` to `M05`, `M08` or `M09`.
    ///
    /// # Errors
    /// The message that quotes the word and lists the permitted ones.
    pub fn set(&mut self, text: &str) -> Result<(), Message> {
        let upper = text.trim().to_ascii_uppercase();
        let wrong = || say::restart_word_wrong(text.trim());
        let mut letters = upper.chars();
        let letter = letters.next().ok_or_else(wrong)?;
        let value = letters.as_str();
        let number = || {
            value
                .parse()
                .ok()
                .filter(|it| (0.0..=MAX_VALUE).contains(it))
        };
        match (letter, value.len(), value.parse::<u16>()) {
            ('F', ..) => {
                let feed = number().filter(|feed: &f64| *feed > 0.0);
                self.feed = Some(feed.ok_or_else(wrong)?);
            }
            ('S', ..) => self.speed = Some(number().ok_or_else(wrong)?),
            ('T', 1..=2, Ok(tool)) => self.tool = Some((tool as u8, None)),
            ('T', 3..=4, Ok(word)) => {
                self.tool = Some(((word / 100) as u8, Some((word % 100) as u8)));
            }
            ('M', 1..=2, Ok(code @ 3..=5)) => self.spindle = Some(code as u8),
            ('M', 1..=2, Ok(code @ 8..=9)) => self.coolant = Some(code as u8),
            _ => return Err(wrong()),
        }
        Ok(())
    }

    /// Returns to the word of the program.
    pub const fn remove(&mut self, word: RestartWord) {
        match word {
            RestartWord::Feed => self.feed = None,
            RestartWord::Tool => self.tool = None,
            RestartWord::Speed => self.speed = None,
            RestartWord::Spindle => self.spindle = None,
            RestartWord::Coolant => self.coolant = None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_read_as_the_operator_writes_them() {
        let mut words = RestartWords::default();
        for text in ["s800", " F0.12", "T3", "T0402", "m5", "M09"] {
            words
                .set(text)
                .unwrap_or_else(|why| panic!("{text}: {why}"));
        }
        let wanted = RestartWords {
            feed: Some(0.12),
            tool: Some((4, Some(2))),
            speed: Some(800.0),
            spindle: Some(5),
            coolant: Some(9),
        };
        assert_eq!(words, wanted);
        for text in [
            "", "S", "S-1", "Snan", "Sinf", "F0", "T", "T12345", "M", "M30", "M003", "é5",
        ] {
            let mut changed = words;
            assert_eq!(
                changed.set(text),
                Err(say::restart_word_wrong(text)),
                "{text}"
            );
            assert_eq!(changed, words);
        }
        words.remove(RestartWord::Spindle);
        assert_eq!(words.spindle, None);
        assert_eq!(RestartWord::Speed.with_value("800"), "S800");
        assert_eq!(RestartWord::Coolant.with_value("M08"), "M08");
    }
}
