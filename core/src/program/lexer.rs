//! Reads the characters of a program text: full-width characters as ASCII, blanks, comments,
//! ends of blocks.

use gsk_messages::say;

use super::syntax::BlockError;
use crate::alarm::number;

/// The result of [`Lexer::peek`] for a character that the language does not have.
pub(super) const INVALID_CHARACTER: u8 = 0xFF;

/// A reading position in a program text. It does not allocate and never moves past the end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lexer<'a> {
    bytes: &'a [u8],
    pub(super) at: usize,
}

impl<'a> Lexer<'a> {
    pub(super) const fn new(text: &'a str) -> Self {
        Self {
            bytes: text.as_bytes(),
            at: 0,
        }
    }

    pub(super) const fn starting_at(text: &'a str, at: usize) -> Self {
        Self {
            bytes: text.as_bytes(),
            at,
        }
    }

    /// The bytes from the position to the end of the text.
    #[inline]
    pub(super) fn rest(&self) -> &'a [u8] {
        self.bytes.get(self.at..).unwrap_or_default()
    }

    /// Returns the length of the text in bytes.
    pub(super) const fn end(&self) -> usize {
        self.bytes.len()
    }

    /// A lexer on the same text at the byte position `at`.
    pub(super) const fn moved_to(&self, at: usize) -> Self {
        Self { at, ..*self }
    }

    /// The character at the position and its length in bytes; `\n` with
    /// length 0 at the end of the text. A lone carriage return is an end of line like LF (the
    /// EOB of EIA).
    #[inline]
    pub(super) fn peek(&self) -> (u8, usize) {
        match self.bytes.get(self.at) {
            None => (b'\n', 0),
            Some(b'\r') => self.carriage_return(),
            Some(&byte) if byte < 0x80 => (byte, 1),
            Some(_) => to_ascii(&self.bytes[self.at..]),
        }
    }

    /// Skips blanks and ASCII letters, digits and marks that neither end a block nor begin a
    /// comment. Returns whether it skipped more than blanks.
    #[inline]
    pub(super) fn skip_plain(&mut self) -> bool {
        let mut has_word = false;
        while let Some(bytes) = self.rest().first_chunk() {
            let kinds = EightBytes::classify(*bytes);
            has_word |= kinds.has_word_before_other();
            self.at += kinds.count_before_other();
            if kinds.others != 0 {
                break;
            }
        }
        // The last bytes of the text, and tabs.
        while let Some(&byte) = self.bytes.get(self.at)
            && BYTE_KINDS[usize::from(byte)] != OTHER_BYTE
        {
            has_word |= BYTE_KINDS[usize::from(byte)] == WORD_BYTE;
            self.at += 1;
        }
        has_word
    }

    /// Skips a line feed. Returns whether there is one.
    #[inline]
    pub(super) fn skip_line_feed(&mut self) -> bool {
        let is_here = self.bytes.get(self.at) == Some(&b'\n');
        self.at += usize::from(is_here);
        is_here
    }

    /// Skips a digit, full-width or not, and returns its value; `None` before another
    /// character.
    #[inline]
    pub(super) fn read_digit(&mut self) -> Option<u8> {
        let (byte, len) = match self.bytes.get(self.at) {
            Some(&byte @ ..0x80) => (byte, 1),
            _ => self.peek(),
        };
        let value = byte.wrapping_sub(b'0');
        if value > 9 {
            return None;
        }
        self.at += len;
        Some(value)
    }

    fn carriage_return(&self) -> (u8, usize) {
        if self.bytes.get(self.at + 1) == Some(&b'\n') {
            (b' ', 1)
        } else {
            (b'\n', 1)
        }
    }

    /// Whether the position is at the end of the text.
    pub(super) const fn is_at_end(&self) -> bool {
        self.at >= self.bytes.len()
    }

    /// Skips blanks and comments. `Err`: a comment lacks its `)` in its line; the payload is
    /// the byte position of its `(`.
    #[inline]
    pub(super) fn skip_blanks(&mut self) -> Result<(), usize> {
        if self
            .bytes
            .get(self.at)
            .is_some_and(|&byte| BYTE_KINDS[usize::from(byte)] == WORD_BYTE)
        {
            return Ok(());
        }
        loop {
            let (byte, len) = self.peek();
            match byte {
                b' ' | b'\t' => self.at += len,
                b'(' => self.skip_comment()?,
                _ => return Ok(()),
            }
        }
    }

    /// Skips the comment at the position. Characters inside are not converted. A comment that
    /// begins with a full-width `（` may end with either kind. `Err`: byte position of the `(`
    /// if the comment has no end in its line.
    pub(super) fn skip_comment(&mut self) -> Result<(), usize> {
        let open = self.at;
        let (_, len) = self.peek();
        self.at += len;
        let wide = len > 1;
        loop {
            let Some(&byte) = self.bytes.get(self.at) else {
                return Err(open);
            };
            match byte {
                b')' => {
                    self.at += 1;
                    return Ok(());
                }
                b'\n' => return Err(open),
                b'\r' if self.carriage_return().0 == b'\n' => return Err(open),
                0xEF if wide && self.peek() == (b')', 3) => {
                    self.at += 3;
                    return Ok(());
                }
                _ => self.at += 1,
            }
        }
    }
}

/// Converts a byte position or a count in a block to `u16`, as words store it; greater values
/// become `u16::MAX`.
pub(super) fn clamp_to_u16(at: usize) -> u16 {
    u16::try_from(at).unwrap_or(u16::MAX)
}

/// Skips blanks and comments; a comment that lacks its `)` raises an alarm.
pub(super) fn skip_blanks(lexer: &mut Lexer<'_>) -> Result<(), BlockError> {
    lexer
        .skip_blanks()
        .map_err(|open| BlockError::at(number::BAD_CHARACTER, open, say::comment_not_closed()))
}

/// Class of a byte outside comments: a character that belongs to a word.
const WORD_BYTE: u8 = 1;
/// Class of a byte outside comments: a blank.
const BLANK_BYTE: u8 = 2;
/// Class of a byte outside comments: any other character.
const OTHER_BYTE: u8 = 0;
static BYTE_KINDS: [u8; 256] = {
    let mut kinds = [OTHER_BYTE; 256];
    let mut byte = b'+';
    while byte <= b'~' {
        if byte != b';' {
            kinds[byte as usize] = WORD_BYTE;
        }
        byte += 1;
    }
    kinds[b' ' as usize] = BLANK_BYTE;
    kinds[b'\t' as usize] = BLANK_BYTE;
    kinds
};

/// The classes of eight bytes at once: the highest bit of each byte that belongs to the class.
/// Blanks other than a space count as others.
struct EightBytes {
    words: u64,
    others: u64,
}

impl EightBytes {
    const ONES: u64 = 0x0101_0101_0101_0101;
    const HIGH_BITS: u64 = 0x80 * Self::ONES;

    #[inline]
    const fn classify(bytes: [u8; 8]) -> Self {
        let value = u64::from_le_bytes(bytes);
        // Without the highest bits no sum of two bytes carries into the next one.
        let low = value & !Self::HIGH_BITS;
        let ascii = !value & Self::HIGH_BITS;
        let words = low + (0x80 - b'+' as u64) * Self::ONES;
        let words = words & Self::differs_from(low, b';') & Self::differs_from(low, 0x7F) & ascii;
        let spaces = !Self::differs_from(low, b' ') & ascii;
        Self {
            words,
            others: !(words | spaces) & Self::HIGH_BITS,
        }
    }

    /// The bytes of `low`, below 0x80, that are not `byte`; the other bits are undefined.
    #[inline]
    const fn differs_from(low: u64, byte: u8) -> u64 {
        (low ^ (byte as u64 * Self::ONES)) + 0x7F * Self::ONES
    }

    /// Whether a byte before the first other one belongs to a word.
    #[inline]
    const fn has_word_before_other(&self) -> bool {
        let first_other = self.others & self.others.wrapping_neg();
        self.words & first_other.wrapping_sub(1) != 0
    }

    /// Number of bytes before the first other one.
    #[inline]
    const fn count_before_other(&self) -> usize {
        (self.others.trailing_zeros() / 8) as usize
    }
}

/// The ASCII form of a full-width character (U+FF01–U+FF5E), and its length in bytes.
/// Ideographic and no-break space and the byte order mark become a blank, others
/// [`INVALID_CHARACTER`]. `bytes` must not be empty.
#[cold]
fn to_ascii(bytes: &[u8]) -> (u8, usize) {
    match *bytes {
        [0xEF, 0xBC, low @ 0x81..=0xBF, ..] => (low - 0x81 + b'!', 3),
        [0xEF, 0xBD, low @ 0x80..=0x9E, ..] => (low - 0x80 + b'`', 3),
        [0xE3, 0x80, 0x80, ..] | [0xEF, 0xBB, 0xBF, ..] => (b' ', 3),
        [0xC2, 0xA0, ..] => (b' ', 2),
        [0xC0..=0xDF, ..] => (INVALID_CHARACTER, 2),
        [0xE0..=0xEF, ..] => (INVALID_CHARACTER, 3),
        [0xF0..=0xF7, ..] => (INVALID_CHARACTER, 4),
        _ => (INVALID_CHARACTER, 1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eight_bytes_are_classified_as_single_ones() {
        for byte in 0..=255 {
            for at in 0..8 {
                for around in [b'X', b' ', b';', 0, 0xFF] {
                    let mut bytes = [around; 8];
                    bytes[at] = byte;
                    let kinds = EightBytes::classify(bytes);
                    let kind_of = |byte: u8| match byte {
                        b'\t' => OTHER_BYTE,
                        byte => BYTE_KINDS[usize::from(byte)],
                    };
                    let is_other = |byte: &u8| kind_of(*byte) == OTHER_BYTE;
                    let count = bytes.iter().position(is_other).unwrap_or(8);
                    assert_eq!(kinds.count_before_other(), count, "{bytes:?}");
                    let has_word = bytes[..count].iter().any(|it| kind_of(*it) == WORD_BYTE);
                    assert_eq!(kinds.has_word_before_other(), has_word, "{bytes:?}");
                }
            }
        }
    }
}
