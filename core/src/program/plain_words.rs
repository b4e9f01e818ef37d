//! Reads words in the most common form: `N10 G01 X40.136 Z-1. F200;`, in ASCII, with so few
//! digits that they cannot exceed the range of their address.

use super::number::WordNumber;
use super::read_number::LAST_PLACE_MILLIONTHS;

/// Reads the words of a block one by one, as long as they have the common form.
pub(crate) struct PlainWords<'a> {
    text: &'a [u8],
    /// Byte position after the word read last.
    at: usize,
    point_required: bool,
}

/// A word in the common form.
#[derive(Clone, Copy)]
pub(crate) struct PlainWord {
    /// Address as an upper-case letter.
    pub(crate) address: u8,
    pub(crate) value: WordNumber,
    /// Byte position of the address in the text.
    pub(crate) start: usize,
}

/// The next part of a block.
pub(crate) enum PlainToken {
    Word(PlainWord),
    BlockEnd,
    /// Text that does not have the common form; the general parser reads it.
    Other,
}

impl<'a> PlainWords<'a> {
    /// Reads the block at the beginning of `text`. `point_required` as in
    /// [`Syntax`](super::Syntax).
    pub(crate) const fn new(text: &'a [u8], point_required: bool) -> Self {
        Self {
            text,
            at: 0,
            point_required,
        }
    }

    /// Byte position after the word read last.
    pub(crate) const fn position(&self) -> usize {
        self.at
    }

    /// Reads the next word of the block.
    #[inline]
    pub(crate) fn next_token(&mut self) -> PlainToken {
        let start = skip_blanks(self.text, self.at);
        match self.text.get(start) {
            Some(b';' | b'\n') => PlainToken::BlockEnd,
            Some(b'\r') if self.text.get(start + 1) == Some(&b'\n') => PlainToken::BlockEnd,
            Some(&address @ b'A'..=b'Z') => match self.read_number(address, start + 1) {
                Some((value, end)) => {
                    self.at = end;
                    PlainToken::Word(PlainWord {
                        address,
                        value,
                        start,
                    })
                }
                None => PlainToken::Other,
            },
            _ => PlainToken::Other,
        }
    }

    /// Reads the number of an address from the position `at`. Returns it and the position after
    /// it; `None` for a number beyond the limits of the address, or if the text ends after it.
    #[inline]
    fn read_number(&self, address: u8, at: usize) -> Option<(WordNumber, usize)> {
        let limits = PLAIN_LIMITS[usize::from(address - b'A')];
        let negative = self.text.get(at) == Some(&b'-');
        if negative && !limits.signed {
            return None;
        }
        let start = at + usize::from(negative);
        let (whole, mut end) = read_digits(self.text, start, 0);
        let count = end - start;
        if count > usize::from(limits.digits) {
            return None;
        }
        let signed = |digits: i64| if negative { -digits } else { digits };
        let number = if self.text.get(end) == Some(&b'.') {
            let point = end;
            let (digits, after) = read_digits(self.text, point + 1, whole);
            end = after;
            let places = end - point - 1;
            if places > usize::from(limits.places) || limits.places == 0 || count + places == 0 {
                return None;
            }
            WordNumber::from_millionths(signed(digits) * LAST_PLACE_MILLIONTHS.get(places)?)
        } else {
            if count == 0 || limits.places > 0 && self.point_required {
                return None;
            }
            WordNumber::from_integer(signed(whole), count as u8)
        };
        // A second point or a full-width character after it is for the general parser.
        let ends = !matches!(self.text.get(end), None | Some(b'.' | 0x80..));
        ends.then_some((number, end))
    }
}

/// Position after the blanks at `at` and the comments that end in their line.
#[inline]
fn skip_blanks(text: &[u8], mut at: usize) -> usize {
    loop {
        match text.get(at) {
            Some(b' ') => at += 1,
            Some(b'(') => match find_comment_end(text, at) {
                Some(end) => at = end,
                None => return at,
            },
            _ => return at,
        }
    }
}

/// Position after the comment at `at`; `None` if it does not end in its line.
#[cold]
fn find_comment_end(text: &[u8], at: usize) -> Option<usize> {
    let comment = text.get(at..)?;
    let ends = |byte: &u8| matches!(byte, b')' | b'\n' | b'\r');
    let end = comment.iter().position(ends)?;
    (comment[end] == b')').then_some(at + end + 1)
}

/// Reads digits from the position `at` and appends them to the number `value`. Returns the
/// number, which wraps if there are too many digits, and the position after them.
#[inline]
fn read_digits(text: &[u8], mut at: usize, mut value: i64) -> (i64, usize) {
    while let Some(digit) = text.get(at).map(|byte| byte.wrapping_sub(b'0'))
        && digit <= 9
    {
        value = value.wrapping_mul(10).wrapping_add(i64::from(digit));
        at += 1;
    }
    (value, at)
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
