//! Which rungs need not run: those that changed nothing when they last ran, and of whose
//! bytes none has changed since.
//!
//! In a cut hardly any signal changes from slot to slot, so that nearly the whole ladder
//! gives what it gave before. A rung without jumps is a function of the bytes that it reads
//! and writes; as long as all of them stand, and running it has changed none of them,
//! running it again changes none either. (The time of a timer that runs is such a byte,
//! and changes in every slot; a counter that has seen its edge counts no second time.)
//! What a slot leaves is what it would leave if every rung ran.

use crate::function::{RESULT_BITS, RESULT_OVERFLOW};
use crate::memory::{RESULT_FLAGS, SIZE};
use crate::reach::Reach;

/// Rungs per word.
const WORD: usize = u64::BITS as usize;
/// Bytes that are compared at once, and those of a difference.
const CHUNK: usize = 1024;
const PIECE: usize = 32;

/// What is known of the rungs; empty when nothing is. It is not part of the PLC's state:
/// any two are equal, none is saved, and a copy begins with nothing.
#[derive(Debug, Default)]
pub(crate) struct Settled {
    /// Memory as it was when its changes were last followed.
    memory: Option<Box<[u8; SIZE]>>,
    /// Rungs that must run, one bit each.
    awake: Vec<u64>,
    /// The result bits that each of the rungs with a comparison left when it last ran;
    /// `None`: it did not compare.
    left: Vec<Option<u8>>,
}

impl Clone for Settled {
    fn clone(&self) -> Settled {
        Settled::default()
    }
}

impl PartialEq for Settled {
    fn eq(&self, _: &Settled) -> bool {
        true
    }
}

impl Settled {
    /// Every rung must run again: something other than a scan has been at work.
    pub fn forget(&mut self) {
        self.memory = None;
    }

    /// Whether the changes since the last slot are known.
    pub fn follows(&self) -> bool {
        self.memory.is_some()
    }

    /// Before a slot: wakes the rungs that outside changes of memory concern.
    ///
    /// `written`: bytes of memory, from the first on, that may have been changed.
    pub fn follow(&mut self, bytes: &[u8; SIZE], written: usize, reach: &Reach) {
        let Some(memory) = &mut self.memory else {
            self.memory = Some(Box::new(*bytes));
            self.awake.clear();
            self.awake.resize(reach.rungs().div_ceil(WORD), u64::MAX);
            self.left.clear();
            self.left.resize(reach.comparisons(), None);
            return;
        };
        for begin in (0..written).step_by(CHUNK) {
            let chunk = begin..(begin + CHUNK).min(written);
            if memory[chunk.clone()] == bytes[chunk.clone()] {
                continue;
            }
            for begin in chunk.clone().step_by(PIECE) {
                let piece = begin..(begin + PIECE).min(chunk.end);
                if memory[piece.clone()] == bytes[piece.clone()] {
                    continue;
                }
                for at in piece {
                    if memory[at] != bytes[at] {
                        memory[at] = bytes[at];
                        wake(&mut self.awake, reach.concerned(at));
                    }
                }
            }
        }
    }

    /// The next rung from `rung` on, before `end`, that must run; it then counts as done.
    pub fn take_next(&mut self, rung: usize, end: usize) -> Option<usize> {
        let mut word = rung / WORD;
        let mut of_word = self.awake.get(word)? & (u64::MAX << (rung % WORD));
        while of_word == 0 {
            word += 1;
            if word * WORD >= end {
                return None;
            }
            of_word = *self.awake.get(word)?;
        }
        let bit = of_word.trailing_zeros();
        let next = word * WORD + bit as usize;
        if next >= end {
            return None;
        }
        self.awake[word] &= !(1 << bit);
        Some(next)
    }

    /// After a rung has run: wakes the rungs, itself among them, that its changes concern.
    pub fn ran(&mut self, rung: usize, bytes: &[u8; SIZE], reach: &Reach) {
        let Some(memory) = &mut self.memory else {
            return;
        };
        for at in reach.writes(rung) {
            let at = usize::from(*at);
            if memory[at] != bytes[at] {
                memory[at] = bytes[at];
                wake(&mut self.awake, reach.concerned(at));
            }
        }
    }

    /// Before a rung with a comparison runs: no comparison leaves R900 like this.
    pub fn before_comparison(bytes: &mut [u8; SIZE]) {
        bytes[RESULT_FLAGS] |= RESULT_OVERFLOW;
    }

    /// After the comparison of that number: what it has left.
    pub fn compared(&mut self, number: usize, bytes: &[u8; SIZE]) {
        let flags = bytes[RESULT_FLAGS];
        if let Some(left) = self.left.get_mut(number) {
            *left = (flags & RESULT_OVERFLOW == 0).then_some(flags & RESULT_BITS);
        }
    }

    /// After the last of some rungs: R900 as the last comparison among them leaves it,
    /// or as it was before.
    pub fn leave_result(
        &mut self,
        rungs: core::ops::Range<usize>,
        before: u8,
        bytes: &mut [u8; SIZE],
        reach: &Reach,
    ) {
        let first = reach.comparisons_before(rungs.start);
        let left = self.left.get(first..reach.comparisons_before(rungs.end));
        let last = left.and_then(|left| left.iter().rev().find_map(|left| *left));
        bytes[RESULT_FLAGS] = last.map_or(before, |bits| before & !RESULT_BITS | bits);
        if let Some(memory) = &mut self.memory {
            memory[RESULT_FLAGS] = bytes[RESULT_FLAGS];
        }
    }
}

fn wake(awake: &mut [u64], rungs: &[u16]) {
    for rung in rungs {
        if let Some(word) = awake.get_mut(usize::from(*rung) / WORD) {
            *word |= 1 << (usize::from(*rung) % WORD);
        }
    }
}
