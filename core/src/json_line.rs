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
/// Number of bytes that a sign, eight digits, a point and its places need at most.
const NUMBER_BYTES: usize = 16;
/// Number of texts of numbers that are kept: 2 to this power.
const KEPT_BITS: u32 = 4;
/// The character 0 in eight bytes.
const ZEROS: u64 = u64::from_le_bytes([b'0'; 8]);

/// A line of JSON that is written piece by piece.
#[derive(Debug, Default)]
pub struct JsonLine {
    /// The line, followed by bytes that the next pieces overwrite: a piece of a few bytes is
    /// written quicker with all bytes of an integer.
    bytes: Vec<u8>,
    length: usize,
    /// Texts of the last numbers, each at the place that [`kept_place`] gives: a move begins
    /// where the one before ended, often with its feed.
    kept: [NumberText; 1 << KEPT_BITS],
}

/// A number and its text.
#[derive(Clone, Copy, Debug)]
struct NumberText {
    value_bits: u64,
    /// The text, followed by any bytes.
    bytes: [u8; NUMBER_BYTES],
    length: usize,
}

impl Default for NumberText {
    fn default() -> Self {
        Self {
            value_bits: 0.0_f64.to_bits(),
            bytes: *b"0.0             ",
            length: 3,
        }
    }
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
    pub fn push_text(&mut self, text: &str) {
        let end = self.length + text.len();
        match self.bytes.get_mut(self.length..end) {
            Some(space) => space.copy_from_slice(text.as_bytes()),
            None => self.grow(text.as_bytes()),
        }
        self.length = end;
    }

    /// Appends a text whose length is known to the compiler, which is quicker.
    #[inline(always)]
    pub fn push_bytes<const N: usize>(&mut self, text: &[u8; N]) {
        self.push_prefix(text, N);
    }

    /// Appends the text `before`, then an integer in decimal digits.
    #[inline(always)]
    pub fn push_integer<const N: usize>(&mut self, before: &[u8; N], number: u64) {
        self.push_bytes(before);
        self.push_digits(number);
    }

    /// Appends the text `before`, then a number rounded to a millionth, in the form of JSON:
    /// `50.0`, `-0.25`. `None`, NaN and infinities become `null`.
    #[inline(always)]
    pub fn push_number<const N: usize>(&mut self, before: &[u8; N], value: Option<f64>) {
        self.push_bytes(before);
        match value {
            Some(value) => self.push_value(value),
            None => self.push_bytes(b"null"),
        }
    }

    fn push_value(&mut self, value: f64) {
        let kept = self.kept[kept_place(value)];
        if kept.value_bits == value.to_bits() {
            return self.push_prefix(&kept.bytes, kept.length);
        }
        self.push_new_value(value);
    }

    /// Appends a number with up to eight digits before its point without a branch for each digit,
    /// others by the general formatter.
    fn push_new_value(&mut self, value: f64) {
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
        let (sign, start) = match whole_millionths < 0 {
            true => (b'-', 1),
            false => (0, 0),
        };
        let point = start + digit_count;
        let bytes = u128::from(sign)
            | (u128::from(digits) << (8 * start))
            | (u128::from(fraction) << (8 * point));
        let text = NumberText {
            value_bits: value.to_bits(),
            bytes: bytes.to_le_bytes(),
            length: point + 1 + place_count,
        };
        self.push_prefix(&text.bytes, text.length);
        self.kept[kept_place(value)] = text;
    }

    #[cold]
    fn push_unusual(&mut self, millionths: f64) {
        let rounded = millionths.round() / MILLIONTHS_PER_UNIT;
        let text = format!("{rounded:?}");
        match rounded.abs() {
            size if !size.is_finite() => self.push_bytes(b"null"),
            size if size < 1.0 => self.push_text(&text),
            // JSON writes a plus before a positive exponent.
            _ => self.push_text(&text.replace('e', "e+")),
        }
    }

    fn push_digits(&mut self, number: u64) {
        if number < EIGHT_DIGITS_LIMIT {
            let (digits, count) = trimmed_digits(number as u32);
            return self.push_prefix(&digits.to_le_bytes(), count);
        }
        self.push_digits(number / EIGHT_DIGITS_LIMIT);
        let last = eight_digits((number % EIGHT_DIGITS_LIMIT) as u32) | ZEROS;
        self.push_prefix(&last.to_le_bytes(), 8);
    }

    /// Appends the first `count` bytes. Copying all bytes is quicker than copying a few.
    #[inline(always)]
    fn push_prefix<const N: usize>(&mut self, bytes: &[u8; N], count: usize) {
        let rest = self.bytes.get_mut(self.length..);
        match rest.and_then(<[u8]>::first_chunk_mut) {
            Some(space) => *space = *bytes,
            None => self.grow(bytes),
        }
        self.length += count;
    }

    /// Makes space and writes `bytes` at its beginning.
    #[cold]
    fn grow(&mut self, bytes: &[u8]) {
        self.bytes.truncate(self.length);
        self.bytes.extend_from_slice(bytes);
        self.bytes.resize(self.bytes.len().next_power_of_two(), 0);
    }
}

/// Where the text of a number is kept: the upper bits of a product mix all bits of the number.
const fn kept_place(value: f64) -> usize {
    const ODD: u64 = 0x9e37_79b9_7f4a_7c15;
    (value.to_bits().wrapping_mul(ODD) >> (u64::BITS - KEPT_BITS)) as usize
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
