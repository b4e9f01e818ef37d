//! Parses the number of a word.

use gsk_messages::say;

use super::lexer::{INVALID_CHARACTER, Lexer, skip_blanks};
use super::number::{VariableReference, WordNumber};
use super::syntax::{BlockError, Syntax};
use crate::alarm::number;

/// Reads the number after an address letter, which is at byte `start`. The flags: whether the
/// block has G65, and whether a G code of the block permits a point.
pub(super) fn read_number(
    lexer: &mut Lexer<'_>,
    address: u8,
    start: usize,
    (g65, point_by_code): (bool, bool),
    syntax: Syntax,
) -> Result<WordNumber, BlockError> {
    let name = char::from(address);
    let (mut negative, mut signed) = (false, false);
    if !matches!(lexer.rest(), [b'0'..=b'9', ..]) {
        skip_blanks(lexer)?;
        let (first, len) = lexer.peek();
        negative = first == b'-';
        signed = negative || first == b'+';
        if signed {
            lexer.at += len;
            skip_blanks(lexer)?;
        }
        if lexer.peek().0 == b'#' {
            return read_variable(lexer, address, negative);
        }
    }
    let digits = match read_plain_digits(lexer) {
        Some(digits) => digits,
        None => read_any_digits(lexer)?,
    };
    let NumberDigits { point, places, .. } = digits;
    if digits.count == 0 && places == 0 {
        return Err(missing_digits(
            lexer,
            name,
            start,
            signed || point.is_some(),
        ));
    }
    if let Some(at) = point
        && (g65 || !(syntax.has_decimal_point(address) || point_by_code))
    {
        let rule = say::point_not_allowed(name);
        return Err(BlockError::at(number::BAD_POINT, at, rule));
    }
    if point.is_none() && syntax.point_required && syntax.has_decimal_point(address) && !g65 {
        let detail = say::point_missing(name);
        return Err(BlockError::at(number::BAD_POINT, start, detail));
    }
    let written = usize::from(digits.count) + usize::from(places);
    if address == b'F'
        && written > MAX_FEED_DIGITS
        && significant_digits(lexer, digits.at) > MAX_FEED_DIGITS
    {
        return Err(BlockError::at(
            number::OUT_OF_RANGE,
            start,
            say::feed_digits_too_many(),
        ));
    }
    if point.is_none() {
        let whole = if negative {
            -digits.whole
        } else {
            digits.whole
        };
        return Ok(WordNumber::from_integer(
            whole,
            digits.count.min(MAX_DIGITS),
        ));
    }
    let size = digits.whole * 1_000_000 + digits.fraction;
    let number = WordNumber::from_millionths(if negative { -size } else { size });
    Ok(
        match syntax.is_length(address) && places > syntax.decimal_places() {
            true => number.rounded_to_increment(syntax.increment()),
            false => number,
        },
    )
}

/// The digits of a number as written, without its sign.
struct NumberDigits {
    /// Byte positions of the first digit and of the point; `point` is `None` without a point.
    at: usize,
    point: Option<usize>,
    /// Value before the point, and how many digits are written before the point.
    whole: i64,
    count: u8,
    /// Value after the point in millionths, and how many digits are written after the point.
    fraction: i64,
    places: u8,
}

/// Reads ASCII digits that are few enough not to overflow; `None` for digits that only
/// [`read_any_digits`] can read.
#[inline]
fn read_plain_digits(lexer: &mut Lexer<'_>) -> Option<NumberDigits> {
    /// Greatest number of digits before the decimal point.
    const MAX_PLAIN_DIGITS: usize = 12;
    let at = lexer.at;
    let (whole, mut rest) = append_digits(0, lexer.rest());
    let count = lexer.rest().len() - rest.len();
    let (mut point, mut fraction, mut places) = (None, 0, 0);
    if let [b'.', after @ ..] = rest {
        point = Some(at + count);
        (fraction, rest) = append_digits(0, after);
        places = after.len() - rest.len();
    }
    let others = matches!(rest, [b'.' | 0x80..=0xFF, ..]);
    if count > MAX_PLAIN_DIGITS || others {
        return None;
    }
    let fraction = fraction * LAST_PLACE_MILLIONTHS.get(places)?;
    lexer.at = lexer.end() - rest.len();
    Some(NumberDigits {
        at,
        point,
        whole,
        count: count as u8,
        fraction,
        places: places as u8,
    })
}

/// Appends the leading ASCII digits of a text to a number. Returns the number, which wraps
/// if there are too many digits, and the rest of the text.
#[inline]
pub(super) fn append_digits(mut value: i64, mut bytes: &[u8]) -> (i64, &[u8]) {
    while let [byte, rest @ ..] = bytes {
        let digit = byte.wrapping_sub(b'0');
        if digit > 9 {
            break;
        }
        value = value.wrapping_mul(10).wrapping_add(i64::from(digit));
        bytes = rest;
    }
    (value, bytes)
}

/// Reads any number of digits, ASCII or full-width, with at most one point.
#[cold]
fn read_any_digits(lexer: &mut Lexer<'_>) -> Result<NumberDigits, BlockError> {
    let at = lexer.at;
    let mut count = 0_u8;
    let mut whole = 0_i64;
    while let Some(digit) = lexer.read_digit() {
        count = count.saturating_add(1);
        if whole < CLAMPED_VALUE {
            whole = whole * 10 + i64::from(digit);
        }
    }
    let mut digits = NumberDigits {
        at,
        point: None,
        whole: whole.min(CLAMPED_VALUE),
        count,
        fraction: 0,
        places: 0,
    };
    let (mark, len) = lexer.peek();
    if mark != b'.' {
        return Ok(digits);
    }
    digits.point = Some(lexer.at);
    lexer.at += len;
    while let Some(digit) = lexer.read_digit() {
        if digits.places < DECIMAL_PLACES {
            digits.fraction = digits.fraction * 10 + i64::from(digit);
        }
        digits.places = digits.places.saturating_add(1);
    }
    digits.fraction *= LAST_PLACE_MILLIONTHS[usize::from(digits.places.min(DECIMAL_PLACES))];
    if lexer.peek().0 == b'.' {
        let rule = say::point_twice();
        return Err(BlockError::at(number::BAD_POINT, lexer.at, rule));
    }
    Ok(digits)
}

/// Values are clamped to this number, which is out of every range of a word.
pub(super) const CLAMPED_VALUE: i64 = 1_000_000_000_000;

/// Number of decimal places that are read, those of a millionth; further ones are dropped.
const DECIMAL_PLACES: u8 = 6;

/// Value of a 1 in the last written place, in millionths, by the number of decimal places.
pub(super) const LAST_PLACE_MILLIONTHS: [i64; DECIMAL_PLACES as usize + 1] =
    [1_000_000, 100_000, 10_000, 1000, 100, 10, 1];

/// Greatest number of significant digits of an F word.
const MAX_FEED_DIGITS: usize = 7;

/// Counts the digits of the number that begins at byte `at`, without leading zeros and without
/// zeros at the end of a fraction.
fn significant_digits(lexer: &Lexer<'_>, at: usize) -> usize {
    let mut lexer = lexer.moved_to(at);
    let mut significant = 0_usize;
    while let Some(digit) = lexer.read_digit() {
        significant += usize::from(significant > 0 || digit != 0);
    }
    let (mark, len) = lexer.peek();
    if mark != b'.' {
        return significant;
    }
    lexer.at += len;
    let mut zeros = 0;
    while let Some(digit) = lexer.read_digit() {
        if digit == 0 {
            zeros += usize::from(significant > 0);
        } else {
            significant += zeros + 1;
            zeros = 0;
        }
    }
    significant
}

/// Greatest stored number of written digits, leading zeros included.
const MAX_DIGITS: u8 = 20;

#[cold]
fn missing_digits(lexer: &Lexer<'_>, name: char, start: usize, marks: bool) -> BlockError {
    if marks {
        return BlockError::at(number::BAD_VALUE, start, say::number_without_digits(name));
    }
    match lexer.peek().0 {
        INVALID_CHARACTER
        | b'!'..=b'$'
        | b'&'..=b'\''
        | b')'
        | b','
        | b'/'
        | b':'
        | b'<'..=b'@'
        | b'['..=b'`'
        | b'{'.. => BlockError::at(
            number::BAD_CHARACTER,
            lexer.at,
            say::number_foreign_character(name),
        ),
        _ => BlockError::at(number::NO_VALUE, start, say::number_missing(name)),
    }
}

/// Reads the reference `#i` after an address; the lexer is at the `#`. Returns the fault of its
/// syntax as error.
#[cold]
fn read_variable(
    lexer: &mut Lexer<'_>,
    address: u8,
    negative: bool,
) -> Result<WordNumber, BlockError> {
    let at = lexer.at;
    let name = char::from(address);
    if matches!(address, b'N' | b'O' | b'J' | b'L') {
        return Err(BlockError::at(
            number::BAD_VALUE,
            at,
            say::variable_not_allowed(name),
        ));
    }
    lexer.at += lexer.peek().1;
    let mut digits = 0;
    let mut number = 0_u16;
    while let (byte @ b'0'..=b'9', len) = lexer.peek() {
        lexer.at += len;
        digits += 1;
        if digits > 4 {
            return Err(BlockError::at(
                number::BAD_VARIABLE,
                at,
                say::variable_number_too_long(),
            ));
        }
        number = number * 10 + u16::from(byte - b'0');
    }
    if digits == 0 {
        return Err(BlockError::at(
            number::BAD_VALUE,
            at,
            say::variable_number_missing(),
        ));
    }
    if lexer.peek().0 == b'.' {
        return Err(BlockError::at(
            number::BAD_POINT,
            lexer.at,
            say::variable_number_with_point(),
        ));
    }
    Ok(WordNumber::from_variable(VariableReference {
        number,
        negative,
    }))
}
