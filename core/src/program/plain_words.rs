//! Reads words in the most common form: `N10 G01 X40.136 Z-1. F200;`, in ASCII, with so few
//! digits that they cannot exceed the range of their address.

use super::block::{ProgramBlock, ProgramWord};
use super::lexer::{Lexer, clamp_to_u16};
use super::number::WordNumber;
use super::read_number::{LAST_PLACE_MILLIONTHS, append_digits};
use super::syntax::Syntax;

/// Reads the words at the beginning of a block that have the common form. Returns `true` if
/// the block has no others; otherwise the caller reads the rest with
/// [`read_block`](super::parse::read_block).
pub(super) fn read_plain_words(
    lexer: &mut Lexer<'_>,
    seen: &mut u32,
    syntax: Syntax,
    block: &mut ProgramBlock,
) -> bool {
    let mut rest = lexer.rest();
    let all = lexer.at + rest.len();
    loop {
        let (address, number) = match rest {
            [b' ', after @ ..] => {
                rest = after;
                continue;
            }
            [b';' | b'\n', ..] | [b'\r', b'\n', ..] => return true,
            [address @ b'A'..=b'Z', number @ ..] => (*address, number),
            _ => return false,
        };
        let letter = address - b'A';
        let bit = 1 << letter;
        let plain = PLAIN_LIMITS[usize::from(letter)];
        if *seen & bit != 0 && address != b'G' {
            return false;
        }
        let Some((value, after)) = read_plain_number(number, plain, syntax) else {
            return false;
        };
        let (start, end) = (all - rest.len(), all - after.len());
        match address {
            b'G' if value.integer() == 65 => return false,
            // After a G code N is not a sequence number on Huaxing lathes.
            b'N' if !block.is_empty() => return false,
            b'N' => block.n = Some(value.integer() as u32),
            _ => {
                let word = ProgramWord {
                    address,
                    value,
                    span: (clamp_to_u16(start), clamp_to_u16(end)),
                };
                if !block.push(word) {
                    return false;
                }
            }
        }
        *seen |= bit;
        rest = after;
        lexer.at = end;
    }
}

/// Limits on the digits of an address; numbers within them are in the range of the address.
#[derive(Clone, Copy)]
struct PlainLimits {
    /// Greatest number of digits before the decimal point.
    digits: u8,
    /// Greatest number of digits after the decimal point.
    places: u8,
    signed: bool,
}

impl PlainLimits {
    /// Accepts no number: the address does not have the common form.
    const NONE: Self = Self::new(0, 0, false);

    const fn new(digits: u8, places: u8, signed: bool) -> Self {
        Self {
            digits,
            places,
            signed,
        }
    }
}

/// The limits for the addresses A to Z, in alphabetical order.
static PLAIN_LIMITS: [PlainLimits; 26] = {
    let mut plain = [PlainLimits::NONE; 26];
    let mut letter = 0;
    while letter < plain.len() {
        plain[letter] = match b'A' + letter as u8 {
            b'X' | b'Z' | b'U' | b'W' | b'R' | b'I' | b'K' => PlainLimits::new(4, 3, true),
            b'F' => PlainLimits::new(4, 3, false),
            b'N' | b'S' | b'T' => PlainLimits::new(4, 0, false),
            b'G' | b'M' => PlainLimits::new(2, 0, false),
            _ => PlainLimits::NONE,
        };
        letter += 1;
    }
    plain
};

/// Reads an ASCII number within the limits `plain`. Returns the number and the rest of the
/// text; `None` for another number or if nothing follows the number.
#[inline]
fn read_plain_number(
    text: &[u8],
    plain: PlainLimits,
    syntax: Syntax,
) -> Option<(WordNumber, &[u8])> {
    let (negative, text) = match text {
        [b'-', after @ ..] => (true, after),
        _ => (false, text),
    };
    if negative && !plain.signed {
        return None;
    }
    let (digits, after) = append_digits(0, text);
    let whole = text.len() - after.len();
    if whole > usize::from(plain.digits) {
        return None;
    }
    let signed = |digits: i64| if negative { -digits } else { digits };
    let (number, places, after) = match after {
        [b'.', fraction @ ..] => {
            let (digits, after) = append_digits(digits, fraction);
            let places = fraction.len() - after.len();
            if places > usize::from(plain.places) || plain.places == 0 {
                return None;
            }
            let value = signed(digits) * LAST_PLACE_MILLIONTHS.get(places)?;
            (WordNumber::from_millionths(value), places, after)
        }
        _ if plain.places > 0 && syntax.point_required => return None,
        _ => (
            WordNumber::from_integer(signed(digits), whole as u8),
            0,
            after,
        ),
    };
    match after {
        [] | [b'.' | 0x80..=0xFF, ..] => None,
        _ => (whole + places > 0).then_some((number, after)),
    }
}
