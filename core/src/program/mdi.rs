//! The block that is typed word by word on the MDI page (manual III-6.1).

use serde::{Deserialize, Serialize};

use super::block::ProgramBlock;
use super::decimal_points::append_points;
use super::macro_b::uses_macro_b;
use super::parse::parse_block;
use super::program_text::Program;
use super::syntax::{BlockError, Syntax};
use crate::alarm::Alarm;
use crate::memory::ControlParameters;

/// The words typed so far on the MDI page, in the order of their first entry.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MdiBlock {
    words: Vec<(MdiSlot, String)>,
    /// Whether the words are parsed as macro B.
    #[serde(default, skip_serializing_if = "core::ops::Not::not")]
    macro_b: bool,
}

/// Identifies the word that a new word replaces: that with the same address, or the G code with
/// which the new one cannot share a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum MdiSlot {
    Address(u8),
    Group(u8),
    /// A statement of macro B, which must be alone in its block.
    Statement,
}

impl MdiBlock {
    /// Adds one or more typed words. A word that is typed again replaces the earlier one.
    ///
    /// # Errors
    /// The alarm of invalid words; the block is then unchanged.
    pub fn enter(
        &mut self,
        text: &str,
        parameters: &ControlParameters,
        macro_b: bool,
    ) -> Result<(), Alarm> {
        if macro_b && is_statement(text) {
            return self.enter_statement(text, parameters);
        }
        let mut next = self.clone();
        next.words.retain(|(slot, _)| *slot != MdiSlot::Statement);
        let in_macro = self.words.iter().any(|(_, word)| is_g65(word));
        let pointed;
        let text = if parameters.is_point_appended() && !in_macro {
            pointed = append_points(text);
            &pointed
        } else {
            text
        };
        for (slot, word) in split_words(text) {
            match next.words.iter_mut().find(|(taken, _)| *taken == slot) {
                Some((_, old)) => *old = word,
                None => next.words.push((slot, word)),
            }
        }
        let syntax = Syntax {
            macro_b: macro_b && uses_macro_b(&next.text()),
            ..Syntax::from(parameters)
        };
        next.macro_b = syntax.macro_b;
        // The whole block must be valid: ranges depend on the G codes.
        parse_block(&next.text(), syntax).map_err(|error| match parse_block(text, syntax) {
            Err(word) => word,
            Ok(_) => error,
        })?;
        *self = next;
        Ok(())
    }

    /// Replaces the block by a typed statement of macro B. Returns the alarm of a faulty statement
    /// as error.
    fn enter_statement(&mut self, text: &str, parameters: &ControlParameters) -> Result<(), Alarm> {
        let text = text.trim().trim_end_matches(';').to_ascii_uppercase();
        let syntax = Syntax {
            macro_b: true,
            ..Syntax::from(parameters)
        };
        parse_block(&text, syntax)?;
        self.words = vec![(MdiSlot::Statement, text)];
        self.macro_b = true;
        Ok(())
    }

    /// The typed statement of macro B; `None` for a block of words.
    pub fn statement(&self) -> Option<&str> {
        match self.words.as_slice() {
            [(MdiSlot::Statement, text)] => Some(text),
            _ => None,
        }
    }

    /// Removes all words of the block.
    pub fn clear(&mut self) {
        self.words.clear();
    }

    /// Whether no word has been typed.
    pub fn is_empty(&self) -> bool {
        self.words.is_empty()
    }

    /// Parses the typed words as one block.
    ///
    /// # Errors
    /// As `parse_block`. It cannot fail after a successful [`Self::enter`] with the same
    /// parameters.
    pub fn block(&self, parameters: &ControlParameters) -> Result<ProgramBlock, BlockError> {
        let text = self.text();
        let syntax = Syntax {
            macro_b: self.macro_b,
            ..Syntax::from(parameters)
        };
        parse_block(&text, syntax)
    }

    /// The typed words as the text of one block.
    pub fn text(&self) -> String {
        let mut text = String::new();
        for (_, word) in &self.words {
            if !text.is_empty() {
                text.push(' ');
            }
            text.push_str(word);
        }
        text
    }

    /// A program that consists of this block, for the interpreter.
    pub fn program(&self) -> Program {
        Program::new(self.text())
    }

    /// The number of a block that only has R, mm: it sets a nose radius, unless the code of
    /// group 01 uses R (manual II-1.3). `None` for other blocks.
    pub(crate) fn lone_r(&self, parameters: &ControlParameters) -> Option<f64> {
        let [(MdiSlot::Address(b'R'), _)] = self.words.as_slice() else {
            return None;
        };
        let r = self.block(parameters).ok()?.number(b'R')?;
        r.variable().is_none().then(|| r.mm())
    }

    /// The number typed after an address letter, as text; of several G codes the last one.
    /// `None` if the address was not typed.
    pub fn entered_number(&self, address: u8) -> Option<&str> {
        let word = self.words.iter().rev().map(|(_, word)| word.as_str());
        let mut word = word.filter(|word| word.bytes().next() == Some(address));
        word.next().and_then(|word| word.get(1..)).map(str::trim)
    }
}

/// Whether a typed word is the code G65.
fn is_g65(word: &str) -> bool {
    let code = word.strip_prefix('G').map(str::trim);
    code.and_then(|code| code.parse::<u8>().ok()) == Some(65)
}

/// Whether a text is a statement of macro B: it begins with `#`, with two letters, or with G65
/// (without H), G66 or G67.
fn is_statement(text: &str) -> bool {
    let text = text.trim();
    let code = |number: &str| {
        let rest = text.strip_prefix(['G', 'g']).map(str::trim_start);
        rest.and_then(|rest| rest.strip_prefix(number))
    };
    let call = code("65")
        .is_some_and(|rest| !rest.trim_start().starts_with(['H', 'h']) && !rest.trim().is_empty());
    let modal = code("66").or(code("67")).is_some();
    let mut bytes = text.bytes();
    let letters = |byte: Option<u8>| byte.is_some_and(|byte| byte.is_ascii_alphabetic());
    call || modal || text.starts_with('#') || letters(bytes.next()) && letters(bytes.next())
}

/// Splits a typed text before each address letter, except letters in brackets. Returns each word
/// with the word that it replaces.
fn split_words(text: &str) -> Vec<(MdiSlot, String)> {
    let mut words: Vec<(MdiSlot, String)> = Vec::new();
    let mut depth = 0_i32;
    for character in text.trim_end_matches([';', '*', ' ', '\n', '\r']).chars() {
        let character = character.to_ascii_uppercase();
        match character {
            '[' => depth += 1,
            ']' => depth -= 1,
            _ => {}
        }
        let begins = depth <= 0 && character.is_ascii_uppercase();
        match (begins, words.last_mut()) {
            (false, Some((_, word))) => word.push(character),
            _ => {
                let address = u8::try_from(character).unwrap_or(b'?');
                words.push((MdiSlot::Address(address), character.to_string()));
            }
        }
    }
    for (slot, word) in &mut words {
        *word = word.trim_end().to_string();
        let code = word
            .strip_prefix('G')
            .and_then(|code| code.trim().parse().ok());
        if let Some(code) = code {
            *slot = MdiSlot::Group(g_group(code));
        }
    }
    words
}

/// The number of the group of a G code (manual I-3, table 3-7). Groups 00 and 01 cannot share
/// a block, so that both yield 0; G20 and G21 yield a separate group.
const fn g_group(code: u8) -> u8 {
    match code {
        96 | 97 => 2,
        98 | 99 => 3,
        40..=42 => 4,
        20 | 21 => 6,
        _ => 0,
    }
}
