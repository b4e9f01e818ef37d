//! Writes lines of JSON number by number. Files of moves have millions of lines, so this avoids
//! the general formatter.

use crate::units::round_to_i64;

/// Number of millionths in 1.
const MILLIONTHS_PER_UNIT: f64 = 1e6;
/// Numbers below this limit have at most eight digits.
const EIGHT_DIGITS_LIMIT: u64 = 100_000_000;
/// Below this limit, in millionths, a number has at most eight digits before its point. Its decimal
/// form is then the shortest that reads back as the same number.
const EXACT_MILLIONTHS_LIMIT: u64 = EIGHT_DIGITS_LIMIT * 1_000_000;
/// Number of bytes that a sign, eight digits, a point and its places need at most, with the
/// bytes that are written after them.
const NUMBER_BYTES: usize = 17;
/// The character 0 in eight bytes.
const ZEROS: u64 = u64::from_le_bytes([b'0'; 8]);

/// A line of JSON that is written piece by piece.
#[derive(Debug, Default)]
pub struct JsonLine {
    /// The line, followed by bytes that the next pieces overwrite: a piece of a few bytes is
    /// written quicker with all bytes of an integer.
    bytes: Vec<u8>,
    length: usize,
}

impl JsonLine {
    /// The text written so far.
    pub fn as_bytes(&self) -> &[u8] {
        self.bytes.get(..self.length).unwrap_or(&[])
    }

    /// Empties the line but keeps its memory.
    pub const fn clear(&mut self) {
        self.length = 0;
    }

    /// Appends a text unchanged.
    #[inline(always)]
    pub fn push_text(&mut self, text: &str) {
        self.space(text.len()).copy_from_slice(text.as_bytes());
        self.length += text.len();
    }

    /// Appends the text `before`, then an integer in decimal digits.
    pub fn push_integer(&mut self, before: &str, number: u64) {
        self.push_text(before);
        self.push_digits(number);
    }

    /// Appends the text `before`, then a number rounded to a millionth, in the form of JSON:
    /// `50.0`, `-0.25`. `None`, NaN and infinities become `null`.
    #[inline(always)]
    pub fn push_number(&mut self, before: &str, value: Option<f64>) {
        self.push_text(before);
        match value {
            Some(value) => self.push_value(value),
            None => self.push_text("null"),
        }
    }

    /// Appends a number with up to eight digits before its point without a branch for each digit,
    /// others by the general formatter.
    fn push_value(&mut self, value: f64) {
        let millionths = value * MILLIONTHS_PER_UNIT;
        let whole_millionths = round_to_i64(millionths);
        let size = whole_millionths.unsigned_abs();
        // JSON writes a few millionths with an exponent.
        let has_exponent = (1..10).contains(&size);
        if has_exponent || size >= EXACT_MILLIONTHS_LIMIT || value.is_nan() {
            return self.push_unusual(millionths);
        }
        let (digits, digit_count) = trimmed_digits((size / 1_000_000) as u32);
        // Two further places are zeros, which are not written.
        let places = eight_digits((size % 1_000_000) as u32 * 100);
        let place_count = (8 - places.leading_zeros() as usize / 8).max(1);
        let fraction = u64::from(b'.') | ((places | ZEROS) << 8);
        let text = self.space(NUMBER_BYTES);
        text[0] = b'-';
        let start = usize::from(whole_millionths < 0);
        let point = start + digit_count;
        text[start..start + 8].copy_from_slice(&digits.to_le_bytes());
        text[point..point + 8].copy_from_slice(&fraction.to_le_bytes());
        self.length += point + 1 + place_count;
    }

    #[cold]
    fn push_unusual(&mut self, millionths: f64) {
        let rounded = millionths.round() / MILLIONTHS_PER_UNIT;
        let text = format!("{rounded:?}");
        match rounded.abs() {
            size if !size.is_finite() => self.push_text("null"),
            size if size < 1.0 => self.push_text(&text),
            // JSON writes a plus before a positive exponent.
            _ => self.push_text(&text.replace('e', "e+")),
        }
    }

    fn push_digits(&mut self, number: u64) {
        if number < EIGHT_DIGITS_LIMIT {
            let (digits, count) = trimmed_digits(number as u32);
            return self.push_prefix(digits.to_le_bytes(), count);
        }
        self.push_digits(number / EIGHT_DIGITS_LIMIT);
        let last = eight_digits((number % EIGHT_DIGITS_LIMIT) as u32) | ZEROS;
        self.push_prefix(last.to_le_bytes(), 8);
    }

    /// Appends the first `count` bytes. Copying all bytes is quicker than copying a few.
    #[inline(always)]
    fn push_prefix<const N: usize>(&mut self, bytes: [u8; N], count: usize) {
        self.space(N).copy_from_slice(&bytes);
        self.length += count;
    }

    /// The next `count` bytes of the line.
    #[inline(always)]
    fn space(&mut self, count: usize) -> &mut [u8] {
        let end = self.length + count;
        if self.bytes.len() < end {
            self.grow(end);
        }
        &mut self.bytes[self.length..end]
    }

    #[cold]
    fn grow(&mut self, length: usize) {
        self.bytes.resize(length.next_power_of_two(), 0);
    }
}

/// The digits of a number below 10^8, as ASCII with the first one in the lowest byte, and their
/// count.
#[inline(always)]
fn trimmed_digits(number: u32) -> (u64, usize) {
    let digits = eight_digits(number);
    let zeros = (digits.trailing_zeros() as usize / 8).min(7);
    ((digits | ZEROS) >> (8 * zeros), 8 - zeros)
}

/// The eight decimal digits of a number below 10^8 as numbers, a byte each, the first digit in
/// the lowest byte. Divides in parts of a word: by 10^4, then both halves by 100, then the four
/// quarters by 10.
#[inline(always)]
const fn eight_digits(number: u32) -> u64 {
    let number = number as u64;
    let halves = (number / 10_000) | ((number % 10_000) << 32);
    let hundreds = ((halves * 5243) >> 19) & 0x7f_0000_007f;
    let quarters = hundreds | ((halves - 100 * hundreds) << 16);
    let tens = ((quarters * 103) >> 10) & 0x000f_000f_000f_000f;
    tens | ((quarters - 10 * tens) << 8)
}
