//! Decodes program files to text and encodes text: detects the encoding and reports bytes
//! that no encoding explains.

use std::fmt;

use encoding_rs::{CoderResult, DecoderResult, EncoderResult, GB18030, WINDOWS_1252};
use gsk_core::program::has_control_characters;
use gsk_messages::{Message, say};

/// The encoding of a text file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TextEncoding {
    /// The text is UTF-8 (or ASCII) without a byte order mark.
    #[default]
    Utf8,
    /// The text is UTF-8 with a byte order mark.
    Utf8Marked,
    /// The text is UTF-16, low byte first, with a byte order mark.
    Utf16Little,
    /// The text is UTF-16, high byte first, with a byte order mark.
    Utf16Big,
    /// The text is GB18030 (also GBK or GB2312).
    Gb18030,
    /// The text is Windows-1252 (or Latin-1).
    Windows1252,
}

impl fmt::Display for TextEncoding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Utf8 | Self::Utf8Marked => "UTF-8",
            Self::Utf16Little | Self::Utf16Big => "UTF-16",
            Self::Gb18030 => "GB18030",
            Self::Windows1252 => "Windows-1252",
        })
    }
}

/// The text of a file and its encoding.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DecodedText {
    pub text: String,
    /// The encoding of the file, in which a changed text is written again.
    pub encoding: TextEncoding,
}

/// The reason why bytes are not a program text. Lines and columns count from 1; columns count
/// characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub enum DecodeError {
    /// A control character that no program text contains is at this position.
    Binary {
        byte: u8,
        line: usize,
        column: usize,
    },
    /// A byte that is invalid in the encoding is at this position.
    Undecodable {
        byte: u8,
        /// The encoding that was tried last.
        encoding: TextEncoding,
        line: usize,
        column: usize,
    },
}

impl DecodeError {
    pub fn message(&self) -> Message {
        match self {
            Self::Binary { byte, line, column } => {
                say::file_is_binary(format_args!("{byte:#04x}"), line, column)
            }
            Self::Undecodable {
                byte,
                encoding,
                line,
                column,
            } => say::file_not_text(line, column, format_args!("{byte:#04x}"), encoding),
        }
    }
}

/// Decodes the bytes of a program file. A byte order mark decides the encoding. Otherwise
/// valid UTF-8 is UTF-8; other bytes are GB18030 or Windows-1252, by their statistics. Drops
/// the leader and trailer of a tape (NUL) and the reader controls DC1 to DC4.
pub fn decode(mut bytes: Vec<u8>) -> Result<DecodedText, DecodeError> {
    remove_tape_leaders(&mut bytes);
    if bytes.starts_with(&[0xEF, 0xBB, 0xBF]) {
        let text = String::from_utf8(bytes[3..].to_vec())
            .map_err(|error| utf8_error(error.as_bytes(), error.utf8_error().valid_up_to()))?;
        return check_text(text, TextEncoding::Utf8Marked);
    }
    if bytes.starts_with(&[0xFF, 0xFE]) {
        return decode_utf16(&bytes[2..], TextEncoding::Utf16Little, u16::from_le_bytes);
    }
    if bytes.starts_with(&[0xFE, 0xFF]) {
        return decode_utf16(&bytes[2..], TextEncoding::Utf16Big, u16::from_be_bytes);
    }
    match String::from_utf8(bytes) {
        Ok(text) => check_text(text, TextEncoding::Utf8),
        Err(error) => {
            let bytes = error.as_bytes();
            match count_encoding_evidence(bytes) {
                Some((alone, pairs)) if alone > pairs => decode_windows_1252(bytes),
                // A tie counts as GB18030 if the bytes are valid in it.
                Some((alone, pairs)) if alone == pairs && alone > 0 => {
                    match decode_gb18030(bytes) {
                        Err(DecodeError::Undecodable { .. }) => decode_windows_1252(bytes),
                        read => read,
                    }
                }
                _ => decode_gb18030(bytes),
            }
        }
    }
}

/// Removes the NULs before a text and after its last line: the leader and the trailer of a
/// tape. NULs within a text mark a binary file.
fn remove_tape_leaders(bytes: &mut Vec<u8>) {
    if matches!(bytes[..], [0xFF, 0xFE, ..] | [0xFE, 0xFF, ..]) {
        return;
    }
    let is_text = |byte: &u8| *byte != 0;
    let last = bytes.iter().rposition(is_text);
    if let Some(last) = last
        && matches!(bytes.get(last), Some(b'\n' | b'\r' | b'%' | b';'))
    {
        bytes.truncate(last + 1);
    }
    let start = bytes.iter().position(is_text).unwrap_or(0);
    bytes.drain(..start);
}

/// Counts the evidence for Windows-1252 (single bytes beyond ASCII between ASCII) and for
/// GB18030 (pairs of bytes of common Chinese characters, GB2312). `None` if a byte is not a
/// western letter.
fn count_encoding_evidence(bytes: &[u8]) -> Option<(usize, usize)> {
    /// First bytes of the common Chinese characters in GB2312.
    const COMMON_LEAD_BYTES: core::ops::RangeInclusive<u8> = 0xB0..=0xD7;
    /// Bytes that Windows-1252 leaves undefined, and ÿ, which no comment contains.
    const NON_LETTERS: [u8; 6] = [0x81, 0x8D, 0x8F, 0x90, 0x9D, 0xFF];
    let (mut single_bytes, mut gb_pairs) = (0_usize, 0_usize);
    for run in bytes.split(u8::is_ascii).filter(|run| !run.is_empty()) {
        single_bytes += run.len() % 2;
        let is_common_pair = |pair: &&[u8]| COMMON_LEAD_BYTES.contains(&pair[0]) && pair[1] >= 0xA1;
        gb_pairs += run.chunks_exact(2).filter(is_common_pair).count();
    }
    let has_non_letter = bytes.iter().any(|byte| NON_LETTERS.contains(byte));
    (!has_non_letter).then_some((single_bytes, gb_pairs))
}

fn decode_windows_1252(bytes: &[u8]) -> Result<DecodedText, DecodeError> {
    let (text, _) = WINDOWS_1252.decode_without_bom_handling(bytes);
    check_text(text.into_owned(), TextEncoding::Windows1252)
}

/// Encodes a text. GB18030 can encode all characters; a text that Windows-1252 cannot encode
/// becomes UTF-8.
pub fn encode(text: &str, encoding: TextEncoding) -> Vec<u8> {
    match encoding {
        TextEncoding::Utf8 => text.as_bytes().to_vec(),
        TextEncoding::Utf8Marked => [&[0xEF, 0xBB, 0xBF], text.as_bytes()].concat(),
        TextEncoding::Utf16Little => encode_utf16(text, u16::to_le_bytes),
        TextEncoding::Utf16Big => encode_utf16(text, u16::to_be_bytes),
        TextEncoding::Gb18030 => encode_gb18030(text),
        TextEncoding::Windows1252 => encode_windows_1252(text),
    }
}

/// UTF-8 if the text contains a character that Windows-1252 lacks.
fn encode_windows_1252(text: &str) -> Vec<u8> {
    let mut encoder = WINDOWS_1252.new_encoder();
    let mut out = Vec::with_capacity(text.len() + 16);
    let (result, _) = encoder.encode_from_utf8_to_vec_without_replacement(text, &mut out, true);
    match result {
        EncoderResult::InputEmpty => out,
        EncoderResult::OutputFull | EncoderResult::Unmappable(_) => text.as_bytes().to_vec(),
    }
}

fn encode_utf16(text: &str, bytes: fn(u16) -> [u8; 2]) -> Vec<u8> {
    std::iter::once(0xFEFF)
        .chain(text.encode_utf16())
        .flat_map(bytes)
        .collect()
}

fn encode_gb18030(text: &str) -> Vec<u8> {
    let mut encoder = GB18030.new_encoder();
    let mut out = Vec::new();
    let mut rest = text;
    loop {
        let capacity = encoder
            .max_buffer_length_from_utf8_if_no_unmappables(rest.len())
            .unwrap_or(rest.len().saturating_mul(4));
        out.reserve(capacity + 16);
        let (result, read, _) = encoder.encode_from_utf8_to_vec(rest, &mut out, true);
        rest = &rest[read..];
        if matches!(result, CoderResult::InputEmpty) {
            return out;
        }
    }
}

/// Line and column, both from 1, of the character that would follow `text`.
fn position_after(text: &str) -> (usize, usize) {
    let line = text.bytes().filter(|byte| *byte == b'\n').count() + 1;
    let start = text.rfind('\n').map_or(0, |at| at + 1);
    (line, text[start..].chars().count() + 1)
}

fn utf8_error(bytes: &[u8], valid: usize) -> DecodeError {
    let before = std::str::from_utf8(&bytes[..valid]).unwrap_or_default();
    let (line, column) = position_after(before);
    let byte = bytes.get(valid).copied().unwrap_or_default();
    DecodeError::Undecodable {
        byte,
        encoding: TextEncoding::Utf8,
        line,
        column,
    }
}

fn decode_utf16(
    bytes: &[u8],
    encoding: TextEncoding,
    unit: fn([u8; 2]) -> u16,
) -> Result<DecodedText, DecodeError> {
    let (units, odd) = bytes.as_chunks::<2>();
    let mut text = String::with_capacity(units.len());
    for decoded in char::decode_utf16(units.iter().map(|pair| unit(*pair))) {
        match decoded {
            Ok(character) => text.push(character),
            Err(error) => {
                let (line, column) = position_after(&text);
                let byte = error.unpaired_surrogate().to_be_bytes()[0];
                return Err(DecodeError::Undecodable {
                    byte,
                    encoding,
                    line,
                    column,
                });
            }
        }
    }
    if let Some(byte) = odd.first() {
        let (line, column) = position_after(&text);
        return Err(DecodeError::Undecodable {
            byte: *byte,
            encoding,
            line,
            column,
        });
    }
    check_text(text, encoding)
}

fn decode_gb18030(bytes: &[u8]) -> Result<DecodedText, DecodeError> {
    // Report a binary file as such, not as an invalid pair of bytes.
    if let Some(at) = bytes.iter().position(|byte| is_binary(*byte)) {
        let before = String::from_utf8_lossy(&bytes[..at]);
        let (line, column) = position_after(&before);
        return Err(DecodeError::Binary {
            byte: bytes[at],
            line,
            column,
        });
    }
    let mut decoder = GB18030.new_decoder_without_bom_handling();
    let capacity = decoder.max_utf8_buffer_length_without_replacement(bytes.len());
    let mut text = String::with_capacity(capacity.unwrap_or(bytes.len() * 4));
    let mut read = 0;
    loop {
        let (result, consumed) =
            decoder.decode_to_string_without_replacement(&bytes[read..], &mut text, true);
        read += consumed;
        match result {
            DecoderResult::InputEmpty => return check_text(text, TextEncoding::Gb18030),
            DecoderResult::OutputFull => text.reserve(bytes.len() - read + 16),
            DecoderResult::Malformed(length, after) => {
                let at = read.saturating_sub(usize::from(length) + usize::from(after));
                let (line, column) = position_after(&text);
                let byte = bytes.get(at).copied().unwrap_or_default();
                let encoding = TextEncoding::Gb18030;
                return Err(DecodeError::Undecodable {
                    byte,
                    encoding,
                    line,
                    column,
                });
            }
        }
    }
}

/// Whether a byte is a control character that no program text contains. Tab, line ends, form
/// feed, the reader controls DC1 to DC4 and the end mark of DOS are allowed.
const fn is_binary(byte: u8) -> bool {
    matches!(byte, 0..=8 | 0x0E..=0x10 | 0x15..=0x19 | 0x1B..=0x1F)
}

/// Whether a text has a binary character. The loop has no branch, so that it vectorizes.
fn has_binary_characters(text: &[u8]) -> bool {
    (text.iter()).fold(false, |any, byte| any | is_binary(*byte))
}

/// Checks a decoded text for binary characters and cuts it at the end mark of DOS. Returns an error
/// if it has binary characters.
fn check_text(mut text: String, encoding: TextEncoding) -> Result<DecodedText, DecodeError> {
    if !has_control_characters(text.as_bytes()) {
        return Ok(DecodedText { text, encoding });
    }
    if has_binary_characters(text.as_bytes())
        && let Some(at) = text.bytes().position(is_binary)
    {
        let (line, column) = position_after(&text[..at]);
        return Err(DecodeError::Binary {
            byte: text.as_bytes()[at],
            line,
            column,
        });
    }
    if let Some(end) = text.find('\u{1A}') {
        text.truncate(end);
    }
    text.retain(|letter| !matches!(letter, '\u{11}'..='\u{14}'));
    Ok(DecodedText { text, encoding })
}

/// The first line, from 1, with a full-width letter or digit outside a comment; `None` without one.
/// The control reads it as ASCII; the operator is notified.
pub fn find_full_width_line(text: &str) -> Option<usize> {
    if text.is_ascii() {
        return None;
    }
    let mut depth = 0usize;
    for (index, line) in text.lines().enumerate() {
        for character in line.chars() {
            match character {
                '(' => depth += 1,
                ')' => depth = depth.saturating_sub(1),
                '\u{FF01}'..='\u{FF5E}' | '\u{3000}' if depth == 0 => return Some(index + 1),
                _ => {}
            }
        }
        depth = 0;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decode_text(bytes: &[u8]) -> DecodedText {
        decode(bytes.to_vec()).expect("text")
    }

    #[test]
    fn every_encoding_comes_back_byte_for_byte() {
        let text = "O0001 (外圆 shaft)\r\nG00 X50.;\n";
        for encoding in [
            TextEncoding::Utf8,
            TextEncoding::Utf8Marked,
            TextEncoding::Utf16Little,
            TextEncoding::Utf16Big,
            TextEncoding::Gb18030,
        ] {
            let bytes = encode(text, encoding);
            let decoded = decode_text(&bytes);
            assert_eq!(
                decoded,
                DecodedText {
                    text: text.to_owned(),
                    encoding
                }
            );
        }
    }

    #[test]
    fn the_position_of_a_bad_byte_is_reported() {
        // A GBK comment, then a lone 0xFF in line 2 after four characters.
        let mut bytes = encode("(车)\n", TextEncoding::Gb18030);
        bytes.extend(b"G00 ");
        bytes.push(0xFF);
        bytes.extend(b"X1\n");
        let error = decode(bytes).expect_err("bad byte");
        assert_eq!(
            error,
            DecodeError::Undecodable {
                byte: 0xFF,
                encoding: TextEncoding::Gb18030,
                line: 2,
                column: 5
            }
        );
    }

    #[test]
    fn a_picture_is_a_binary_file() {
        let error = decode(b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR".to_vec()).expect_err("binary");
        assert!(
            matches!(
                error,
                DecodeError::Binary {
                    byte: 0,
                    line: 3,
                    column: 1
                }
            ),
            "{error:?}"
        );
        let error = decode(vec![b'G', 0]).expect_err("binary");
        assert!(error.to_string().contains("line 1, column 2"));
    }

    #[test]
    fn a_byte_order_mark_decides_the_encoding() {
        let error = decode(vec![0xEF, 0xBB, 0xBF, b'G', 0xB3]).expect_err("bad UTF-8");
        assert!(matches!(
            error,
            DecodeError::Undecodable {
                line: 1,
                column: 2,
                ..
            }
        ));
        let error = decode(vec![0xFF, 0xFE, b'G', 0, b'1']).expect_err("odd byte");
        assert!(matches!(
            error,
            DecodeError::Undecodable {
                line: 1,
                column: 2,
                ..
            }
        ));
    }

    #[test]
    fn the_end_mark_of_dos_ends_the_text() {
        assert_eq!(decode_text(b"G00 X1\r\n\x1a\x1a").text, "G00 X1\r\n");
        assert_eq!(decode_text(b"").text, "");
    }

    #[test]
    fn western_comments_are_windows_1252() {
        for text in [
            "O0147 (BUCHSE)\nT0101 (WKZ \u{D8}20)\n",
            "(f\u{FC}r Ma\u{DF} \u{B1}0.1, 45\u{B0})\nG00 X1\n",
            "(Gr\u{F6}\u{DF}e f\u{FC}r pi\u{E8}ce)\n",
            "(\u{20AC} \u{D8})\n",
            "(\u{D6}\u{C4}NDERUNG \u{E4}\u{F6}\u{FC} \u{E9}\u{E8})\n",
        ] {
            let bytes = encode(text, TextEncoding::Windows1252);
            let decoded = decode_text(&bytes);
            assert_eq!(
                (decoded.text.as_str(), decoded.encoding),
                (text, TextEncoding::Windows1252)
            );
        }
        // Chinese stays Chinese, also beside letters and alone.
        for text in ["(车)\n", "(M8螺纹 粗车)\n", "T0101(外圆刀)\n(镗)\n"] {
            let bytes = encode(text, TextEncoding::Gb18030);
            assert_eq!(
                decode_text(&bytes).encoding,
                TextEncoding::Gb18030,
                "{text}"
            );
        }
        let chinese = encode("(\u{D8}车)", TextEncoding::Windows1252);
        assert_eq!(chinese, "(\u{D8}车)".as_bytes(), "nothing is lost");
    }

    #[test]
    fn leaders_and_reader_controls_are_no_text() {
        assert_eq!(
            decode_text(b"\0\0\0%\nO0001\nM30\n%\n\0\0").text,
            "%\nO0001\nM30\n%\n"
        );
        assert_eq!(decode_text(b"\x11%\nG00\x13 X1\n\x14").text, "%\nG00 X1\n");
        assert_eq!(
            decode_text(b"\0\0\xEF\xBB\xBFG00\n").encoding,
            TextEncoding::Utf8Marked
        );
    }

    #[test]
    fn full_width_letters_outside_comments_are_found() {
        assert_eq!(find_full_width_line("G00 X1 (ＡＢ)\nＧ01 Z2\n"), Some(2));
        assert_eq!(find_full_width_line("G00 (ＡＢ)\n"), None);
    }
}
