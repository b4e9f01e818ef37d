//! Words as most programs have them: `N10 G01 X40.136 Z-1. F200;`, in ASCII, each within
//! the range of its address by its digits alone.

use super::block::{Block, Word};
use super::lexer::{Lexer, narrow};
use super::number::Number;
use super::read_number::LAST_PLACE;
use super::syntax::Syntax;

/// Passes the words in front that are written as most are: `N10 G01 X40.136 Z-1. F200;`.
/// Whether they are the whole block; what comes after them is left to
/// [`read_block`](super::parse::read_block).
pub(super) fn plain_words(
    lexer: &mut Lexer<'_>,
    seen: &mut u32,
    syntax: Syntax,
    block: &mut Block,
) -> bool {
    let text = lexer.rest();
    let begin = lexer.at;
    let mut at = 0;
    loop {
        let rest = text.get(at..).unwrap_or_default();
        let (address, number) = match rest {
            [b' ', ..] => {
                at += 1;
                continue;
            }
            [b';' | b'\n', ..] | [b'\r', b'\n', ..] => return true,
            [address @ b'A'..=b'Z', number @ ..] => (*address, number),
            _ => return false,
        };
        let letter = address - b'A';
        let bit = 1 << letter;
        let plain = PLAIN[usize::from(letter)];
        if *seen & bit != 0 && address != b'G' {
            return false;
        }
        let Some((value, length)) = plain_number(number, plain, syntax) else {
            return false;
        };
        let start = at;
        at += 1 + length;
        match address {
            b'G' if value.integer() == 65 => return false,
            // After a G code it is no sequence number on the Huaxing lathes.
            b'N' if !block.is_empty() => return false,
            b'N' => block.n = Some(value.integer() as u32),
            _ => {
                let word = Word {
                    address,
                    value,
                    span: (narrow(begin + start), narrow(begin + at)),
                };
                if !block.push(word) {
                    return false;
                }
            }
        }
        *seen |= bit;
        lexer.at = begin + at;
    }
}

/// The numbers of an address that are within its range by their digits alone.
#[derive(Clone, Copy)]
struct Plain {
    /// Digits before the point.
    digits: u8,
    /// Digits after it.
    places: u8,
    signed: bool,
}

impl Plain {
    /// There are none.
    const NONE: Self = Self::of(0, 0, false);

    const fn of(digits: u8, places: u8, signed: bool) -> Self {
        Self {
            digits,
            places,
            signed,
        }
    }
}

/// Those of the addresses A to Z.
static PLAIN: [Plain; 26] = {
    let mut plain = [Plain::NONE; 26];
    let mut letter = 0;
    while letter < plain.len() {
        plain[letter] = match b'A' + letter as u8 {
            b'X' | b'Z' | b'U' | b'W' | b'R' | b'I' | b'K' => Plain::of(4, 3, true),
            b'F' => Plain::of(4, 3, false),
            b'N' | b'S' | b'T' => Plain::of(4, 0, false),
            b'G' | b'M' => Plain::of(2, 0, false),
            _ => Plain::NONE,
        };
        letter += 1;
    }
    plain
};

/// A number in ASCII that is within the range of its address by its digits, and its
/// length. Something follows it.
#[inline]
fn plain_number(text: &[u8], plain: Plain, syntax: Syntax) -> Option<(Number, usize)> {
    let negative = matches!(text, [b'-', ..]);
    if negative && !plain.signed {
        return None;
    }
    let begin = usize::from(negative);
    let (mut at, mut point) = (begin, None);
    // Too many digits are found by their count.
    let mut digits = 0_u32;
    let end = loop {
        let byte = *text.get(at)?;
        let digit = byte.wrapping_sub(b'0');
        if digit <= 9 {
            digits = digits.wrapping_mul(10).wrapping_add(u32::from(digit));
        } else if byte == b'.' && point.is_none() {
            point = Some(at);
        } else {
            break byte;
        }
        at += 1;
    };
    let (whole, places) = match point {
        Some(point) => (point - begin, at - point - 1),
        None => (at - begin, 0),
    };
    let fits = whole <= usize::from(plain.digits) && places <= usize::from(plain.places);
    if !fits || whole + places == 0 || matches!(end, b'.' | 0x80..=0xFF) {
        return None;
    }
    let value = i64::from(digits);
    let value = if negative { -value } else { value };
    let number = match point {
        Some(_) if plain.places == 0 => return None,
        Some(_) => Number::from_millionths(value * LAST_PLACE[places]),
        None if plain.places > 0 && syntax.point_required => return None,
        None => Number::from_integer(value, whole as u8),
    };
    Some((number, at))
}
