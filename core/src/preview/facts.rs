//! Tracks which facts are uncertain after a refused block. An alarm that may only be a
//! consequence of them is not reported.

use super::written::{Written, has, numbers};
use crate::alarm::number;
use crate::command::{Action, Command};

/// Facts about the state of the program at a block, one bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Facts(u16);

impl Facts {
    pub(super) const NONE: Self = Self(0);
    /// Position of the tool in X and in Z.
    pub(super) const X: Self = Self(1);
    pub(super) const Z: Self = Self(2);
    /// The active code of group 01.
    pub(super) const MOTION: Self = Self(4);
    /// The value of F, and its unit (G98, G99).
    pub(super) const FEED: Self = Self(8);
    pub(super) const PER: Self = Self(16);
    /// Direction of the spindle, and its speed.
    pub(super) const TURNING: Self = Self(32);
    pub(super) const SPEED: Self = Self(64);
    /// Tool and offset numbers.
    pub(super) const TOOL: Self = Self(128);
    /// Data that the first block of a cycle stores for the second.
    pub(super) const CYCLE: Self = Self(256);
    /// The lead of a thread.
    pub(super) const LEAD: Self = Self(512);
    /// Whether a contour is compensated.
    pub(super) const NOSE: Self = Self(1024);
    pub(super) const ALL: Self = Self(1023);

    pub(super) const fn and(self, others: Self) -> Self {
        Self(self.0 | others.0)
    }

    pub(super) const fn without(self, others: Self) -> Self {
        Self(self.0 & !others.0)
    }

    pub(super) const fn meets(self, others: Self) -> bool {
        self.0 & others.0 != 0
    }

    fn all(facts: impl Iterator<Item = Self>) -> Self {
        facts.fold(Self::NONE, Self::and)
    }

    /// The facts that words define for their own block and the later ones, even if they are
    /// wrong. `before` is the code of group 01 before the block.
    pub(super) fn given(words: &[Written], before: u8) -> Self {
        let thread = is_thread(words, before);
        Self::all(words.iter().map(|word| match word {
            (b'F' | b'I', _) if thread => Self::LEAD,
            (b'G', Some(code)) if is_motion(*code) => Self::MOTION.and(Self::CYCLE),
            (b'G', Some(98 | 99)) => Self::PER,
            (b'G', Some(40)) => Self::NOSE,
            (b'F', _) => Self::FEED,
            (b'S', _) => Self::SPEED,
            (b'M', Some(3..=5)) => Self::TURNING,
            (b'T', _) => Self::TOOL,
            _ => Self::NONE,
        }))
    }

    /// The facts that are unknown after a refused block with these words.
    pub(super) fn lost(words: &[Written]) -> Self {
        Self::all(words.iter().map(|word| match word {
            (b'X' | b'U', _) => Self::X,
            (b'Z' | b'W', _) => Self::Z,
            (b'G', Some(4 | 28 | 40 | 50)) => Self::NONE,
            (b'G', Some(41 | 42)) => Self::NOSE,
            // E is the lead on other controls, A the angle of a line.
            (b'F' | b'E', _) => Self::FEED.and(Self::LEAD),
            (b'A', _) => Self::X.and(Self::Z),
            (b'I', _) => Self::LEAD,
            (b'G', Some(70..=76)) => Self::CYCLE,
            (b'G', Some(96 | 97)) | (b'M', Some(41..=44)) => Self::SPEED,
            (b'G', Some(98 | 99)) => Self::PER,
            (b'G', _) => Self::MOTION.and(Self::CYCLE),
            (b'S' | b'M' | b'T', _) => Self::given(&[*word], 0),
            _ => Self::NONE,
        }))
    }

    /// The facts that an executed command defines: a move along a contour ends where its
    /// block says, and G50 sets the position of the tool.
    pub(super) fn reached(command: &Command, words: &[Written]) -> Self {
        let plain = |code| matches!(code, Some(0..=3 | 40..=42 | 96..=99));
        let named = |names: bool, axes| if names { axes } else { Self::NONE };
        let place = match &command.action {
            Action::Rapid { .. } | Action::Line { .. } | Action::Arc { .. } => {
                command.block_end && command.modal.motion <= 3 && numbers(words, b'G').all(plain)
            }
            Action::Frame { program_zero, .. } => program_zero.is_some(),
            _ => false,
        };
        named(place && has(words, b'X'), Self::X).and(named(place && has(words, b'Z'), Self::Z))
    }

    /// The facts that an alarm depends on besides the words of its block. `thread`: a thread
    /// raises it.
    pub(super) const fn behind(alarm: u16, thread: bool) -> Self {
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
            number::ARC_DATA | number::CYCLE_TAPER => Self::MOTION.and(Self::X).and(Self::Z),
            number::NO_FEED if thread => Self::MOTION.and(Self::LEAD),
            number::NO_FEED => Self::MOTION
                .and(Self::FEED)
                .and(Self::PER)
                .and(Self::TURNING)
                .and(Self::SPEED),
            1009 | 1010 | 1012 => Self::TURNING,
            34 | 36 | 46..=59 => Self::ALL.and(Self::NOSE),
            _ => Self::ALL,
        }
    }
}

/// Whether a block cuts a thread, so that its F is a lead.
pub(super) fn is_thread(words: &[Written], before: u8) -> bool {
    let mut codes = numbers(words, b'G').flatten();
    let motion = codes.clone().rfind(|code| is_motion(*code));
    let motion = motion.unwrap_or_else(|| u32::from(before));
    matches!(motion, 32..=34 | 92) || codes.any(|code| code == 76)
}

/// Whether a G code belongs to group 01.
const fn is_motion(code: u32) -> bool {
    matches!(code, 0..=3 | 32..=34 | 90 | 92 | 94)
}

#[cfg(test)]
mod tests {
    use super::super::written::words;
    use super::*;

    #[test]
    fn a_refused_block_leaves_its_words_in_doubt() {
        let lost = |line| Facts::lost(&words(line));
        assert_eq!(lost("N10 G54"), Facts::MOTION.and(Facts::CYCLE));
        assert_eq!(lost("G00 U2 F100 (Z5)").0, 1 | 4 | 8 | 256 | 512);
        assert_eq!(lost("G04 Q1"), Facts::NONE);
        assert_eq!(
            Facts::given(&words("M03 S500 G99"), 0),
            Facts::TURNING.and(Facts::SPEED).and(Facts::PER)
        );
    }

    #[test]
    fn a_lead_is_no_feed() {
        let feeds = |line, before| Facts::given(&words(line), before).meets(Facts::FEED);
        assert!(feeds("X5 F100", 1) && feeds("G01 X5 F100", 92));
        assert!(Facts::given(&words("X5 F2"), 92).meets(Facts::LEAD));
        assert!(!feeds("X5 F2", 92) && !feeds("G32 Z5 F2", 0) && !feeds("G76 X5 F2", 0));
    }

    #[test]
    fn wrong_words_need_nothing_else() {
        let behind = |alarm| Facts::behind(alarm, false);
        assert!(!Facts::ALL.meets(behind(10)));
        assert!(Facts::FEED.meets(behind(11)) && !Facts::X.meets(behind(11)));
        assert!(Facts::LEAD.meets(Facts::behind(11, true)) && !Facts::LEAD.meets(behind(11)));
        assert!(Facts::X.meets(behind(13)));
    }
}
