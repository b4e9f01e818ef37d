//! Bytes of a program file to text and back: which encoding it is in, and what
//! in it no encoding explains.

use std::fmt;

use encoding_rs::{CoderResult, DecoderResult, EncoderResult, GB18030, WINDOWS_1252};
use gsk_messages::{Message, say};

/// How the text of a file is written down.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Encoding {
    /// UTF-8 without a byte order mark (ASCII included).
    #[default]
    Utf8,
    /// UTF-8 with a byte order mark.
    Utf8Marked,
    /// UTF-16, low byte first, with a byte order mark.
    Utf16Little,
    /// UTF-16, high byte first, with a byte order mark.
    Utf16Big,
    /// GB18030 (GBK, GB2312).
    Gb18030,
    /// Windows-1252 (Latin-1).
    Windows1252,
}

impl fmt::Display for Encoding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Utf8 | Self::Utf8Marked => "UTF-8",
            Self::Utf16Little | Self::Utf16Big => "UTF-16",
            Self::Gb18030 => "GB18030",
            Self::Windows1252 => "Windows-1252",
        })
    }
}

/// A decoded file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Decoded {
    /// The text.
    pub text: String,
    /// What it was written in, to be written back the same way.
    pub encoding: Encoding,
}

/// Why bytes are no program text. Line and column count from 1; a column is a
/// character.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub enum DecodeError {
    /// A byte that text never has.
    Binary {
        /// The byte.
        byte: u8,
        /// Its line.
        line: usize,
        /// Its column.
        column: usize,
    },
    /// Bytes that the encoding does not know.
    Undecodable {
        /// The byte.
        byte: u8,
        /// The encoding that was tried last.
        encoding: Encoding,
        /// Its line.
        line: usize,
        /// Its column.
        column: usize,
    },
}

impl DecodeError {
    /// What is said of it.
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

/// Decodes the bytes of a program file: a byte order mark decides, else valid
/// UTF-8, else what the bytes beyond ASCII look like, GB18030 or Windows-1252. The leader
/// and the trailer of a tape (NUL) and the reader controls DC1 to DC4 are left out.
pub fn decode(mut bytes: Vec<u8>) -> Result<Decoded, DecodeError> {
    leave_out_leaders(&mut bytes);
    if bytes.starts_with(&[0xEF, 0xBB, 0xBF]) {
        let text = String::from_utf8(bytes[3..].to_vec())
            .map_err(|error| bad_utf8(error.as_bytes(), error.utf8_error().valid_up_to()))?;
        return plain(text, Encoding::Utf8Marked);
    }
    if bytes.starts_with(&[0xFF, 0xFE]) {
        return utf16(&bytes[2..], Encoding::Utf16Little, u16::from_le_bytes);
    }
    if bytes.starts_with(&[0xFE, 0xFF]) {
        return utf16(&bytes[2..], Encoding::Utf16Big, u16::from_be_bytes);
    }
    match String::from_utf8(bytes) {
        Ok(text) => plain(text, Encoding::Utf8),
        Err(error) => {
            let bytes = error.as_bytes();
            match western_signs(bytes) {
                Some((alone, pairs)) if alone > pairs => windows_1252(bytes),
                // In doubt what GB18030 can read is GB18030.
                Some((alone, pairs)) if alone == pairs && alone > 0 => match gb18030(bytes) {
                    Err(DecodeError::Undecodable { .. }) => windows_1252(bytes),
                    read => read,
                },
                _ => gb18030(bytes),
            }
        }
    }
}

/// Leaves out the NULs before a text and after its last line: the leader and the trailer of
/// a tape. Within a text they are the mark of a binary file.
fn leave_out_leaders(bytes: &mut Vec<u8>) {
    if matches!(bytes[..], [0xFF, 0xFE, ..] | [0xFE, 0xFF, ..]) {
        return;
    }
    let text = |byte: &u8| *byte != 0;
    let last = bytes.iter().rposition(text);
    if let Some(last) = last
        && matches!(bytes.get(last), Some(b'\n' | b'\r' | b'%' | b';'))
    {
        bytes.truncate(last + 1);
    }
    let begin = bytes.iter().position(text).unwrap_or(0);
    bytes.drain(..begin);
}

/// Counts bytes beyond ASCII that speak for Windows-1252, and pairs that speak for GB18030:
/// letters of Windows-1252 are single between ASCII, while the Chinese characters of a shop
/// floor (GB2312) are pairs of such bytes. None if a byte cannot be a western letter.
fn western_signs(bytes: &[u8]) -> Option<(usize, usize)> {
    /// Lead bytes of the common characters of GB2312.
    const COMMON: core::ops::RangeInclusive<u8> = 0xB0..=0xD7;
    /// Bytes that Windows-1252 leaves undefined, and ÿ, which is in no shop's comment.
    const NO_LETTERS: [u8; 6] = [0x81, 0x8D, 0x8F, 0x90, 0x9D, 0xFF];
    let (mut alone, mut pairs) = (0_usize, 0_usize);
    for run in bytes.split(u8::is_ascii).filter(|run| !run.is_empty()) {
        alone += run.len() % 2;
        let common = |pair: &&[u8]| COMMON.contains(&pair[0]) && pair[1] >= 0xA1;
        pairs += run.chunks_exact(2).filter(common).count();
    }
    let foreign = bytes.iter().any(|byte| NO_LETTERS.contains(byte));
    (!foreign).then_some((alone, pairs))
}

fn windows_1252(bytes: &[u8]) -> Result<Decoded, DecodeError> {
    let (text, _) = WINDOWS_1252.decode_without_bom_handling(bytes);
    plain(text.into_owned(), Encoding::Windows1252)
}

/// The bytes of a text in an encoding; characters that GB18030 cannot write do
/// not exist.
pub fn encode(text: &str, encoding: Encoding) -> Vec<u8> {
    match encoding {
        Encoding::Utf8 => text.as_bytes().to_vec(),
        Encoding::Utf8Marked => [&[0xEF, 0xBB, 0xBF], text.as_bytes()].concat(),
        Encoding::Utf16Little => with_mark(text, u16::to_le_bytes),
        Encoding::Utf16Big => with_mark(text, u16::to_be_bytes),
        Encoding::Gb18030 => gb18030_bytes(text),
        Encoding::Windows1252 => windows_1252_bytes(text),
    }
}

/// In UTF-8 where a character was added that Windows-1252 does not have.
fn windows_1252_bytes(text: &str) -> Vec<u8> {
    let mut encoder = WINDOWS_1252.new_encoder();
    let mut out = Vec::with_capacity(text.len() + 16);
    let (result, _) = encoder.encode_from_utf8_to_vec_without_replacement(text, &mut out, true);
    match result {
        EncoderResult::InputEmpty => out,
        EncoderResult::OutputFull | EncoderResult::Unmappable(_) => text.as_bytes().to_vec(),
    }
}

fn with_mark(text: &str, bytes: fn(u16) -> [u8; 2]) -> Vec<u8> {
    std::iter::once(0xFEFF)
        .chain(text.encode_utf16())
        .flat_map(bytes)
        .collect()
}

fn gb18030_bytes(text: &str) -> Vec<u8> {
    let mut encoder = GB18030.new_encoder();
    let mut out = Vec::new();
    let mut rest = text;
    loop {
        let room = encoder
            .max_buffer_length_from_utf8_if_no_unmappables(rest.len())
            .unwrap_or(rest.len().saturating_mul(4));
        out.reserve(room + 16);
        let (result, read, _) = encoder.encode_from_utf8_to_vec(rest, &mut out, true);
        rest = &rest[read..];
        if matches!(result, CoderResult::InputEmpty) {
            return out;
        }
    }
}

/// The place of the next character after a text, from 1.
fn place_after(text: &str) -> (usize, usize) {
    let line = text.bytes().filter(|byte| *byte == b'\n').count() + 1;
    let start = text.rfind('\n').map_or(0, |at| at + 1);
    (line, text[start..].chars().count() + 1)
}

fn bad_utf8(bytes: &[u8], valid: usize) -> DecodeError {
    let before = std::str::from_utf8(&bytes[..valid]).unwrap_or_default();
    let (line, column) = place_after(before);
    let byte = bytes.get(valid).copied().unwrap_or_default();
    DecodeError::Undecodable {
        byte,
        encoding: Encoding::Utf8,
        line,
        column,
    }
}

fn utf16(
    bytes: &[u8],
    encoding: Encoding,
    unit: fn([u8; 2]) -> u16,
) -> Result<Decoded, DecodeError> {
    let (units, odd) = bytes.as_chunks::<2>();
    let mut text = String::with_capacity(units.len());
    for decoded in char::decode_utf16(units.iter().map(|pair| unit(*pair))) {
        match decoded {
            Ok(character) => text.push(character),
            Err(error) => {
                let (line, column) = place_after(&text);
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
        let (line, column) = place_after(&text);
        return Err(DecodeError::Undecodable {
            byte: *byte,
            encoding,
            line,
            column,
        });
    }
    plain(text, encoding)
}

fn gb18030(bytes: &[u8]) -> Result<Decoded, DecodeError> {
    // A binary file is named as such, and not by some pair of bytes in it.
    if let Some(at) = bytes.iter().position(|byte| is_binary(*byte)) {
        let before = String::from_utf8_lossy(&bytes[..at]);
        let (line, column) = place_after(&before);
        return Err(DecodeError::Binary {
            byte: bytes[at],
            line,
            column,
        });
    }
    let mut decoder = GB18030.new_decoder_without_bom_handling();
    let room = decoder.max_utf8_buffer_length_without_replacement(bytes.len());
    let mut text = String::with_capacity(room.unwrap_or(bytes.len() * 4));
    let mut read = 0;
    loop {
        let (result, taken) =
            decoder.decode_to_string_without_replacement(&bytes[read..], &mut text, true);
        read += taken;
        match result {
            DecoderResult::InputEmpty => return plain(text, Encoding::Gb18030),
            DecoderResult::OutputFull => text.reserve(bytes.len() - read + 16),
            DecoderResult::Malformed(length, after) => {
                let at = read.saturating_sub(usize::from(length) + usize::from(after));
                let (line, column) = place_after(&text);
                let byte = bytes.get(at).copied().unwrap_or_default();
                let encoding = Encoding::Gb18030;
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

/// Control characters that no program text has. Tab, line ends, form feed,
/// the reader controls DC1–DC4 and the end mark of DOS may occur.
const fn is_binary(byte: u8) -> bool {
    matches!(byte, 0..=8 | 0x0E..=0x10 | 0x15..=0x19 | 0x1B..=0x1F)
}

/// Whether a text has control characters other than tabulators and ends of lines: hardly
/// any has, and this is quickly seen.
fn has_control(text: &[u8]) -> bool {
    let control = |byte: u8| byte < b' ' && byte != b'\n' && byte != b'\r' && byte != b'\t';
    (text.iter()).fold(false, |any, byte| any | control(*byte))
}

/// Whether a text has any; all bytes are looked at together.
fn has_binary(text: &[u8]) -> bool {
    (text.iter()).fold(false, |any, byte| any | is_binary(*byte))
}

/// The last gate: text without binary characters; an end mark of DOS and what
/// follows it is dropped.
fn plain(mut text: String, encoding: Encoding) -> Result<Decoded, DecodeError> {
    if !has_control(text.as_bytes()) {
        return Ok(Decoded { text, encoding });
    }
    if has_binary(text.as_bytes())
        && let Some(at) = text.bytes().position(is_binary)
    {
        let (line, column) = place_after(&text[..at]);
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
    Ok(Decoded { text, encoding })
}

/// The first line with a full-width letter or digit outside a comment: it is
/// read as its ASCII form, and the user is told.
pub fn full_width_line(text: &str) -> Option<usize> {
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

    fn text_of(bytes: &[u8]) -> Decoded {
        decode(bytes.to_vec()).expect("text")
    }

    #[test]
    fn every_encoding_comes_back_byte_for_byte() {
        let text = "O0001 (外圆 shaft)\r\nG00 X50.;\n";
        for encoding in [
            Encoding::Utf8,
            Encoding::Utf8Marked,
            Encoding::Utf16Little,
            Encoding::Utf16Big,
            Encoding::Gb18030,
        ] {
            let bytes = encode(text, encoding);
            let decoded = text_of(&bytes);
            assert_eq!(
                decoded,
                Decoded {
                    text: text.to_owned(),
                    encoding
                }
            );
        }
    }

    #[test]
    fn the_place_of_a_bad_byte_is_named() {
        // A GBK comment, then a lone 0xFF in line 2 after four characters.
        let mut bytes = encode("(车)\n", Encoding::Gb18030);
        bytes.extend(b"G00 ");
        bytes.push(0xFF);
        bytes.extend(b"X1\n");
        let error = decode(bytes).expect_err("bad byte");
        assert_eq!(
            error,
            DecodeError::Undecodable {
                byte: 0xFF,
                encoding: Encoding::Gb18030,
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
    fn a_marked_file_is_held_to_its_mark() {
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
        assert_eq!(text_of(b"G00 X1\r\n\x1a\x1a").text, "G00 X1\r\n");
        assert_eq!(text_of(b"").text, "");
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
            let bytes = encode(text, Encoding::Windows1252);
            let decoded = text_of(&bytes);
            assert_eq!(
                (decoded.text.as_str(), decoded.encoding),
                (text, Encoding::Windows1252)
            );
        }
        // Chinese stays Chinese, also beside letters and alone.
        for text in ["(车)\n", "(M8螺纹 粗车)\n", "T0101(外圆刀)\n(镗)\n"] {
            let bytes = encode(text, Encoding::Gb18030);
            assert_eq!(text_of(&bytes).encoding, Encoding::Gb18030, "{text}");
        }
        let chinese = encode("(\u{D8}车)", Encoding::Windows1252);
        assert_eq!(chinese, "(\u{D8}车)".as_bytes(), "nothing is lost");
    }

    #[test]
    fn leaders_and_reader_controls_are_no_text() {
        assert_eq!(
            text_of(b"\0\0\0%\nO0001\nM30\n%\n\0\0").text,
            "%\nO0001\nM30\n%\n"
        );
        assert_eq!(text_of(b"\x11%\nG00\x13 X1\n\x14").text, "%\nG00 X1\n");
        assert_eq!(
            text_of(b"\0\0\xEF\xBB\xBFG00\n").encoding,
            Encoding::Utf8Marked
        );
    }

    #[test]
    fn full_width_outside_comments_is_noticed() {
        assert_eq!(full_width_line("G00 X1 (ＡＢ)\nＧ01 Z2\n"), Some(2));
        assert_eq!(full_width_line("G00 (ＡＢ)\n"), None);
    }
}
