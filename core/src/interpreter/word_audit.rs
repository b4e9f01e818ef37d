//! Finds the words of a block that change nothing.
//!
//! Removes and changes each word of a block in turn and evaluates the block again. If the
//! commands, the state after the block and its alarms stay the same, no code reads the word.
//! So the codes are the only list of what they read.
//!
//! The control ignores such words, as the manual states. Only a preview searches for them.

use std::collections::BTreeSet;

use crate::alarm::Alarm;
use crate::command::Source;
use crate::interpreter::context::state::State;
use crate::interpreter::context::words::{OneShot, Words};
use crate::interpreter::macros::arithmetic::Operation;
use crate::interpreter::plan::Plan;
use crate::model::{GCode, Record};
use crate::program::{Block, Program, Word};

/// Greatest number of stored shapes of blocks; a program has a few dozen.
const MOST_SHAPES: usize = 4096;
/// Greatest number of remarks of a run.
const MOST_FINDINGS: usize = 256;

/// One millimetre, or one count, in the millionths of a word.
const STEP: i64 = 1_000_000;

/// What a preview reports about a block that the control carries out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Remark {
    /// The block has a word that changes nothing.
    Ignored(IgnoredWord),
    /// The block is after a `;` at the beginning of its line.
    AfterSemicolon,
}

/// A word that changes nothing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IgnoredWord {
    /// The word as written, without blanks.
    pub text: String,
    /// Its letter.
    pub address: char,
    /// The code of the block that does not read it, such as `G01`; `None` without a code.
    pub code: Option<String>,
    /// What its author probably meant.
    pub advice: WordAdvice,
    /// First and last column in the line, in characters from 1.
    pub columns: (u32, u32),
}

/// What the author of an ignored word probably meant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum WordAdvice {
    /// Unknown.
    None,
    /// L as a number of calls, which P contains: this P makes these calls.
    CallCount(String),
    /// I or K as the taper of a cycle, which is this R.
    TaperIsR(String),
    /// I as threads per inch, in a block with F.
    LeadByF,
    /// I or K as a centre, in a block with R.
    CenterBesideRadius,
    /// R of an arc that ends at its start.
    ArcWithoutLength,
    /// An increment in a block with the absolute word of this axis.
    BesideAbsolute(char),
    /// A dwell in seconds, in a block with P.
    DwellByP,
    /// A G code before this one of the same group.
    LaterCode(String),
}

/// A remark and its source position.
pub type Remarked = (Remark, Source);

/// Searches the blocks of a run for words that change nothing.
#[derive(Clone, Debug, Default)]
pub(crate) struct WordAudit {
    /// Shapes of blocks without an ignored word.
    sound: BTreeSet<Shape>,
    /// Each remark of the run once, and the number of those taken.
    remarks: Vec<Remarked>,
    taken: usize,
}

/// Two interpreters are equal whatever their audits have found.
impl PartialEq for WordAudit {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

/// What decides which words of a block are read, besides their values.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Shape {
    addresses: u32,
    zeros: u32,
    codes: Vec<u8>,
    m: Option<u8>,
    motion: u8,
    nose: u8,
    flags: [bool; 4],
}

impl Shape {
    fn of(block: &Block, words: &Words, before: &State) -> Self {
        let bit = |word: &Word| 1_u32 << (word.address.wrapping_sub(b'A') & 31);
        let all = |found: u32, word: &Word| found | bit(word);
        let written = block.words().iter();
        let zero = |word: &&Word| word.value.millionths() == 0;
        Self {
            addresses: written.clone().fold(0, all),
            zeros: written.filter(zero).fold(0, all),
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

/// An evaluated block and its result.
pub(crate) struct Evaluated<'a> {
    /// The block as parsed.
    pub(crate) block: &'a Block,
    /// Its words, sorted.
    pub(crate) words: &'a Words,
    pub(crate) record: &'a Record,
    /// The state before and after the block.
    pub(crate) before: &'a State,
    pub(crate) after: &'a State,
    pub(crate) plan: &'a Plan,
}

impl WordAudit {
    /// Searches a block of a program. `evaluate` evaluates other words in place of the
    /// block's.
    pub(crate) fn look(
        &mut self,
        program: &Program,
        index: u32,
        block: &Evaluated<'_>,
        evaluate: &mut dyn FnMut(&Words, &mut State, &mut Plan) -> Result<(), Alarm>,
    ) {
        if self.remarks.len() >= MOST_FINDINGS {
            return;
        }
        for (word, advice) in self.idle_words(block, evaluate) {
            let code = code_of(block);
            let ignored = IgnoredWord::new(program, index, &word, code, advice);
            self.keep(Remark::Ignored(ignored), block.plan.source);
        }
    }

    /// Searches a G65 block. Its operations act while the reader reads them, so they cannot be
    /// evaluated twice.
    pub(crate) fn look_at_macro(
        &mut self,
        program: &Program,
        index: u32,
        block: &Block,
        source: Source,
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
            self.keep(Remark::Ignored(ignored), source);
        }
    }

    /// The words that change nothing, with advice.
    fn idle_words(
        &mut self,
        block: &Evaluated<'_>,
        evaluate: &mut dyn FnMut(&Words, &mut State, &mut Plan) -> Result<(), Alarm>,
    ) -> Vec<(Word, WordAdvice)> {
        let shape = Shape::of(block.block, block.words, block.before);
        if self.sound.contains(&shape) {
            return Vec::new();
        }
        // A changed value that is refused shows only that the control checks it. If the block
        // is refused without the word, it needs the word.
        let mut differs = |words: &Words, change: Change| {
            let mut state = *block.before;
            let mut plan = Plan::new(block.plan.source, block.before.modal);
            match evaluate(words, &mut state, &mut plan) {
                Ok(()) => state != *block.after || plan != *block.plan,
                Err(_) => matches!(change, Change::Removed),
            }
        };
        let mut idle = Vec::new();
        for (at, word) in block.block.words().iter().enumerate() {
            match word.address {
                b'M' => {}
                b'G' => {
                    if let Some(later) = later_of_group(block, at) {
                        idle.push((*word, WordAdvice::LaterCode(format!("G{later:02}"))));
                    }
                }
                letter => {
                    let changes = [Change::Removed, Change::By(STEP), Change::By(-STEP)];
                    let mut is_read =
                        |change| differs(&changed(block.words, letter, change), change);
                    if !changes.into_iter().any(&mut is_read) {
                        idle.push((*word, advice(block, word)));
                    }
                }
            }
        }
        if idle.is_empty() && self.sound.len() < MOST_SHAPES {
            self.sound.insert(shape);
        }
        idle
    }

    /// Stores a remark, once for each source position.
    pub(crate) fn keep(&mut self, remark: Remark, source: Source) {
        let remarked = (remark, source);
        if self.remarks.len() < MOST_FINDINGS && !self.remarks.contains(&remarked) {
            self.remarks.push(remarked);
        }
    }

    /// Whether remarks exist that [`Self::take`] has not returned yet.
    #[inline]
    pub(crate) const fn has_remarks(&self) -> bool {
        self.remarks.len() > self.taken
    }

    /// The remarks since the last call.
    pub(crate) fn take(&mut self) -> Vec<Remarked> {
        let new = self.remarks.get(self.taken..).unwrap_or_default().to_vec();
        self.taken = self.remarks.len();
        new
    }
}

impl IgnoredWord {
    /// A word of a block, with its columns in its line.
    #[cold]
    fn new(
        program: &Program,
        index: u32,
        word: &Word,
        code: Option<String>,
        advice: WordAdvice,
    ) -> Self {
        let text = program.block(index);
        let (from, to) = (usize::from(word.span.0), usize::from(word.span.1));
        let written = text.get(from..to).unwrap_or_default().trim_end();
        let before = text.get(..from).unwrap_or_default().chars().count() as u32;
        let first = program.block_column(index).saturating_add(before);
        let length = written.chars().count() as u32;
        let plain: String = written.chars().filter(|letter| *letter != ' ').collect();
        Self {
            text: match plain.is_empty() {
                true => char::from(word.address).into(),
                false => plain,
            },
            address: word.address.into(),
            code,
            advice,
            columns: (first, first + length.saturating_sub(1)),
        }
    }
}

/// The code that carries a block out, as messages name it.
fn code_of(block: &Evaluated<'_>) -> Option<String> {
    let words = block.words;
    if words.one_shot.is_some() {
        let own = |code: &u8| {
            let meaning = block.record.g_code((*code).into());
            meaning.is_some_and(|meaning| group(meaning) == 0)
        };
        let code = block.block.g_codes().filter(own).last()?;
        return Some(format!("G{code:02}"));
    }
    match words.m {
        Some(m) if !words.has_axis_words() => Some(format!("M{m:02}")),
        _ if words.has_axis_words() || words.motion.is_some() => {
            Some(format!("G{:02}", block.after.modal.motion))
        }
        _ => None,
    }
}

/// How the audit changes a word to see whether it is read.
#[derive(Clone, Copy)]
enum Change {
    Removed,
    /// Adds to its value, in millionths.
    By(i64),
}

impl Change {
    fn exact(self, value: &mut Option<i64>) {
        *value = match self {
            Self::Removed => None,
            Self::By(step) => value.map(|value| value.saturating_add(step)),
        };
    }

    fn whole(self, value: &mut Option<i64>) {
        *value = match self {
            Self::Removed => None,
            Self::By(step) => value.map(|value| value.saturating_add(step / STEP)),
        };
    }
}

/// A copy of the words with one of them changed. Their number stays, because single block
/// depends on it.
fn changed(words: &Words, letter: u8, change: Change) -> Words {
    let mut words = *words;
    let by = match change {
        Change::Removed => None,
        Change::By(step) => Some(step),
    };
    match letter {
        b'X' => change.exact(&mut words.x),
        b'U' => change.exact(&mut words.u),
        b'Z' => change.exact(&mut words.z),
        b'W' => change.exact(&mut words.w),
        b'I' => change.exact(&mut words.i),
        b'J' => change.exact(&mut words.j),
        b'K' => change.exact(&mut words.k),
        b'R' => change.exact(&mut words.r),
        b'D' => change.exact(&mut words.d_exact),
        b'Q' => change.whole(&mut words.q),
        b'S' => change.whole(&mut words.s),
        b'T' => change.whole(&mut words.t),
        b'P' => {
            change.whole(&mut words.p);
            change.exact(&mut words.p_exact);
        }
        b'L' => {
            change.whole(&mut words.l);
            change.exact(&mut words.l_exact);
        }
        b'F' => {
            let step = |feed: f64, by: i64| feed + by as f64 / STEP as f64;
            words.f = words.f.zip(by).map(|(feed, by)| step(feed, by));
        }
        b'H' => {
            let step = |h: u8, by: i64| h.checked_add_signed((by / STEP) as i8);
            words.h = words.h.zip(by).and_then(|(h, by)| step(h, by));
        }
        b'N' => {
            let step = |n: u32, by: i64| n.checked_add_signed((by / STEP) as i32);
            words.n = words.n.zip(by).and_then(|(n, by)| step(n, by));
        }
        _ => {}
    }
    words
}

/// A later G code of the block that replaces this one: the last of a group is valid (decision
/// TEXT-4).
fn later_of_group(block: &Evaluated<'_>, at: usize) -> Option<i64> {
    let code = |word: &Word| {
        let number = word.value.integer();
        Some((number, block.record.g_code(number)?))
    };
    let words = block.block.words();
    let (number, meaning) = code(words.get(at)?)?;
    let later = words.get(at + 1..)?.iter();
    let mut later = later.filter(|word| word.address == b'G').filter_map(code);
    let same = later.find(|(_, other)| group(*other) == group(meaning))?;
    (same.0 != number).then_some(same.0)
}

/// The field of [`Words`] that a code sets, as a group number.
const fn group(code: GCode) -> u8 {
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

fn advice(block: &Evaluated<'_>, word: &Word) -> WordAdvice {
    let words = block.words;
    let motion = match words.one_shot {
        None => Some(block.after.modal.motion),
        Some(_) => None,
    };
    let cycle = matches!(motion, Some(90 | 94));
    let thread =
        matches!(motion, Some(32..=34 | 92)) || words.one_shot == Some(OneShot::CompoundThread);
    let arc = matches!(motion, Some(2 | 3));
    match word.address {
        b'L' if words.m == Some(98) => call_count(words),
        b'U' if words.x.is_some() && words.one_shot != Some(OneShot::Dwell) => {
            WordAdvice::BesideAbsolute('X')
        }
        b'W' if words.z.is_some() => WordAdvice::BesideAbsolute('Z'),
        b'X' | b'U' if words.one_shot == Some(OneShot::Dwell) && words.p.is_some() => {
            WordAdvice::DwellByP
        }
        b'I' | b'K' if arc && words.r.is_some() => WordAdvice::CenterBesideRadius,
        b'R' if arc => WordAdvice::ArcWithoutLength,
        b'I' | b'K' if cycle && words.r.is_none() => {
            WordAdvice::TaperIsR(format!("R{}", word.value))
        }
        b'I' if thread && words.f.is_some() => WordAdvice::LeadByF,
        _ => WordAdvice::None,
    }
}

/// M98 P0118 L3 is M98 P30118 (manual I-3.3).
fn call_count(words: &Words) -> WordAdvice {
    match (words.p, words.l) {
        (Some(program @ 1..=9999), Some(count @ 1..=9999)) => {
            WordAdvice::CallCount(format!("P{count}{program:04}"))
        }
        _ => WordAdvice::None,
    }
}
