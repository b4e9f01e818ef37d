//! Writes lines of JSON number by number. Files of moves have millions of lines, so this avoids
//! the general formatter.

use crate::units::round_to_i64;

/// Number of millionths in 1.
const MILLIONTHS_PER_UNIT: u64 = 1_000_000;
/// Below this limit, in millionths, a number has at most fifteen digits. Its decimal form is
/// then the shortest that reads back as the same number.
const EXACT_MILLIONTHS_LIMIT: f64 = 1e15;

/// A line of JSON that is written piece by piece.
#[derive(Debug, Default)]
pub struct JsonLine {
    bytes: Vec<u8>,
}

impl JsonLine {
    /// The text written so far.
    pub fn as_bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Empties the line but keeps its memory.
    pub fn clear(&mut self) {
        self.bytes.clear();
    }

    /// Appends a text unchanged.
    pub fn push_text(&mut self, text: &str) {
        self.bytes.extend_from_slice(text.as_bytes());
    }

    /// Appends the text `before`, then an integer in decimal digits.
    pub fn push_integer(&mut self, before: &str, number: u64) {
        self.push_text(before);
        self.push_digits(number);
    }

    /// Appends the text `before`, then a number rounded to a millionth, in the form of JSON:
    /// `50.0`, `-0.25`. `None`, NaN and infinities become `null`.
    pub fn push_number(&mut self, before: &str, value: Option<f64>) {
        self.push_text(before);
        let millionths = value.unwrap_or(f64::NAN) * MILLIONTHS_PER_UNIT as f64;
        if millionths.abs() < EXACT_MILLIONTHS_LIMIT {
            self.push_millionths(round_to_i64(millionths));
        } else if millionths.is_finite() {
            let rounded = millionths.round() / MILLIONTHS_PER_UNIT as f64;
            // Numbers this large have positive exponents, before which JSON writes a plus.
            self.push_text(&format!("{rounded:?}").replace('e', "e+"));
        } else {
            self.push_text("null");
        }
    }

    /// Appends a number with up to four digits before its decimal point in one piece, as most
    /// are, and others in several.
    #[inline(always)]
    fn push_millionths(&mut self, millionths: i64) {
        let size = millionths.unsigned_abs();
        let whole = size / MILLIONTHS_PER_UNIT;
        let (places, place_count) = decimal_places((size % MILLIONTHS_PER_UNIT) as u32);
        if whole < 10_000 && !(1..10).contains(&size) {
            let (digits, count) = digits_below_10_000(whole as u32);
            let with_point = u64::from(digits) | u64::from(b'.') << (8 * count);
            let text = u128::from(with_point) | u128::from(places) << (8 * (count + 1));
            let length = count + 1 + place_count;
            return match millionths < 0 {
                true => self.push_prefix((text << 8 | u128::from(b'-')).to_le_bytes(), length + 1),
                false => self.push_prefix(text.to_le_bytes(), length),
            };
        }
        if millionths < 0 {
            self.push_text("-");
        }
        // JSON writes a few millionths with an exponent.
        if whole == 0 {
            self.push_digits(size);
            return self.push_text("e-6");
        }
        self.push_digits(whole);
        self.push_text(".");
        self.push_prefix(places.to_le_bytes(), place_count);
    }

    fn push_digits(&mut self, number: u64) {
        if number < 10_000 {
            let (digits, count) = digits_below_10_000(number as u32);
            return self.push_prefix(digits.to_le_bytes(), count);
        }
        self.push_digits(number / 10_000);
        let last = (number % 10_000) as u32;
        self.bytes.extend_from_slice(&digit_pair(last / 100));
        self.bytes.extend_from_slice(&digit_pair(last % 100));
    }

    /// Appends the first `count` bytes. Copying all bytes and truncating is quicker than
    /// copying a few.
    #[inline(always)]
    fn push_prefix<const N: usize>(&mut self, bytes: [u8; N], count: u32) {
        let length = self.bytes.len() + count as usize;
        self.bytes.extend_from_slice(&bytes);
        self.bytes.truncate(length);
    }
}

/// The digits of a number below ten thousand, as ASCII with the first one in the lowest byte,
/// and their count.
#[inline(always)]
fn digits_below_10_000(number: u32) -> (u32, u32) {
    let ([a, b], [c, d]) = (digit_pair(number / 100), digit_pair(number % 100));
    let count = 1 + u32::from(number >= 10) + u32::from(number >= 100) + u32::from(number >= 1000);
    let leading = 8 * (4 - count);
    (u32::from_le_bytes([a, b, c, d]) >> leading, count)
}

/// A fraction, in millionths, as decimal places, as ASCII with the first one in the lowest byte,
/// and their count: at least one digit, no further trailing zeros.
#[inline(always)]
fn decimal_places(millionths: u32) -> (u64, u32) {
    let [a, b] = digit_pair(millionths / 10_000);
    let [c, d] = digit_pair(millionths / 100 % 100);
    let [e, f] = digit_pair(millionths % 100);
    let places = u64::from_le_bytes([a, b, c, d, e, f, b'0', b'0']);
    // Trailing zeros are zero bits of the highest bytes.
    let zeros = (places ^ u64::from_le_bytes([b'0'; 8])).leading_zeros();
    (places, 8 - (zeros / 8).min(7))
}

/// The two decimal digits, as ASCII, of a number below a hundred.
#[inline(always)]
fn digit_pair(number: u32) -> [u8; 2] {
    DIGIT_PAIRS[number as usize % DIGIT_PAIRS.len()]
}

static DIGIT_PAIRS: [[u8; 2]; 100] = {
    let mut pairs = [[b'0'; 2]; 100];
    let mut number = 0;
    while number < pairs.len() {
        pairs[number] = [b'0' + (number / 10) as u8, b'0' + (number % 10) as u8];
        number += 1;
    }
    pairs
};
