//! Parses the statements of macro B.

use gsk_messages::say;

use super::super::lexer::{Lexer, skip_blanks};
use super::super::syntax::BlockError;
use super::expression::{self, FormulaCode, formula_error, is_name, read_letters};
use crate::alarm::number;

/// The macro B statement of a block, or the formulas of its words.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum MacroStatement {
    /// `#i=formula`: stores a value in a variable.
    Assign(MacroAssignment),
    /// `GOTO n`: jumps to the block with the sequence number that the formula yields.
    Goto(FormulaCode),
    /// `IF [condition] GOTO n` or `IF [condition] THEN #i=formula`.
    If(MacroCondition, IfAction),
    /// `WHILE [condition] DO m` with the loop number m; `DO m` (`None`) repeats forever.
    Do(Option<MacroCondition>, u8),
    /// `END m`: ends the loop with the number m.
    End(u8),
    /// `G65 P`: calls a macro program once.
    Call(MacroCall),
    /// `G66 P`: calls a macro program after each following block with a movement.
    ModalCall(MacroCall),
    /// `G67`: cancels the modal call of `G66`.
    CancelModalCall,
    /// The formulas of ordinary words. A word with a formula stores its index in this list.
    Words(Vec<FormulaCode>),
}

/// An assignment `#i=formula` of macro B.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MacroAssignment {
    /// The formula that yields the number of the variable.
    pub(crate) variable: FormulaCode,
    pub(crate) value: FormulaCode,
    /// The comment after the assignment; it is the text of an alarm if `#3000` is set.
    pub(crate) comment: String,
}

/// The action of an `IF` if its condition is met.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum IfAction {
    Goto(FormulaCode),
    Assign(MacroAssignment),
}

/// A comparison in macro B, such as `[a EQ b]`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MacroCondition {
    pub(crate) left: FormulaCode,
    pub(crate) relation: MacroRelation,
    pub(crate) right: FormulaCode,
}

/// The relation by which a condition compares its two values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MacroRelation {
    Equal,
    NotEqual,
    Greater,
    GreaterOrEqual,
    Less,
    LessOrEqual,
}

/// The words of a macro call: program, number of runs, and the arguments as address letter and
/// value in the order of the text.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MacroCall {
    pub(crate) program: Option<FormulaCode>,
    pub(crate) runs: Option<FormulaCode>,
    pub(crate) arguments: Vec<(u8, FormulaCode)>,
}

const RELATIONS: [(&str, MacroRelation); 6] = [
    ("EQ", MacroRelation::Equal),
    ("NE", MacroRelation::NotEqual),
    ("GT", MacroRelation::Greater),
    ("GE", MacroRelation::GreaterOrEqual),
    ("LT", MacroRelation::Less),
    ("LE", MacroRelation::LessOrEqual),
];

/// Whether a macro statement begins at the position: a `#`, or two consecutive letters.
pub(in crate::program) fn is_statement_start(lexer: &Lexer<'_>) -> bool {
    let (byte, len) = lexer.peek();
    let next = lexer.moved_to(lexer.at + len).peek().0;
    byte == b'#' || byte.is_ascii_alphabetic() && next.is_ascii_alphabetic()
}

impl MacroStatement {
    /// Reads the statement at the position of the lexer.
    ///
    /// # Errors
    /// 114 for an invalid statement, 118 for brackets that are nested too deep, 126 for an
    /// invalid loop number.
    pub(in crate::program) fn read(lexer: &mut Lexer<'_>) -> Result<Self, BlockError> {
        if lexer.peek().0 == b'#' {
            return Ok(Self::Assign(read_assignment(lexer)?));
        }
        let at = lexer.at;
        let word = read_letters(lexer);
        if is_name(&word, "GOTO") {
            return Ok(Self::Goto(FormulaCode::read_value(lexer)?));
        }
        if is_name(&word, "IF") {
            let condition = read_condition(lexer)?;
            return Ok(Self::If(condition, read_if_action(lexer)?));
        }
        if is_name(&word, "WHILE") {
            let condition = read_condition(lexer)?;
            expect_keyword(lexer, "DO")?;
            return Ok(Self::Do(Some(condition), read_loop_number(lexer)?));
        }
        if is_name(&word, "DO") {
            return Ok(Self::Do(None, read_loop_number(lexer)?));
        }
        if is_name(&word, "END") {
            return Ok(Self::End(read_loop_number(lexer)?));
        }
        lexer.at = at;
        Err(formula_error(lexer, say::formula_name_unknown(word)))
    }
}

/// Reads the words of a macro call after its G or M code.
///
/// # Errors
/// 114 for an invalid word, 129 for an address that cannot be an argument.
pub(in crate::program) fn read_arguments(lexer: &mut Lexer<'_>) -> Result<MacroCall, BlockError> {
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
            _ => return Err(formula_error(lexer, say::formula_address_missing())),
        }
        let value = FormulaCode::read_value(lexer)?;
        match address {
            b'P' => call.program = Some(value),
            b'L' => call.runs = Some(value),
            _ => call.arguments.push((address, value)),
        }
    }
}

fn read_assignment(lexer: &mut Lexer<'_>) -> Result<MacroAssignment, BlockError> {
    let variable = FormulaCode::read_variable(lexer)?;
    skip_blanks(lexer)?;
    let (byte, len) = lexer.peek();
    if byte != b'=' {
        return Err(formula_error(lexer, say::formula_equals_missing()));
    }
    lexer.at += len;
    let begin = *lexer;
    let value = FormulaCode::read(lexer)?;
    Ok(MacroAssignment {
        variable,
        value,
        comment: last_comment(begin, lexer.at),
    })
}

/// The text of the last comment before the byte position `end`; empty without one.
fn last_comment(mut lexer: Lexer<'_>, end: usize) -> String {
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

fn read_condition(lexer: &mut Lexer<'_>) -> Result<MacroCondition, BlockError> {
    expect_mark(lexer, b'[')?;
    let left = FormulaCode::read(lexer)?;
    skip_blanks(lexer)?;
    let Some(relation) = skip_relation(lexer) else {
        return Err(formula_error(lexer, say::formula_relation_missing()));
    };
    let right = FormulaCode::read(lexer)?;
    expect_mark(lexer, b']')?;
    Ok(MacroCondition {
        left,
        relation,
        right,
    })
}

/// Skips the relation at the position and returns it; `None`, without moving, if the text
/// begins with none.
pub(super) fn skip_relation(lexer: &mut Lexer<'_>) -> Option<MacroRelation> {
    expression::skip_keyword(lexer, &RELATIONS)
}

fn expect_mark(lexer: &mut Lexer<'_>, wanted: u8) -> Result<(), BlockError> {
    skip_blanks(lexer)?;
    let (byte, len) = lexer.peek();
    if byte != wanted {
        let rule = match wanted {
            b'[' => say::formula_bracket_missing(),
            _ => say::formula_bracket_open(),
        };
        return Err(formula_error(lexer, rule));
    }
    lexer.at += len;
    Ok(())
}

fn read_if_action(lexer: &mut Lexer<'_>) -> Result<IfAction, BlockError> {
    skip_blanks(lexer)?;
    let at = lexer.at;
    let word = read_letters(lexer);
    if is_name(&word, "GOTO") {
        return Ok(IfAction::Goto(FormulaCode::read_value(lexer)?));
    }
    if !is_name(&word, "THEN") {
        lexer.at = at;
        return Err(formula_error(lexer, say::formula_then_missing()));
    }
    skip_blanks(lexer)?;
    if lexer.peek().0 != b'#' {
        return Err(formula_error(lexer, say::formula_then_missing()));
    }
    Ok(IfAction::Assign(read_assignment(lexer)?))
}

fn expect_keyword(lexer: &mut Lexer<'_>, name: &'static str) -> Result<(), BlockError> {
    skip_blanks(lexer)?;
    let at = lexer.at;
    if is_name(&read_letters(lexer), name) {
        return Ok(());
    }
    lexer.at = at;
    Err(formula_error(lexer, say::formula_keyword_missing(name)))
}

fn read_loop_number(lexer: &mut Lexer<'_>) -> Result<u8, BlockError> {
    skip_blanks(lexer)?;
    let at = lexer.at;
    let digit = lexer.read_digit();
    match (digit, lexer.read_digit()) {
        (Some(number @ 1..=3), None) => Ok(number),
        _ => {
            let rule = say::loop_number_wrong();
            Err(BlockError::at(number::LOOP_NUMBER, at, rule))
        }
    }
}
