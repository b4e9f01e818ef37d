//! A block: the words of one command unit, in a fixed place without heap.

use core::fmt;

use gsk_messages::say;
use serde::{Deserialize, Serialize};

use super::macro_b::{Expression, Statement};
use super::number::{Number, Variable, is_length};
use super::syntax::{BlockError, Syntax};
use crate::alarm;
use crate::model::Record;

/// Words a block can hold besides N and O; more raise alarm 012.
pub(crate) const MAX_WORDS: usize = 24;

/// One word: address letter and number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Word {
    /// Upper-case letter, e.g. `b'X'`.
    pub address: u8,
    /// Its number.
    pub value: Number,
    /// Byte range in the text of the block.
    pub span: (u16, u16),
}

impl Word {
    pub(super) const EMPTY: Self = Self {
        address: 0,
        value: Number::ZERO,
        span: (0, 0),
    };
}

/// The words of one block in the order of the text.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(into = "Plain", try_from = "Plain")]
pub struct Block {
    /// Sequence number N.
    pub n: Option<u32>,
    /// Program name O.
    pub o: Option<u16>,
    /// Whether `/` stands before it.
    pub skip: bool,
    /// Line of the file it stands in, from 1; 0 without a file.
    pub line: u32,
    /// What it says in macro B; none in a block of words and numbers.
    pub(super) statement: Option<Box<Statement>>,
    variables: bool,
    len: u8,
    addresses: u32,
    codes: u128,
    words: [Word; MAX_WORDS],
}

/// The same for storage.
#[derive(Serialize, Deserialize)]
struct Plain {
    n: Option<u32>,
    o: Option<u16>,
    skip: bool,
    line: u32,
    words: Vec<Word>,
}

impl Default for Block {
    fn default() -> Self {
        Self {
            n: None,
            o: None,
            skip: false,
            line: 0,
            statement: None,
            variables: false,
            len: 0,
            addresses: 0,
            codes: 0,
            words: [Word::EMPTY; MAX_WORDS],
        }
    }
}

const fn address_bit(address: u8) -> u32 {
    if address.is_ascii_uppercase() {
        1 << (address - b'A')
    } else {
        0
    }
}

#[inline]
const fn bits(addresses: &[u8]) -> u32 {
    let (mut bits, mut at) = (0, 0);
    while at < addresses.len() {
        bits |= address_bit(addresses[at]);
        at += 1;
    }
    bits
}

impl Block {
    /// Empties it. What is left in the places of words is none of them.
    pub(super) fn clear(&mut self) {
        self.statement = None;
        (self.n, self.o, self.skip, self.line) = (None, None, false, 0);
        self.variables = false;
        (self.len, self.addresses, self.codes) = (0, 0, 0);
    }

    /// The number of the first variable that stands for the number of a word.
    pub(crate) fn first_variable(&self) -> Option<u16> {
        let variable = |word: &Word| word.value.variable();
        let found = self.words().iter().find_map(variable);
        found.map(|variable| variable.number)
    }

    /// The words in order, without N and O.
    pub fn words(&self) -> &[Word] {
        &self.words[..usize::from(self.len)]
    }

    /// Whether nothing stands in it besides N: it repeats a cycle of group 01.
    pub const fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Whether nothing but the name of a program stands in it.
    pub(crate) fn is_name(&self) -> bool {
        self.is_empty() && self.o.is_some() && self.statement.is_none()
    }

    /// The statement of macro B that it is.
    pub(crate) fn macro_statement(&self) -> Option<&Statement> {
        let statement = self.statement.as_deref();
        statement.filter(|it| !matches!(it, Statement::Words(_)))
    }

    /// The formulas of its words.
    pub(crate) fn formulas(&self) -> Option<&[Expression]> {
        match self.statement.as_deref() {
            Some(Statement::Words(formulas)) => Some(formulas),
            _ => None,
        }
    }

    /// Whether an address occurs.
    pub const fn has(&self, address: u8) -> bool {
        self.addresses & address_bit(address) != 0
    }

    /// Whether any of these addresses occurs.
    pub(crate) const fn has_any(&self, addresses: &[u8]) -> bool {
        self.addresses & bits(addresses) != 0
    }

    /// Whether no other address occurs, and nothing of macro B.
    pub const fn has_only(&self, addresses: &[u8]) -> bool {
        self.addresses & !bits(addresses) == 0 && self.statement.is_none()
    }

    /// The word of an address; of several G the first.
    pub fn word(&self, address: u8) -> Option<&Word> {
        if !self.has(address) {
            return None;
        }
        self.words().iter().find(|word| word.address == address)
    }

    /// The number of an address.
    pub fn number(&self, address: u8) -> Option<Number> {
        self.word(address).map(|word| word.value)
    }

    /// Whether a G code occurs.
    pub(crate) const fn has_g(&self, code: u8) -> bool {
        code < 100 && self.codes & (1 << code) != 0
    }

    /// Whether two different G codes occur.
    pub(crate) const fn has_two_codes(&self) -> bool {
        self.codes.count_ones() > 1
    }

    /// The G codes in order.
    pub fn g_codes(&self) -> impl Iterator<Item = u8> {
        let words = if self.has(b'G') { self.words() } else { &[] };
        words
            .iter()
            .filter(|word| word.address == b'G' && word.value.variable().is_none())
            .map(|word| word.value.integer() as u8)
    }

    /// Whether a number is still a reference to a variable.
    pub(crate) const fn has_variables(&self) -> bool {
        self.variables
    }

    /// Puts the values of variables in the place of their references and checks
    /// the ranges again. A value counts as 0.001 mm (0.0001 inch) on X Z U W R I J
    /// K, as 0.001 s on X U of G04, and as the number itself elsewhere. The words of G65 stay as they are: the macro
    /// operations read variables themselves.
    ///
    /// # Errors
    /// The alarm of `lookup`, or 043 for a value beyond the range of its address.
    pub fn resolve<E: From<BlockError>>(
        mut self,
        syntax: Syntax,
        mut lookup: impl FnMut(Variable) -> Result<i64, E>,
    ) -> Result<Self, E> {
        if !self.has_variables() || self.has_g(65) {
            return Ok(self);
        }
        let dwell = self.has_g(4);
        for word in &mut self.words[..usize::from(self.len)] {
            let Some(variable) = word.value.variable() else {
                continue;
            };
            let value = lookup(variable)?;
            let value = if variable.negative {
                value.saturating_neg()
            } else {
                value
            };
            word.value = if is_length(word.address) {
                let seconds = dwell && matches!(word.address, b'X' | b'U');
                let increment = if seconds { 1000 } else { syntax.increment() };
                Number::from_millionths(value.saturating_mul(increment))
            } else {
                Number::from_integer(value, 0)
            };
        }
        self.index(syntax)?;
        Ok(self)
    }

    /// Puts numbers in the place of formulas, in their order: lengths in millionths of
    /// their unit, everything else a number of its own. A word whose formula gives
    /// nothing is left out.
    ///
    /// # Errors
    /// 043 for a value beyond the range of its address.
    pub(crate) fn with_values(
        &self,
        values: &[Option<f64>],
        syntax: Syntax,
    ) -> Result<Self, BlockError> {
        let mut block = Self {
            n: self.n,
            o: self.o,
            skip: self.skip,
            line: self.line,
            ..Self::default()
        };
        let dwell = self.has_g(4);
        for word in self.words() {
            let mut word = *word;
            if let Some(formula) = word.value.variable() {
                let value = values.get(usize::from(formula.number)).copied().flatten();
                let Some(value) = value else { continue };
                let value = if formula.negative { -value } else { value };
                let seconds = dwell && matches!(word.address, b'X' | b'U');
                let increment = if seconds { 1000 } else { syntax.increment() };
                let length = syntax.is_length(word.address).then_some(increment);
                word.value = Number::from_value(value, word.address, length);
            }
            block.push(word);
        }
        check_values(&block, syntax)?;
        Ok(block)
    }

    /// Changes the numbers of words; their ranges are not checked again.
    pub(crate) fn change(&mut self, mut change: impl FnMut(u8, Number) -> Number) {
        for word in &mut self.words[..usize::from(self.len)] {
            word.value = change(word.address, word.value);
        }
    }

    /// Adds a word; `false` when the block is full.
    pub(super) const fn push(&mut self, word: Word) -> bool {
        let len = self.len as usize;
        if len >= MAX_WORDS {
            return false;
        }
        self.words[len] = word;
        self.len += 1;
        self.addresses |= address_bit(word.address);
        if word.value.variable().is_some() {
            self.variables = true;
        } else if word.address == b'G' {
            let code = word.value.integer();
            if code >= 0 && code < 100 {
                self.codes |= 1 << code;
            }
        }
        true
    }

    /// Rebuilds what depends on the words and checks their values.
    fn index(&mut self, syntax: Syntax) -> Result<(), BlockError> {
        let words = self.words;
        let len = usize::from(self.len);
        (self.len, self.addresses, self.codes, self.variables) = (0, 0, 0, false);
        for word in &words[..len] {
            self.push(*word);
        }
        check_values(self, syntax)
    }
}

impl PartialEq for Block {
    fn eq(&self, other: &Self) -> bool {
        let head = |block: &Self| (block.n, block.o, block.skip, block.line);
        head(self) == head(other) && self.words() == other.words()
    }
}

/// One line of text that reads back as the same block.
impl fmt::Display for Block {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.skip {
            f.write_str("/")?;
        }
        if let Some(o) = self.o {
            write!(f, "O{o:04} ")?;
        }
        if let Some(n) = self.n {
            write!(f, "N{n:04} ")?;
        }
        for (index, word) in self.words().iter().enumerate() {
            let gap = if index == 0 { "" } else { " " };
            write!(f, "{gap}{}{}", char::from(word.address), word.value)?;
        }
        f.write_str(";")
    }
}

impl From<Block> for Plain {
    fn from(block: Block) -> Self {
        Self {
            n: block.n,
            o: block.o,
            skip: block.skip,
            line: block.line,
            words: block.words().to_vec(),
        }
    }
}

impl TryFrom<Plain> for Block {
    type Error = BlockError;

    fn try_from(plain: Plain) -> Result<Self, BlockError> {
        let Plain {
            n,
            o,
            skip,
            line,
            words,
        } = plain;
        let mut block = Self {
            n,
            o,
            skip,
            line,
            ..Self::default()
        };
        if !words.iter().all(|word| block.push(*word)) {
            return Err(BlockError::too_many_words());
        }
        check_values(&block, Syntax::default())?;
        Ok(block)
    }
}

/// Checks every number of a block against table 2-1; references to variables are
/// left out.
pub(super) fn check_values(block: &Block, syntax: Syntax) -> Result<(), BlockError> {
    if syntax.model.is_mill() {
        return check_mill(block);
    }
    let all_usual = !narrows_words(syntax)
        && block.words().iter().all(|word| {
            let (low, high) = usual_range(word.address);
            word.value.variable().is_none() && (low..=high).contains(&word.value.millionths())
        });
    match all_usual {
        true => Ok(()),
        false => check_each(block, syntax),
    }
}

/// Whether the model has ranges of words of its own.
pub(super) fn narrows_words(syntax: Syntax) -> bool {
    !syntax.model.is_main() && !syntax.model.record().word_limits.is_empty()
}

/// The same of a mill.
fn check_mill(block: &Block) -> Result<(), BlockError> {
    for word in block.words() {
        let (low, high) = match word.address {
            b'D' | b'H' => (0, 400 * ONE),
            b'G' => (0, 999 * ONE),
            b'L' | b'M' | b'T' => (0, 9999 * ONE),
            b'S' => (0, 99_999 * ONE),
            b'F' | b'P' => usual_range(word.address),
            // Scales of G51 in 0.00001.
            b'I' | b'J' | b'K' if block.has_g(51) => (-999_999 * ONE, 999_999 * ONE),
            _ => (-MILL_LENGTH, MILL_LENGTH),
        };
        if !(low..=high).contains(&word.value.millionths()) && word.value.variable().is_none() {
            return Err(out_of_range(word, low, high));
        }
    }
    Ok(())
}

/// The same, each word against what its block allows.
fn check_each(block: &Block, syntax: Syntax) -> Result<(), BlockError> {
    let g65 = block.has_g(65);
    let record = syntax.model.record();
    let greatest = record.greatest_coordinate * (ONE / 1000);
    for word in block.words() {
        if word.value.variable().is_some() {
            continue;
        }
        let (mut low, mut high) = range(block, word, g65, record);
        let signed_d = word.address == b'D' && low < 0;
        if greatest > LENGTH && (signed_d || COORDINATES.contains(&word.address)) {
            (low, high) = (low.min(-greatest), high.max(greatest));
        }
        let value = word.value.millionths();
        if value < low || value > high {
            return Err(out_of_range(word, low, high));
        }
    }
    Ok(())
}

/// Whether words of a model begin with a letter.
pub(super) fn is_address_of(letter: u8, record: &Record) -> bool {
    is_address(letter) || record.has_address(letter)
}

/// Table 2-1, with J and L, which the thread codes use.
const fn is_address(letter: u8) -> bool {
    matches!(letter, b'F'..=b'U' | b'W' | b'X' | b'Z')
}

/// Addresses whose values are as great as the coordinates of the model.
const COORDINATES: &[u8] = b"XZUWIJKR";

const ONE: i64 = 1_000_000;
/// Largest length, ±9999.999 mm.
const LENGTH: i64 = 9_999_999_000;
/// The same of a mill, ±99999.999 mm; its angles and scales are within it, too.
const MILL_LENGTH: i64 = 99_999_999_000;
/// Largest dwell, 99999.999 s; a negative one is told when its block is carried out.
const DWELL: i64 = 99_999_999_000;
/// What a macro operation can hold, ±2³².
const MACRO: i64 = (1 << 32) * ONE;

/// Lowest and highest value of the words A to Z in most blocks, in millionths.
const USUAL: [(i64, i64); 26] = {
    let mut usual = [(-LENGTH, LENGTH); 26];
    let mut letter = 0;
    while letter < usual.len() {
        match b'A' + letter as u8 {
            b'F' | b'D' => usual[letter] = (0, 9_999_999 * ONE),
            b'G' | b'M' | b'H' => usual[letter] = (0, 99 * ONE),
            b'L' => usual[letter] = (ONE, 99 * ONE),
            b'N' | b'S' | b'T' => usual[letter] = (0, 9999 * ONE),
            b'P' => usual[letter] = (-99_999_999 * ONE, 99_999_999 * ONE),
            b'Q' => usual[letter] = (-9_999_999 * ONE, 9_999_999 * ONE),
            _ => {}
        }
        letter += 1;
    }
    usual
};

fn usual_range(address: u8) -> (i64, i64) {
    let letter = usize::from(address.wrapping_sub(b'A'));
    USUAL.get(letter).copied().unwrap_or((-LENGTH, LENGTH))
}

/// Lowest and highest number of a word in most blocks (manual table 2-1), as they are
/// written; some codes take less or more.
pub fn limits(address: u8) -> (String, String) {
    let (low, high) = usual_range(address);
    (limit(low), limit(high))
}

/// A limit as it is written.
fn limit(millionths: i64) -> String {
    let text = Number::from_millionths(millionths).to_string();
    text.trim_end_matches('.').to_string()
}

/// Lowest and highest value of a word in its block, in millionths: the usual ones, or
/// farther apart.
fn range(block: &Block, word: &Word, g65: bool, record: &Record) -> (i64, i64) {
    let of_model = |address| {
        let limits = record.word_limits.get(&char::from(address));
        limits.map_or_else(|| usual_range(address), |it| (it.0 * ONE, it.1 * ONE))
    };
    match word.address {
        b'H' | b'P' | b'Q' | b'R' if g65 => (-MACRO, MACRO),
        b'X' | b'U' if block.has_g(4) => (-DWELL, DWELL),
        // G76 R(d): an integer counts in 0.001 mm.
        b'R' if block.has_g(76) && !word.value.has_point() => (-9_999_999 * ONE, 9_999_999 * ONE),
        // Vector of an arc, or threads per inch.
        b'I' => (-LENGTH, 25_400 * ONE),
        // After a G code it names a block, a subprogram or a count.
        b'N' => (0, 99_999 * ONE),
        // The factor of G31, and the approach of the threads of the Huaxing lathes.
        b'L' if block.has_g(31) => (ONE / 1000, 99_999_000),
        b'D' if block.has_g(33) || block.has_g(34) => (-LENGTH, LENGTH),
        // The input that the M01 of an NC-B08 waits for.
        b'L' if block.word(b'M').is_some_and(|it| it.value.integer() == 1) => (0, 99 * ONE),
        address => of_model(address),
    }
}

#[cold]
fn out_of_range(word: &Word, low: i64, high: i64) -> BlockError {
    let name = char::from(word.address);
    let detail = say::word_out_of_range(name, word.value, limit(low), limit(high));
    BlockError::at(alarm::number::OUT_OF_RANGE, word.span.0.into(), detail)
}
