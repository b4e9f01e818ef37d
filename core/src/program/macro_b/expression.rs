//! Compiles formulas to postfix code.
//!
//! ```text
//!   #1+#2*SIN[30]      1 var  2 var  30 sin  *  +
//! ```
//!
//! Priority, from high to low: functions and signs; `*` `/` `AND` `MOD`; `+` `-` `OR` `XOR`.

use gsk_messages::say;

use super::super::lexer::{Lexer, skip_blanks};
use super::super::syntax::BlockError;
use crate::alarm::number;

/// Greatest number of nested brackets, including those of functions.
const MAX_BRACKET_DEPTH: u8 = 5;

/// One step of a formula in postfix code. It operates on a stack of values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum FormulaStep {
    /// The step pushes this number onto the stack.
    Number(f64),
    /// Replaces the number on top of the stack by the value of the variable with that number.
    Variable,
    /// Negates the value on top of the stack.
    Negate,
    /// Replaces the two upper values of the stack by the result of an operator.
    Operator(FormulaOperator),
    /// Replaces the value on top of the stack by the result of a function.
    Function(FormulaFunction),
    /// Replaces the two upper values y and x of the stack by `ATAN[y]/[x]`.
    ArcTangent,
}

/// An operator between two values of a formula.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FormulaOperator {
    Add,
    Subtract,
    Multiply,
    Divide,
    Modulo,
    And,
    Or,
    Xor,
}

/// A function of a formula, whose argument follows in brackets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FormulaFunction {
    Sine,
    Cosine,
    Tangent,
    ArcSine,
    ArcCosine,
    Root,
    Absolute,
    Round,
    /// `FIX`: rounds towards zero.
    Fix,
    /// `FUP`: rounds away from zero.
    Up,
    Logarithm,
    Exponential,
    /// `BIN`: converts BCD to binary.
    Binary,
    /// `BCD`: converts binary to BCD.
    DecimalCode,
}

/// The functions with their names. The first two letters of a name are sufficient.
const FUNCTIONS: [(&str, FormulaFunction); 14] = [
    ("SIN", FormulaFunction::Sine),
    ("COS", FormulaFunction::Cosine),
    ("TAN", FormulaFunction::Tangent),
    ("ASIN", FormulaFunction::ArcSine),
    ("ACOS", FormulaFunction::ArcCosine),
    ("SQRT", FormulaFunction::Root),
    ("ABS", FormulaFunction::Absolute),
    ("ROUND", FormulaFunction::Round),
    ("FIX", FormulaFunction::Fix),
    ("FUP", FormulaFunction::Up),
    ("LN", FormulaFunction::Logarithm),
    ("EXP", FormulaFunction::Exponential),
    ("BIN", FormulaFunction::Binary),
    ("BCD", FormulaFunction::DecimalCode),
];

/// Greatest number of steps of a formula; a line of the control has far fewer.
const MAX_STEPS: usize = 1000;

/// A formula as a list of steps in postfix order.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct FormulaCode(Vec<FormulaStep>);

impl FormulaCode {
    /// Returns the steps of the formula, in order.
    pub(crate) fn steps(&self) -> &[FormulaStep] {
        &self.0
    }

    /// A formula that consists of a number.
    pub(in crate::program) fn from_number(value: f64) -> Self {
        Self(vec![FormulaStep::Number(value)])
    }

    /// Reads a formula from the position of the lexer up to the first character after it.
    ///
    /// # Errors
    /// 114 for an invalid formula, 118 for brackets that are nested too deep.
    pub(super) fn read(lexer: &mut Lexer<'_>) -> Result<Self, BlockError> {
        let mut reader = FormulaReader::new(lexer);
        reader.read_sum()?;
        Ok(Self(reader.steps))
    }

    /// Reads the value of a word or of a macro argument: a signed number, variable or
    /// formula in brackets.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub(super) fn read_value(lexer: &mut Lexer<'_>) -> Result<Self, BlockError> {
        let mut reader = FormulaReader::new(lexer);
        reader.read_signed(FormulaReader::read_operand)?;
        Ok(Self(reader.steps))
    }

    /// Reads `#i` or `#[formula]`. The result is the formula of the variable number.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub(super) fn read_variable(lexer: &mut Lexer<'_>) -> Result<Self, BlockError> {
        let mut reader = FormulaReader::new(lexer);
        reader.read_variable_number()?;
        Ok(Self(reader.steps))
    }
}

/// Reads the `#i`, `#[formula]` or `[formula]` that a word has instead of a number. Returns the
/// first fault of its syntax as error.
pub(in crate::program) fn read_word_formula(
    lexer: &mut Lexer<'_>,
) -> Result<FormulaCode, BlockError> {
    let mut reader = FormulaReader::new(lexer);
    reader.read_operand()?;
    Ok(FormulaCode(reader.steps))
}

/// The variable number in the digits at the start of `text`, which follows a `#`; `None`
/// without digits, as in `#[formula]`.
pub(in crate::program) fn parse_variable_number(text: &[u8]) -> Option<u32> {
    let digits = text.iter().take_while(|byte| byte.is_ascii_digit()).count();
    let digits = core::str::from_utf8(text.get(..digits)?).ok()?;
    digits.parse().ok()
}

/// Reads consecutive ASCII letters, in upper case, and moves the lexer after them.
pub(super) fn read_letters(lexer: &mut Lexer<'_>) -> String {
    let mut letters = String::new();
    while let (byte, len @ 1..) = lexer.peek() {
        if !byte.is_ascii_alphabetic() {
            break;
        }
        letters.push(byte.to_ascii_uppercase().into());
        lexer.at += len;
    }
    letters
}

/// Skips the keyword at the position and returns its value from the list `of`; `None`, without
/// moving, if the text begins with none of them.
pub(super) fn skip_keyword<T: Copy>(lexer: &mut Lexer<'_>, of: &[(&str, T)]) -> Option<T> {
    let mut ahead = *lexer;
    let (meant, taken) = find_leading_name(&read_letters(&mut ahead), of)?;
    for _ in 0..taken {
        lexer.at += lexer.peek().1;
    }
    Some(meant)
}

/// Whether `letters` are the keyword `name` or its first two letters.
pub(super) fn is_name(letters: &str, name: &str) -> bool {
    letters == name || (letters.len() == 2 && name.starts_with(letters))
}

/// The value of the first keyword of `of` with which `letters` begin, and the number of its
/// letters: all or two. Only a function may follow directly, as in `ANDABS[#1]`. `None` if no
/// keyword matches.
fn find_leading_name<'n, T: Copy>(letters: &str, of: &'n [(&'n str, T)]) -> Option<(T, usize)> {
    let fits = |name: &str, taken: usize| {
        let (head, rest) = letters.split_at_checked(taken)?;
        (name.get(..taken) == Some(head) && (rest.is_empty() || is_function(rest))).then_some(taken)
    };
    of.iter().find_map(|(name, meant)| {
        let taken = fits(name, name.len()).or_else(|| fits(name, 2))?;
        Some((*meant, taken))
    })
}

fn is_function(letters: &str) -> bool {
    is_name(letters, "ATAN") || FUNCTIONS.iter().any(|(name, _)| is_name(letters, name))
}

/// Alarm 114 of an invalid formula, at the position of the lexer; `rule` is the violated rule.
#[cold]
pub(super) fn formula_error(lexer: &Lexer<'_>, rule: gsk_messages::Message) -> BlockError {
    BlockError::at(number::BAD_OPERATION, lexer.at, rule)
}

struct FormulaReader<'l, 't> {
    lexer: &'l mut Lexer<'t>,
    steps: Vec<FormulaStep>,
    depth: u8,
}

type ReadResult = Result<(), BlockError>;

impl<'l, 't> FormulaReader<'l, 't> {
    const fn new(lexer: &'l mut Lexer<'t>) -> Self {
        Self {
            lexer,
            steps: Vec::new(),
            depth: 0,
        }
    }

    /// Skips blanks and returns the next byte without skipping it; an error for a comment without
    /// its end.
    fn peek_byte(&mut self) -> Result<u8, BlockError> {
        skip_blanks(self.lexer)?;
        Ok(self.lexer.peek().0)
    }

    /// Skips the byte `wanted` if it is the next one after blanks; returns whether it was. An error
    /// for a comment without its end.
    fn skip_byte(&mut self, wanted: u8) -> Result<bool, BlockError> {
        let here = self.peek_byte()? == wanted;
        if here {
            self.lexer.at += self.lexer.peek().1;
        }
        Ok(here)
    }

    /// Reads the next operator if it is in the list `of`; otherwise returns `None`. An error for a
    /// comment without its end.
    fn read_operator(
        &mut self,
        of: &[(&str, FormulaOperator)],
    ) -> Result<Option<FormulaOperator>, BlockError> {
        let first = self.peek_byte()?;
        if !first.is_ascii_alphabetic() {
            let mark = char::from(first).to_string();
            let found = of.iter().find(|(name, _)| *name == mark);
            self.lexer.at += found.map_or(0, |_| self.lexer.peek().1);
            return Ok(found.map(|(_, operator)| *operator));
        }
        Ok(skip_keyword(self.lexer, of))
    }

    fn read_sum(&mut self) -> ReadResult {
        const OF: [(&str, FormulaOperator); 4] = [
            ("+", FormulaOperator::Add),
            ("-", FormulaOperator::Subtract),
            ("OR", FormulaOperator::Or),
            ("XOR", FormulaOperator::Xor),
        ];
        self.read_product()?;
        while let Some(operator) = self.read_operator(&OF)? {
            self.read_product()?;
            self.steps.push(FormulaStep::Operator(operator));
        }
        Ok(())
    }

    fn read_product(&mut self) -> ReadResult {
        const OF: [(&str, FormulaOperator); 4] = [
            ("*", FormulaOperator::Multiply),
            ("/", FormulaOperator::Divide),
            ("AND", FormulaOperator::And),
            ("MOD", FormulaOperator::Modulo),
        ];
        self.read_signed(Self::read_operand)?;
        while let Some(operator) = self.read_operator(&OF)? {
            self.read_signed(Self::read_operand)?;
            self.steps.push(FormulaStep::Operator(operator));
        }
        Ok(())
    }

    fn read_signed(&mut self, read: fn(&mut Self) -> ReadResult) -> ReadResult {
        if self.skip_byte(b'-')? {
            read(self)?;
            self.steps.push(FormulaStep::Negate);
            return Ok(());
        }
        self.skip_byte(b'+')?;
        read(self)
    }

    /// Reads a number, a variable, a formula in brackets or a function call.
    fn read_operand(&mut self) -> ReadResult {
        if self.steps.len() >= MAX_STEPS {
            return Err(formula_error(self.lexer, say::formula_too_long(MAX_STEPS)));
        }
        match self.peek_byte()? {
            b'#' => {
                self.read_variable_number()?;
                self.steps.push(FormulaStep::Variable);
                Ok(())
            }
            b'[' => self.read_bracket(),
            b'0'..=b'9' | b'.' => self.read_number(),
            byte if byte.is_ascii_alphabetic() => self.read_function(),
            _ => Err(formula_error(self.lexer, say::formula_value_missing())),
        }
    }

    fn read_bracket(&mut self) -> ReadResult {
        let at = self.lexer.at;
        if !self.skip_byte(b'[')? {
            return Err(formula_error(self.lexer, say::formula_bracket_missing()));
        }
        self.depth += 1;
        if self.depth > MAX_BRACKET_DEPTH {
            let rule = say::formula_brackets_too_deep(MAX_BRACKET_DEPTH);
            return Err(BlockError::at(number::BRACKETS_TOO_DEEP, at, rule));
        }
        self.read_sum()?;
        if !self.skip_byte(b']')? {
            return Err(formula_error(self.lexer, say::formula_bracket_open()));
        }
        self.depth -= 1;
        Ok(())
    }

    fn read_variable_number(&mut self) -> ReadResult {
        self.skip_byte(b'#')?;
        match self.lexer.peek().0 {
            b'[' => self.read_bracket(),
            b'0'..=b'9' => self.read_number(),
            _ => Err(formula_error(self.lexer, say::variable_number_missing())),
        }
    }

    fn read_number(&mut self) -> ReadResult {
        let mut text = String::new();
        let mut point = false;
        loop {
            if let Some(digit) = self.lexer.read_digit() {
                text.push(char::from(b'0' + digit));
                continue;
            }
            let (byte, len) = self.lexer.peek();
            if byte != b'.' {
                break;
            }
            if point {
                let rule = say::point_twice();
                return Err(BlockError::at(number::BAD_POINT, self.lexer.at, rule));
            }
            point = true;
            text.push('.');
            self.lexer.at += len;
        }
        match text.parse() {
            Ok(value) => {
                self.steps.push(FormulaStep::Number(value));
                Ok(())
            }
            // Only a point.
            Err(_) => Err(formula_error(self.lexer, say::formula_value_missing())),
        }
    }

    fn read_function(&mut self) -> ReadResult {
        let at = self.lexer.at;
        let name = read_letters(self.lexer);
        if is_name(&name, "ATAN") {
            self.read_bracket()?;
            if !self.skip_byte(b'/')? {
                return Err(formula_error(self.lexer, say::formula_arc_tangent()));
            }
            self.read_bracket()?;
            self.steps.push(FormulaStep::ArcTangent);
            return Ok(());
        }
        let found = FUNCTIONS.iter().find(|(full, _)| is_name(&name, full));
        let Some((_, function)) = found else {
            self.lexer.at = at;
            return Err(formula_error(self.lexer, say::formula_name_unknown(name)));
        };
        self.read_bracket()?;
        self.steps.push(FormulaStep::Function(*function));
        Ok(())
    }
}
