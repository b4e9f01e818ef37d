//! The chain of causes, as text in both languages.

use gsk_core::plc::Ladder;
use gsk_core::plc::address::BitAddress;
use gsk_messages::{Language, Message, say};

use crate::keys::Key;
use crate::pages::plc_names;

/// One fact of a chain.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CauseFact {
    /// A bit of PLC memory has a value.
    Bit {
        bit: BitAddress,
        value: bool,
        /// Tick of the last change; `None` if it is unknown.
        since: Option<u64>,
        /// The key that closes this contact; `None` for other bits.
        key: Option<Key>,
    },
    /// A rung writes the bit above: its number, and whether power reaches its output.
    Rung {
        number: u32,
        /// Line of the ladder's source text, from 1.
        line: u32,
        is_live: bool,
        /// Whether a coil keeps its value without power (SET, RST).
        is_latched: bool,
    },
    /// A condition of the control, a parameter or a fault.
    Condition(Message),
}

/// A fact with its depth: the facts below it that are one deeper decide it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CauseLink {
    /// 0 for the subject itself.
    pub depth: usize,
    /// The fact.
    pub fact: CauseFact,
}

/// The facts that decide a subject, each before those that decide it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CauseChain {
    /// The facts.
    pub links: Vec<CauseLink>,
}

impl CauseChain {
    pub(super) fn push(&mut self, depth: usize, fact: CauseFact) {
        self.links.push(CauseLink { depth, fact });
    }

    /// The chain as lines, indented by depth. `ladder` has the comments of the bits.
    pub fn text(&self, ladder: &Ladder, language: Language) -> String {
        let mut text = String::new();
        for link in &self.links {
            for _ in 0..link.depth {
                text.push_str("  ");
            }
            text.push_str(&link.fact.text(ladder, language));
            text.push('\n');
        }
        text
    }
}

impl CauseFact {
    /// The fact in a language.
    pub fn text(&self, ladder: &Ladder, language: Language) -> String {
        let message = match self {
            Self::Bit {
                bit,
                value,
                since,
                key,
            } => {
                let meaning = match key {
                    Some(key) => say::why_key(key_name(*key, language)).text(language),
                    None => plc_names::meaning(ladder, *bit, language),
                };
                let value = u8::from(*value);
                match since {
                    Some(since) => {
                        say::why_bit_since(bit, value, *since as f64 / 1000.0, meaning)
                    }
                    None => say::why_bit(bit, value, meaning),
                }
            }
            Self::Rung {
                number,
                line,
                is_live: true,
                ..
            } => say::why_rung_live(*number, *line),
            Self::Rung {
                number,
                line,
                is_latched: true,
                ..
            } => say::why_rung_latched(*number, *line),
            Self::Rung { number, line, .. } => say::why_rung_dead(*number, *line),
            Self::Condition(message) => message.clone(),
        };
        message.text(language)
    }
}

fn key_name(key: Key, language: Language) -> &'static str {
    match language {
        Language::Zh => key.row().name_zh,
        Language::En => key.row().name_en,
    }
}
