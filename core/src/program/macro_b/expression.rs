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

/// Greatest nesting of brackets, including those of functions.
const DEPTH: u8 = 5;

/// One step of a formula. It operates on a stack of values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Step {
    /// Pushes a number.
    Number(f64),
    /// Replaces the number on the stack by the value of the variable with that number.
    Variable,
    /// Negates the value on the stack.
    Negate,
    /// Combines two values to one.
    Operator(Operator),
    /// Replaces one value by another.
    Function(Function),
    /// Computes `ATAN[y]/[x]` from two values.
    ArcTangent,
}

/// An operator between two values.
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

/// A function before a bracket.
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
    /// Rounds towards zero.
    Fix,
    /// Rounds away from zero.
    Up,
    Logarithm,
    Exponential,
    /// Converts BCD to binary.
    Binary,
    /// Converts binary to BCD.
    DecimalCode,
}

/// The functions by name. The first two letters are sufficient.
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

/// Greatest number of steps of a formula; a line of the control has far fewer.
const MOST_STEPS: usize = 1000;

/// A formula in postfix code.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Expression(Vec<Step>);

impl Expression {
    /// The steps of the formula, in order.
    pub(crate) fn steps(&self) -> &[Step] {
        &self.0
    }

    /// A formula that consists of a number.
    pub(in crate::program) fn number(value: f64) -> Self {
        Self(vec![Step::Number(value)])
    }

    /// Reads a formula to its end.
    ///
    /// # Errors
    /// 114 for an invalid formula, 118 for brackets that are nested too deep.
    pub(super) fn read(lexer: &mut Lexer<'_>) -> Result<Self, BlockError> {
        let mut reader = Reader::new(lexer);
        reader.sum()?;
        Ok(Self(reader.steps))
    }

    /// Reads the value of a word or of a macro argument: a signed number, variable or
    /// formula in brackets.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub(super) fn value(lexer: &mut Lexer<'_>) -> Result<Self, BlockError> {
        let mut reader = Reader::new(lexer);
        reader.signed(Reader::operand)?;
        Ok(Self(reader.steps))
    }

    /// Reads `#i` or `#[formula]`. The result is the formula of the variable number.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub(super) fn variable(lexer: &mut Lexer<'_>) -> Result<Self, BlockError> {
        let mut reader = Reader::new(lexer);
        reader.variable_number()?;
        Ok(Self(reader.steps))
    }
}

/// Reads the `#i`, `#[formula]` or `[formula]` that a word has instead of a number.
pub(in crate::program) fn in_word(lexer: &mut Lexer<'_>) -> Result<Expression, BlockError> {
    let mut reader = Reader::new(lexer);
    reader.operand()?;
    Ok(Expression(reader.steps))
}

/// The number after a `#`, without moving the lexer; `None` for a formula.
pub(in crate::program) fn word_variable(text: &[u8]) -> Option<u32> {
    let digits = text.iter().take_while(|byte| byte.is_ascii_digit()).count();
    let digits = core::str::from_utf8(text.get(..digits)?).ok()?;
    digits.parse().ok()
}

/// Reads letters as one word of the language, in upper case, and moves past them.
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

/// Skips one of these names and returns its meaning; `None` if the text has none of them.
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

/// The first of these names that letters begin with, and the number of letters it takes: its
/// full length or two. Only a function may follow directly, as in `ANDABS[#1]`.
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

/// The error of an invalid formula.
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

    /// The next byte after blanks.
    fn next(&mut self) -> Result<u8, BlockError> {
        skip_blanks(self.lexer)?;
        Ok(self.lexer.peek().0)
    }

    /// Skips this byte if it is the next one.
    fn pass(&mut self, wanted: u8) -> Result<bool, BlockError> {
        let here = self.next()? == wanted;
        if here {
            self.lexer.at += self.lexer.peek().1;
        }
        Ok(here)
    }

    /// The next operator if it is in the list.
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

    /// Reads a number, a variable, a formula in brackets or a function.
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
            // Only a point.
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
