//! Splits a line into words as written, even if they do not form a valid block.

/// A word as written: its letter in upper case, and its number; `None` if it is not an
/// integer.
pub(super) type WrittenWord = (u8, Option<u32>);

/// Splits a line into its words, valid or not, without comments.
pub(super) fn split_line(line: &str) -> Vec<WrittenWord> {
    let mut words: Vec<(u8, String)> = Vec::new();
    let mut comment = false;
    for character in line.chars().map(ascii_character) {
        match character {
            ')' => comment = false,
            '(' => comment = true,
            _ if comment || character == ' ' || character == '\t' => {}
            _ if character.is_ascii_alphabetic() => {
                words.push((character.to_ascii_uppercase() as u8, String::new()));
            }
            _ => {
                if let Some((_, number)) = words.last_mut() {
                    number.push(character);
                }
            }
        }
    }
    words
        .into_iter()
        .map(|(letter, number)| (letter, number.trim_end_matches(';').parse().ok()))
        .collect()
}

/// Whether a line has at most one block.
pub(super) fn is_one_block(line: &str) -> bool {
    let line = line.trim_end();
    !line.strip_suffix(';').unwrap_or(line).contains([';', '*'])
}

/// Whether one of the words has the letter `letter`.
pub(super) fn has_letter(words: &[WrittenWord], letter: u8) -> bool {
    words.iter().any(|(written, _)| *written == letter)
}

/// The numbers of all words with the letter `letter`, in order; `None` for a number that is
/// not an integer.
pub(super) fn numbers_of(
    words: &[WrittenWord],
    letter: u8,
) -> impl DoubleEndedIterator<Item = Option<u32>> + Clone {
    words
        .iter()
        .filter(move |(written, _)| *written == letter)
        .map(|(_, number)| *number)
}

/// Converts a full-width character to the ASCII one, as the control reads it.
fn ascii_character(character: char) -> char {
    match u32::from(character) {
        wide @ 0xFF01..=0xFF5E => char::from_u32(wide - 0xFEE0).unwrap_or(character),
        0x3000 => ' ',
        _ => character,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn valid_and_invalid_words_are_listed() {
        assert_eq!(
            split_line("/N10 g01 X-5. (X9) C2 M#200;"),
            [
                (b'N', Some(10)),
                (b'G', Some(1)),
                (b'X', None),
                (b'C', Some(2)),
                (b'M', None)
            ]
        );
        assert_eq!(
            split_line("Ｇ０１　Ｘ５"),
            [(b'G', Some(1)), (b'X', Some(5))]
        );
        assert!(is_one_block("G00 X5;") && !is_one_block("G00 X5; M30;"));
    }
}
