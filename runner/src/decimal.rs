//! Writes lines of JSON number by number. Files of moves have millions of lines, so this
//! avoids the general formatter.

use gsk_core::units::round_to_i64;

/// Millionths in a unit.
const ONE: u64 = 1_000_000;
/// Below this many millionths a number has at most fifteen digits. Its decimal form is then
/// the shortest that reads back as the same number.
const EXACT: f64 = 1e15;
/// The line of a move is rarely longer.
const USUAL_BYTES: usize = 256;

/// A line being written.
#[derive(Debug)]
pub(crate) struct Line {
    pub(crate) bytes: Vec<u8>,
}

impl Default for Line {
    fn default() -> Self {
        Self {
            bytes: Vec::with_capacity(USUAL_BYTES),
        }
    }
}

impl Line {
    /// Appends a text unchanged.
    #[inline]
    pub(crate) fn text(&mut self, text: &str) {
        self.bytes.extend_from_slice(text.as_bytes());
    }

    /// Appends a text and an integer.
    #[inline]
    pub(crate) fn number(&mut self, before: &str, number: u64) {
        self.text(before);
        self.digits(number);
    }

    /// Appends a text and a number rounded to a millionth, in the form of JSON: `50.0`,
    /// `-0.25`. `None`, NaN and infinities become `null`.
    #[inline]
    pub(crate) fn value(&mut self, before: &str, value: Option<f64>) {
        self.text(before);
        match value {
            Some(value) => self.decimal(value),
            None => self.text("null"),
        }
    }

    fn decimal(&mut self, value: f64) {
        let millionths = value * ONE as f64;
        if millionths.abs() < EXACT {
            self.millionths(round_to_i64(millionths));
        } else if millionths.is_finite() {
            self.text(&serde_json::Value::from(millionths.round() / ONE as f64).to_string());
        } else {
            self.text("null");
        }
    }

    fn millionths(&mut self, millionths: i64) {
        if millionths < 0 {
            self.text("-");
        }
        let size = millionths.unsigned_abs();
        // JSON writes these with an exponent.
        if (1..10).contains(&size) {
            self.digits(size);
            return self.text("e-6");
        }
        self.digits(size / ONE);
        self.text(".");
        self.fraction((size % ONE) as u32);
    }

    /// Appends decimal places without trailing zeros, at least one.
    fn fraction(&mut self, millionths: u32) {
        let [a, b] = pair(millionths / 10_000);
        let [c, d] = pair(millionths / 100 % 100);
        let [e, f] = pair(millionths % 100);
        let places = [a, b, c, d, e, f, b'0', b'0'];
        // Trailing zeros are zero bits of the highest bytes.
        let zeros = (u64::from_le_bytes(places) ^ u64::from_le_bytes([b'0'; 8])).leading_zeros();
        self.front_of(places, 8 - (zeros as usize / 8).min(7));
    }

    fn digits(&mut self, number: u64) {
        if number >= 10_000 {
            self.digits(number / 10_000);
            return self.four_digits((number % 10_000) as u32, 4);
        }
        let number = number as u32;
        let count = match number {
            0..10 => 1,
            10..100 => 2,
            100..1000 => 3,
            _ => 4,
        };
        self.four_digits(number, count);
    }

    /// Appends the last `count` digits of a number below ten thousand.
    fn four_digits(&mut self, number: u32, count: usize) {
        let ([a, b], [c, d]) = (pair(number / 100), pair(number % 100));
        let leading = 8 * (4 - count as u32);
        self.front_of(
            (u32::from_le_bytes([a, b, c, d]) >> leading).to_le_bytes(),
            count,
        );
    }

    /// Appends the first `count` bytes. Copying all bytes and truncating is quicker than
    /// copying a few.
    fn front_of<const N: usize>(&mut self, bytes: [u8; N], count: usize) {
        let length = self.bytes.len() + count;
        self.bytes.extend_from_slice(&bytes);
        self.bytes.truncate(length);
    }
}

/// The two digits of a number below a hundred.
fn pair(number: u32) -> [u8; 2] {
    PAIRS[number as usize % PAIRS.len()]
}

static PAIRS: [[u8; 2]; 100] = {
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
    use crate::moves::rounded;

    const SCALES: [f64; 7] = [1e-12, 1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e8];

    fn written(value: f64) -> String {
        let mut line = Line::default();
        line.value("", Some(value));
        String::from_utf8(line.bytes).expect("text")
    }

    fn of_json(value: f64) -> String {
        serde_json::to_string(&rounded(value)).expect("a number")
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
            assert_eq!(written(value), of_json(value), "{value}");
        }
        let mut line = Line::default();
        line.number("n", u64::MAX);
        line.value(":", None);
        assert_eq!(line.bytes, b"n18446744073709551615:null");
    }

    proptest! {
        #[test]
        fn any_number_is_written_as_json_writes_it(
            (size, scale) in (-1e6..1e6, prop::sample::select(&SCALES[..]))
        ) {
            let value: f64 = size * scale;
            prop_assert_eq!(written(value), of_json(value));
        }

        #[test]
        fn whole_numbers_have_all_their_digits((number, bits) in (any::<u64>(), 0..64_u32)) {
            let mut line = Line::default();
            line.number("", number >> bits);
            prop_assert_eq!(line.bytes, (number >> bits).to_string().into_bytes());
        }
    }
}
