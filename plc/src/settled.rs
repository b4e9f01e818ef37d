//! Which rungs need not run: those that changed nothing when they last ran, and of whose
//! bytes none has changed since.
//!
//! In a cut hardly any signal changes from slot to slot, so that nearly the whole ladder
//! gives what it gave before. A rung without jumps is a function of the bytes that it reads
//! and writes; as long as all of them stand, and running it has changed none of them,
//! running it again changes none either. (The time of a timer that runs is such a byte,
//! and changes in every slot. Whether a counter has seen its edge is none: a rung in which
//! one has just seen it, or its end, runs again.)
//! What a slot leaves is what it would leave if every rung ran.
//!
//! Rungs that write one another's bytes wake one another in every pass, though the pass
//! as a whole changes nothing: one clears a number, another sets it again. When a pass has
//! left memory, timers and counters as it found them, those rungs rest, too: until
//! something wakes a rung of that pass. Then all of them run, as what one of them leaves
//! for the next is seen by no comparison of memory before and after.

use core::ops::Range;

use crate::function::{RESULT_BITS, RESULT_OVERFLOW};
use crate::memory::{RESULT_FLAGS, SIZE};
use crate::reach::Reach;
use crate::timer::Timers;

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
    /// Rungs that must run when another one of their pass does.
    resting: Vec<u64>,
    /// Last ACT of each counter, when a rung last ran; empty before the first one.
    edges: Vec<bool>,
    /// The pass under way.
    pass: Pass,
    /// The result bits that each of the rungs with a comparison left when it last ran;
    /// `None`: it did not compare.
    left: Vec<Option<u8>>,
}

/// What a pass over the rungs of a level, or of a part of level 2, has found and changed.
#[derive(Debug, Default)]
struct Pass {
    timers: Timers,
    /// The ACT of a counter has changed.
    counted: bool,
    /// Bytes in the order in which they were changed, as they were before.
    changed: Vec<(u16, u8)>,
}

/// With more changes a pass is not looked at whether it changed something as a whole.
const CHANGES: usize = 64;

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
            self.resting.clear();
            self.resting.resize(reach.rungs().div_ceil(WORD), 0);
            self.edges.clear();
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

    /// Before a pass over these rungs: whether one of them must run. Those that rest run
    /// with it.
    pub fn begin_pass(&mut self, rungs: &Range<usize>, timers: Timers) -> bool {
        let awake = |word| self.awake.get(word).copied().unwrap_or(0);
        if masks(rungs).all(|(word, mask)| awake(word) & mask == 0) {
            return false;
        }
        hand_over(&mut self.resting, &mut self.awake, rungs);
        self.pass.timers = timers;
        self.pass.counted = false;
        self.pass.changed.clear();
        true
    }

    /// After a pass: if it has changed nothing as a whole, the rungs that it has woken for
    /// the next one rest.
    pub fn end_pass(&mut self, rungs: &Range<usize>, bytes: &[u8; SIZE], timers: Timers) {
        let pass = &self.pass;
        let first = |at: &u16| pass.changed.iter().find(|(first, _)| first == at);
        let found = |(at, _): &(u16, u8)| {
            first(at).is_some_and(|(_, before)| *before == bytes[usize::from(*at)])
        };
        let idle = pass.changed.len() <= CHANGES
            && pass.changed.iter().all(found)
            && pass.timers == timers
            && !pass.counted;
        if idle {
            hand_over(&mut self.awake, &mut self.resting, rungs);
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
    pub fn ran(&mut self, rung: usize, bytes: &[u8; SIZE], edges: &[bool], reach: &Reach) {
        if self.edges != edges {
            self.edges.clear();
            self.edges.extend_from_slice(edges);
            self.pass.counted = true;
            if let Some(word) = self.awake.get_mut(rung / WORD) {
                *word |= 1 << (rung % WORD);
            }
        }
        let Some(memory) = &mut self.memory else {
            return;
        };
        for at in reach.writes(rung) {
            let at = usize::from(*at);
            if memory[at] != bytes[at] {
                if self.pass.changed.len() <= CHANGES {
                    self.pass.changed.push((at as u16, memory[at]));
                }
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
        rungs: Range<usize>,
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

/// The words that the bits of these rungs stand in, and which bits of each.
fn masks(rungs: &Range<usize>) -> impl Iterator<Item = (usize, u64)> + use<> {
    let (start, end) = (rungs.start, rungs.end);
    (start / WORD..end.div_ceil(WORD)).map(move |word| {
        let from = start.saturating_sub(word * WORD).min(WORD);
        let to = (end - word * WORD).min(WORD);
        (word, ones(to) & !ones(from))
    })
}

/// The bits of these rungs go from one set to the other.
fn hand_over(from: &mut [u64], to: &mut [u64], rungs: &Range<usize>) {
    for (word, mask) in masks(rungs) {
        if let (Some(from), Some(to)) = (from.get_mut(word), to.get_mut(word)) {
            *to |= *from & mask;
            *from &= !mask;
        }
    }
}

/// So many ones, up to a word of them.
const fn ones(count: usize) -> u64 {
    if count < WORD {
        (1 << count) - 1
    } else {
        u64::MAX
    }
}

fn wake(awake: &mut [u64], rungs: &[u16]) {
    for rung in rungs {
        if let Some(word) = awake.get_mut(usize::from(*rung) / WORD) {
            *word |= 1 << (usize::from(*rung) % WORD);
        }
    }
}
