//! Writes lines of JSON number by number. Files of moves have millions of lines, so this
//! avoids the general formatter.

use gsk_core::units::round_to_i64;

/// Number of millionths in 1.
const MILLIONTHS_PER_UNIT: u64 = 1_000_000;
/// Below this limit, in millionths, a number has at most fifteen digits. Its decimal form is
/// then the shortest that reads back as the same number.
const EXACT_MILLIONTHS_LIMIT: f64 = 1e15;
/// Initial capacity of a line, bytes; the line of a move is rarely longer.
const LINE_CAPACITY_BYTES: usize = 256;

/// A line of JSON that is written piece by piece.
#[derive(Debug)]
pub(crate) struct JsonLine {
    pub(crate) bytes: Vec<u8>,
}

impl Default for JsonLine {
    fn default() -> Self {
        Self {
            bytes: Vec::with_capacity(LINE_CAPACITY_BYTES),
        }
    }
}

impl JsonLine {
    /// Appends a text unchanged.
    #[inline]
    pub(crate) fn push_text(&mut self, text: &str) {
        self.bytes.extend_from_slice(text.as_bytes());
    }

    /// Appends the text `before`, then an integer in decimal digits.
    #[inline]
    pub(crate) fn push_integer(&mut self, before: &str, number: u64) {
        self.push_text(before);
        self.push_digits(number);
    }

    /// Appends the text `before`, then a number rounded to a millionth, in the form of JSON:
    /// `50.0`, `-0.25`. `None`, NaN and infinities become `null`.
    #[inline]
    pub(crate) fn push_number(&mut self, before: &str, value: Option<f64>) {
        self.push_text(before);
        match value {
            Some(value) => self.push_decimal(value),
            None => self.push_text("null"),
        }
    }

    fn push_decimal(&mut self, value: f64) {
        let millionths = value * MILLIONTHS_PER_UNIT as f64;
        if millionths.abs() < EXACT_MILLIONTHS_LIMIT {
            self.push_millionths(round_to_i64(millionths));
        } else if millionths.is_finite() {
            self.push_text(
                &serde_json::Value::from(millionths.round() / MILLIONTHS_PER_UNIT as f64)
                    .to_string(),
            );
        } else {
            self.push_text("null");
        }
    }

    fn push_millionths(&mut self, millionths: i64) {
        if millionths < 0 {
            self.push_text("-");
        }
        let size = millionths.unsigned_abs();
        // JSON writes these with an exponent.
        if (1..10).contains(&size) {
            self.push_digits(size);
            return self.push_text("e-6");
        }
        self.push_digits(size / MILLIONTHS_PER_UNIT);
        self.push_text(".");
        self.push_fraction((size % MILLIONTHS_PER_UNIT) as u32);
    }

    /// Appends a fraction, in millionths, as decimal places: at least one digit, no further
    /// trailing zeros.
    fn push_fraction(&mut self, millionths: u32) {
        let [a, b] = digit_pair(millionths / 10_000);
        let [c, d] = digit_pair(millionths / 100 % 100);
        let [e, f] = digit_pair(millionths % 100);
        let places = [a, b, c, d, e, f, b'0', b'0'];
        // Trailing zeros are zero bits of the highest bytes.
        let zeros = (u64::from_le_bytes(places) ^ u64::from_le_bytes([b'0'; 8])).leading_zeros();
        self.push_prefix(places, 8 - (zeros as usize / 8).min(7));
    }

    fn push_digits(&mut self, number: u64) {
        if number >= 10_000 {
            self.push_digits(number / 10_000);
            return self.push_last_digits((number % 10_000) as u32, 4);
        }
        let number = number as u32;
        let count = match number {
            0..10 => 1,
            10..100 => 2,
            100..1000 => 3,
            _ => 4,
        };
        self.push_last_digits(number, count);
    }

    /// Appends the last `count` digits of a number below ten thousand.
    fn push_last_digits(&mut self, number: u32, count: usize) {
        let ([a, b], [c, d]) = (digit_pair(number / 100), digit_pair(number % 100));
        let leading = 8 * (4 - count as u32);
        self.push_prefix(
            (u32::from_le_bytes([a, b, c, d]) >> leading).to_le_bytes(),
            count,
        );
    }

    /// Appends the first `count` bytes. Copying all bytes and truncating is quicker than
    /// copying a few.
    fn push_prefix<const N: usize>(&mut self, bytes: [u8; N], count: usize) {
        let length = self.bytes.len() + count;
        self.bytes.extend_from_slice(&bytes);
        self.bytes.truncate(length);
    }
}

/// The two decimal digits, as ASCII, of a number below a hundred.
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

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::move_output::round_to_millionth;

    const SCALES: [f64; 7] = [1e-12, 1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e8];

    fn json_line_text(value: f64) -> String {
        let mut line = JsonLine::default();
        line.push_number("", Some(value));
        String::from_utf8(line.bytes).expect("text")
    }

    fn serde_json_text(value: f64) -> String {
        serde_json::to_string(&round_to_millionth(value)).expect("a number")
    }

    #[test]
    fn numbers_are_written_as_json_writes_them() {
        for value in [
            0.0,
            -0.0,
            1.0,
            -0.25,
            4e-7,
            6e-7,
            -1e-6,
            9e-6,
            1e-5,
            0.1,
            1e8,
            999_999_999.999_999,
            1e9,
            123_456_789_012.3,
            1e17,
            1e22,
            -1e300,
            f64::MAX,
            f64::INFINITY,
            f64::NAN,
        ] {
            assert_eq!(json_line_text(value), serde_json_text(value), "{value}");
        }
        let mut line = JsonLine::default();
        line.push_integer("n", u64::MAX);
        line.push_number(":", None);
        assert_eq!(line.bytes, b"n18446744073709551615:null");
    }

    proptest! {
        #[test]
        fn any_number_is_written_as_json_writes_it(
            (size, scale) in (-1e6..1e6, prop::sample::select(&SCALES[..]))
        ) {
            let value: f64 = size * scale;
            prop_assert_eq!(json_line_text(value), serde_json_text(value));
        }

        #[test]
        fn whole_numbers_have_all_their_digits((number, bits) in (any::<u64>(), 0..64_u32)) {
            let mut line = JsonLine::default();
            line.push_integer("", number >> bits);
            prop_assert_eq!(line.bytes, (number >> bits).to_string().into_bytes());
        }
    }
}
