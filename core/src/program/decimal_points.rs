//! 013.3 PODI: appends decimal points to the numbers of a typed block.

use super::number::is_length;
use super::parse::parse_block;
use super::syntax::Syntax;

/// Appends a decimal point to each number of a typed block that accepts a point and has none.
/// Returns an invalid block or a G65 block unchanged.
pub fn append_points(text: &str) -> String {
    let mut pointed = text.to_owned();
    let Ok(block) = parse_block(text, Syntax::default()) else {
        return pointed;
    };
    if block.has_g(65) || text.len() > usize::from(u16::MAX) {
        return pointed;
    }
    for word in block.words().iter().rev() {
        let takes = is_length(word.address) || word.address == b'F';
        if takes && !word.value.has_point() && word.value.variable().is_none() {
            pointed.insert(word.span.1.into(), '.');
        }
    }
    pointed
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_come_after_numbers_that_take_one() {
        for (keyed, kept) in [
            ("G01 X10 Z-5 (a 1) F100", "G01 X10. Z-5. (a 1) F100."),
            ("X1.5 U-.5 W#200 P100 T0101", "X1.5 U-.5 W#200 P100 T0101"),
            ("G65 H01 P#200 Q5 R7", "G65 H01 P#200 Q5 R7"),
            ("X", "X"),
            ("Ｘ10；", "Ｘ10.；"),
        ] {
            assert_eq!(append_points(keyed), kept);
            assert_eq!(append_points(kept), kept);
        }
    }
}
