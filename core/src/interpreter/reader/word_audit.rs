//! Finds the words of a block that change nothing.
//!
//! Removes and changes each word of a block in turn and evaluates the block again. If the
//! commands, the state after the block and its alarms stay the same, no code reads the word.
//! So the codes are the only list of what they read.
//!
//! The control ignores such words, as the manual states. Only a preview searches for them.

use std::collections::BTreeSet;

use crate::alarm::Alarm;
use crate::command::{MotionCode, SourcePosition};
use crate::interpreter::macros::arithmetic::Operation;
use crate::interpreter::plan::Plan;
use crate::interpreter::state::State;
use crate::interpreter::words::{OneShot, SortedWords};
use crate::model::{GCode, ModelRecord};
use crate::program::{Program, ProgramBlock, ProgramWord};

/// Greatest number of stored block shapes; a program has a few dozen.
const MAX_SHAPES: usize = 4096;
/// Greatest number of remarks that a run stores.
const MAX_REMARKS: usize = 256;

/// The change that the audit makes to a value: one millimetre or one count, in millionths.
const CHANGE_STEP: i64 = 1_000_000;

/// A remark of a preview about a block that the control executes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum BlockRemark {
    /// The block has a word that changes nothing.
    Ignored(IgnoredWord),
    /// The block is after a `;` at the beginning of its line.
    AfterSemicolon,
}

/// A word of a block that changes nothing, and advice about this word.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IgnoredWord {
    /// The ignored word as written, without blanks.
    pub text: String,
    /// Address letter of the ignored word.
    pub address: char,
    /// The code that does not read the word, such as `G01`; `None` for a block without a code.
    pub code: Option<String>,
    /// What the programmer probably meant by the ignored word.
    pub advice: WordAdvice,
    /// First and last column in the line, in characters from 1.
    pub columns: (u32, u32),
}

/// What the programmer probably meant by an ignored word.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum WordAdvice {
    /// It is unknown what the programmer meant.
    None,
    /// L was meant as the number of calls, which belongs into P: payload is the P to write.
    CallCount(String),
    /// I or K was meant as the taper of a cycle: the payload is the R to write.
    TaperIsR(String),
    /// I was meant as threads per inch, but F of the same block sets the lead.
    LeadByF,
    /// I or K was meant as the centre of an arc, but R of the same block sets the radius.
    CenterBesideRadius,
    /// R belongs to an arc without length, which ends at its start.
    ArcWithoutLength,
    /// An increment (U or W) is ignored beside the absolute word of the same axis, X or Z.
    BesideAbsolute(char),
    /// A dwell in seconds is ignored beside P, the dwell in ms.
    DwellByP,
    /// A G code is replaced by this later one of the same group.
    LaterCode(String),
}

/// A remark about a block and the source position of that block.
pub type LocatedRemark = (BlockRemark, SourcePosition);

/// Searches the blocks of a run for words that change nothing.
#[derive(Clone, Debug, Default)]
pub(crate) struct WordAudit {
    /// Shapes of blocks in which the audit found no ignored word.
    clean_shapes: BTreeSet<BlockShape>,
    /// The remarks of the run, without repetitions.
    remarks: Vec<LocatedRemark>,
    /// Number of remarks that [`Self::take_remarks`] has returned.
    taken_count: usize,
}

/// All audits are equal, so that the comparison of two interpreters ignores their findings.
impl PartialEq for WordAudit {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

/// The features of a block, besides the values of its words, that decide which words are read.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct BlockShape {
    addresses: u32,
    zeros: u32,
    codes: Vec<u8>,
    m: Option<u8>,
    motion: MotionCode,
    nose: u8,
    flags: [bool; 4],
}

impl BlockShape {
    fn from_block(block: &ProgramBlock, words: &SortedWords, before: &State) -> Self {
        let letter_bit = |word: &ProgramWord| 1_u32 << (word.address.wrapping_sub(b'A') & 31);
        let add_letter = |found: u32, word: &ProgramWord| found | letter_bit(word);
        let written = block.words().iter();
        let is_zero = |word: &&ProgramWord| word.value.millionths() == 0;
        Self {
            addresses: written.clone().fold(0, add_letter),
            zeros: written.filter(is_zero).fold(0, add_letter),
            codes: block.g_codes().collect(),
            m: words.m,
            motion: before.modal.motion,
            nose: before.modal.nose_compensation,
            flags: [
                before.incremental,
                before.modal.surface_speed,
                before.cycle.is_set(),
                before.scale.is_some(),
            ],
        }
    }
}

/// A block, and the state and plan that its evaluation gave.
pub(crate) struct EvaluatedBlock<'a> {
    /// The block as parsed, with its words in the order of the text.
    pub(crate) block: &'a ProgramBlock,
    /// The words of the block, sorted by meaning.
    pub(crate) words: &'a SortedWords,
    pub(crate) record: &'a ModelRecord,
    /// The modal state before the block.
    pub(crate) before: &'a State,
    /// The modal state after the block.
    pub(crate) after: &'a State,
    pub(crate) plan: &'a Plan,
}

impl WordAudit {
    /// Searches the block `index` (from 0) of a program for ignored words and stores a remark for
    /// each. `evaluate` evaluates changed words instead of those of the block.
    pub(crate) fn audit_block(
        &mut self,
        program: &Program,
        index: u32,
        block: &EvaluatedBlock<'_>,
        evaluate: &mut dyn FnMut(&SortedWords, &mut State, &mut Plan) -> Result<(), Alarm>,
    ) {
        if self.remarks.len() >= MAX_REMARKS {
            return;
        }
        for (word, advice) in self.find_ignored_words(block, evaluate) {
            let code = executing_code(block);
            let ignored = IgnoredWord::new(program, index, &word, code, advice);
            self.add_remark(BlockRemark::Ignored(ignored), block.plan.source);
        }
    }

    /// Searches a G65 block for ignored words. The operations of G65 act while the reader
    /// reads them, so they cannot be evaluated twice.
    pub(crate) fn audit_macro_block(
        &mut self,
        program: &Program,
        index: u32,
        block: &ProgramBlock,
        source: SourcePosition,
    ) {
        let Some(h) = block.number(b'H').filter(|h| h.variable().is_none()) else {
            return;
        };
        let unread = Operation::unread_words(h.integer());
        for word in block
            .words()
            .iter()
            .filter(|word| unread.contains(&word.address))
        {
            let code = Some(format!("G65 H{:02}", h.integer()));
            let ignored = IgnoredWord::new(program, index, word, code, WordAdvice::None);
            self.add_remark(BlockRemark::Ignored(ignored), source);
        }
    }

    /// Finds the words of a block that change nothing, each with advice.
    fn find_ignored_words(
        &mut self,
        block: &EvaluatedBlock<'_>,
        evaluate: &mut dyn FnMut(&SortedWords, &mut State, &mut Plan) -> Result<(), Alarm>,
    ) -> Vec<(ProgramWord, WordAdvice)> {
        let shape = BlockShape::from_block(block.block, block.words, block.before);
        if self.clean_shapes.contains(&shape) {
            return Vec::new();
        }
        // A changed value that is refused shows only that the control checks it. If the block
        // is refused without the word, it needs the word.
        let mut has_effect = |words: &SortedWords, change: WordChange| {
            let mut state = *block.before;
            let mut plan = Plan::new(block.plan.source, block.before.modal);
            match evaluate(words, &mut state, &mut plan) {
                Ok(()) => state != *block.after || plan != *block.plan,
                Err(_) => matches!(change, WordChange::Removed),
            }
        };
        let mut ignored = Vec::new();
        for (at, word) in block.block.words().iter().enumerate() {
            match word.address {
                b'M' => {}
                b'G' => {
                    if let Some(later) = find_later_code(block, at) {
                        ignored.push((*word, WordAdvice::LaterCode(format!("G{later:02}"))));
                    }
                }
                letter => {
                    let changes = [
                        WordChange::Removed,
                        WordChange::Add(CHANGE_STEP),
                        WordChange::Add(-CHANGE_STEP),
                    ];
                    let mut is_read =
                        |change| has_effect(&change_word(block.words, letter, change), change);
                    if !changes.into_iter().any(&mut is_read) {
                        ignored.push((*word, find_advice(block, word)));
                    }
                }
            }
        }
        if ignored.is_empty() && self.clean_shapes.len() < MAX_SHAPES {
            self.clean_shapes.insert(shape);
        }
        ignored
    }

    /// Stores a remark on the block at `source`, unless the same remark is stored already.
    pub(crate) fn add_remark(&mut self, remark: BlockRemark, source: SourcePosition) {
        let remarked = (remark, source);
        if self.remarks.len() < MAX_REMARKS && !self.remarks.contains(&remarked) {
            self.remarks.push(remarked);
        }
    }

    /// Whether remarks exist that [`Self::take_remarks`] has not returned yet.
    #[inline]
    pub(crate) const fn has_remarks(&self) -> bool {
        self.remarks.len() > self.taken_count
    }

    /// Returns the remarks stored since the last call of this function.
    pub(crate) fn take_remarks(&mut self) -> Vec<LocatedRemark> {
        let new = self
            .remarks
            .get(self.taken_count..)
            .unwrap_or_default()
            .to_vec();
        self.taken_count = self.remarks.len();
        new
    }
}

impl IgnoredWord {
    /// Describes a word of the block `index` with its text and its columns in the line.
    #[cold]
    fn new(
        program: &Program,
        index: u32,
        word: &ProgramWord,
        code: Option<String>,
        advice: WordAdvice,
    ) -> Self {
        let text = program.block(index);
        let (from, to) = (usize::from(word.span.0), usize::from(word.span.1));
        let written = text.get(from..to).unwrap_or_default().trim_end();
        let before = text.get(..from).unwrap_or_default().chars().count() as u32;
        let first = program.block_column(index).saturating_add(before);
        let length = written.chars().count() as u32;
        let compact: String = written.chars().filter(|letter| *letter != ' ').collect();
        Self {
            text: match compact.is_empty() {
                true => char::from(word.address).into(),
                false => compact,
            },
            address: word.address.into(),
            code,
            advice,
            columns: (first, first + length.saturating_sub(1)),
        }
    }
}

/// The code that carries out a block, as messages name it (`G01`, `M03`); `None` if the block
/// has no code.
fn executing_code(block: &EvaluatedBlock<'_>) -> Option<String> {
    let words = block.words;
    if words.one_shot.is_some() {
        let is_group_00 = |code: &u8| {
            let meaning = block.record.g_code((*code).into());
            meaning.is_some_and(|meaning| code_group(meaning) == 0)
        };
        let code = block.block.g_codes().filter(is_group_00).last()?;
        return Some(format!("G{code:02}"));
    }
    match words.m {
        Some(m) if !words.has_axis_words() => Some(format!("M{m:02}")),
        _ if words.has_axis_words() || words.motion.is_some() => {
            Some(format!("G{:02}", block.after.modal.motion.number()))
        }
        _ => None,
    }
}

/// A change that the audit makes to a word, to find out whether a code reads the word.
#[derive(Clone, Copy)]
enum WordChange {
    Removed,
    /// Adds this amount to the value, in millionths.
    Add(i64),
}

impl WordChange {
    fn apply_exact(self, value: &mut Option<i64>) {
        *value = match self {
            Self::Removed => None,
            Self::Add(step) => value.map(|value| value.saturating_add(step)),
        };
    }

    fn apply_integer(self, value: &mut Option<i64>) {
        *value = match self {
            Self::Removed => None,
            Self::Add(step) => value.map(|value| value.saturating_add(step / CHANGE_STEP)),
        };
    }
}

/// Copies the words and changes the one with the address `letter`. The count of words stays
/// the same, because single block depends on it.
fn change_word(words: &SortedWords, letter: u8, change: WordChange) -> SortedWords {
    let mut words = *words;
    let by = match change {
        WordChange::Removed => None,
        WordChange::Add(step) => Some(step),
    };
    match letter {
        b'X' => change.apply_exact(&mut words.x),
        b'U' => change.apply_exact(&mut words.u),
        b'Z' => change.apply_exact(&mut words.z),
        b'W' => change.apply_exact(&mut words.w),
        b'I' => change.apply_exact(&mut words.i),
        b'J' => change.apply_exact(&mut words.j),
        b'K' => change.apply_exact(&mut words.k),
        b'R' => change.apply_exact(&mut words.r),
        b'D' => change.apply_exact(&mut words.d_exact),
        b'Q' => change.apply_integer(&mut words.q),
        b'S' => change.apply_integer(&mut words.s),
        b'T' => change.apply_integer(&mut words.t),
        b'P' => {
            change.apply_integer(&mut words.p);
            change.apply_exact(&mut words.p_exact);
        }
        b'L' => {
            change.apply_integer(&mut words.l);
            change.apply_exact(&mut words.l_exact);
        }
        b'F' => {
            let step = |feed: f64, by: i64| feed + by as f64 / CHANGE_STEP as f64;
            words.f = words.f.zip(by).map(|(feed, by)| step(feed, by));
        }
        b'H' => {
            let step = |h: u8, by: i64| h.checked_add_signed((by / CHANGE_STEP) as i8);
            words.h = words.h.zip(by).and_then(|(h, by)| step(h, by));
        }
        b'N' => {
            let step = |n: u32, by: i64| n.checked_add_signed((by / CHANGE_STEP) as i32);
            words.n = words.n.zip(by).and_then(|(n, by)| step(n, by));
        }
        _ => {}
    }
    words
}

/// Finds a later G code of the block that replaces the word at index `at`: the last code of a
/// group is valid (decision TEXT-4). Returns its number; `None` if no other code of the group
/// follows.
fn find_later_code(block: &EvaluatedBlock<'_>, at: usize) -> Option<i64> {
    let code = |word: &ProgramWord| {
        let number = word.value.integer();
        Some((number, block.record.g_code(number)?))
    };
    let words = block.block.words();
    let (number, meaning) = code(words.get(at)?)?;
    let later = words.get(at + 1..)?.iter();
    let mut later = later.filter(|word| word.address == b'G').filter_map(code);
    let replacement = later.find(|(_, other)| code_group(*other) == code_group(meaning))?;
    (replacement.0 != number).then_some(replacement.0)
}

/// The group of a G code. Codes of one group set the same field of [`SortedWords`]; 0 is that
/// of one-shot codes.
const fn code_group(code: GCode) -> u8 {
    match code {
        GCode::Rapid
        | GCode::StraightRapid
        | GCode::Line
        | GCode::ArcClockwise
        | GCode::LongArcClockwise
        | GCode::DiameterArcClockwise
        | GCode::ArcCounterclockwise
        | GCode::LongArcCounterclockwise
        | GCode::DiameterArcCounterclockwise
        | GCode::Thread
        | GCode::Tapping
        | GCode::VariableThread
        | GCode::TurningCycle
        | GCode::ThreadCycle
        | GCode::FacingCycle => 1,
        GCode::SurfaceSpeed | GCode::SpindleSpeed => 2,
        GCode::FeedPerMinute | GCode::FeedPerRevolution => 3,
        GCode::NoseOff | GCode::NoseLeft | GCode::NoseRight => 4,
        GCode::Absolute | GCode::Incremental => 5,
        GCode::ExactStop => 6,
        _ => 0,
    }
}

fn find_advice(block: &EvaluatedBlock<'_>, word: &ProgramWord) -> WordAdvice {
    let words = block.words;
    let motion = match words.one_shot {
        None => Some(block.after.modal.motion),
        Some(_) => None,
    };
    let is_cycle = matches!(
        motion,
        Some(MotionCode::TurningCycle | MotionCode::FacingCycle)
    );
    let is_thread = motion.is_some_and(MotionCode::is_thread)
        || words.one_shot == Some(OneShot::CompoundThread);
    let is_arc = motion.is_some_and(MotionCode::is_arc);
    match word.address {
        b'L' if words.m == Some(98) => call_count_advice(words),
        b'U' if words.x.is_some() && words.one_shot != Some(OneShot::Dwell) => {
            WordAdvice::BesideAbsolute('X')
        }
        b'W' if words.z.is_some() => WordAdvice::BesideAbsolute('Z'),
        b'X' | b'U' if words.one_shot == Some(OneShot::Dwell) && words.p.is_some() => {
            WordAdvice::DwellByP
        }
        b'I' | b'K' if is_arc && words.r.is_some() => WordAdvice::CenterBesideRadius,
        b'R' if is_arc => WordAdvice::ArcWithoutLength,
        b'I' | b'K' if is_cycle && words.r.is_none() => {
            WordAdvice::TaperIsR(format!("R{}", word.value))
        }
        b'I' if is_thread && words.f.is_some() => WordAdvice::LeadByF,
        _ => WordAdvice::None,
    }
}

/// Advises to write the number of calls into P: M98 P0118 L3 is M98 P30118 (manual I-3.3).
fn call_count_advice(words: &SortedWords) -> WordAdvice {
    match (words.p, words.l) {
        (Some(program @ 1..=9999), Some(count @ 1..=9999)) => {
            WordAdvice::CallCount(format!("P{count}{program:04}"))
        }
        _ => WordAdvice::None,
    }
}
