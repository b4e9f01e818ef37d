//! Detects whether a program uses macro B or the macro language of G65 H.

use super::super::lexer::Lexer;
use super::expression::parse_variable_number;
use crate::memory::Variables;

/// Whether macro A and macro B both have the variable `number`: the variables of macro A,
/// direct or indirect (9nnn), and the signals of the PLC.
fn is_shared_variable(number: u32) -> bool {
    let Ok(number) = u16::try_from(number) else {
        return false;
    };
    let through = number.checked_sub(9000);
    Variables::has_integer(number)
        || through.is_some_and(Variables::has_integer)
        || matches!(number, 1000..=1015 | 1032 | 1100..=1115 | 1132 | 1133)
}

/// Whether a text has a statement, a formula or a variable that only macro B has. Without any
/// of them, a variable in a word counts least increments, as G65 H stores values.
pub(in crate::program) fn uses_macro_b(text: &str) -> bool {
    let mut lexer = Lexer::new(text);
    let mut before = 0_u8;
    while !lexer.is_at_end() {
        let (byte, len) = lexer.peek();
        let letter = byte.is_ascii_alphabetic();
        match byte {
            b'(' if lexer.skip_comment().is_ok() => {
                before = b' ';
                continue;
            }
            b'[' | b']' | b'=' => return true,
            b'#' => {
                let after = lexer.moved_to(lexer.at + len);
                if parse_variable_number(after.rest())
                    .is_none_or(|number| !is_shared_variable(number))
                {
                    return true;
                }
            }
            b'G' | b'g' if is_macro_call(lexer.moved_to(lexer.at + len)) => return true,
            _ if letter && before.is_ascii_alphabetic() => return true,
            _ => {}
        }
        before = byte;
        lexer.at += len.max(1);
    }
    false
}

/// Whether the G code at the position is G66, G67, or G65 without H.
fn is_macro_call(mut lexer: Lexer<'_>) -> bool {
    let mut code = 0_u32;
    while let Some(digit) = lexer.read_digit() {
        code = code.saturating_mul(10).saturating_add(digit.into());
    }
    match code {
        66 | 67 => true,
        65 => lexer.skip_blanks().is_ok() && !matches!(lexer.peek().0, b'H' | b'h'),
        _ => false,
    }
}
