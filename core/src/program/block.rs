//! A block: the words of one command, stored without heap allocation.

use core::fmt;

use gsk_messages::say;
use serde::{Deserialize, Serialize};

use super::macro_b::{FormulaCode, MacroStatement};
use super::number::{VariableReference, WordNumber, is_length};
use super::syntax::{BlockError, Syntax};
use crate::alarm;
use crate::model::ModelRecord;

/// Greatest number of words in a block besides N and O; more raise alarm 012.
pub(crate) const MAX_WORDS: usize = 24;

/// A word of a block: an address letter and a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ProgramWord {
    /// Address as an upper-case letter, e.g. `b'X'`.
    pub address: u8,
    /// The number after the address, or the variable that replaces it.
    pub value: WordNumber,
    /// Byte positions of the word in the text of its block, from 0: first byte, and the byte
    /// after the last one.
    pub span: (u16, u16),
}

impl ProgramWord {
    pub(super) const EMPTY: Self = Self {
        address: 0,
        value: WordNumber::ZERO,
        span: (0, 0),
    };
}

/// The words of one block, in the order of the text.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(into = "Plain", try_from = "Plain")]
pub struct ProgramBlock {
    /// Sequence number (N word); `None` without one.
    pub n: Option<u32>,
    /// Program number (O word); `None` without one.
    pub o: Option<u16>,
    /// Whether the block begins with the skip mark `/`.
    pub skip: bool,
    /// Line of the file, from 1; 0 without a file.
    pub line: u32,
    /// The macro B statement of the block; `None` if all words have plain numbers.
    pub(super) statement: Option<Box<MacroStatement>>,
    variables: bool,
    len: u8,
    addresses: u32,
    codes: u128,
    words: [ProgramWord; MAX_WORDS],
}

/// The serialized form of a block; the derived fields of [`ProgramBlock`] are computed again.
#[derive(Serialize, Deserialize)]
struct Plain {
    n: Option<u32>,
    o: Option<u16>,
    skip: bool,
    line: u32,
    words: Vec<ProgramWord>,
}

impl Default for ProgramBlock {
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
            words: [ProgramWord::EMPTY; MAX_WORDS],
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

/// A set of address letters, as one bit each.
#[inline]
pub(crate) const fn address_bits(addresses: &[u8]) -> u32 {
    let (mut bits, mut index) = (0, 0);
    while index < addresses.len() {
        bits |= address_bit(addresses[index]);
        index += 1;
    }
    bits
}

impl ProgramBlock {
    /// Empties the block. Old entries of `words` remain and have no meaning.
    pub(super) fn clear(&mut self) {
        self.statement = None;
        (self.n, self.o, self.skip, self.line) = (None, None, false, 0);
        self.variables = false;
        (self.len, self.addresses, self.codes) = (0, 0, 0);
    }

    /// The number of the first variable that a word has instead of a number; `None` if all
    /// words have numbers.
    pub(crate) fn first_variable(&self) -> Option<u16> {
        let variable = |word: &ProgramWord| word.value.variable();
        let found = self.words().iter().find_map(variable);
        found.map(|variable| variable.number)
    }

    /// The words in the order of the text, without N and O.
    pub fn words(&self) -> &[ProgramWord] {
        &self.words[..usize::from(self.len)]
    }

    /// Whether the block has no words besides N and O. Such a block repeats a cycle of group
    /// 01.
    pub const fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Whether the block consists of a program name only.
    pub(crate) fn is_name_only(&self) -> bool {
        self.is_empty() && self.o.is_some() && self.statement.is_none()
    }

    /// The macro B statement of the block; `None` for a block of words.
    pub(crate) fn macro_statement(&self) -> Option<&MacroStatement> {
        let statement = self.statement.as_deref();
        statement.filter(|it| !matches!(it, MacroStatement::Words(_)))
    }

    /// The formulas that words of the block refer to; `None` if the block has a macro
    /// statement, or only words with plain numbers.
    pub(crate) fn formulas(&self) -> Option<&[FormulaCode]> {
        match self.statement.as_deref() {
            Some(MacroStatement::Words(formulas)) => Some(formulas),
            _ => None,
        }
    }

    /// Whether the block has a word with the address `address`, an upper-case letter.
    pub const fn has(&self, address: u8) -> bool {
        self.addresses & address_bit(address) != 0
    }

    /// Whether the block has no words with other address letters, and no macro B.
    pub const fn has_only(&self, addresses: &[u8]) -> bool {
        self.addresses & !address_bits(addresses) == 0 && self.statement.is_none()
    }

    /// The first word with the address `address`; `None` if the block has no such word.
    pub fn word(&self, address: u8) -> Option<&ProgramWord> {
        if !self.has(address) {
            return None;
        }
        self.words().iter().find(|word| word.address == address)
    }

    /// The number of the first word with the address `address`; `None` without such a word.
    pub fn number(&self, address: u8) -> Option<WordNumber> {
        self.word(address).map(|word| word.value)
    }

    /// Whether the block has the G code `code`.
    pub(crate) const fn has_g(&self, code: u8) -> bool {
        code < 100 && self.codes & (1 << code) != 0
    }

    /// The numbers of the G codes of the block, in the order of the text.
    pub fn g_codes(&self) -> impl Iterator<Item = u8> {
        let words = if self.has(b'G') { self.words() } else { &[] };
        words
            .iter()
            .filter(|word| word.address == b'G' && word.value.variable().is_none())
            .map(|word| word.value.integer() as u8)
    }

    /// Whether a word refers to a variable that is not resolved yet.
    pub(crate) const fn has_variables(&self) -> bool {
        self.variables
    }

    /// Replaces references to variables by their values and checks the ranges again. A value
    /// counts as 0.001 mm (0.0001 inch) on X Z U W R I J K, as 0.001 s on X and U of G04,
    /// and as the number itself on other addresses and on those for which `is_count` holds in
    /// this block. The words of G65 remain unchanged: the macro operations read variables
    /// themselves.
    ///
    /// # Errors
    /// The alarm of `lookup`, or 043 for a value out of the range of its address.
    pub fn resolve<E: From<BlockError>>(
        mut self,
        syntax: Syntax,
        is_count: impl Fn(u8) -> bool,
        mut lookup: impl FnMut(VariableReference) -> Result<i64, E>,
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
            word.value = if is_length(word.address) && !is_count(word.address) {
                let seconds = dwell && matches!(word.address, b'X' | b'U');
                let increment = if seconds { 1000 } else { syntax.increment() };
                WordNumber::from_millionths(value.saturating_mul(increment))
            } else {
                WordNumber::from_integer(value, 0)
            };
        }
        self.reindex(syntax)?;
        Ok(self)
    }

    /// Replaces the formula of each word by its value; `values` are in the order of
    /// [`Self::formulas`]. Lengths are rounded to the least input increment, other numbers but
    /// F to an integer. A word whose formula yields null (`None`) is removed.
    ///
    /// # Errors
    /// 043 for a value out of the range of its address.
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
                word.value = WordNumber::from_value(value, word.address, length);
            }
            block.push(word);
        }
        check_values(&block, syntax)?;
        Ok(block)
    }

    /// Replaces the number of each word by the result of `change` (address, number), without
    /// checking the range.
    pub(crate) fn map_numbers(&mut self, mut change: impl FnMut(u8, WordNumber) -> WordNumber) {
        for word in &mut self.words[..usize::from(self.len)] {
            word.value = change(word.address, word.value);
        }
    }

    /// Adds a word. Returns `false` if the block is full.
    pub(super) const fn push(&mut self, word: ProgramWord) -> bool {
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

    /// Recomputes the data derived from the words and checks the ranges of their numbers. Returns
    /// an error for a number out of range.
    fn reindex(&mut self, syntax: Syntax) -> Result<(), BlockError> {
        let words = self.words;
        let len = usize::from(self.len);
        (self.len, self.addresses, self.codes, self.variables) = (0, 0, 0, false);
        for word in &words[..len] {
            self.push(*word);
        }
        check_values(self, syntax)
    }
}

impl PartialEq for ProgramBlock {
    fn eq(&self, other: &Self) -> bool {
        let head = |block: &Self| (block.n, block.o, block.skip, block.line);
        head(self) == head(other) && self.words() == other.words()
    }
}

/// Formats a block as a line of text that parses to the same block.
impl fmt::Display for ProgramBlock {
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

impl From<ProgramBlock> for Plain {
    fn from(block: ProgramBlock) -> Self {
        Self {
            n: block.n,
            o: block.o,
            skip: block.skip,
            line: block.line,
            words: block.words().to_vec(),
        }
    }
}

impl TryFrom<Plain> for ProgramBlock {
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

/// Checks the numbers of a block against the ranges of manual table 2-1; references to
/// variables are not checked. Alarm 043 if a number is out of range.
pub(super) fn check_values(block: &ProgramBlock, syntax: Syntax) -> Result<(), BlockError> {
    if syntax.model.is_mill() {
        return check_mill_words(block);
    }
    let all_usual = !syntax.narrows_words()
        && block.words().iter().all(|word| {
            let (low, high) = usual_range(word.address);
            word.value.variable().is_none() && (low..=high).contains(&word.value.millionths())
        });
    match all_usual {
        true => Ok(()),
        false => check_each_word(block, syntax),
    }
}

/// Checks the numbers of a block of a mill against their ranges; alarm 043 if one is outside.
fn check_mill_words(block: &ProgramBlock) -> Result<(), BlockError> {
    for word in block.words() {
        let (low, high) = match word.address {
            b'D' | b'H' => (0, 400 * MILLIONTHS),
            b'G' => (0, 999 * MILLIONTHS),
            b'L' | b'M' | b'T' => (0, 9999 * MILLIONTHS),
            b'S' => (0, 99_999 * MILLIONTHS),
            b'F' | b'P' => usual_range(word.address),
            // Scale factors of G51, in units of 0.00001.
            b'I' | b'J' | b'K' if block.has_g(51) => (-999_999 * MILLIONTHS, 999_999 * MILLIONTHS),
            _ => (-LARGEST_MILL_LENGTH, LARGEST_MILL_LENGTH),
        };
        if !(low..=high).contains(&word.value.millionths()) && word.value.variable().is_none() {
            return Err(out_of_range(word, low, high));
        }
    }
    Ok(())
}

/// Checks each number against the range that its block allows; alarm 043 if one is outside.
fn check_each_word(block: &ProgramBlock, syntax: Syntax) -> Result<(), BlockError> {
    let g65 = block.has_g(65);
    let record = syntax.model.record();
    let greatest = record.greatest_coordinate * (MILLIONTHS / 1000);
    for word in block.words() {
        if word.value.variable().is_some() {
            continue;
        }
        let (mut low, mut high) = word_range(block, word, g65, record);
        let signed_d = word.address == b'D' && low < 0;
        if greatest > LARGEST_LENGTH && (signed_d || COORDINATES.contains(&word.address)) {
            (low, high) = (low.min(-greatest), high.max(greatest));
        }
        let value = word.value.millionths();
        if value < low || value > high {
            return Err(out_of_range(word, low, high));
        }
    }
    Ok(())
}

/// Whether an upper-case letter is an address of the model that `record` describes.
pub(super) fn is_address_of_model(letter: u8, record: &ModelRecord) -> bool {
    is_address(letter) || record.has_address(letter)
}

/// Whether a letter is an address of table 2-1, or J or L, which thread codes use.
const fn is_address(letter: u8) -> bool {
    matches!(letter, b'F'..=b'U' | b'W' | b'X' | b'Z')
}

/// Addresses with the same range as the coordinates of the model.
const COORDINATES: &[u8] = b"XZUWIJKR";

const MILLIONTHS: i64 = 1_000_000;
/// Greatest length that a word can have, 9999.999 mm, in millionths.
const LARGEST_LENGTH: i64 = 9_999_999_000;
/// Greatest length on a mill, 99999.999 mm, in millionths. Angles and scale factors of a mill
/// are smaller.
const LARGEST_MILL_LENGTH: i64 = 99_999_999_000;
/// Greatest dwell, 99999.999 s, in millionths. A negative dwell raises an alarm when its block
/// is executed.
const LARGEST_DWELL: i64 = 99_999_999_000;
/// Greatest value of a macro operation, 2³², in millionths.
const LARGEST_MACRO_VALUE: i64 = (1 << 32) * MILLIONTHS;

/// Least and greatest value of the words A to Z in most blocks, in millionths.
const USUAL_RANGES: [(i64, i64); 26] = {
    let mut usual = [(-LARGEST_LENGTH, LARGEST_LENGTH); 26];
    let mut letter = 0;
    while letter < usual.len() {
        match b'A' + letter as u8 {
            b'F' | b'D' => usual[letter] = (0, 9_999_999 * MILLIONTHS),
            b'G' | b'M' | b'H' => usual[letter] = (0, 99 * MILLIONTHS),
            b'L' => usual[letter] = (MILLIONTHS, 99 * MILLIONTHS),
            b'N' | b'S' | b'T' => usual[letter] = (0, 9999 * MILLIONTHS),
            b'P' => usual[letter] = (-99_999_999 * MILLIONTHS, 99_999_999 * MILLIONTHS),
            b'Q' => usual[letter] = (-9_999_999 * MILLIONTHS, 9_999_999 * MILLIONTHS),
            _ => {}
        }
        letter += 1;
    }
    usual
};

fn usual_range(address: u8) -> (i64, i64) {
    let letter = usize::from(address.wrapping_sub(b'A'));
    USUAL_RANGES
        .get(letter)
        .copied()
        .unwrap_or((-LARGEST_LENGTH, LARGEST_LENGTH))
}

/// Least and greatest number of a word in most blocks (manual table 2-1), as written in a
/// program. Some codes accept a smaller or a greater range.
pub fn word_limits(address: u8) -> (String, String) {
    let (low, high) = usual_range(address);
    (format_limit(low), format_limit(high))
}

/// Formats a limit, in millionths, as written in a program.
fn format_limit(millionths: i64) -> String {
    let text = WordNumber::from_millionths(millionths).to_string();
    text.trim_end_matches('.').to_string()
}

/// Least and greatest value of a word in its block, in millionths: the usual range or a
/// wider one.
fn word_range(
    block: &ProgramBlock,
    word: &ProgramWord,
    g65: bool,
    record: &ModelRecord,
) -> (i64, i64) {
    let of_model = |address| {
        let limits = record.word_limits.get(&char::from(address));
        limits.map_or_else(
            || usual_range(address),
            |it| (it.0 * MILLIONTHS, it.1 * MILLIONTHS),
        )
    };
    match word.address {
        b'H' | b'P' | b'Q' | b'R' if g65 => (-LARGEST_MACRO_VALUE, LARGEST_MACRO_VALUE),
        b'X' | b'U' if block.has_g(4) => (-LARGEST_DWELL, LARGEST_DWELL),
        // G76 R(d): an integer counts units of 0.001 mm.
        b'R' if block.has_g(76) && !word.value.has_point() => {
            (-9_999_999 * MILLIONTHS, 9_999_999 * MILLIONTHS)
        }
        // Vector of an arc, or threads per inch.
        b'I' => (-LARGEST_LENGTH, 25_400 * MILLIONTHS),
        // After a G code N is a block, a subprogram or a count.
        b'N' => (0, 99_999 * MILLIONTHS),
        // The factor of G31, and the approach of threads on Huaxing lathes.
        b'L' if block.has_g(31) => (MILLIONTHS / 1000, 99_999_000),
        b'D' if block.has_g(33) || block.has_g(34) => (-LARGEST_LENGTH, LARGEST_LENGTH),
        // The input that M01 waits for on an NC-B08.
        b'L' if block.word(b'M').is_some_and(|it| it.value.integer() == 1) => (0, 99 * MILLIONTHS),
        address => of_model(address),
    }
}

#[cold]
fn out_of_range(word: &ProgramWord, low: i64, high: i64) -> BlockError {
    let name = char::from(word.address);
    let detail = say::word_out_of_range(name, word.value, format_limit(low), format_limit(high));
    BlockError::at(alarm::number::OUT_OF_RANGE, word.span.0.into(), detail)
}
