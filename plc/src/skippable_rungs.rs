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
use crate::rung_dependencies::RungDependencies;
use crate::timer::Timers;

/// Rungs per word.
const RUNGS_PER_WORD: usize = u64::BITS as usize;
/// Bytes that are compared at once, and those of a difference.
const CHUNK_BYTES: usize = 1024;
const SUBCHUNK_BYTES: usize = 32;

/// What is known of the rungs; empty when nothing is. It is not part of the PLC's state:
/// any two are equal, none is saved, and a copy begins with nothing.
#[derive(Debug, Default)]
pub(crate) struct SkippableRungs {
    /// Memory as it was when its changes were last followed.
    memory: Option<Box<[u8; SIZE]>>,
    /// Rungs that must run, one bit each.
    awake: Vec<u64>,
    /// Rungs that must run when another one of their pass does.
    resting: Vec<u64>,
    /// Last ACT of each counter, when a rung last ran; empty before the first one.
    counter_inputs: Vec<bool>,
    /// The pass under way.
    pass: RungPass,
    /// The result bits that each of the rungs with a comparison left when it last ran;
    /// `None`: it did not compare.
    result_flags: Vec<Option<u8>>,
}

/// What a pass over the rungs of a level, or of a part of level 2, has found and changed.
#[derive(Debug, Default)]
struct RungPass {
    timers: Timers,
    /// The ACT of a counter has changed.
    counter_input_changed: bool,
    /// Bytes in the order in which they were changed, as they were before.
    changed: Vec<(u16, u8)>,
}

/// With more changes a pass is not looked at whether it changed something as a whole.
const MAX_PASS_CHANGES: usize = 64;

impl Clone for SkippableRungs {
    fn clone(&self) -> SkippableRungs {
        SkippableRungs::default()
    }
}

impl PartialEq for SkippableRungs {
    fn eq(&self, _: &SkippableRungs) -> bool {
        true
    }
}

impl SkippableRungs {
    /// Every rung must run again: something other than a scan has been at work.
    pub fn invalidate(&mut self) {
        self.memory = None;
    }

    /// Whether the changes since the last slot are known.
    pub fn is_tracking(&self) -> bool {
        self.memory.is_some()
    }

    /// Before a slot: wakes the rungs that outside changes of memory concern.
    ///
    /// `written`: bytes of memory, from the first on, that may have been changed.
    pub fn apply_memory_changes(
        &mut self,
        bytes: &[u8; SIZE],
        written: usize,
        dependencies: &RungDependencies,
    ) {
        let Some(memory) = &mut self.memory else {
            self.memory = Some(Box::new(*bytes));
            self.awake.clear();
            self.awake
                .resize(dependencies.rung_count().div_ceil(RUNGS_PER_WORD), u64::MAX);
            self.resting.clear();
            self.resting
                .resize(dependencies.rung_count().div_ceil(RUNGS_PER_WORD), 0);
            self.counter_inputs.clear();
            self.result_flags.clear();
            self.result_flags
                .resize(dependencies.comparison_count(), None);
            return;
        };
        for start in (0..written).step_by(CHUNK_BYTES) {
            let chunk = start..(start + CHUNK_BYTES).min(written);
            if memory[chunk.clone()] == bytes[chunk.clone()] {
                continue;
            }
            for start in chunk.clone().step_by(SUBCHUNK_BYTES) {
                let subchunk = start..(start + SUBCHUNK_BYTES).min(chunk.end);
                if memory[subchunk.clone()] == bytes[subchunk.clone()] {
                    continue;
                }
                for at in subchunk {
                    if memory[at] != bytes[at] {
                        memory[at] = bytes[at];
                        wake_rungs(&mut self.awake, dependencies.rungs_using(at));
                    }
                }
            }
        }
    }

    /// Before a pass over these rungs: whether one of them must run. Those that rest run
    /// with it.
    pub fn begin_pass(&mut self, rungs: &Range<usize>, timers: Timers) -> bool {
        let awake = |word| self.awake.get(word).copied().unwrap_or(0);
        if rung_masks(rungs).all(|(word, mask)| awake(word) & mask == 0) {
            return false;
        }
        move_rungs(&mut self.resting, &mut self.awake, rungs);
        self.pass.timers = timers;
        self.pass.counter_input_changed = false;
        self.pass.changed.clear();
        true
    }

    /// After a pass: if it has changed nothing as a whole, the rungs that it has woken for
    /// the next one rest.
    pub fn end_pass(&mut self, rungs: &Range<usize>, bytes: &[u8; SIZE], timers: Timers) {
        let pass = &self.pass;
        let first = |at: &u16| pass.changed.iter().find(|(first, _)| first == at);
        let is_restored = |(at, _): &(u16, u8)| {
            first(at).is_some_and(|(_, before)| *before == bytes[usize::from(*at)])
        };
        let idle = pass.changed.len() <= MAX_PASS_CHANGES
            && pass.changed.iter().all(is_restored)
            && pass.timers == timers
            && !pass.counter_input_changed;
        if idle {
            move_rungs(&mut self.awake, &mut self.resting, rungs);
        }
    }

    /// The next rung from `rung` on, before `end`, that must run; it then counts as done.
    pub fn take_next_awake(&mut self, rung: usize, end: usize) -> Option<usize> {
        let mut word = rung / RUNGS_PER_WORD;
        let mut of_word = self.awake.get(word)? & (u64::MAX << (rung % RUNGS_PER_WORD));
        while of_word == 0 {
            word += 1;
            if word * RUNGS_PER_WORD >= end {
                return None;
            }
            of_word = *self.awake.get(word)?;
        }
        let bit = of_word.trailing_zeros();
        let next = word * RUNGS_PER_WORD + bit as usize;
        if next >= end {
            return None;
        }
        self.awake[word] &= !(1 << bit);
        Some(next)
    }

    /// After a rung has run: wakes the rungs, itself among them, that its changes concern.
    pub fn record_run(
        &mut self,
        rung: usize,
        bytes: &[u8; SIZE],
        counter_inputs: &[bool],
        dependencies: &RungDependencies,
    ) {
        if self.counter_inputs != counter_inputs {
            self.counter_inputs.clear();
            self.counter_inputs.extend_from_slice(counter_inputs);
            self.pass.counter_input_changed = true;
            if let Some(word) = self.awake.get_mut(rung / RUNGS_PER_WORD) {
                *word |= 1 << (rung % RUNGS_PER_WORD);
            }
        }
        let Some(memory) = &mut self.memory else {
            return;
        };
        for at in dependencies.written_bytes(rung) {
            let at = usize::from(*at);
            if memory[at] != bytes[at] {
                if self.pass.changed.len() <= MAX_PASS_CHANGES {
                    self.pass.changed.push((at as u16, memory[at]));
                }
                memory[at] = bytes[at];
                wake_rungs(&mut self.awake, dependencies.rungs_using(at));
            }
        }
    }

    /// Before a rung with a comparison runs: no comparison leaves R900 like this.
    pub fn mark_result_flags(bytes: &mut [u8; SIZE]) {
        bytes[RESULT_FLAGS] |= RESULT_OVERFLOW;
    }

    /// After the comparison of that number: what it has left.
    pub fn record_comparison(&mut self, number: usize, bytes: &[u8; SIZE]) {
        let flags = bytes[RESULT_FLAGS];
        if let Some(result_flags) = self.result_flags.get_mut(number) {
            *result_flags = (flags & RESULT_OVERFLOW == 0).then_some(flags & RESULT_BITS);
        }
    }

    /// After the last of some rungs: R900 as the last comparison among them leaves it,
    /// or as it was before.
    pub fn write_result_flags(
        &mut self,
        rungs: Range<usize>,
        before: u8,
        bytes: &mut [u8; SIZE],
        dependencies: &RungDependencies,
    ) {
        let first = dependencies.comparison_count_before(rungs.start);
        let result_flags = self
            .result_flags
            .get(first..dependencies.comparison_count_before(rungs.end));
        let last = result_flags.and_then(|result_flags| {
            result_flags
                .iter()
                .rev()
                .find_map(|result_flags| *result_flags)
        });
        bytes[RESULT_FLAGS] = last.map_or(before, |bits| before & !RESULT_BITS | bits);
        if let Some(memory) = &mut self.memory {
            memory[RESULT_FLAGS] = bytes[RESULT_FLAGS];
        }
    }
}

/// The words that the bits of these rungs stand in, and which bits of each.
fn rung_masks(rungs: &Range<usize>) -> impl Iterator<Item = (usize, u64)> + use<> {
    let (start, end) = (rungs.start, rungs.end);
    (start / RUNGS_PER_WORD..end.div_ceil(RUNGS_PER_WORD)).map(move |word| {
        let from = start
            .saturating_sub(word * RUNGS_PER_WORD)
            .min(RUNGS_PER_WORD);
        let to = (end - word * RUNGS_PER_WORD).min(RUNGS_PER_WORD);
        (word, low_bits(to) & !low_bits(from))
    })
}

/// The bits of these rungs go from one set to the other.
fn move_rungs(from: &mut [u64], to: &mut [u64], rungs: &Range<usize>) {
    for (word, mask) in rung_masks(rungs) {
        if let (Some(from), Some(to)) = (from.get_mut(word), to.get_mut(word)) {
            *to |= *from & mask;
            *from &= !mask;
        }
    }
}

/// So many ones, up to a word of them.
const fn low_bits(count: usize) -> u64 {
    if count < RUNGS_PER_WORD {
        (1 << count) - 1
    } else {
        u64::MAX
    }
}

fn wake_rungs(awake: &mut [u64], rungs: &[u16]) {
    for rung in rungs {
        if let Some(word) = awake.get_mut(usize::from(*rung) / RUNGS_PER_WORD) {
            *word |= 1 << (usize::from(*rung) % RUNGS_PER_WORD);
        }
    }
}
