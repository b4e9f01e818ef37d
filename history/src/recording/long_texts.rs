//! Stores long texts of MessagePack values (programs, ladders) once in a recording: a number
//! stands for each in the value.

use std::collections::BTreeMap;

use crate::moment::HashWriter;

/// Texts from this length on are numbered, bytes.
const MIN_TEXT_BYTES: usize = 256;
/// The extension type that holds the number of a text; the values have no other extension.
const TEXT_EXTENSION: u8 = 1;
const FIXEXT4: u8 = 0xd6;
/// Greatest size of a value with its texts, bytes: numbers are short and texts are long.
const MAX_VALUE_BYTES: usize = 512 * 1024 * 1024;

/// A token of MessagePack at the start of `bytes`.
struct Token<'a> {
    /// The bytes of the token: for arrays and maps only their head.
    bytes: &'a [u8],
    /// The text, if the token is one.
    text: Option<&'a str>,
}

/// Returns the first token; `None` if the bytes end within it or it is invalid.
fn first_token(bytes: &[u8]) -> Option<Token<'_>> {
    let head = *bytes.first()?;
    // Bytes of the head, and of a length after it.
    let length_at = |size: usize| -> Option<usize> {
        let field = bytes.get(1..1 + size)?;
        Some(
            field
                .iter()
                .fold(0, |sum, byte| sum << 8 | usize::from(*byte)),
        )
    };
    let (head_bytes, content_bytes, is_text) = match head {
        0xa0..=0xbf => (1, usize::from(head & 0x1f), true),
        0xd9 => (2, length_at(1)?, true),
        0xda => (3, length_at(2)?, true),
        0xdb => (5, length_at(4)?, true),
        0xc4 => (2, length_at(1)?, false),
        0xc5 => (3, length_at(2)?, false),
        0xc6 => (5, length_at(4)?, false),
        0xc7 => (3, length_at(1)?, false),
        0xc8 => (4, length_at(2)?, false),
        0xc9 => (6, length_at(4)?, false),
        0xcc | 0xd0 => (2, 0, false),
        0xcd | 0xd1 | 0xdc | 0xde => (3, 0, false),
        0xca | 0xce | 0xd2 | 0xdd | 0xdf => (5, 0, false),
        0xcb | 0xcf | 0xd3 => (9, 0, false),
        0xd4..=0xd8 => (2, 1 << (head - 0xd4), false),
        _ => (1, 0, false),
    };
    let end = usize::checked_add(head_bytes, content_bytes)?;
    let token = bytes.get(..end)?;
    let text = token.get(head_bytes..).filter(|_| is_text);
    Some(Token {
        bytes: token,
        text: text.and_then(|text| core::str::from_utf8(text).ok()),
    })
}

/// The texts of a recording, by length and hash: the encoder keeps no texts.
#[derive(Debug, Default)]
pub(super) struct TextNumbers(BTreeMap<(usize, u64), u32>);

impl TextNumbers {
    /// Replaces the long texts of a value by their numbers. Returns the value, and the texts
    /// that are new.
    pub(super) fn number_texts<'a>(&mut self, value: &'a [u8]) -> (Vec<u8>, Vec<&'a str>) {
        let (mut out, mut new_texts) = (Vec::with_capacity(value.len()), Vec::new());
        let mut rest = value;
        while let Some(token) = first_token(rest) {
            rest = rest.get(token.bytes.len()..).unwrap_or_default();
            let Some(text) = token.text.filter(|text| text.len() >= MIN_TEXT_BYTES) else {
                out.extend_from_slice(token.bytes);
                continue;
            };
            let mut hash = HashWriter::new();
            hash.add(text.as_bytes());
            let next = self.0.len() as u32;
            let number = *self.0.entry((text.len(), hash.hash())).or_insert(next);
            if number == next {
                new_texts.push(text);
            }
            out.extend([FIXEXT4, TEXT_EXTENSION]);
            out.extend(number.to_be_bytes());
        }
        (out, new_texts)
    }
}

/// Replaces the numbers in a value by their texts; `None` if the value is invalid or a text is
/// missing.
pub(super) fn restore_texts(value: &[u8], texts: &[&str]) -> Option<Vec<u8>> {
    let mut out = Vec::with_capacity(value.len());
    let mut rest = value;
    while !rest.is_empty() {
        let token = first_token(rest)?;
        rest = rest.get(token.bytes.len()..)?;
        match token.bytes {
            [FIXEXT4, TEXT_EXTENSION, number @ ..] => {
                let number = u32::from_be_bytes(number.try_into().ok()?);
                let text = *texts.get(usize::try_from(number).ok()?)?;
                if out.len() + text.len() > MAX_VALUE_BYTES {
                    return None;
                }
                out.push(0xdb);
                out.extend(u32::try_from(text.len()).ok()?.to_be_bytes());
                out.extend_from_slice(text.as_bytes());
            }
            other => out.extend_from_slice(other),
        }
    }
    Some(out)
}
