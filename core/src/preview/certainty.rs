//! Tracks which facts are uncertain after a refused block. An alarm that may only be a
//! consequence of them is not reported.

use super::line_words::{WrittenWord, has_letter, numbers_of};
use crate::alarm::number;
use crate::command::{Action, ControlCommand, MotionCode};

/// Set of facts about the state of the program at a block, one bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct ProgramFacts(u16);

impl ProgramFacts {
    pub(super) const NONE: Self = Self(0);
    /// Position of the tool in X; the next one in Z.
    pub(super) const X: Self = Self(1);
    pub(super) const Z: Self = Self(2);
    /// Bit for the active G code of group 01.
    pub(super) const MOTION: Self = Self(4);
    /// The value of F; the next one its unit (G98, G99).
    pub(super) const FEED: Self = Self(8);
    pub(super) const FEED_UNIT: Self = Self(16);
    /// Direction of the spindle; the next one its speed.
    pub(super) const SPINDLE_DIRECTION: Self = Self(32);
    pub(super) const SPINDLE_SPEED: Self = Self(64);
    /// Bit for the active tool number and offset number.
    pub(super) const TOOL: Self = Self(128);
    /// Data that the first block of a cycle stores for the second.
    pub(super) const CYCLE: Self = Self(256);
    /// Bit for the lead of a thread.
    pub(super) const LEAD: Self = Self(512);
    /// Bit for the nose radius compensation of a contour.
    pub(super) const COMPENSATION: Self = Self(1024);
    pub(super) const ALL: Self = Self(1023);

    pub(super) const fn union(self, others: Self) -> Self {
        Self(self.0 | others.0)
    }

    pub(super) const fn minus(self, others: Self) -> Self {
        Self(self.0 & !others.0)
    }

    pub(super) const fn intersects(self, others: Self) -> bool {
        self.0 & others.0 != 0
    }

    fn union_all(facts: impl Iterator<Item = Self>) -> Self {
        facts.fold(Self::NONE, Self::union)
    }

    /// The facts that the words of a block define for this block and later ones, even if the
    /// words are wrong. `before` is the code of group 01 before the block.
    pub(super) fn defined_by(words: &[WrittenWord], before: MotionCode) -> Self {
        let thread = is_thread(words, before);
        Self::union_all(words.iter().map(|word| match word {
            (b'F' | b'I', _) if thread => Self::LEAD,
            (b'G', Some(code)) if MotionCode::from_number(*code).is_some() => {
                Self::MOTION.union(Self::CYCLE)
            }
            (b'G', Some(98 | 99)) => Self::FEED_UNIT,
            (b'G', Some(40)) => Self::COMPENSATION,
            (b'F', _) => Self::FEED,
            (b'S', _) => Self::SPINDLE_SPEED,
            (b'M', Some(3..=5)) => Self::SPINDLE_DIRECTION,
            (b'T', _) => Self::TOOL,
            _ => Self::NONE,
        }))
    }

    /// The facts that are uncertain after a refused block with the words `words`.
    pub(super) fn uncertain_after(words: &[WrittenWord]) -> Self {
        Self::union_all(words.iter().map(|word| match word {
            (b'X' | b'U', _) => Self::X,
            (b'Z' | b'W', _) => Self::Z,
            (b'G', Some(4 | 28 | 40 | 50)) => Self::NONE,
            (b'G', Some(41 | 42)) => Self::COMPENSATION,
            // E is the lead on other controls, A the angle of a line.
            (b'F' | b'E', _) => Self::FEED.union(Self::LEAD),
            (b'A', _) => Self::X.union(Self::Z),
            (b'I', _) => Self::LEAD,
            (b'G', Some(70..=76)) => Self::CYCLE,
            (b'G', Some(96 | 97)) | (b'M', Some(41..=44)) => Self::SPINDLE_SPEED,
            (b'G', Some(98 | 99)) => Self::FEED_UNIT,
            (b'G', _) => Self::MOTION.union(Self::CYCLE),
            (b'S' | b'M' | b'T', _) => Self::defined_by(&[*word], MotionCode::Rapid),
            _ => Self::NONE,
        }))
    }

    /// The position facts that an executed command makes certain: a move along a contour ends
    /// where its block specifies, and G50 sets the position of the tool.
    pub(super) fn confirmed_by(command: &ControlCommand, words: &[WrittenWord]) -> Self {
        let plain = |code| matches!(code, Some(0..=3 | 40..=42 | 96..=99));
        let axes_if = |names: bool, axes| if names { axes } else { Self::NONE };
        let is_position_known = match &command.action {
            Action::Rapid { .. } | Action::Line { .. } | Action::Arc { .. } => {
                command.block_end
                    && command.modal.motion.is_contour()
                    && numbers_of(words, b'G').all(plain)
            }
            Action::Frame { program_zero, .. } => program_zero.is_some(),
            _ => false,
        };
        axes_if(is_position_known && has_letter(words, b'X'), Self::X).union(axes_if(
            is_position_known && has_letter(words, b'Z'),
            Self::Z,
        ))
    }

    /// The facts, besides the words of its block, on which an alarm depends. `thread` is
    /// whether the block cuts a thread.
    pub(super) const fn required_by(alarm: u16, thread: bool) -> Self {
        match alarm {
            number::BAD_VALUE
            | number::NO_VALUE..=number::BAD_POINT
            | number::BAD_G
            | number::TOO_MANY_WORDS
            | number::EMPTY_G50
            | number::ADDRESS_TWICE
            | number::BAD_M
            | number::G_CONFLICT
            | number::TOOL_TOO_GREAT
            | number::BAD_OFFSET
            | number::PROGRAM_MISSING
            | number::BAD_TOOL
            | number::PROFILE_WORDS
            | number::PROFILE_MISSING
            | number::CALL_WITHOUT_P
            | number::TARGET_MISSING
            | number::ZERO_UNDEFINED
            | number::NO_TAILSTOCK
            | number::NO_CHUCK => Self::NONE,
            number::NEGATIVE_RADIUS | number::ENCODER_LINES => Self::MOTION,
            number::ARC_DATA | number::CYCLE_TAPER => Self::MOTION.union(Self::X).union(Self::Z),
            number::NO_FEED if thread => Self::MOTION.union(Self::LEAD),
            number::NO_FEED => Self::MOTION
                .union(Self::FEED)
                .union(Self::FEED_UNIT)
                .union(Self::SPINDLE_DIRECTION)
                .union(Self::SPINDLE_SPEED),
            1009 | 1010 | 1012 => Self::SPINDLE_DIRECTION,
            34 | 36 | 46..=59 => Self::ALL.union(Self::COMPENSATION),
            _ => Self::ALL,
        }
    }
}

/// Whether a block cuts a thread, so that its F is a lead. `before` is the code of group 01
/// before the block.
pub(super) fn is_thread(words: &[WrittenWord], before: MotionCode) -> bool {
    let mut codes = numbers_of(words, b'G').flatten();
    let motion = codes
        .clone()
        .filter_map(MotionCode::from_number)
        .next_back();
    motion.unwrap_or(before).is_thread() || codes.any(|code| code == 76)
}

#[cfg(test)]
mod tests {
    use super::super::line_words::split_line;
    use super::*;

    #[test]
    fn a_refused_block_makes_its_words_uncertain() {
        let uncertain = |line| ProgramFacts::uncertain_after(&split_line(line));
        assert_eq!(
            uncertain("N10 G54"),
            ProgramFacts::MOTION.union(ProgramFacts::CYCLE)
        );
        assert_eq!(uncertain("G00 U2 F100 (Z5)").0, 1 | 4 | 8 | 256 | 512);
        assert_eq!(uncertain("G04 Q1"), ProgramFacts::NONE);
        assert_eq!(
            ProgramFacts::defined_by(&split_line("M03 S500 G99"), MotionCode::Rapid),
            ProgramFacts::SPINDLE_DIRECTION
                .union(ProgramFacts::SPINDLE_SPEED)
                .union(ProgramFacts::FEED_UNIT)
        );
    }

    #[test]
    fn a_lead_is_no_feed() {
        let feeds = |line, before| {
            ProgramFacts::defined_by(&split_line(line), before).intersects(ProgramFacts::FEED)
        };
        assert!(
            feeds("X5 F100", MotionCode::Line) && feeds("G01 X5 F100", MotionCode::ThreadCycle)
        );
        assert!(
            ProgramFacts::defined_by(&split_line("X5 F2"), MotionCode::ThreadCycle)
                .intersects(ProgramFacts::LEAD)
        );
        assert!(
            !feeds("X5 F2", MotionCode::ThreadCycle)
                && !feeds("G32 Z5 F2", MotionCode::Rapid)
                && !feeds("G76 X5 F2", MotionCode::Rapid)
        );
    }

    #[test]
    fn wrong_words_need_nothing_else() {
        let required = |alarm| ProgramFacts::required_by(alarm, false);
        assert!(!ProgramFacts::ALL.intersects(required(10)));
        assert!(
            ProgramFacts::FEED.intersects(required(11))
                && !ProgramFacts::X.intersects(required(11))
        );
        assert!(
            ProgramFacts::LEAD.intersects(ProgramFacts::required_by(11, true))
                && !ProgramFacts::LEAD.intersects(required(11))
        );
        assert!(ProgramFacts::X.intersects(required(13)));
    }
}
