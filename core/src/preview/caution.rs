//! Cautions: probable mistakes that raise no alarm.

use core::mem::discriminant;

use gsk_messages::{Message, say};

use super::certainty::ProgramFacts;
use super::{PreviewRun, SpindleRotation};
use crate::command::{ControlCommand, ProgramId, SourcePosition};
use crate::interpreter::{BlockRemark, IgnoredWord, Interpreter, WordAdvice};
use crate::units::Feed;

/// Feed per minute, mm/min, below which the program probably means a feed per revolution.
const LEAST_FEED_MM_PER_MIN: f64 = 1.0;

/// The kind of a probable mistake in a program.
#[derive(Clone, Debug, PartialEq)]
pub enum CautionKind {
    /// A cut under G98 has a feed below 1 mm/min.
    SlowFeed,
    /// A cut is made while the spindle is stopped.
    SpindleStopped,
    /// A cut after a T word while no tool offset is active.
    NoOffset,
    /// G28 while the position of the work on the machine is unknown.
    MachineZero,
    /// The program does not end where its first G50 sets the tool. X is a diameter or radius,
    /// as in the program; all values in mm.
    EndElsewhere {
        /// Position that G50 sets, X and Z, mm.
        set: (f64, f64),
        /// Position at the end, in the coordinates of that G50, X and Z, mm.
        end: (f64, f64),
    },
    /// A word that no code of its block uses; the payload describes it.
    IgnoredWord(Box<IgnoredWord>),
    /// A block follows a `;` at the beginning of its line, which other languages use for a
    /// comment.
    AfterSemicolon,
    /// Text follows the `%` at the end of the program; the control does not read it.
    AfterEnd,
    /// The name of the program begins with `:` instead of O; the payload is the program
    /// number.
    ColonName(u16),
}

/// Greatest number of cautions of one kind in the list.
const MAX_CAUTIONS_PER_KIND: usize = 50;

/// A probable mistake in a program, with its block.
#[derive(Clone, Debug, PartialEq)]
pub struct Caution {
    /// The kind of the probable mistake.
    pub kind: CautionKind,
    /// The block with the mistake; for most kinds the first such block.
    pub source: SourcePosition,
}

impl Caution {
    /// The message about the mistake for the operator, with the line number.
    pub fn message_with_line(&self) -> Message {
        say::in_line(self.source.line, self.kind.message())
    }

    /// First and last column of the ignored word, in characters from 1; `None` if the caution
    /// is about the whole line.
    pub fn columns(&self) -> Option<(u32, u32)> {
        match &self.kind {
            CautionKind::IgnoredWord(word) => Some(word.columns),
            _ => None,
        }
    }
}

impl CautionKind {
    /// A stable identifier of the kind, e.g. `slow-feed`, for tools that sort findings.
    pub const fn id(&self) -> &'static str {
        match self {
            Self::SlowFeed => "slow-feed",
            Self::SpindleStopped => "spindle-stands",
            Self::NoOffset => "no-offset",
            Self::MachineZero => "machine-zero",
            Self::EndElsewhere { .. } => "end-elsewhere",
            Self::IgnoredWord(_) => "ignored-word",
            Self::AfterSemicolon => "after-semicolon",
            Self::AfterEnd => "after-end",
            Self::ColonName(_) => "colon-name",
        }
    }

    /// The message about the mistake for the operator, without the line number.
    pub fn message(&self) -> Message {
        match self {
            Self::SlowFeed => say::caution_feed_slow(),
            Self::SpindleStopped => say::caution_spindle_stands(),
            Self::NoOffset => say::caution_no_offset(),
            Self::MachineZero => say::caution_machine_zero(),
            Self::EndElsewhere { set, end } => {
                say::caution_end_elsewhere(set.0, set.1, end.0, end.1)
            }
            Self::IgnoredWord(word) => ignored_word_message(word),
            Self::AfterSemicolon => say::caution_after_semicolon(),
            Self::AfterEnd => say::caution_after_end(),
            Self::ColonName(number) => say::caution_colon_name(format_args!("{number:04}")),
        }
    }
}

/// The message about a word without effect, with the correct notation if it is known.
fn ignored_word_message(word: &IgnoredWord) -> Message {
    let text = &word.text;
    let rule = match &word.code {
        Some(code) => say::ignored_word_of_code(text, code, word.address),
        None => say::ignored_word(text),
    };
    let advice = match &word.advice {
        WordAdvice::None => return rule,
        WordAdvice::CallCount(p) => say::ignored_call_count(p),
        WordAdvice::TaperIsR(r) => say::ignored_taper(r),
        WordAdvice::LeadByF => say::ignored_beside_lead(),
        WordAdvice::CenterBesideRadius => say::ignored_beside_radius(),
        WordAdvice::ArcWithoutLength => say::ignored_radius_without_distance(),
        WordAdvice::BesideAbsolute(axis) => say::ignored_beside_absolute(axis),
        WordAdvice::DwellByP => say::ignored_beside_dwell(),
        WordAdvice::LaterCode(code) => return say::ignored_code(text, code),
    };
    say::several([rule, advice])
}

impl PreviewRun<'_> {
    /// Adds cautions for the remarks that the interpreter has made about a block.
    pub(super) fn take_remarks(&mut self, interpreter: &mut Interpreter) {
        for (remark, source) in interpreter.take_remarks() {
            let slip = match remark {
                BlockRemark::Ignored(word) => CautionKind::IgnoredWord(Box::new(word)),
                BlockRemark::AfterSemicolon => CautionKind::AfterSemicolon,
            };
            self.add_each_caution(slip, source);
        }
    }

    /// Adds cautions about the text of a program: `:` in its name, and text after its end.
    pub(super) fn check_text(&mut self, program: ProgramId) {
        let Some(text) = self.programs.get(program) else {
            return;
        };
        let at = |line| SourcePosition {
            program,
            line,
            sequence: None,
        };
        let (colon, after) = (text.colon_name(), text.line_after_end());
        if let Some((line, number)) = colon {
            self.add_caution(CautionKind::ColonName(number), at(line));
        }
        if let Some(line) = after {
            self.add_caution(CautionKind::AfterEnd, at(line));
        }
    }

    /// Adds cautions about a cut before it is executed: slow feed, stopped spindle, no offset.
    pub(super) fn check_cut(&mut self, command: &ControlCommand, feed: Option<Feed>) {
        let source = command.source;
        let feed_facts = ProgramFacts::MOTION
            .union(ProgramFacts::FEED)
            .union(ProgramFacts::FEED_UNIT);
        if matches!(feed, Some(Feed::PerMinute(rate)) if rate < LEAST_FEED_MM_PER_MIN)
            && self.is_certain(feed_facts)
        {
            self.add_caution(CautionKind::SlowFeed, source);
        }
        if self.spindle.rotation() == SpindleRotation::Stopped
            && self.is_certain(ProgramFacts::MOTION.union(ProgramFacts::SPINDLE_DIRECTION))
        {
            self.add_caution(CautionKind::SpindleStopped, source);
        }
        if command.modal.offset == 0
            && !self.preview.tools.is_empty()
            && self.is_certain(ProgramFacts::MOTION.union(ProgramFacts::TOOL))
        {
            self.add_caution(CautionKind::NoOffset, source);
        }
    }

    pub(super) fn add_caution(&mut self, slip: CautionKind, source: SourcePosition) {
        let cautions = &mut self.preview.cautions;
        let same = |caution: &Caution| discriminant(&caution.kind) == discriminant(&slip);
        if !cautions.iter().any(same) {
            cautions.push(Caution { kind: slip, source });
        }
    }

    /// Adds a caution at each block with the mistake, not only at the first one.
    fn add_each_caution(&mut self, slip: CautionKind, source: SourcePosition) {
        let caution = Caution { kind: slip, source };
        let cautions = &mut self.preview.cautions;
        let same = |other: &&Caution| discriminant(&other.kind) == discriminant(&caution.kind);
        if cautions.iter().filter(same).count() < MAX_CAUTIONS_PER_KIND
            && !cautions.contains(&caution)
        {
            cautions.push(caution);
        }
    }
}
