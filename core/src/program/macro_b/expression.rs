//! Formulas: text to postfix code.
//!
//! ```text
//!   #1+#2*SIN[30]      1 var  2 var  30 sin  *  +
//! ```
//!
//! Priority, highest first: functions and signs; `*` `/` `AND` `MOD`; `+` `-` `OR` `XOR`.

use gsk_messages::say;

use super::super::lexer::{Lexer, skip_blanks};
use super::super::syntax::BlockError;
use crate::alarm::number;

/// Brackets that may stand in each other, those of functions among them.
const DEPTH: u8 = 5;

/// One step of a formula, on a stack of values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Step {
    /// A number as it is written.
    Number(f64),
    /// The variable whose number is on the stack.
    Variable,
    /// The other sign.
    Negate,
    /// Two values to one.
    Operator(Operator),
    /// One value to one.
    Function(Function),
    /// `ATAN[y]/[x]`.
    ArcTangent,
}

/// What stands between two values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Operator {
    Add,
    Subtract,
    Multiply,
    Divide,
    Modulo,
    And,
    Or,
    Xor,
}

/// What stands before a bracket.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Function {
    Sine,
    Cosine,
    Tangent,
    ArcSine,
    ArcCosine,
    Root,
    Absolute,
    Round,
    /// Toward zero.
    Fix,
    /// Away from zero.
    Up,
    Logarithm,
    Exponential,
    /// Decimal code to binary.
    Binary,
    /// Binary to decimal code.
    DecimalCode,
}

/// Functions by their names; the first two letters are enough.
const FUNCTIONS: [(&str, Function); 14] = [
    ("SIN", Function::Sine),
    ("COS", Function::Cosine),
    ("TAN", Function::Tangent),
    ("ASIN", Function::ArcSine),
    ("ACOS", Function::ArcCosine),
    ("SQRT", Function::Root),
    ("ABS", Function::Absolute),
    ("ROUND", Function::Round),
    ("FIX", Function::Fix),
    ("FUP", Function::Up),
    ("LN", Function::Logarithm),
    ("EXP", Function::Exponential),
    ("BIN", Function::Binary),
    ("BCD", Function::DecimalCode),
];

/// Steps of a formula; a line of the control holds far fewer.
const MOST_STEPS: usize = 1000;

/// A formula.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Expression(Vec<Step>);

impl Expression {
    /// What is to be done, in order.
    pub(crate) fn steps(&self) -> &[Step] {
        &self.0
    }

    /// A number alone.
    pub(in crate::program) fn number(value: f64) -> Self {
        Self(vec![Step::Number(value)])
    }

    /// Reads a formula as long as it goes.
    ///
    /// # Errors
    /// 114 for what is none, 118 for brackets too deep.
    pub(super) fn read(lexer: &mut Lexer<'_>) -> Result<Self, BlockError> {
        let mut reader = Reader::new(lexer);
        reader.sum()?;
        Ok(Self(reader.steps))
    }

    /// Reads the value of a word or of a macro call: a number, a variable or a formula in
    /// brackets, with its sign.
    ///
    /// # Errors
    /// As for [`Self::read`].
    pub(super) fn value(lexer: &mut Lexer<'_>) -> Result<Self, BlockError> {
        let mut reader = Reader::new(lexer);
        reader.signed(Reader::operand)?;
        Ok(Self(reader.steps))
    }

    /// Reads `#i` or `#[formula]`: the number of the variable.
    ///
    /// # Errors
    /// As for [`Self::read`].
    pub(super) fn variable(lexer: &mut Lexer<'_>) -> Result<Self, BlockError> {
        let mut reader = Reader::new(lexer);
        reader.variable_number()?;
        Ok(Self(reader.steps))
    }
}

/// Reads the `#i`, `#[formula]` or `[formula]` that stands for the number of a word.
pub(in crate::program) fn in_word(lexer: &mut Lexer<'_>) -> Result<Expression, BlockError> {
    let mut reader = Reader::new(lexer);
    reader.operand()?;
    Ok(Expression(reader.steps))
}

/// The number after a `#`, without anything else being read; none for a formula.
pub(in crate::program) fn word_variable(text: &[u8]) -> Option<u32> {
    let digits = text.iter().take_while(|byte| byte.is_ascii_digit()).count();
    let digits = core::str::from_utf8(text.get(..digits)?).ok()?;
    digits.parse().ok()
}

/// Reads letters as one word of the language, in capitals; the lexer stands behind them.
pub(super) fn letters(lexer: &mut Lexer<'_>) -> String {
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

/// Passes the one of these names that stands here.
pub(super) fn keyword<T: Copy>(lexer: &mut Lexer<'_>, of: &[(&str, T)]) -> Option<T> {
    let mut ahead = *lexer;
    let (meant, taken) = leading(&letters(&mut ahead), of)?;
    for _ in 0..taken {
        lexer.at += lexer.peek().1;
    }
    Some(meant)
}

/// Whether letters are a name or its first two letters.
pub(super) fn names(letters: &str, name: &str) -> bool {
    letters == name || (letters.len() == 2 && name.starts_with(letters))
}

/// The first of these names that letters begin with, and how many of them it takes: the
/// whole of it or two letters, before nothing or before a function, as in `ANDABS[#1]`.
fn leading<'n, T: Copy>(letters: &str, of: &'n [(&'n str, T)]) -> Option<(T, usize)> {
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
    names(letters, "ATAN") || FUNCTIONS.iter().any(|(name, _)| names(letters, name))
}

/// A formula that is not one.
#[cold]
pub(super) fn wrong(lexer: &Lexer<'_>, rule: gsk_messages::Message) -> BlockError {
    BlockError::at(number::BAD_OPERATION, lexer.at, rule)
}

struct Reader<'l, 't> {
    lexer: &'l mut Lexer<'t>,
    steps: Vec<Step>,
    depth: u8,
}

type Read = Result<(), BlockError>;

impl<'l, 't> Reader<'l, 't> {
    const fn new(lexer: &'l mut Lexer<'t>) -> Self {
        Self {
            lexer,
            steps: Vec::new(),
            depth: 0,
        }
    }

    /// The byte that comes next, blanks passed.
    fn next(&mut self) -> Result<u8, BlockError> {
        skip_blanks(self.lexer)?;
        Ok(self.lexer.peek().0)
    }

    /// Passes this byte, if it comes next.
    fn pass(&mut self, wanted: u8) -> Result<bool, BlockError> {
        let here = self.next()? == wanted;
        if here {
            self.lexer.at += self.lexer.peek().1;
        }
        Ok(here)
    }

    /// The operator that comes next, of those in the list.
    fn operator(&mut self, of: &[(&str, Operator)]) -> Result<Option<Operator>, BlockError> {
        let first = self.next()?;
        if !first.is_ascii_alphabetic() {
            let mark = char::from(first).to_string();
            let found = of.iter().find(|(name, _)| *name == mark);
            self.lexer.at += found.map_or(0, |_| self.lexer.peek().1);
            return Ok(found.map(|(_, operator)| *operator));
        }
        Ok(keyword(self.lexer, of))
    }

    fn sum(&mut self) -> Read {
        const OF: [(&str, Operator); 4] = [
            ("+", Operator::Add),
            ("-", Operator::Subtract),
            ("OR", Operator::Or),
            ("XOR", Operator::Xor),
        ];
        self.product()?;
        while let Some(operator) = self.operator(&OF)? {
            self.product()?;
            self.steps.push(Step::Operator(operator));
        }
        Ok(())
    }

    fn product(&mut self) -> Read {
        const OF: [(&str, Operator); 4] = [
            ("*", Operator::Multiply),
            ("/", Operator::Divide),
            ("AND", Operator::And),
            ("MOD", Operator::Modulo),
        ];
        self.signed(Self::operand)?;
        while let Some(operator) = self.operator(&OF)? {
            self.signed(Self::operand)?;
            self.steps.push(Step::Operator(operator));
        }
        Ok(())
    }

    fn signed(&mut self, read: fn(&mut Self) -> Read) -> Read {
        if self.pass(b'-')? {
            read(self)?;
            self.steps.push(Step::Negate);
            return Ok(());
        }
        self.pass(b'+')?;
        read(self)
    }

    /// A number, a variable, a formula in brackets or a function.
    fn operand(&mut self) -> Read {
        if self.steps.len() >= MOST_STEPS {
            return Err(wrong(self.lexer, say::formula_too_long(MOST_STEPS)));
        }
        match self.next()? {
            b'#' => {
                self.variable_number()?;
                self.steps.push(Step::Variable);
                Ok(())
            }
            b'[' => self.bracket(),
            b'0'..=b'9' | b'.' => self.number(),
            byte if byte.is_ascii_alphabetic() => self.function(),
            _ => Err(wrong(self.lexer, say::formula_value_missing())),
        }
    }

    fn bracket(&mut self) -> Read {
        let at = self.lexer.at;
        if !self.pass(b'[')? {
            return Err(wrong(self.lexer, say::formula_bracket_missing()));
        }
        self.depth += 1;
        if self.depth > DEPTH {
            let rule = say::formula_brackets_too_deep(DEPTH);
            return Err(BlockError::at(number::BRACKETS_TOO_DEEP, at, rule));
        }
        self.sum()?;
        if !self.pass(b']')? {
            return Err(wrong(self.lexer, say::formula_bracket_open()));
        }
        self.depth -= 1;
        Ok(())
    }

    fn variable_number(&mut self) -> Read {
        self.pass(b'#')?;
        match self.lexer.peek().0 {
            b'[' => self.bracket(),
            b'0'..=b'9' => self.number(),
            _ => Err(wrong(self.lexer, say::variable_number_missing())),
        }
    }

    fn number(&mut self) -> Read {
        let mut text = String::new();
        let mut point = false;
        loop {
            if let Some(digit) = self.lexer.digit() {
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
                self.steps.push(Step::Number(value));
                Ok(())
            }
            // A point alone.
            Err(_) => Err(wrong(self.lexer, say::formula_value_missing())),
        }
    }

    fn function(&mut self) -> Read {
        let at = self.lexer.at;
        let name = letters(self.lexer);
        if names(&name, "ATAN") {
            self.bracket()?;
            if !self.pass(b'/')? {
                return Err(wrong(self.lexer, say::formula_arc_tangent()));
            }
            self.bracket()?;
            self.steps.push(Step::ArcTangent);
            return Ok(());
        }
        let found = FUNCTIONS.iter().find(|(full, _)| names(&name, full));
        let Some((_, function)) = found else {
            self.lexer.at = at;
            return Err(wrong(self.lexer, say::formula_name_unknown(name)));
        };
        self.bracket()?;
        self.steps.push(Step::Function(*function));
        Ok(())
    }
}
