//! Blocks of a long program that need no taking apart.

use std::ops::Range;

/// The number, with its digits, of a block that has nothing else to be shown: most blocks
/// of a long program are moves, and most of the time goes into them. None for a line that
/// must be taken apart.
pub(crate) fn plain(line: &str) -> Option<Option<(u16, Range<usize>)>> {
    let bytes = line.as_bytes();
    let named = bytes.first() == Some(&b'N');
    let digits = bytes.get(1..)?.iter().take_while(|it| it.is_ascii_digit());
    let digits = 1..1 + digits.count();
    let rest = if named {
        bytes.get(digits.end..)?
    } else {
        bytes
    };
    // No letter of a statement, and none that leads anywhere or is looked for.
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
