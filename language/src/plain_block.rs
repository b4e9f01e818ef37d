//! Recognises simple blocks of long programs without splitting them into words.

use std::ops::Range;

/// Returns the number of a plain block with the range of its digits. The inner `None` is a
/// plain block without a number. The outer `None` is a line that must be split into words.
///
/// Most blocks of a long program are plain moves, and most of the reading time goes into them.
pub(crate) fn parse_plain_block(line: &str) -> Option<Option<(u16, Range<usize>)>> {
    let bytes = line.as_bytes();
    let named = bytes.first() == Some(&b'N');
    let digits = bytes.get(1..)?.iter().take_while(|it| it.is_ascii_digit());
    let digits = 1..1 + digits.count();
    let rest = if named {
        bytes.get(digits.end..)?
    } else {
        bytes
    };
    // No letter of a statement, and no address that refers to a block or that the structure
    // lists.
    let shows_nothing = |it: &u8| {
        matches!(
            it,
            b'0'..=b'9'
                | b'X'
                | b'Z'
                | b'.'
                | b'-'
                | b' '
                | b'G'
                | b'U'
                | b'F'
                | b'R'
                | b'K'
                | b'S'
        )
    };
    let begins_word = |it: &u8| it.is_ascii_uppercase() || *it == b' ';
    let is_plain = rest.first().is_some_and(begins_word) && rest.iter().all(shows_nothing);
    if !is_plain || rest.iter().all(|it| *it == b' ') {
        return None;
    }
    if !named {
        return Some(None);
    }
    let number = line.get(digits.clone())?.parse().ok()?;
    (number <= 9999).then_some(Some((number, digits)))
}
