//! Reads numbers from outside: decimal text and RON files in which every number is finite.
//!
//! Rust and RON read `NaN`, `inf` and `1e999` as numbers. A position or a variable that
//! holds one of them passes every comparison with a limit and ends as zero in a move.

/// Reads a decimal number.
///
/// `None` for text that is no number, for `nan` and `inf` in any spelling, and for a number
/// that overflows.
pub fn parse_finite(text: &str) -> Option<f64> {
    let plain =
        |byte: u8| byte.is_ascii_digit() || matches!(byte, b'.' | b'+' | b'-' | b'e' | b'E');
    if !text.bytes().all(plain) {
        return None;
    }
    text.parse().ok().filter(|value: &f64| value.is_finite())
}

/// A number in a RON text that is NaN, infinite or too large for `f64`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NonFinite {
    /// Line of the number in the text, from 1.
    pub line: usize,
    /// The number as it is written in the text, cut off after 20 characters.
    pub token: String,
}

/// Finds the first number of a RON text that is not finite; `None` if all are finite. The
/// search skips strings, characters and comments.
pub fn find_non_finite(text: &str) -> Option<NonFinite> {
    const LONGEST: usize = 20;
    let bytes = text.as_bytes();
    let mut at = 0;
    while let Some(&byte) = bytes.get(at) {
        let rest = &bytes[at..];
        at += match byte {
            b'/' if rest.starts_with(b"//") => length_until(rest, b"\n"),
            b'/' if rest.starts_with(b"/*") => block_comment(rest),
            b'r' if is_raw_string(rest) => raw_string(rest),
            b'"' => string(rest),
            b'\'' => character(rest),
            byte if is_word(byte) => {
                let length = rest.iter().take_while(|byte| is_word(**byte)).count();
                let token = text.get(at..at + length).unwrap_or_default();
                if is_non_finite(token) {
                    let line = bytes[..at].iter().filter(|byte| **byte == b'\n').count() + 1;
                    let token = token.chars().take(LONGEST).collect();
                    return Some(NonFinite { line, token });
                }
                length
            }
            _ => 1,
        };
    }
    None
}

/// Whether a byte belongs to a number or an identifier. Bytes of characters beyond ASCII
/// belong to identifiers.
const fn is_word(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || byte >= 0x80 || matches!(byte, b'_' | b'.' | b'+' | b'-')
}

fn is_non_finite(token: &str) -> bool {
    let number = token.trim_start_matches(['+', '-']);
    let number = number.trim_end_matches("f64").trim_end_matches("f32");
    if matches!(number, "NaN" | "inf" | "nan" | "infinity") {
        return true;
    }
    let digits = number.replace('_', "");
    let begins = digits.starts_with(|first: char| first.is_ascii_digit() || first == '.');
    begins && digits.parse().is_ok_and(|value: f64| !value.is_finite())
}

/// Returns the number of bytes up to and including the first `end`; all bytes without one.
fn length_until(text: &[u8], end: &[u8]) -> usize {
    let found = text.windows(end.len()).position(|here| here == end);
    found.map_or(text.len(), |at| at + end.len())
}

/// Returns the length in bytes of the block comment at the start of `text`. Block comments may
/// nest.
fn block_comment(text: &[u8]) -> usize {
    let (mut at, mut depth) = (2, 1);
    while depth > 0 && at < text.len() {
        let rest = &text[at..];
        if rest.starts_with(b"/*") {
            (at, depth) = (at + 2, depth + 1);
        } else if rest.starts_with(b"*/") {
            (at, depth) = (at + 2, depth - 1);
        } else {
            at += 1;
        }
    }
    at
}

fn is_raw_string(text: &[u8]) -> bool {
    let hashes = text[1..].iter().take_while(|byte| **byte == b'#').count();
    text.get(1 + hashes) == Some(&b'"')
}

fn raw_string(text: &[u8]) -> usize {
    let hashes = text[1..].iter().take_while(|byte| **byte == b'#').count();
    let begin = 2 + hashes;
    let end = [b"\"".as_slice(), &vec![b'#'; hashes]].concat();
    begin + length_until(text.get(begin..).unwrap_or_default(), &end)
}

fn string(text: &[u8]) -> usize {
    let mut at = 1;
    while let Some(&byte) = text.get(at) {
        at += 1;
        match byte {
            b'"' => return at,
            b'\\' => at += 1,
            _ => {}
        }
    }
    text.len()
}

/// Returns the length in bytes of the character in single quotes at the start of `text`; 1 for
/// a lone quote.
fn character(text: &[u8]) -> usize {
    match text {
        [_, b'\\', _, ..] => 2 + length_until(&text[3.min(text.len())..], b"'").min(12) + 1,
        [_, _, b'\'', ..] => 3,
        _ => 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_finite_decimals_are_numbers() {
        for (text, value) in [
            ("1.5", 1.5),
            ("-0.25", -0.25),
            ("+2e3", 2000.0),
            (".5", 0.5),
        ] {
            assert_eq!(parse_finite(text), Some(value), "{text}");
        }
        let long = "9".repeat(400);
        for text in [
            "nan", "NaN", "-nan", "inf", "-inf", "Infinity", "1e999", &long, "", "e", "1,5",
        ] {
            assert_eq!(parse_finite(text), None, "{text}");
        }
    }

    #[test]
    fn numbers_of_a_file_are_found_with_their_line() {
        let found = |text: &str| find_non_finite(text).map(|it| (it.line, it.token));
        assert_eq!(found("(x: 1.5, y: -2e3)"), None);
        assert_eq!(found("(x: 1,\n y: NaN)"), Some((2, "NaN".to_owned())));
        assert_eq!(found("[-inf]"), Some((1, "-inf".to_owned())));
        assert_eq!(found("{500: 1e999}"), Some((1, "1e999".to_owned())));
        assert_eq!(
            found("{500: 1_000e9_99}"),
            Some((1, "1_000e9_99".to_owned()))
        );
        assert_eq!(
            found(&format!("({})", "7".repeat(400))).map(|it| it.1.len()),
            Some(20)
        );
        for text in [
            "(name: \"inf \\\" NaN\")",
            "(name: r#\"NaN \" inf\"#)",
            "(x: 1 // NaN\n)",
            "(x: /* inf /* NaN */ inf */ 1)",
            "(info: 1, nano: 2, inf_rate: 3)",
            "(letter: 'N', quote: '\\'', next: 0x1F)",
            "\"",
            "'",
            "r#\"",
            "/*",
        ] {
            assert_eq!(found(text), None, "{text}");
        }
    }
}
