//! Finds the target of a jump by its sequence number: G65 H80–H86 (manual I-3.7.3), GOTO.
//!
//! ```text
//!   P n     searches forward from the block to the end, then from the beginning
//!   P -n    searches backward from the block to the beginning, then forward
//! ```

use gsk_messages::say;
use serde::{Deserialize, Serialize};

use crate::alarm::{Alarm, number};
use crate::interpreter::flow::program_position::ProgramPosition;
use crate::program::Program;

/// Number of jumps whose targets are stored, so that a loop searches its target once.
const REMEMBERED_JUMPS: usize = 8;

/// A jump that was searched before: its start, its P and the index of its target.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct KnownJump {
    from: ProgramPosition,
    p: i64,
    to: u32,
}

/// Finds the targets of jumps and stores the last ones, so that a loop searches its target
/// once.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct JumpTargets {
    known: [Option<KnownJump>; REMEMBERED_JUMPS],
    oldest: u8,
}

impl JumpTargets {
    /// Finds the block that a jump from `from` to the sequence number `p` leads to; returns
    /// its index, from 0. A negative `p` searches backward first.
    ///
    /// # Errors
    /// 128 if the number is out of range or missing in the program.
    pub(crate) fn find_target(
        &mut self,
        program: &Program,
        from: ProgramPosition,
        p: i64,
    ) -> Result<u32, Alarm> {
        let number = u32::try_from(p.unsigned_abs()).ok();
        let Some(number) = number.filter(|number| *number <= 9999) else {
            return Err(Alarm::new(number::BAD_JUMP).with_detail(say::jump_out_of_range(p)));
        };
        let known = self.known.iter().flatten();
        let mut known = known.filter(|known| known.from == from && known.p == p);
        // The operator may have edited the text since.
        if let Some(known) = known.find(|known| program.sequence(known.to) == Some(number)) {
            return Ok(known.to);
        }
        let Some(to) = search_sequence_block(program, from.block, number, p < 0) else {
            return Err(Alarm::new(number::BAD_JUMP).with_detail(say::jump_target_missing(number)));
        };
        let slot = usize::from(self.oldest) % REMEMBERED_JUMPS;
        self.known[slot] = Some(KnownJump { from, p, to });
        self.oldest = (slot + 1) as u8;
        Ok(to)
    }
}

fn search_sequence_block(program: &Program, from: u32, number: u32, backward: bool) -> Option<u32> {
    let is_target = |block: &u32| program.sequence(*block) == Some(number);
    let count = program.block_count();
    if backward {
        let mut earlier = (0..from).rev();
        return earlier
            .find(is_target)
            .or_else(|| (from..count).find(is_target));
    }
    let mut later = from.saturating_add(1)..count;
    later.find(is_target).or_else(|| (0..=from).find(is_target))
}
