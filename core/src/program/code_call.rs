//! G and M codes that call a program with arguments: the block is read as that of a G65.

use gsk_messages::say;

use super::head::Head;
use super::lexer::{Lexer, skip_blanks};
use super::macro_b::{Expression, MacroCall, arguments};
use super::syntax::BlockError;
use crate::alarm::number;

/// The digits of a code that may call.
const DIGITS: u8 = 3;

/// A block that calls a program by its first code.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CodeCall {
    /// Its letter and number.
    pub(crate) code: (char, u16),
    /// Sequence number N.
    pub(crate) n: Option<u32>,
    /// Whether `/` stands before it.
    pub(crate) skip: bool,
    /// The words after the code.
    pub(crate) call: MacroCall,
}

/// The call that a block makes by the code it begins with; `program_of` says what a
/// letter and a number call.
///
/// # Errors
/// 114 for what is no word, 129 for an address that carries no argument, P among them.
pub(super) fn read(
    text: &str,
    program_of: &dyn Fn(char, u16) -> Option<u16>,
) -> Result<Option<CodeCall>, BlockError> {
    let head = Head::read(text);
    let mut lexer = Lexer::new(text);
    if head.o.is_some() || !head.skip_in(&mut lexer) {
        return Ok(None);
    }
    let letter = match lexer.peek() {
        (b'G' | b'g', _) => 'G',
        (b'M' | b'm', _) => 'M',
        _ => return Ok(None),
    };
    let at = lexer.at;
    lexer.at += 1;
    let Some(code) = code(&mut lexer) else {
        return Ok(None);
    };
    let Some(program) = program_of(letter, code) else {
        return Ok(None);
    };
    let mut call = arguments(&mut lexer).map_err(|error| error.located(text))?;
    if call.program.is_some() {
        let rule = say::macro_argument_address('P');
        return Err(BlockError::at(number::BAD_ARGUMENT, at, rule).located(text));
    }
    call.program = Some(Expression::number(program.into()));
    Ok(Some(CodeCall {
        code: (letter, code),
        n: head.n,
        skip: head.skip,
        call,
    }))
}

/// The number of a code, without a fraction and without a variable.
fn code(lexer: &mut Lexer<'_>) -> Option<u16> {
    skip_blanks(lexer).ok()?;
    let (mut value, mut digits) = (0_u16, 0);
    while let Some(digit) = lexer.digit() {
        digits += 1;
        if digits > DIGITS {
            return None;
        }
        value = value * 10 + u16::from(digit);
    }
    (digits > 0 && lexer.peek().0 != b'.').then_some(value)
}

impl Head {
    /// Moves to the first word after `/` and N; whether there may be one.
    fn skip_in(&self, lexer: &mut Lexer<'_>) -> bool {
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
            while lexer.digit().is_some() {}
        }
        next(lexer)
    }
}
