//! A line of JSON put together number by number: files of moves hold millions of them.

/// Millionths in one.
const ONE: u64 = 1_000_000;
/// Decimal places of a millionth.
const PLACES: usize = 6;
/// Below this many millionths a number has at most fifteen digits, and its decimal form
/// is the shortest one that reads back as the same number.
const EXACT: f64 = 1e15;
/// A line of a move is hardly longer.
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
    /// Text as it is.
    pub(crate) fn text(&mut self, text: &str) {
        self.bytes.extend_from_slice(text.as_bytes());
    }

    /// A whole number behind a text.
    pub(crate) fn number(&mut self, before: &str, number: u64) {
        self.text(before);
        self.digits(number);
    }

    /// A number rounded to a millionth behind a text, as JSON writes it: `50.0`, `-0.25`;
    /// `null` for none and for what is no number.
    pub(crate) fn value(&mut self, before: &str, value: Option<f64>) {
        self.text(before);
        let millionths = value.map_or(f64::NAN, |value| (value * ONE as f64).round());
        if millionths.abs() < EXACT {
            self.millionths(millionths as i64);
        } else if millionths.is_finite() {
            self.text(&serde_json::Value::from(millionths / ONE as f64).to_string());
        } else {
            self.text("null");
        }
    }

    fn millionths(&mut self, millionths: i64) {
        if millionths < 0 {
            self.text("-");
        }
        let size = millionths.unsigned_abs();
        // JSON goes over to exponents there.
        if (1..10).contains(&size) {
            self.digits(size);
            return self.text("e-6");
        }
        self.digits(size / ONE);
        self.text(".");
        self.fraction(size % ONE);
    }

    /// Decimal places without the zeros at the end, one at least.
    fn fraction(&mut self, mut millionths: u64) {
        let mut places = [b'0'; PLACES];
        for place in places.iter_mut().rev() {
            *place += (millionths % 10) as u8;
            millionths /= 10;
        }
        let last = places.iter().rposition(|place| *place != b'0');
        self.bytes.extend_from_slice(&places[..=last.unwrap_or(0)]);
    }

    fn digits(&mut self, mut number: u64) {
        let mut digits = [b'0'; 20];
        let mut first = digits.len();
        loop {
            first -= 1;
            digits[first] += (number % 10) as u8;
            number /= 10;
            if number == 0 {
                break;
            }
        }
        self.bytes.extend_from_slice(&digits[first..]);
    }
}

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
    }
}
