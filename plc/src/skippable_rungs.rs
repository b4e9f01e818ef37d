//! Tracks which rungs the scan may skip: those that changed nothing in their last run and
//! whose bytes have not changed since.
//!
//! During a cut few signals change from slot to slot, so that nearly all rungs give their
//! previous result. The effect of a rung without jumps depends only on the bytes that it
//! reads and writes. While these do not change and its last run changed none of them,
//! another run changes nothing. The value of a running timer is such a byte, and it changes
//! in every slot. The previous input of a counter is not a byte: a rung runs again after
//! the input of its counter has changed. A slot leaves the same memory as if every rung
//! ran.
//!
//! Rungs that write each other's bytes wake each other in every pass, even if the pass as a
//! whole changes nothing: one clears a number and another sets it again. If a pass has left
//! memory, timers and counters unchanged, its rungs rest until something wakes one of them.
//! Then all of them run, because a comparison of memory before and after the pass does not
//! show what one rung writes for the next.

use core::ops::Range;

use crate::function::{RESULT_BITS, RESULT_OVERFLOW};
use crate::memory::{RESULT_FLAGS, SIZE};
use crate::rung_dependencies::RungDependencies;
use crate::timer::Timers;

/// Number of rungs that one word of a bit set stores.
const RUNGS_PER_WORD: usize = u64::BITS as usize;
/// Size of a large block in which memory is compared, bytes; blocks that differ are compared in
/// small blocks of `SUBCHUNK_BYTES`.
const CHUNK_BYTES: usize = 1024;
const SUBCHUNK_BYTES: usize = 32;

/// The rungs that must run in the next slot, and the memory contents for which this is known; empty
/// if unknown.
///
/// This is a cache and not part of the PLC's state: it is not serialized, all values are equal, and
/// a clone is empty.
#[derive(Debug, Default)]
pub(crate) struct SkippableRungs {
    /// Copy of PLC memory at the last update; `None` if unknown.
    memory: Option<Box<[u8; SIZE]>>,
    /// Bit set of the rungs that must run.
    awake: Vec<u64>,
    /// Bit set of the rungs that must run only if another rung of their pass runs.
    resting: Vec<u64>,
    /// Input state (ACT) of each counter after the last run of a rung; empty before the
    /// first.
    counter_inputs: Vec<bool>,
    /// Changes of memory, timers and counters in the current pass.
    pass: RungPass,
    /// For each rung with a comparison, the result flags that it wrote in its last run; `None` if
    /// it did not compare.
    result_flags: Vec<Option<u8>>,
}

/// The changes of one pass through the rungs of level 1 or of a part of level 2.
#[derive(Debug, Default)]
struct RungPass {
    timers: Timers,
    /// Whether the input (ACT) of any counter has changed in the pass.
    counter_input_changed: bool,
    /// Index and previous value of each changed byte, in the order of the changes.
    changed: Vec<(u16, u8)>,
}

/// Greatest number of changes in a pass for which it is checked whether the pass as a whole changed
/// nothing.
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
    /// Marks all rungs as rungs that must run, after a change that the scan did not make.
    pub fn invalidate(&mut self) {
        self.memory = None;
    }

    /// Returns whether the memory at the last slot is known, so that changes can be found.
    pub fn is_tracking(&self) -> bool {
        self.memory.is_some()
    }

    /// Marks the rungs that use bytes changed outside the scan as rungs that must run. Call it
    /// before a slot.
    ///
    /// `written` is the length, from the start of memory, in which bytes may have changed.
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

    /// Returns false if none of `rungs` must run. Otherwise starts a pass through them, in which
    /// also the rungs run that were skipped because of a pass without changes.
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

    /// Ends a pass through `rungs`. If the pass as a whole has changed nothing, its rungs need not
    /// run again until one of their bytes changes.
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

    /// Returns the next rung that must run, from `rung` to before `end`, and marks it as done;
    /// `None` if there is none.
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

    /// Records the run of a rung. All rungs that use a byte changed by it, including the rung
    /// itself, must run again.
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

    /// Sets R900 to a value that no comparison writes, to find out whether the next rung compares.
    pub fn mark_result_flags(bytes: &mut [u8; SIZE]) {
        bytes[RESULT_FLAGS] |= RESULT_OVERFLOW;
    }

    /// Records the result flags that the comparison with this index has written, if it has
    /// run.
    pub fn record_comparison(&mut self, number: usize, bytes: &[u8; SIZE]) {
        let flags = bytes[RESULT_FLAGS];
        if let Some(result_flags) = self.result_flags.get_mut(number) {
            *result_flags = (flags & RESULT_OVERFLOW == 0).then_some(flags & RESULT_BITS);
        }
    }

    /// Writes the result flags of the last comparison in `rungs` to R900 after a pass, or
    /// the flags `before` the pass if there is none.
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

/// Returns the words of a bit set that contain these rungs, each with the mask of their
/// bits.
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

/// Moves the bits of these rungs from one bit set to the other.
fn move_rungs(from: &mut [u64], to: &mut [u64], rungs: &Range<usize>) {
    for (word, mask) in rung_masks(rungs) {
        if let (Some(from), Some(to)) = (from.get_mut(word), to.get_mut(word)) {
            *to |= *from & mask;
            *from &= !mask;
        }
    }
}

/// Returns a word with its lowest `count` bits set; all bits if `count` is larger than a
/// word.
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
