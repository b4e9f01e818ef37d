//! Cautions: probable mistakes that raise no alarm.

use gsk_messages::{Message, say};

use super::certainty::ProgramFacts;
use super::line_words::{numbers_of, split_line};
use super::lint::Lint;
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
    /// The run-in of a thread is too short for the acceleration of the axis.
    ThreadRunIn {
        /// Length from the start of the thread to the face at Z0, mm.
        programmed: f64,
        /// Length that the axis needs to reach the speed of the thread, mm.
        needed: f64,
    },
    /// A thread is cut at constant surface speed (G96).
    ThreadSurfaceSpeed {
        /// Speed of the spindle where the thread begins, r/min.
        rpm: u32,
    },
    /// The speed changes between two passes of the same thread.
    ThreadSpeedChanged {
        /// S word of the pass before.
        before: f64,
        /// S word of this pass.
        now: f64,
    },
    /// A dwell of a few milliseconds; the payload is its duration, ms.
    ShortDwell(u32),
    /// A taper or an arc is cut under G40 by a tool whose offset has this nose radius, mm.
    NoseUncompensated(f64),
    /// No block leads to this one.
    UnreachableBlock,
    /// A cut under this code, G41 or G42, with a tool whose nose radius is 0.
    NoseRadiusZero(u8),
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
    /// The kind without its values.
    pub const fn lint(&self) -> Lint {
        match self {
            Self::SlowFeed => Lint::SlowFeed,
            Self::SpindleStopped => Lint::SpindleStopped,
            Self::NoOffset => Lint::NoOffset,
            Self::MachineZero => Lint::MachineZero,
            Self::EndElsewhere { .. } => Lint::EndElsewhere,
            Self::IgnoredWord(_) => Lint::IgnoredWord,
            Self::AfterSemicolon => Lint::AfterSemicolon,
            Self::AfterEnd => Lint::AfterEnd,
            Self::ColonName(_) => Lint::ColonName,
            Self::ThreadRunIn { .. } => Lint::ThreadRunIn,
            Self::ThreadSurfaceSpeed { .. } => Lint::ThreadSurfaceSpeed,
            Self::ThreadSpeedChanged { .. } => Lint::ThreadSpeedChanged,
            Self::ShortDwell(_) => Lint::ShortDwell,
            Self::NoseUncompensated(_) => Lint::NoseUncompensated,
            Self::UnreachableBlock => Lint::UnreachableBlock,
            Self::NoseRadiusZero(_) => Lint::NoseRadiusZero,
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
            Self::ThreadRunIn { programmed, needed } => say::caution_thread_run_in(
                format_args!("{programmed:.2}"),
                format_args!("{needed:.2}"),
            ),
            Self::ThreadSurfaceSpeed { .. } => say::caution_thread_surface_speed(),
            Self::ThreadSpeedChanged { before, now } => {
                say::caution_thread_speed_changed(before, now)
            }
            Self::ShortDwell(ms) => say::caution_short_dwell(ms, u64::from(*ms) * 1000),
            Self::NoseUncompensated(radius) => say::caution_nose_uncompensated(radius),
            Self::UnreachableBlock => say::caution_unreachable_block(),
            Self::NoseRadiusZero(code) => say::caution_nose_radius_zero(code),
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

    /// Adds cautions about a cut before it is executed: slow feed, stopped spindle, no offset,
    /// no nose radius compensation, or none to compensate. `is_sloped`: the cut is a taper or an arc.
    pub(super) fn check_cut(
        &mut self,
        command: &ControlCommand,
        feed: Option<Feed>,
        is_sloped: bool,
    ) {
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
        match command.modal.nose_compensation {
            40 if is_sloped => self.check_nose(command),
            40 => {}
            code => self.check_nose_radius(code, command),
        }
    }

    /// Adds a caution about a cut under G41 or G42 (`code`) with a tool whose nose radius is 0,
    /// if the offsets of other tools have radii: without any the radii are unknown.
    fn check_nose_radius(&mut self, code: u8, command: &ControlCommand) {
        let facts = ProgramFacts::TOOL.union(ProgramFacts::COMPENSATION);
        if self.has_nose_radii
            && self.offsets.get(command.modal.offset).r == 0.0
            && !self.has_caution(Lint::NoseRadiusZero)
            && self.is_certain(facts)
        {
            self.add_caution(CautionKind::NoseRadiusZero(code), command.source);
        }
    }

    /// Adds a caution about a taper or an arc that the nose radius of the tool cuts beside the
    /// programmed contour. Passes that rough are left out: the finish follows.
    fn check_nose(&mut self, command: &ControlCommand) {
        let radius = self.offsets.get(command.modal.offset).r;
        if radius <= 0.0
            || !self.is_certain(ProgramFacts::MOTION.union(ProgramFacts::COMPENSATION))
            || self.has_caution(Lint::NoseUncompensated)
        {
            return;
        }
        let words = split_line(self.line_text(command.source));
        let roughs = numbers_of(&words, b'G').any(|code| matches!(code, Some(71..=73)));
        if !roughs {
            let kind = CautionKind::NoseUncompensated(radius);
            self.add_caution(kind, command.source);
        }
    }

    /// Whether the list has a caution of a kind.
    pub(super) fn has_caution(&self, lint: Lint) -> bool {
        let mut cautions = self.preview.cautions.iter();
        cautions.any(|caution| caution.kind.lint() == lint)
    }

    pub(super) fn add_caution(&mut self, slip: CautionKind, source: SourcePosition) {
        if !self.has_caution(slip.lint()) {
            let cautions = &mut self.preview.cautions;
            cautions.push(Caution { kind: slip, source });
        }
    }

    /// Adds a caution at each block with the mistake, not only at the first one.
    fn add_each_caution(&mut self, slip: CautionKind, source: SourcePosition) {
        let caution = Caution { kind: slip, source };
        let cautions = &mut self.preview.cautions;
        let same = |other: &&Caution| other.kind.lint() == caution.kind.lint();
        if cautions.iter().filter(same).count() < MAX_CAUTIONS_PER_KIND
            && !cautions.contains(&caution)
        {
            cautions.push(caution);
        }
    }
}
