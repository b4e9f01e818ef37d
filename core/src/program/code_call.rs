//! Reads G and M codes that call a program with arguments: their block is read like that of
//! a G65.

use gsk_messages::say;

use super::block_head::BlockHead;
use super::lexer::{Lexer, skip_blanks};
use super::macro_b::{FormulaCode, MacroCall, read_arguments};
use super::syntax::BlockError;
use crate::alarm::number;

/// Greatest number of digits of a code that calls a program.
const MAX_CODE_DIGITS: u8 = 3;

/// A block that begins with a G or M code that calls a program (macro B).
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CodeCall {
    /// Letter and number of the code, e.g. `('M', 98)`.
    pub(crate) code: (char, u16),
    /// Sequence number (N word) of the block; `None` without one.
    pub(crate) n: Option<u32>,
    /// Whether the block begins with the skip mark `/`.
    pub(crate) skip: bool,
    /// The call: the program that the code calls, and the arguments after the code.
    pub(crate) call: MacroCall,
}

/// Reads the program call by the first code of a block; `None` if that code calls no program.
/// `program_of` returns the program number for a letter and a code number.
///
/// # Errors
/// 114 for an invalid word, 129 for an address that cannot be an argument, such as P.
pub(super) fn read_code_call(
    text: &str,
    program_of: &dyn Fn(char, u16) -> Option<u16>,
) -> Result<Option<CodeCall>, BlockError> {
    let head = BlockHead::read(text);
    let mut lexer = Lexer::new(text);
    if head.o.is_some() || !head.skip_to_word(&mut lexer) {
        return Ok(None);
    }
    let letter = match lexer.peek() {
        (b'G' | b'g', _) => 'G',
        (b'M' | b'm', _) => 'M',
        _ => return Ok(None),
    };
    let start = lexer.at;
    lexer.at += 1;
    let Some(code) = read_code(&mut lexer) else {
        return Ok(None);
    };
    let Some(program) = program_of(letter, code) else {
        return Ok(None);
    };
    let mut call = read_arguments(&mut lexer).map_err(|error| error.with_character_column(text))?;
    if call.program.is_some() {
        let rule = say::macro_argument_address('P');
        return Err(BlockError::at(number::BAD_ARGUMENT, start, rule).with_character_column(text));
    }
    call.program = Some(FormulaCode::from_number(program.into()));
    Ok(Some(CodeCall {
        code: (letter, code),
        n: head.n,
        skip: head.skip,
        call,
    }))
}

/// Reads the number of a G or M code; `None` for a fraction, a variable or too many digits.
fn read_code(lexer: &mut Lexer<'_>) -> Option<u16> {
    skip_blanks(lexer).ok()?;
    let (mut value, mut digits) = (0_u16, 0);
    while let Some(digit) = lexer.read_digit() {
        digits += 1;
        if digits > MAX_CODE_DIGITS {
            return None;
        }
        value = value * 10 + u16::from(digit);
    }
    (digits > 0 && lexer.peek().0 != b'.').then_some(value)
}

impl BlockHead {
    /// Moves the lexer to the first word after `/` and N. Returns `false` if a comment before
    /// that word is not closed.
    fn skip_to_word(&self, lexer: &mut Lexer<'_>) -> bool {
        let next = |lexer: &mut Lexer<'_>| lexer.skip_blanks().is_ok();
        if !next(lexer) {
            return false;
        }
        if self.skip {
            lexer.at += lexer.peek().1;
        }
        if !next(lexer) {
            return false;
        }
        if self.n.is_some() {
            lexer.at += lexer.peek().1;
            if !next(lexer) {
                return false;
            }
            while lexer.read_digit().is_some() {}
        }
        next(lexer)
    }
}
