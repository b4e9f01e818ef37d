//! Reads the symbols of an ISO designation one after the other.

use gsk_messages::{Message, say};

/// The symbol at which a designation breaks its standard.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IsoCodeError {
    /// The designation without spaces.
    pub code: String,
    /// Reference position of the symbol in the standard, from 1.
    pub position: u8,
    /// What the symbol stands for.
    pub part: Message,
    /// The symbol; empty if the designation ends before it.
    pub found: String,
    /// What the standard permits here.
    pub rule: Message,
}

impl IsoCodeError {
    /// The message: designation, position, symbol and rule.
    pub fn message(&self) -> Message {
        let (code, position) = (&self.code, self.position);
        let (part, rule) = (self.part.clone(), self.rule.clone());
        match self.found.as_str() {
            "" => say::tool_code_short(code, position, part, rule),
            found => say::tool_code_fault(code, position, part, found, rule),
        }
    }
}

/// The unread rest of a designation.
pub(super) struct CodeReader<'a> {
    code: &'a str,
    rest: &'a str,
}

impl<'a> CodeReader<'a> {
    /// `code` is in capitals and has no spaces.
    pub(super) const fn new(code: &'a str) -> Self {
        Self { code, rest: code }
    }

    /// An error at a symbol.
    pub(super) fn error(
        &self,
        (position, part): (u8, Message),
        found: &str,
        rule: Message,
    ) -> IsoCodeError {
        IsoCodeError {
            code: self.code.to_owned(),
            position,
            part,
            found: found.to_owned(),
            rule,
        }
    }

    /// Skips a character if it is next.
    pub(super) fn skip(&mut self, character: char) {
        self.rest = self.rest.strip_prefix(character).unwrap_or(self.rest);
    }

    /// Takes a symbol of `length` characters; fewer at the end of the designation.
    pub(super) fn take(&mut self, length: usize) -> &'a str {
        let mut ends = self.rest.char_indices().map(|(index, _)| index);
        let end = ends.nth(length).unwrap_or(self.rest.len());
        let (symbol, rest) = self.rest.split_at(end);
        self.rest = rest;
        symbol
    }

    /// Takes a letter of a list.
    ///
    /// # Errors
    /// Another character, or the end.
    pub(super) fn letter(
        &mut self,
        place: (u8, Message),
        letters: &str,
    ) -> Result<char, IsoCodeError> {
        let symbol = self.take(1);
        let mut characters = symbol.chars();
        characters
            .next()
            .filter(|it| letters.contains(*it))
            .ok_or_else(|| self.error(place, symbol, one_of(letters.chars())))
    }

    /// Takes two digits.
    ///
    /// # Errors
    /// Other characters, or the end.
    pub(super) fn two_digits(&mut self, place: (u8, Message)) -> Result<u8, IsoCodeError> {
        let symbol = self.take(2);
        let is_number = symbol.len() == 2 && symbol.bytes().all(|it| it.is_ascii_digit());
        match symbol.parse() {
            Ok(number) if is_number => Ok(number),
            _ => Err(self.error(place, symbol, say::tool_rule_digits())),
        }
    }
}

/// The rule that a symbol is one of a list.
pub(super) fn one_of<T: core::fmt::Display>(symbols: impl Iterator<Item = T>) -> Message {
    let symbols: Vec<String> = symbols.map(|it| it.to_string()).collect();
    say::tool_rule_one_of(symbols.join(" "))
}
