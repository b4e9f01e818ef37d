//! Syntax options of a block, and the error of an invalid block.

use core::fmt;

use gsk_messages::{Message, say};

use super::number::is_length;
use crate::alarm::{Alarm, number};
use crate::memory::ControlParameters;
use crate::model::ModelId;

/// The options that decide how a block is parsed, from parameters and the program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Syntax {
    /// Parameter 013 POD: whether X Z U W R I J K F need a decimal point.
    pub point_required: bool,
    /// Whether lengths are in inches, with 0.0001 inch as the least increment, not 0.001 mm.
    pub inch: bool,
    /// Whether the least increment is 0.0001 mm or 0.00001 inch (IS-C of the GSK980MDi).
    pub fine: bool,
    /// Whether the program uses macro B and the control has this option.
    pub macro_b: bool,
    /// The control model whose addresses, codes and ranges apply.
    pub model: ModelId,
}

impl Syntax {
    /// The least input increment of a length, in millionths of a millimetre or an inch.
    pub(super) const fn increment(self) -> i64 {
        match (self.inch, self.fine) {
            (true, true) => 10,
            (true, false) | (false, true) => 100,
            (false, false) => 1000,
        }
    }

    /// The increment that `ROUND` rounds to in a word of this address, in the unit of the
    /// address.
    pub(crate) const fn rounding_unit(self, address: u8) -> f64 {
        match address {
            b'F' => 0.0001,
            address if self.is_length(address) => self.increment() as f64 / 1e6,
            _ => 1.0,
        }
    }

    /// Whether the numbers of an address are lengths; on a mill also those of Y, A, B, C and Q
    /// (the depth of a peck).
    pub(super) const fn is_length(self, address: u8) -> bool {
        is_length(address) || self.model.is_mill() && matches!(address, b'A'..=b'C' | b'Q' | b'Y')
    }

    /// Whether the numbers of an address may have a decimal point; on a mill also those of G
    /// (G54.1).
    pub(super) const fn has_decimal_point(self, address: u8) -> bool {
        self.is_length(address) || address == b'F' || self.model.is_mill() && address == b'G'
    }

    /// Whether the control model changes the usual ranges of words.
    pub(crate) fn narrows_words(self) -> bool {
        !self.model.is_main() && !self.model.record().word_limits.is_empty()
    }

    /// Returns the number of decimal places of the least input increment.
    pub(super) const fn decimal_places(self) -> u8 {
        3 + self.inch as u8 + self.fine as u8
    }
}

impl From<&ControlParameters> for Syntax {
    fn from(parameters: &ControlParameters) -> Self {
        Self {
            point_required: parameters.is_point_required(),
            inch: false,
            fine: false,
            macro_b: false,
            model: ModelId::default(),
        }
    }
}

/// The reason why a text is not a valid block, with its position.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BlockError {
    /// Number of the alarm that the block raises.
    pub alarm: u16,
    /// Column in the text of the block, in characters from 1.
    pub column: u32,
    /// Message about the violated rule of the syntax, with advice if available.
    pub detail: Message,
}

impl BlockError {
    /// An error at the byte position `byte`, from 0, of the text of a block.
    #[cold]
    pub(super) fn at(alarm: u16, byte: usize, detail: Message) -> Self {
        let column = u32::try_from(byte).unwrap_or(u32::MAX).saturating_add(1);
        Self {
            alarm,
            column,
            detail,
        }
    }

    pub(super) fn too_many_words() -> Self {
        Self::at(number::TOO_MANY_WORDS, 0, say::block_words_too_many())
    }

    /// Converts the column from bytes to characters of `text`. Adds a message if a comment
    /// before the error contains a bracket.
    pub(super) fn with_character_column(mut self, text: &str) -> Self {
        let byte = (self.column - 1) as usize;
        let before = text.char_indices().take_while(|(at, _)| *at < byte).count();
        self.column = u32::try_from(before).unwrap_or(u32::MAX).saturating_add(1);
        if has_nested_comment(text, byte) {
            self.detail = say::several([self.detail, say::comment_nested()]);
        }
        self
    }
}

impl BlockError {
    /// The message about an invalid block for the operator: alarm, column and rule.
    pub fn message(&self) -> Message {
        say::alarm_at_column(self.alarm, self.column, self.detail.clone())
    }
}

impl fmt::Display for BlockError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.message().fmt(f)
    }
}

impl core::error::Error for BlockError {}

impl From<BlockError> for Alarm {
    fn from(error: BlockError) -> Self {
        Self::new(error.alarm).with_detail(say::at_column(error.column, error.detail))
    }
}

/// Whether a comment before a byte contains a `(`: the first `)` ends the comment, and the
/// text after that is read as words.
fn has_nested_comment(text: &str, byte: usize) -> bool {
    let before = text.as_bytes().get(..byte).unwrap_or(text.as_bytes());
    let (mut open, mut nested, mut found) = (false, false, false);
    for byte in before {
        match byte {
            b'(' if open => nested = true,
            b'(' => (open, nested) = (true, false),
            b')' if open => {
                found |= nested;
                open = false;
            }
            _ => {}
        }
    }
    found
}
