//! Warns about words without effect in their block and about M codes that only the ladder
//! knows. Neither raises an alarm.

use gsk_core::command::SourcePosition;
use gsk_core::preview::Lint;
use gsk_core::program::ProgramBlock;
use gsk_messages::{Message, say};

use crate::block;
use crate::memory::MillMemory;
use crate::modal::{Hole, MillMotion};
use crate::state::MillState;
use crate::words::{BlockWords, OnOff, OneShotCode};

/// A probable mistake in a mill program that raises no alarm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MillSlip {
    /// No code of the block uses the word with this letter.
    WordWithoutEffect(char),
    /// Only the ladder knows this M code, so that its effect is not previewed.
    LadderCode(i64),
}

impl MillSlip {
    /// Returns the kind of warning without its value.
    pub const fn lint(self) -> Lint {
        match self {
            Self::WordWithoutEffect(_) => Lint::MillWord,
            Self::LadderCode(_) => Lint::LadderCode,
        }
    }

    /// Returns the message about the mistake.
    pub fn message(self) -> Message {
        match self {
            Self::WordWithoutEffect(letter) => say::caution_mill_word(letter),
            Self::LadderCode(code) => say::caution_mill_ladder_code(code),
        }
    }
}

/// A probable mistake with the block in which it occurs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MillCaution {
    /// The probable mistake.
    pub slip: MillSlip,
    /// Position of the first block with this mistake.
    pub source: SourcePosition,
}

impl MillCaution {
    /// Returns the message about the mistake, with its line.
    pub fn sentence(&self) -> Message {
        say::in_line(self.source.line, self.slip.message())
    }
}

/// Returns the probable mistakes in an executed block that is not a macro call. `state` is the
/// state after the block.
pub(crate) fn find_slips<'a>(
    block: &'a ProgramBlock,
    words: &'a BlockWords,
    state: &'a MillState,
    memory: &'a MillMemory,
) -> impl Iterator<Item = MillSlip> + 'a {
    let m = words.letters.m.map(gsk_core::program::WordNumber::integer);
    let ladder = m
        .filter(|code| block::is_ladder_code(*code, memory))
        .map(MillSlip::LadderCode);
    let written = block.words().iter();
    let unused = written.filter(move |word| !is_used(word.address, words, state, memory));
    let unused = unused.map(|word| MillSlip::WordWithoutEffect(char::from(word.address)));
    ladder.into_iter().chain(unused)
}

fn is_used(address: u8, words: &BlockWords, state: &MillState, memory: &MillMemory) -> bool {
    let one_shot = words.one_shot;
    let is = |code: OneShotCode| one_shot == Some(code);
    let arc = one_shot.is_none() && matches!(state.modal.motion, MillMotion::Arc { .. });
    let hole = state.modal.hole.filter(|_| one_shot.is_none());
    let scaling = words.scaling == Some(OnOff::On);
    let rotation = words.rotation == Some(OnOff::On);
    let calls = words.letters.m.is_some_and(|code| {
        let code = code.integer();
        matches!(code, 98 | 99) || memory.model.m_subprogram(code).is_some()
    });
    match address {
        b'X' => !is(OneShotCode::OffsetInput),
        b'Y' | b'Z' | b'A' | b'B' | b'C' => {
            !is(OneShotCode::OffsetInput) && !is(OneShotCode::Dwell)
        }
        b'I' | b'J' => arc || scaling,
        b'K' => arc || scaling || hole.is_some(),
        b'R' => arc && hole.is_none() || hole.is_some() || rotation || is(OneShotCode::OffsetInput),
        b'Q' => hole.is_some_and(takes_q),
        b'P' => {
            calls
                || scaling
                || words.additional
                || hole.is_some()
                || is(OneShotCode::Dwell)
                || is(OneShotCode::OffsetInput)
                || is(OneShotCode::FurtherReference)
        }
        // The call by an M code has taken it.
        b'L' if words.letters.l.is_none() => true,
        b'L' => calls || hole.is_some() || is(OneShotCode::OffsetInput),
        _ => true,
    }
}

/// Returns whether a cycle uses Q, as a depth or a shift.
const fn takes_q(hole: Hole) -> bool {
    matches!(
        hole,
        Hole::HighSpeedPeck
            | Hole::Peck
            | Hole::LeftTap
            | Hole::RightTap
            | Hole::FineBore
            | Hole::BackBore
    )
}
