//! Parses the words of a block and checks their ranges (manual I-2.2, table 2-1).

use gsk_messages::say;

use super::block::{ProgramBlock, ProgramWord, check_values, is_address_of_model};
use super::foreign_words::two_block_form;
use super::lexer::{Lexer, clamp_to_u16, skip_blanks};
use super::macro_b::{self, MacroStatement};
use super::number::{VariableReference, WordNumber};
use super::plain_words::{PlainToken, PlainWord, PlainWords};
use super::read_number::{CLAMPED_VALUE, read_number};
use super::syntax::{BlockError, Syntax};
use crate::alarm::number;
use crate::dialect::{self, with_advice};
use crate::model::GCode;

/// Parses one block: the text up to the first `;`, `*`, `%` or line end outside comments. The
/// parser allocates only if it fails.
///
/// # Errors
/// The alarm of the syntax: 002, 005, 006, 007, 009, 012, 018, 043, 125; of macro B 114,
/// 118, 126, 127, 129.
pub(crate) fn parse_block(text: &str, syntax: Syntax) -> Result<ProgramBlock, BlockError> {
    let mut block = ProgramBlock::default();
    read_block(text, syntax, &mut block)?;
    Ok(block)
}

/// Parses the first block of `text` into `block`, which must be empty. Returns the first fault of
/// its syntax as error.
pub(super) fn read_block(
    text: &str,
    syntax: Syntax,
    block: &mut ProgramBlock,
) -> Result<(), BlockError> {
    let mut lexer = Lexer::new(text);
    let mut seen = 0;
    // Plain words are within their ranges if the model does not narrow these.
    let is_plain = !syntax.macro_b && !syntax.narrows_words();
    if is_plain && read_plain_words(&mut lexer, &mut seen, syntax, block) {
        return Ok(());
    }
    read_words(text, lexer, seen, syntax, block)
        .and_then(|()| check_values(block, syntax))
        .map_err(|error| error.with_character_column(text))
}

/// Reads the words at the beginning of a block that have the common form. Returns `true` if
/// the block has no others; otherwise [`read_words`] reads the rest.
fn read_plain_words(
    lexer: &mut Lexer<'_>,
    seen: &mut u32,
    syntax: Syntax,
    block: &mut ProgramBlock,
) -> bool {
    let mut words = PlainWords::new(lexer.rest(), syntax.point_required);
    loop {
        let PlainWord {
            address,
            value,
            start,
        } = match words.next_token() {
            PlainToken::Word(word) => word,
            PlainToken::BlockEnd => return true,
            PlainToken::Other => return false,
        };
        let bit = 1 << (address - b'A');
        if *seen & bit != 0 && address != b'G' {
            return false;
        }
        match address {
            b'G' if value.integer() == 65 => return false,
            // After a G code N is not a sequence number on Huaxing lathes.
            b'N' if !block.is_empty() => return false,
            b'N' => block.n = Some(value.integer() as u32),
            _ => {
                let span = (clamp_to_u16(start), clamp_to_u16(words.position()));
                let word = ProgramWord {
                    address,
                    value,
                    span,
                };
                if !block.push(word) {
                    return false;
                }
            }
        }
        *seen |= bit;
        lexer.at = words.position();
    }
}

/// Reads the words from the position of the lexer to the end of the block. `seen` has one bit for
/// each address already read. Returns the first fault of the syntax as error.
fn read_words(
    text: &str,
    mut lexer: Lexer<'_>,
    mut seen: u32,
    syntax: Syntax,
    block: &mut ProgramBlock,
) -> Result<(), BlockError> {
    let mut g65 = false;
    skip_blanks(&mut lexer)?;
    if seen == 0 {
        read_skip_mark(&mut lexer, block);
    }
    loop {
        skip_blanks(&mut lexer)?;
        let start = lexer.at;
        let (byte, len) = lexer.peek();
        if syntax.macro_b && macro_b::is_statement_start(&lexer) {
            if !block.is_empty() {
                return Err(statement_not_alone(start));
            }
            block.statement = Some(Box::new(MacroStatement::read(&mut lexer)?));
            return check_block_end(&mut lexer);
        }
        let address = match byte {
            b'A'..=b'Z' => byte,
            b'a'..=b'z' => byte.to_ascii_uppercase(),
            // The program name of other controls.
            b':' if block.is_empty() && block.o.is_none() && block.n.is_none() => b'O',
            // In a block with formulas it means multiplication and is no end.
            b'*' if block.statement.is_some() => return check_block_end(&mut lexer),
            b'\n' | b';' | b'*' => return Ok(()),
            // Alone in its line it ends the text, and the block is empty.
            b'%' if seen == 0 && !block.skip && is_blank_after_mark(&lexer) => return Ok(()),
            _ => return Err(misplaced_character(text, start, byte)),
        };
        if !is_address_of_model(address, syntax.model.record()) {
            return Err(foreign_address(text, address, start, syntax));
        }
        if g65 && !matches!(address, b'H' | b'P' | b'Q' | b'R') {
            return Err(foreign_macro_address(address, start));
        }
        let bit = 1 << (address - b'A');
        if seen & bit != 0 && address != b'G' && !is_count_word(address, syntax, block) {
            return Err(repeated_address(address, start));
        }
        seen |= bit;

        lexer.at += len;
        if is_count_word(address, syntax, block) {
            read_count_words(&mut lexer, block, start)?;
            continue;
        }
        let formula = match syntax.macro_b && !g65 {
            true => read_formula(&mut lexer, address, block)?,
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
            && let Some(statement) = read_macro_call(&mut lexer, value, syntax)?
        {
            if !block.is_empty() {
                return Err(statement_not_alone(start));
            }
            block.statement = Some(Box::new(statement));
            return check_block_end(&mut lexer);
        }
        let code = address == b'G' && value.variable().is_none();
        if code && value.integer() == 65 && !syntax.model.is_mill() {
            if !block.is_empty() {
                return Err(macro_not_first(start));
            }
            g65 = true;
        }
        let span = (clamp_to_u16(start), clamp_to_u16(lexer.at));
        if !block.push(ProgramWord {
            address,
            value,
            span,
        }) {
            return Err(too_many_words(start));
        }
    }
}

/// Skips the mark `/` at the start of a block and records it in the block.
#[inline]
fn read_skip_mark(lexer: &mut Lexer<'_>, block: &mut ProgramBlock) {
    if let (b'/', len) = lexer.peek() {
        lexer.at += len;
        block.skip = true;
    }
}

/// Alarm 012 of a block with too many words.
#[cold]
fn too_many_words(start: usize) -> BlockError {
    let rule = say::block_words_too_many();
    BlockError::at(number::TOO_MANY_WORDS, start, rule)
}

/// The error of an address that a G65 block (macro A) does not accept.
#[cold]
fn foreign_macro_address(address: u8, start: usize) -> BlockError {
    let detail = say::macro_address_wrong(char::from(address));
    BlockError::at(number::BAD_IN_MACRO, start, detail)
}

/// The error of an address that is already in the block.
#[cold]
fn repeated_address(address: u8, start: usize) -> BlockError {
    let detail = say::address_twice(char::from(address));
    BlockError::at(number::ADDRESS_TWICE, start, detail)
}

/// The error of a G65 that is not the first word of its block.
#[cold]
fn macro_not_first(start: usize) -> BlockError {
    let detail = say::macro_not_first_in_block();
    BlockError::at(number::BAD_IN_MACRO, start, detail)
}

/// Whether an N word is not a sequence number because a G code is before it (Huaxing).
#[inline]
fn is_count_word(address: u8, syntax: Syntax, block: &ProgramBlock) -> bool {
    address == b'N' && block.has(b'G') && syntax.model.record().n_after_g
}

/// Whether a G code earlier in the block makes the number of `address`, usually an integer, a
/// length or a factor (Huaxing): L of G31, D of the thread codes, P as their lead.
#[inline]
fn has_point_by_code(address: u8, syntax: Syntax, block: &ProgramBlock) -> bool {
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

/// Reads an N word after a G code of the Huaxing lathes: the number of a block or subprogram,
/// or a count. Up to two more numbers after points are P and L: `G25 N100.140.3` is `N100 P140
/// L3`, `G20 N05.3` is `N05 L3`.
#[cold]
fn read_count_words(
    lexer: &mut Lexer<'_>,
    block: &mut ProgramBlock,
    start: usize,
) -> Result<(), BlockError> {
    let mut numbers = Vec::new();
    loop {
        skip_blanks(lexer)?;
        let begin = lexer.at;
        let mut value = 0_i64;
        while let Some(digit) = lexer.read_digit() {
            value = (value * 10 + i64::from(digit)).min(CLAMPED_VALUE);
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
        let word = ProgramWord {
            address: *address,
            value: WordNumber::from_integer(value, 0),
            span: (clamp_to_u16(start), clamp_to_u16(lexer.at)),
        };
        if !block.push(word) {
            return Err(BlockError::too_many_words());
        }
    }
    Ok(())
}

/// Reads the macro call after a G code: G65 without H, G66 or G67; `None` for other codes. Returns
/// the first fault of its syntax as error.
#[cold]
fn read_macro_call(
    lexer: &mut Lexer<'_>,
    code: WordNumber,
    syntax: Syntax,
) -> Result<Option<MacroStatement>, BlockError> {
    if code.variable().is_some() {
        return Ok(None);
    }
    skip_blanks(lexer)?;
    let macro_a = matches!(lexer.peek().0, b'H' | b'h') && !syntax.model.is_mill();
    Ok(match code.integer() {
        65 if !macro_a => Some(MacroStatement::Call(macro_b::read_arguments(lexer)?)),
        66 => Some(MacroStatement::ModalCall(macro_b::read_arguments(lexer)?)),
        67 => Some(MacroStatement::CancelModalCall),
        _ => None,
    })
}

/// Reads the variable or formula that a word has instead of a number, and stores the formula
/// in the block. `None` if the word has a number.
#[cold]
fn read_formula(
    lexer: &mut Lexer<'_>,
    address: u8,
    block: &mut ProgramBlock,
) -> Result<Option<WordNumber>, BlockError> {
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
    let expression = macro_b::read_word_formula(&mut ahead)?;
    *lexer = ahead;
    let statement = block
        .statement
        .get_or_insert_with(|| Box::new(MacroStatement::Words(Vec::new())));
    let MacroStatement::Words(formulas) = &mut **statement else {
        return Err(statement_not_alone(lexer.at));
    };
    let number = clamp_to_u16(formulas.len());
    formulas.push(expression);
    Ok(Some(WordNumber::from_variable(VariableReference {
        number,
        negative,
    })))
}

/// The error of a macro statement that shares its block with words other than N.
#[cold]
fn statement_not_alone(at: usize) -> BlockError {
    BlockError::at(number::MIXED_BLOCK, at, say::macro_statement_not_alone())
}

/// Checks that only blanks and comments follow a macro statement in its block. Returns an error if
/// not.
#[cold]
fn check_block_end(lexer: &mut Lexer<'_>) -> Result<(), BlockError> {
    skip_blanks(lexer)?;
    match lexer.peek().0 {
        b'\n' | b';' => Ok(()),
        byte if byte.is_ascii_alphabetic() => Err(statement_not_alone(lexer.at)),
        _ => Err(BlockError::at(
            number::BAD_OPERATION,
            lexer.at,
            say::formula_end_wrong(),
        )),
    }
}

/// The error of a letter that is not an address of the control model.
#[cold]
fn foreign_address(text: &str, address: u8, start: usize, syntax: Syntax) -> BlockError {
    let rule = say::address_unknown(char::from(address));
    let cycle = match address {
        b'A' | b'D' => two_block_form(text, syntax),
        _ => None,
    };
    let advice = cycle.or_else(|| dialect::advice_for_address(address));
    BlockError::at(number::BAD_ADDRESS, start, with_advice(rule, advice))
}

/// Whether only blanks and further end marks follow the `%` at the position of the lexer.
fn is_blank_after_mark(lexer: &Lexer<'_>) -> bool {
    let mut bytes = lexer.rest().iter();
    bytes.all(|byte| *byte == b'%' || byte.is_ascii_whitespace() || *byte < b' ')
}

/// The error of the character `byte`, at byte `at`, where a word must begin.
#[cold]
fn misplaced_character(text: &str, at: usize, byte: u8) -> BlockError {
    match byte {
        b'#' if text
            .get(..at)
            .is_some_and(|before| before.trim().is_empty()) =>
        {
            let rule = say::block_begins_with_variable();
            BlockError::at(
                number::BAD_CHARACTER,
                at,
                with_advice(rule, dialect::advice_for_character(byte)),
            )
        }
        b'0'..=b'9' | b'.' => {
            BlockError::at(number::BAD_CHARACTER, at, say::number_without_address())
        }
        b'+' | b'-' | b'#' => BlockError::at(number::BAD_VALUE, at, say::number_end_wrong()),
        b'/' => BlockError::at(number::BAD_CHARACTER, at, say::skip_mark_misplaced()),
        b'%' => BlockError::at(number::BAD_CHARACTER, at, say::percent_within_line()),
        b',' if let Some(number) = decimal_comma(text, at) => {
            BlockError::at(number::BAD_CHARACTER, at, say::decimal_comma(number))
        }
        _ => {
            let character = text.get(at..).and_then(|rest| rest.chars().next());
            let character = character.unwrap_or(' ');
            let rule = say::character_unknown(format_args!("{character:?}"));
            let detail = with_advice(rule, dialect::advice_for_character(byte));
            BlockError::at(number::BAD_CHARACTER, at, detail)
        }
    }
}

/// Greatest number of digits of a word that [`decimal_comma`] corrects.
const MAX_CORRECTED_DIGITS: usize = 20;

/// The word around a comma that is between digits, with a point instead of the comma; `None`
/// if the comma is not a decimal comma.
fn decimal_comma(text: &str, at: usize) -> Option<String> {
    let (before, after) = (text.get(..at)?, text.get(at..)?);
    let comma = after.chars().next()?;
    let after = after.strip_prefix(comma)?;
    let digits = after.bytes().take_while(u8::is_ascii_digit).count();
    let number = |byte: u8| byte.is_ascii_digit() || matches!(byte, b'+' | b'-');
    let whole = before
        .bytes()
        .rev()
        .take_while(|byte| number(*byte))
        .count();
    let address = before.len().checked_sub(whole + 1)?;
    let word = before.get(address..)?;
    let plain = digits > 0
        && before.ends_with(|last: char| last.is_ascii_digit())
        && word.starts_with(|first: char| first.is_ascii_alphabetic());
    let few = whole + digits < MAX_CORRECTED_DIGITS;
    (plain && few).then(|| format!("{}.{}", word.to_ascii_uppercase(), &after[..digits]))
}

fn program_number(value: WordNumber, at: usize) -> Result<u16, BlockError> {
    match u16::try_from(value.integer()) {
        Ok(number @ ..=9999) => Ok(number),
        _ => Err(number_too_great(b'O', value, at, 9999)),
    }
}

/// The sequence number of a block; alarm 043 if it exceeds the greatest one of the model.
fn sequence_number(value: WordNumber, syntax: Syntax, at: usize) -> Result<u32, BlockError> {
    let last = syntax.model.record().last_sequence;
    match u32::try_from(value.integer()) {
        Ok(number) if number <= last => Ok(number),
        _ => Err(number_too_great(b'N', value, at, last)),
    }
}

#[cold]
fn number_too_great(address: u8, value: WordNumber, at: usize, most: u32) -> BlockError {
    let rule = say::number_too_great(char::from(address), value, most);
    let detail = with_advice(rule, dialect::advice_for_number(address));
    BlockError::at(number::OUT_OF_RANGE, at, detail)
}
