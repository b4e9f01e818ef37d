//! The text of a DXF file: encoding, and pairs of a group code and a value.

use std::borrow::Cow;

use encoding_rs::{Encoding, WINDOWS_1252};
use gsk_messages::{Message, say};
use gsk_units::parse_finite;

/// A group code with its value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct GroupTag<'a> {
    pub(super) code: i32,
    pub(super) value: &'a str,
    /// Line of the value in the file, from 1.
    pub(super) line: usize,
}

impl GroupTag<'_> {
    /// The value as a number.
    pub(super) fn number(&self) -> Result<f64, Message> {
        let number = parse_finite(self.value);
        number.ok_or_else(|| say::outline_bad_number(self.line, shortened(self.value)))
    }

    /// The value as a whole number; 0 for another value.
    pub(super) fn flags(&self) -> i64 {
        self.value.parse().unwrap_or_default()
    }
}

/// The first characters of a text that a message quotes.
pub(super) fn shortened(text: &str) -> String {
    const LONGEST: usize = 30;
    text.chars().take(LONGEST).collect()
}

/// Decodes the bytes of a DXF file: UTF-8, or the code page that its header names.
pub(super) fn decode(bytes: &[u8]) -> Cow<'_, str> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    if let Ok(text) = core::str::from_utf8(bytes) {
        return Cow::Borrowed(text);
    }
    find_code_page(bytes)
        .unwrap_or(WINDOWS_1252)
        .decode(bytes)
        .0
}

/// The encoding of `$DWGCODEPAGE`; `None` without one.
fn find_code_page(bytes: &[u8]) -> Option<&'static Encoding> {
    const NAME: &[u8] = b"$DWGCODEPAGE";
    let at = bytes
        .windows(NAME.len())
        .position(|window| window == NAME)?;
    let rest = &bytes[at..];
    let mut lines = rest.split(|byte| *byte == b'\n');
    let value = core::str::from_utf8(lines.nth(2)?).ok()?;
    let number = value.trim().to_ascii_lowercase();
    let number = number.strip_prefix("ansi_")?;
    let label = match number {
        "936" => "gbk",
        "950" => "big5",
        "932" => "shift_jis",
        "949" => "euc-kr",
        "874" => "windows-874",
        other => return Encoding::for_label(format!("windows-{other}").as_bytes()),
    };
    Encoding::for_label(label.as_bytes())
}

/// Splits a DXF text into its tags.
///
/// # Errors
/// A line that must be a group code is not a whole number.
pub(super) fn split_tags(text: &str) -> Result<Vec<GroupTag<'_>>, Message> {
    let mut lines = text.lines().zip(1..);
    let mut tags = Vec::new();
    while let Some((code, line)) = lines.next() {
        let code = code.trim();
        let Some((value, value_line)) = lines.next() else {
            // Text after the end of the file.
            break;
        };
        let code = code
            .parse()
            .map_err(|_| say::outline_bad_group_code(line, shortened(code)))?;
        let tag = GroupTag {
            code,
            value: value.trim(),
            line: value_line,
        };
        tags.push(tag);
        if code == 0 && tag.value == "EOF" {
            break;
        }
    }
    Ok(tags)
}

/// A text with characters written as `\U+4E2D`.
pub(super) fn unescape(text: &str) -> String {
    let mut pieces = text.split("\\U+");
    let mut out = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        let code = piece
            .get(..4)
            .and_then(|hex| u32::from_str_radix(hex, 16).ok());
        match code.and_then(char::from_u32) {
            Some(letter) => {
                out.push(letter);
                out.push_str(&piece[4..]);
            }
            None => {
                out.push_str("\\U+");
                out.push_str(piece);
            }
        }
    }
    out
}
