//! Parses the statements of macro B.

use gsk_messages::say;

use super::super::lexer::{Lexer, skip_blanks};
use super::super::syntax::BlockError;
use super::expression::{self, Expression, letters, names, wrong};
use crate::alarm::number;

/// The macro B statement of a block.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Statement {
    /// `#i=formula`.
    Assign(Assignment),
    /// `GOTO n`.
    Goto(Expression),
    /// `IF [condition] GOTO n`, `IF [condition] THEN #i=formula`.
    If(Condition, Then),
    /// `WHILE [condition] DO m`; without a condition it repeats forever.
    Do(Option<Condition>, u8),
    /// `END m`.
    End(u8),
    /// `G65 P`.
    Call(MacroCall),
    /// `G66 P`.
    ModalCall(MacroCall),
    /// `G67`.
    CancelModalCall,
    /// Ordinary words. Words with formulas hold the index of their formula in this list.
    Words(Vec<Expression>),
}

/// `#i=formula`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Assignment {
    /// The formula of the variable number.
    pub(crate) variable: Expression,
    pub(crate) value: Expression,
    /// The comment after it: the text of an alarm.
    pub(crate) comment: String,
}

/// The consequence of an `IF`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Then {
    Goto(Expression),
    Assign(Assignment),
}

/// A comparison such as `[a EQ b]`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Condition {
    pub(crate) left: Expression,
    pub(crate) relation: Relation,
    pub(crate) right: Expression,
}

/// The comparison of two values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Relation {
    Equal,
    NotEqual,
    Greater,
    GreaterOrEqual,
    Less,
    LessOrEqual,
}

/// The words of a macro call: addresses and values in the order of the text.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MacroCall {
    pub(crate) program: Option<Expression>,
    pub(crate) runs: Option<Expression>,
    pub(crate) arguments: Vec<(u8, Expression)>,
}

const RELATIONS: [(&str, Relation); 6] = [
    ("EQ", Relation::Equal),
    ("NE", Relation::NotEqual),
    ("GT", Relation::Greater),
    ("GE", Relation::GreaterOrEqual),
    ("LT", Relation::Less),
    ("LE", Relation::LessOrEqual),
];

/// Whether a macro statement begins at the position: a variable, or two consecutive letters.
pub(in crate::program) fn begins(lexer: &Lexer<'_>) -> bool {
    let (byte, len) = lexer.peek();
    let next = lexer.moved_to(lexer.at + len).peek().0;
    byte == b'#' || byte.is_ascii_alphabetic() && next.is_ascii_alphabetic()
}

impl Statement {
    /// Reads the statement at the position.
    ///
    /// # Errors
    /// 114 for an invalid statement, 118 for brackets that are nested too deep, 126 for an
    /// invalid loop number.
    pub(in crate::program) fn read(lexer: &mut Lexer<'_>) -> Result<Self, BlockError> {
        if lexer.peek().0 == b'#' {
            return Ok(Self::Assign(assignment(lexer)?));
        }
        let at = lexer.at;
        let word = letters(lexer);
        if names(&word, "GOTO") {
            return Ok(Self::Goto(Expression::value(lexer)?));
        }
        if names(&word, "IF") {
            let condition = condition(lexer)?;
            return Ok(Self::If(condition, then(lexer)?));
        }
        if names(&word, "WHILE") {
            let condition = condition(lexer)?;
            keyword(lexer, "DO")?;
            return Ok(Self::Do(Some(condition), loop_number(lexer)?));
        }
        if names(&word, "DO") {
            return Ok(Self::Do(None, loop_number(lexer)?));
        }
        if names(&word, "END") {
            return Ok(Self::End(loop_number(lexer)?));
        }
        lexer.at = at;
        Err(wrong(lexer, say::formula_name_unknown(word)))
    }
}

/// Reads the words after G65 and G66.
///
/// # Errors
/// 114 for an invalid word, 129 for an address that cannot be an argument.
pub(in crate::program) fn arguments(lexer: &mut Lexer<'_>) -> Result<MacroCall, BlockError> {
    let mut call = MacroCall {
        program: None,
        runs: None,
        arguments: Vec::new(),
    };
    loop {
        skip_blanks(lexer)?;
        let (byte, len) = lexer.peek();
        let address = byte.to_ascii_uppercase();
        match address {
            b'\n' | b';' | b'%' => return Ok(call),
            b'G' | b'N' | b'O' => {
                let rule = say::macro_argument_address(char::from(address));
                return Err(BlockError::at(number::BAD_ARGUMENT, lexer.at, rule));
            }
            b'A'..=b'Z' => lexer.at += len,
            _ => return Err(wrong(lexer, say::formula_address_missing())),
        }
        let value = Expression::value(lexer)?;
        match address {
            b'P' => call.program = Some(value),
            b'L' => call.runs = Some(value),
            _ => call.arguments.push((address, value)),
        }
    }
}

fn assignment(lexer: &mut Lexer<'_>) -> Result<Assignment, BlockError> {
    let variable = Expression::variable(lexer)?;
    skip_blanks(lexer)?;
    let (byte, len) = lexer.peek();
    if byte != b'=' {
        return Err(wrong(lexer, say::formula_equals_missing()));
    }
    lexer.at += len;
    let begin = *lexer;
    let value = Expression::read(lexer)?;
    Ok(Assignment {
        variable,
        value,
        comment: comment(begin, lexer.at),
    })
}

/// The last comment before a byte position.
fn comment(mut lexer: Lexer<'_>, end: usize) -> String {
    let mut last = String::new();
    while lexer.at < end {
        let (byte, len) = lexer.peek();
        let text = lexer.rest();
        let begin = lexer.at;
        if byte == b'(' && lexer.skip_comment().is_ok() {
            let text = text.get(len..lexer.at - begin).unwrap_or_default();
            let text = String::from_utf8_lossy(text);
            text.trim_end_matches([')', '\u{ff09}'])
                .trim()
                .clone_into(&mut last);
        } else {
            lexer.at += len.max(1);
        }
    }
    last
}

fn condition(lexer: &mut Lexer<'_>) -> Result<Condition, BlockError> {
    mark(lexer, b'[')?;
    let left = Expression::read(lexer)?;
    skip_blanks(lexer)?;
    let Some(relation) = expression::keyword(lexer, &RELATIONS) else {
        return Err(wrong(lexer, say::formula_relation_missing()));
    };
    let right = Expression::read(lexer)?;
    mark(lexer, b']')?;
    Ok(Condition {
        left,
        relation,
        right,
    })
}

fn mark(lexer: &mut Lexer<'_>, wanted: u8) -> Result<(), BlockError> {
    skip_blanks(lexer)?;
    let (byte, len) = lexer.peek();
    if byte != wanted {
        let rule = match wanted {
            b'[' => say::formula_bracket_missing(),
            _ => say::formula_bracket_open(),
        };
        return Err(wrong(lexer, rule));
    }
    lexer.at += len;
    Ok(())
}

fn then(lexer: &mut Lexer<'_>) -> Result<Then, BlockError> {
    skip_blanks(lexer)?;
    let at = lexer.at;
    let word = letters(lexer);
    if names(&word, "GOTO") {
        return Ok(Then::Goto(Expression::value(lexer)?));
    }
    if !names(&word, "THEN") {
        lexer.at = at;
        return Err(wrong(lexer, say::formula_then_missing()));
    }
    skip_blanks(lexer)?;
    if lexer.peek().0 != b'#' {
        return Err(wrong(lexer, say::formula_then_missing()));
    }
    Ok(Then::Assign(assignment(lexer)?))
}

fn keyword(lexer: &mut Lexer<'_>, name: &'static str) -> Result<(), BlockError> {
    skip_blanks(lexer)?;
    let at = lexer.at;
    if names(&letters(lexer), name) {
        return Ok(());
    }
    lexer.at = at;
    Err(wrong(lexer, say::formula_keyword_missing(name)))
}

fn loop_number(lexer: &mut Lexer<'_>) -> Result<u8, BlockError> {
    skip_blanks(lexer)?;
    let at = lexer.at;
    let digit = lexer.digit();
    match (digit, lexer.digit()) {
        (Some(number @ 1..=3), None) => Ok(number),
        _ => {
            let rule = say::loop_number_wrong();
            Err(BlockError::at(number::LOOP_NUMBER, at, rule))
        }
    }
}
