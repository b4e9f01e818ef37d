//! The word syntax: text of a block to words, with every range (manual I-2.2,
//! table 2-1).

use core::fmt;

use super::block::{Block, Word, is_length};
use super::lexer::{FOREIGN, Lexer};
use super::number::{Number, Variable};
use crate::alarm::Alarm;
use crate::memory::Parameters;

/// What parameters change in the syntax.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Syntax {
    /// 013 POD: a decimal point is compulsory on X Z U W R I J K F.
    pub point_required: bool,
    /// Lengths are inches, to 0.0001.
    pub inch: bool,
}

impl Syntax {
    /// The least input increment of a length, in millionths of its unit.
    pub(super) const fn increment(self) -> i64 {
        if self.inch { 100 } else { 1000 }
    }
}

impl From<&Parameters> for Syntax {
    fn from(parameters: &Parameters) -> Self {
        Self {
            point_required: parameters.point_required(),
            inch: false,
        }
    }
}

/// Why a text is no block.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BlockError {
    /// Alarm number.
    pub alarm: u16,
    /// Column in the text of the block, in characters from 1.
    pub column: u32,
    /// The rule that is broken, in English.
    pub detail: String,
}

impl BlockError {
    /// An error at a byte of the text.
    #[cold]
    fn at(alarm: u16, byte: usize, detail: impl Into<String>) -> Self {
        let column = u32::try_from(byte).unwrap_or(u32::MAX).saturating_add(1);
        Self {
            alarm,
            column,
            detail: detail.into(),
        }
    }

    pub(super) fn too_many_words() -> Self {
        Self::at(12, 0, "more words than a block can hold")
    }

    /// Turns the byte column into one of characters.
    fn located(mut self, text: &str) -> Self {
        let byte = (self.column - 1) as usize;
        let before = text.char_indices().take_while(|(at, _)| *at < byte).count();
        self.column = u32::try_from(before).unwrap_or(u32::MAX).saturating_add(1);
        self
    }
}

impl fmt::Display for BlockError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{:03} at column {}: {}",
            self.alarm, self.column, self.detail
        )
    }
}

impl core::error::Error for BlockError {}

impl From<BlockError> for Alarm {
    fn from(error: BlockError) -> Self {
        Self::new(error.alarm).because(format!("column {}: {}", error.column, error.detail))
    }
}

/// Reads one block: up to the first `;`, `*`, `%` or end of line outside
/// comments. Does not allocate unless it fails.
///
/// # Errors
/// The alarm of the syntax: 002, 005, 006, 007, 009, 012, 018, 043, 125.
pub fn parse_block(text: &str, syntax: Syntax) -> Result<Block, BlockError> {
    let mut block = Block::default();
    read_block(text, syntax, &mut block)?;
    Ok(block)
}

/// The same into an empty block.
pub(super) fn read_block(text: &str, syntax: Syntax, block: &mut Block) -> Result<(), BlockError> {
    read_words(text, syntax, block)
        .and_then(|()| check_values(block))
        .map_err(|error| error.located(text))
}

fn read_words(text: &str, syntax: Syntax, block: &mut Block) -> Result<(), BlockError> {
    let mut lexer = Lexer::new(text);
    let mut seen = 0_u32;
    let mut g65 = false;
    skip_blanks(&mut lexer)?;
    if let (b'/', len) = lexer.peek() {
        lexer.at += len;
        block.skip = true;
    }
    loop {
        skip_blanks(&mut lexer)?;
        let start = lexer.at;
        let (byte, len) = lexer.peek();
        let address = match byte {
            b'A'..=b'Z' => byte,
            b'a'..=b'z' => byte.to_ascii_uppercase(),
            b'\n' | b';' | b'*' | b'%' => return Ok(()),
            _ => return Err(misplaced(text, start, byte)),
        };
        if !is_address(address) {
            let detail = format!("{} is not an address", char::from(address));
            return Err(BlockError::at(9, start, detail));
        }
        if g65 && !matches!(address, b'H' | b'P' | b'Q' | b'R') {
            let detail = format!(
                "{} after G65: only H, P, Q, R may follow",
                char::from(address)
            );
            return Err(BlockError::at(125, start, detail));
        }
        let bit = 1 << (address - b'A');
        if seen & bit != 0 && address != b'G' {
            let detail = format!("a second {} in the block", char::from(address));
            return Err(BlockError::at(18, start, detail));
        }
        seen |= bit;

        lexer.at += len;
        let value = read_number(&mut lexer, address, start, g65, syntax)?;
        if matches!(address, b'N' | b'O') {
            let number = program_number(address, value, start)?;
            *(if address == b'N' {
                &mut block.n
            } else {
                &mut block.o
            }) = Some(number);
            continue;
        }
        if address == b'G' && value.integer() == 65 && value.variable().is_none() {
            if !block.is_empty() {
                return Err(BlockError::at(
                    125,
                    start,
                    "only O and N may stand before G65",
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

fn narrow(at: usize) -> u16 {
    u16::try_from(at).unwrap_or(u16::MAX)
}

fn skip_blanks(lexer: &mut Lexer<'_>) -> Result<(), BlockError> {
    lexer
        .skip_blanks()
        .map_err(|open| BlockError::at(6, open, "a comment that is not closed on its line"))
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
        b'0'..=b'9' | b'.' => BlockError::at(6, at, "a number without an address"),
        b'+' | b'-' | b'#' => BlockError::at(
            2,
            at,
            "the number before it ends in a way that cannot be read",
        ),
        b'/' => BlockError::at(6, at, "/ stands only at the start of a block"),
        _ => {
            let character = text.get(at..).and_then(|rest| rest.chars().next());
            let detail = format!(
                "{:?} is no character of the language",
                character.unwrap_or(' ')
            );
            BlockError::at(6, at, detail)
        }
    }
}

/// The number after an address letter that stands at `start`.
fn read_number(
    lexer: &mut Lexer<'_>,
    address: u8,
    start: usize,
    g65: bool,
    syntax: Syntax,
) -> Result<Number, BlockError> {
    skip_blanks(lexer)?;
    let name = char::from(address);
    let (first, len) = lexer.peek();
    let negative = first == b'-';
    let signed = negative || first == b'+';
    if signed {
        lexer.at += len;
        skip_blanks(lexer)?;
    }
    if lexer.peek().0 == b'#' {
        return read_variable(lexer, address, negative);
    }

    let mut digits = 0_u8;
    let mut significant = 0_u32;
    let mut whole = 0_i64;
    while let (byte @ b'0'..=b'9', len) = lexer.peek() {
        lexer.at += len;
        digits = digits.saturating_add(1);
        significant += u32::from(significant > 0 || byte != b'0');
        if whole < HUGE {
            whole = whole * 10 + i64::from(byte - b'0');
        }
    }
    let (mark, mark_len) = lexer.peek();
    let point = mark == b'.';
    let point_at = lexer.at;
    let mut fraction = 0_i64;
    let mut fraction_digits = 0_u8;
    if point {
        lexer.at += mark_len;
        let mut unit = 100_000;
        let mut zeros = 0;
        while let (byte @ b'0'..=b'9', len) = lexer.peek() {
            lexer.at += len;
            fraction_digits = fraction_digits.saturating_add(1);
            fraction += i64::from(byte - b'0') * unit;
            unit /= 10;
            if byte == b'0' {
                zeros += u32::from(significant > 0);
            } else {
                significant += zeros + 1;
                zeros = 0;
            }
        }
        if lexer.peek().0 == b'.' {
            return Err(BlockError::at(7, lexer.at, "a second decimal point"));
        }
    }

    if digits == 0 && fraction_digits == 0 {
        return Err(no_digits(lexer, name, start, signed || point));
    }
    if point && (g65 || !takes_point(address)) {
        return Err(BlockError::at(
            7,
            point_at,
            format!("{name} takes no decimal point"),
        ));
    }
    if !point && syntax.point_required && takes_point(address) && !g65 {
        let detail = format!("{name} needs a decimal point (parameter 013 POD = 1)");
        return Err(BlockError::at(7, start, detail));
    }
    if address == b'F' && significant > 7 {
        return Err(BlockError::at(43, start, "F has more than 7 digits"));
    }
    let size = whole.min(HUGE) * 1_000_000 + fraction;
    let millionths = if negative { -size } else { size };
    if point {
        let number = Number::from_millionths(millionths);
        return Ok(if is_length(address) {
            number.rounded_to_increment(syntax.increment())
        } else {
            number
        });
    }
    Ok(Number::from_integer(
        millionths / 1_000_000,
        digits.min(MAX_DIGITS),
    ))
}

/// Numbers this large are out of every range; reading stops to grow there.
const HUGE: i64 = 1_000_000_000_000;

/// Leading zeros beyond these are not kept.
const MAX_DIGITS: u8 = 20;

#[cold]
fn no_digits(lexer: &Lexer<'_>, name: char, start: usize, marks: bool) -> BlockError {
    if marks {
        return BlockError::at(
            2,
            start,
            format!("{name} has a sign or a point but no digits"),
        );
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
            6,
            lexer.at,
            format!("{name} is followed by a character that is no number"),
        ),
        _ => BlockError::at(5, start, format!("{name} has no number")),
    }
}

/// `#i` after an address; the lexer stands on `#`.
#[cold]
fn read_variable(lexer: &mut Lexer<'_>, address: u8, negative: bool) -> Result<Number, BlockError> {
    let at = lexer.at;
    let name = char::from(address);
    if matches!(address, b'N' | b'O' | b'J' | b'L') {
        return Err(BlockError::at(2, at, format!("{name} takes no variable")));
    }
    lexer.at += lexer.peek().1;
    let mut digits = 0;
    let mut number = 0_u16;
    while let (byte @ b'0'..=b'9', len) = lexer.peek() {
        lexer.at += len;
        digits += 1;
        if digits > 4 {
            return Err(BlockError::at(
                115,
                at,
                "a variable number has at most 4 digits",
            ));
        }
        number = number * 10 + u16::from(byte - b'0');
    }
    if digits == 0 {
        return Err(BlockError::at(2, at, "# without a variable number"));
    }
    if lexer.peek().0 == b'.' {
        return Err(BlockError::at(
            7,
            lexer.at,
            "a variable number takes no decimal point",
        ));
    }
    Ok(Number::from_variable(Variable { number, negative }))
}

fn program_number(address: u8, value: Number, at: usize) -> Result<u16, BlockError> {
    match u16::try_from(value.integer()) {
        Ok(number @ ..=9999) => Ok(number),
        _ => {
            let detail = format!("{}{value} is outside 0 to 9999", char::from(address));
            Err(BlockError::at(43, at, detail))
        }
    }
}

/// Checks every number of a block against table 2-1; references to variables are
/// left out.
pub(super) fn check_values(block: &Block) -> Result<(), BlockError> {
    let g65 = block.has_g(65);
    for word in block.words() {
        if word.value.variable().is_some() {
            continue;
        }
        let (low, high) = range(block, word, g65);
        let value = word.value.millionths();
        if value < low || value > high {
            return Err(out_of_range(word, low, high));
        }
    }
    Ok(())
}

const ONE: i64 = 1_000_000;
/// Largest length, ±9999.999 mm.
const LENGTH: i64 = 9_999_999_000;
/// Largest dwell, 99999.999 s; negative values count as zero.
const DWELL: i64 = 99_999_999_000;
/// What a macro operation can hold, ±2³².
const MACRO: i64 = (1 << 32) * ONE;

/// Lowest and highest value of a word, in millionths.
fn range(block: &Block, word: &Word, g65: bool) -> (i64, i64) {
    match word.address {
        b'H' | b'P' | b'Q' | b'R' if g65 => (-MACRO, MACRO),
        b'X' | b'U' if block.has_g(4) => (-DWELL, DWELL),
        // G76 R(d): an integer counts in 0.001 mm.
        b'R' if block.has_g(76) && !word.value.has_point() => (-9_999_999 * ONE, 9_999_999 * ONE),
        // Vector of an arc, or threads per inch.
        b'I' => (-LENGTH, 25_400 * ONE),
        b'F' => (0, 9_999_999 * ONE),
        b'G' | b'M' | b'H' => (0, 99 * ONE),
        b'L' => (ONE, 99 * ONE),
        b'S' | b'T' => (0, 9999 * ONE),
        b'P' => (-99_999_999 * ONE, 99_999_999 * ONE),
        b'Q' => (-9_999_999 * ONE, 9_999_999 * ONE),
        _ => (-LENGTH, LENGTH),
    }
}

#[cold]
fn out_of_range(word: &Word, low: i64, high: i64) -> BlockError {
    let limit = |millionths: i64| {
        let text = Number::from_millionths(millionths).to_string();
        text.trim_end_matches('.').to_string()
    };
    let name = char::from(word.address);
    let detail = format!(
        "{name}{} is outside {} to {}",
        word.value,
        limit(low),
        limit(high)
    );
    BlockError::at(43, word.span.0.into(), detail)
}
