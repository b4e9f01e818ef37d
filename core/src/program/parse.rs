//! The word syntax: text of a block to words, with every range (manual I-2.2,
//! table 2-1).

use gsk_messages::say;

use super::block::{Block, Word, check_values};
use super::lexer::{FOREIGN, Lexer, skip_blanks};
use super::macro_b::{self, Statement};
use super::number::{Number, Variable, is_length};
use super::syntax::{BlockError, Syntax};
use crate::alarm::number;
use crate::dialect::{self, advised};
use crate::model::GCode;

/// Reads one block: up to the first `;`, `*`, `%` or end of line outside
/// comments. Does not allocate unless it fails.
///
/// # Errors
/// The alarm of the syntax: 002, 005, 006, 007, 009, 012, 018, 043, 125; of macro B 114,
/// 118, 126, 127, 129.
pub(crate) fn parse_block(text: &str, syntax: Syntax) -> Result<Block, BlockError> {
    let mut block = Block::default();
    read_block(text, syntax, &mut block)?;
    Ok(block)
}

/// The same into an empty block.
pub(super) fn read_block(text: &str, syntax: Syntax, block: &mut Block) -> Result<(), BlockError> {
    let mut lexer = Lexer::new(text);
    let mut seen = 0;
    // Their values are in range as they are written.
    if !syntax.macro_b && plain_words(&mut lexer, &mut seen, syntax, block) {
        return Ok(());
    }
    read_words(text, lexer, seen, syntax, block)
        .and_then(|()| check_values(block))
        .map_err(|error| error.located(text))
}

/// Passes the words in front that are written as most are: `N10 G01 X40.136 Z-1. F200;`.
/// Whether they are the whole block; what comes after them is left to [`read_words`].
fn plain_words(lexer: &mut Lexer<'_>, seen: &mut u32, syntax: Syntax, block: &mut Block) -> bool {
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

/// The words of a block from where the lexer stands, after those of the addresses `seen`.
fn read_words(
    text: &str,
    mut lexer: Lexer<'_>,
    mut seen: u32,
    syntax: Syntax,
    block: &mut Block,
) -> Result<(), BlockError> {
    let mut g65 = false;
    skip_blanks(&mut lexer)?;
    if seen == 0
        && let (b'/', len) = lexer.peek()
    {
        lexer.at += len;
        block.skip = true;
    }
    loop {
        skip_blanks(&mut lexer)?;
        let start = lexer.at;
        let (byte, len) = lexer.peek();
        if syntax.macro_b && macro_b::begins(&lexer) {
            if !block.is_empty() {
                return Err(shares_block(start));
            }
            block.statement = Some(Box::new(Statement::read(&mut lexer)?));
            return nothing_more(&mut lexer);
        }
        let address = match byte {
            b'A'..=b'Z' => byte,
            b'a'..=b'z' => byte.to_ascii_uppercase(),
            // Where there are formulas it multiplies, and ends nothing.
            b'*' if block.statement.is_some() => return nothing_more(&mut lexer),
            b'\n' | b';' | b'*' | b'%' => return Ok(()),
            _ => return Err(misplaced(text, start, byte)),
        };
        if !is_address(address) && !syntax.model.record().has_address(address) {
            let rule = say::address_unknown(char::from(address));
            let detail = advised(rule, dialect::instead_of_address(address));
            return Err(BlockError::at(number::BAD_ADDRESS, start, detail));
        }
        if g65 && !matches!(address, b'H' | b'P' | b'Q' | b'R') {
            let detail = say::macro_address_wrong(char::from(address));
            return Err(BlockError::at(number::BAD_IN_MACRO, start, detail));
        }
        let bit = 1 << (address - b'A');
        if seen & bit != 0 && address != b'G' && !is_count(address, syntax, block) {
            let detail = say::address_twice(char::from(address));
            return Err(BlockError::at(number::ADDRESS_TWICE, start, detail));
        }
        seen |= bit;

        lexer.at += len;
        if is_count(address, syntax, block) {
            count_words(&mut lexer, block, start)?;
            continue;
        }
        let formula = match syntax.macro_b && !g65 {
            true => formula(&mut lexer, address, block)?,
            false => None,
        };
        let value = match formula {
            Some(value) => value,
            None => {
                let by_code = has_point_by_code(address, syntax, block);
                read_number(&mut lexer, address, start, (g65, by_code), syntax)?
            }
        };
        if matches!(address, b'N' | b'O') {
            match address {
                b'N' => block.n = Some(sequence_number(value, syntax, start)?),
                _ => block.o = Some(program_number(value, start)?),
            }
            continue;
        }
        if syntax.macro_b
            && address == b'G'
            && let Some(statement) = call(&mut lexer, value)?
        {
            if !block.is_empty() {
                return Err(shares_block(start));
            }
            block.statement = Some(Box::new(statement));
            return nothing_more(&mut lexer);
        }
        if address == b'G' && value.integer() == 65 && value.variable().is_none() {
            if !block.is_empty() {
                return Err(BlockError::at(
                    number::BAD_IN_MACRO,
                    start,
                    say::macro_not_first_in_block(),
                ));
            }
            g65 = true;
        }
        let span = (narrow(start), narrow(lexer.at));
        if !block.push(Word {
            address,
            value,
            span,
        }) {
            return Err(BlockError {
                column: narrow(start).into(),
                ..BlockError::too_many_words()
            });
        }
    }
}

/// Whether an N stands after a G code (Huaxing): it is no sequence number there.
#[inline]
fn is_count(address: u8, syntax: Syntax, block: &Block) -> bool {
    address == b'N' && block.has(b'G') && syntax.model.record().n_after_g
}

/// Whether a G code before it makes a length or a factor of a word that is a whole
/// number otherwise (Huaxing): L of G31, D of its threads, P as their lead.
#[inline]
fn has_point_by_code(address: u8, syntax: Syntax, block: &Block) -> bool {
    let record = syntax.model.record();
    let means = |codes: &[GCode]| {
        let mut written = block.g_codes();
        written.any(|code| {
            let meaning = record.g_code(code.into());
            meaning.is_some_and(|it| codes.contains(&it))
        })
    };
    match address {
        _ if !record.n_after_g => false,
        b'L' => means(&[GCode::ScaleOn]),
        b'D' => means(&[GCode::MetricThreadPass, GCode::InchThreadPass]),
        b'P' => means(&[
            GCode::MetricThreadPass,
            GCode::MetricRigidTapping,
            GCode::MetricThreadCycle,
        ]),
        _ => false,
    }
}

/// N after a code of the Huaxing lathes: a block, a subprogram or a count, with up to
/// two more numbers after points, which are those of P and L: `G25 N100.140.3` is
/// `N100 P140 L3`, `G20 N05.3` is `N05 L3`.
#[cold]
fn count_words(lexer: &mut Lexer<'_>, block: &mut Block, start: usize) -> Result<(), BlockError> {
    let mut numbers = Vec::new();
    loop {
        skip_blanks(lexer)?;
        let begin = lexer.at;
        let mut value = 0_i64;
        while let Some(digit) = lexer.digit() {
            value = (value * 10 + i64::from(digit)).min(HUGE);
        }
        if lexer.at == begin || numbers.len() == 3 {
            let rule = say::number_missing('N');
            return Err(BlockError::at(number::NO_VALUE, start, rule));
        }
        numbers.push(value);
        match lexer.peek() {
            (b'.', len) => lexer.at += len,
            _ => break,
        }
    }
    let addresses: &[u8] = match (numbers.len(), block.has_g(20)) {
        (2, true) => b"NL",
        _ => b"NPL",
    };
    for (address, value) in addresses.iter().zip(numbers) {
        if block.has(*address) {
            let rule = say::address_twice(char::from(*address));
            return Err(BlockError::at(number::ADDRESS_TWICE, start, rule));
        }
        let word = Word {
            address: *address,
            value: Number::from_integer(value, 0),
            span: (narrow(start), narrow(lexer.at)),
        };
        if !block.push(word) {
            return Err(BlockError::too_many_words());
        }
    }
    Ok(())
}

/// The call that a G code of macro B makes: G66, G67, and G65 without H.
#[cold]
fn call(lexer: &mut Lexer<'_>, code: Number) -> Result<Option<Statement>, BlockError> {
    if code.variable().is_some() {
        return Ok(None);
    }
    skip_blanks(lexer)?;
    let macro_a = matches!(lexer.peek().0, b'H' | b'h');
    Ok(match code.integer() {
        65 if !macro_a => Some(Statement::Call(macro_b::arguments(lexer)?)),
        66 => Some(Statement::ModalCall(macro_b::arguments(lexer)?)),
        67 => Some(Statement::CancelModalCall),
        _ => None,
    })
}

/// The variable or the formula that stands for the number of a word.
#[cold]
fn formula(
    lexer: &mut Lexer<'_>,
    address: u8,
    block: &mut Block,
) -> Result<Option<Number>, BlockError> {
    let mut ahead = *lexer;
    skip_blanks(&mut ahead)?;
    let (sign, len) = ahead.peek();
    let negative = sign == b'-';
    if matches!(sign, b'+' | b'-') {
        ahead.at += len;
        skip_blanks(&mut ahead)?;
    }
    if !matches!(ahead.peek().0, b'#' | b'[') {
        return Ok(None);
    }
    if matches!(address, b'N' | b'O') {
        let rule = say::variable_not_allowed(char::from(address));
        return Err(BlockError::at(number::BAD_OPERATION, ahead.at, rule));
    }
    let expression = macro_b::in_word(&mut ahead)?;
    *lexer = ahead;
    let statement = block
        .statement
        .get_or_insert_with(|| Box::new(Statement::Words(Vec::new())));
    let Statement::Words(formulas) = &mut **statement else {
        return Err(shares_block(lexer.at));
    };
    let number = narrow(formulas.len());
    formulas.push(expression);
    Ok(Some(Number::from_variable(Variable { number, negative })))
}

/// A macro statement stands alone in its block, behind N.
#[cold]
fn shares_block(at: usize) -> BlockError {
    BlockError::at(number::MIXED_BLOCK, at, say::macro_statement_not_alone())
}

/// Nothing but comments follows a macro statement.
#[cold]
fn nothing_more(lexer: &mut Lexer<'_>) -> Result<(), BlockError> {
    skip_blanks(lexer)?;
    match lexer.peek().0 {
        b'\n' | b';' | b'%' => Ok(()),
        byte if byte.is_ascii_alphabetic() => Err(shares_block(lexer.at)),
        _ => Err(BlockError::at(
            number::BAD_OPERATION,
            lexer.at,
            say::formula_end_wrong(),
        )),
    }
}

fn narrow(at: usize) -> u16 {
    u16::try_from(at).unwrap_or(u16::MAX)
}

/// Table 2-1, with J and L, which the thread codes use.
const fn is_address(letter: u8) -> bool {
    matches!(letter, b'F'..=b'U' | b'W' | b'X' | b'Z')
}

/// Addresses whose numbers may have a decimal point.
const fn takes_point(address: u8) -> bool {
    is_length(address) || address == b'F'
}

/// A character at a place where a word must begin.
#[cold]
fn misplaced(text: &str, at: usize, byte: u8) -> BlockError {
    match byte {
        b'#' if text
            .get(..at)
            .is_some_and(|before| before.trim().is_empty()) =>
        {
            let rule = say::block_begins_with_variable();
            BlockError::at(
                number::BAD_CHARACTER,
                at,
                advised(rule, dialect::instead_of_character(byte)),
            )
        }
        b'0'..=b'9' | b'.' => {
            BlockError::at(number::BAD_CHARACTER, at, say::number_without_address())
        }
        b'+' | b'-' | b'#' => BlockError::at(number::BAD_VALUE, at, say::number_end_wrong()),
        b'/' => BlockError::at(number::BAD_CHARACTER, at, say::skip_mark_misplaced()),
        _ => {
            let character = text.get(at..).and_then(|rest| rest.chars().next());
            let character = character.unwrap_or(' ');
            let rule = say::character_unknown(format_args!("{character:?}"));
            let detail = advised(rule, dialect::instead_of_character(byte));
            BlockError::at(number::BAD_CHARACTER, at, detail)
        }
    }
}

/// The number after an address letter that stands at `start`.
fn read_number(
    lexer: &mut Lexer<'_>,
    address: u8,
    start: usize,
    (g65, point_by_code): (bool, bool),
    syntax: Syntax,
) -> Result<Number, BlockError> {
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
    let digits = match plain_digits(lexer) {
        Some(digits) => digits,
        None => any_digits(lexer)?,
    };
    let Digits { point, places, .. } = digits;
    if digits.count == 0 && places == 0 {
        return Err(no_digits(lexer, name, start, signed || point.is_some()));
    }
    if let Some(at) = point
        && (g65 || !(takes_point(address) || point_by_code))
    {
        let rule = say::point_not_allowed(name);
        return Err(BlockError::at(number::BAD_POINT, at, rule));
    }
    if point.is_none() && syntax.point_required && takes_point(address) && !g65 {
        let detail = say::point_missing(name);
        return Err(BlockError::at(number::BAD_POINT, start, detail));
    }
    let written = usize::from(digits.count) + usize::from(places);
    if address == b'F'
        && written > FEED_DIGITS
        && significant_digits(lexer, digits.at) > FEED_DIGITS
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
        return Ok(Number::from_integer(whole, digits.count.min(MAX_DIGITS)));
    }
    let size = digits.whole * 1_000_000 + digits.fraction;
    let number = Number::from_millionths(if negative { -size } else { size });
    Ok(match is_length(address) && places > syntax.places() {
        true => number.rounded_to_increment(syntax.increment()),
        false => number,
    })
}

/// The digits of a number as they are written.
struct Digits {
    /// Where they begin, and where their point stands.
    at: usize,
    point: Option<usize>,
    /// What stands before the point, and its digits.
    whole: i64,
    count: u8,
    /// What stands after it, in millionths, and its digits.
    fraction: i64,
    places: u8,
}

/// Digits as most are written: ASCII, and not very many. Anything else is left to
/// [`any_digits`].
#[inline]
fn plain_digits(lexer: &mut Lexer<'_>) -> Option<Digits> {
    /// Digits before the point.
    const MOST: usize = 12;
    let at = lexer.at;
    let (whole, mut rest) = leading(lexer.rest());
    let count = lexer.rest().len() - rest.len();
    let (mut point, mut fraction, mut places) = (None, 0, 0);
    if let [b'.', after @ ..] = rest {
        point = Some(at + count);
        (fraction, rest) = leading(after);
        places = after.len() - rest.len();
    }
    let others = matches!(rest, [b'.' | 0x80..=0xFF, ..]);
    if count > MOST || others {
        return None;
    }
    let fraction = fraction * LAST_PLACE.get(places)?;
    lexer.at = lexer.end() - rest.len();
    Some(Digits {
        at,
        point,
        whole,
        count: count as u8,
        fraction,
        places: places as u8,
    })
}

/// The value of the ASCII digits in front, whatever it is of very many, and what follows.
#[inline]
fn leading(mut bytes: &[u8]) -> (i64, &[u8]) {
    let mut value = 0_i64;
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

/// Digits however they are written.
#[cold]
fn any_digits(lexer: &mut Lexer<'_>) -> Result<Digits, BlockError> {
    let at = lexer.at;
    let mut count = 0_u8;
    let mut whole = 0_i64;
    while let Some(digit) = lexer.digit() {
        count = count.saturating_add(1);
        if whole < HUGE {
            whole = whole * 10 + i64::from(digit);
        }
    }
    let mut digits = Digits {
        at,
        point: None,
        whole: whole.min(HUGE),
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
    while let Some(digit) = lexer.digit() {
        if digits.places < PLACES {
            digits.fraction = digits.fraction * 10 + i64::from(digit);
        }
        digits.places = digits.places.saturating_add(1);
    }
    digits.fraction *= LAST_PLACE[usize::from(digits.places.min(PLACES))];
    if lexer.peek().0 == b'.' {
        let rule = say::point_twice();
        return Err(BlockError::at(number::BAD_POINT, lexer.at, rule));
    }
    Ok(digits)
}

/// Numbers this large are out of every range; reading stops to grow there.
const HUGE: i64 = 1_000_000_000_000;

/// Decimal places of a millionth; what is written after them is dropped.
const PLACES: u8 = 6;

/// What one in the last of so many places is worth, in millionths.
const LAST_PLACE: [i64; PLACES as usize + 1] = [1_000_000, 100_000, 10_000, 1000, 100, 10, 1];

/// So many digits the number of a feed may have, but for zeros that say nothing.
const FEED_DIGITS: usize = 7;

/// Digits of the number that was read last, from here on, without the zeros in front and
/// those at the end of a fraction.
fn significant_digits(lexer: &Lexer<'_>, at: usize) -> usize {
    let mut lexer = lexer.moved_to(at);
    let mut significant = 0_usize;
    while let Some(digit) = lexer.digit() {
        significant += usize::from(significant > 0 || digit != 0);
    }
    let (mark, len) = lexer.peek();
    if mark != b'.' {
        return significant;
    }
    lexer.at += len;
    let mut zeros = 0;
    while let Some(digit) = lexer.digit() {
        if digit == 0 {
            zeros += usize::from(significant > 0);
        } else {
            significant += zeros + 1;
            zeros = 0;
        }
    }
    significant
}

/// Leading zeros beyond these are not kept.
const MAX_DIGITS: u8 = 20;

#[cold]
fn no_digits(lexer: &Lexer<'_>, name: char, start: usize, marks: bool) -> BlockError {
    if marks {
        return BlockError::at(number::BAD_VALUE, start, say::number_without_digits(name));
    }
    match lexer.peek().0 {
        FOREIGN
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

/// `#i` after an address; the lexer stands on `#`.
#[cold]
fn read_variable(lexer: &mut Lexer<'_>, address: u8, negative: bool) -> Result<Number, BlockError> {
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
    Ok(Number::from_variable(Variable { number, negative }))
}

fn program_number(value: Number, at: usize) -> Result<u16, BlockError> {
    match u16::try_from(value.integer()) {
        Ok(number @ ..=9999) => Ok(number),
        _ => Err(number_too_great(b'O', value, at, 9999)),
    }
}

/// The number of a block, as far as the model counts.
fn sequence_number(value: Number, syntax: Syntax, at: usize) -> Result<u32, BlockError> {
    let last = syntax.model.record().last_sequence;
    match u32::try_from(value.integer()) {
        Ok(number) if number <= last => Ok(number),
        _ => Err(number_too_great(b'N', value, at, last)),
    }
}

#[cold]
fn number_too_great(address: u8, value: Number, at: usize, most: u32) -> BlockError {
    let rule = say::number_too_great(char::from(address), value, most);
    let detail = advised(rule, dialect::instead_of_number(address));
    BlockError::at(number::OUT_OF_RANGE, at, detail)
}
