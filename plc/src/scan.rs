//! Scans the ladder in slots of 8 ms: the whole of level 1 and one part of level 2.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

use crate::check::MAX_CALL_DEPTH;
use crate::code::{Code, MemoryBit, Op};
use crate::force::Forces;
use crate::function::{FunctionState, execute};
use crate::ladder::Ladder;
use crate::memory::{PlcMemory, RESULT_FLAGS, SIZE};
use crate::rung_dependencies::RungDependencies;
use crate::scan_position::{ScanPosition, ScanStop};
use crate::skippable_rungs::SkippableRungs;
use crate::timer::{SLOT_MS, Timers};

/// Number of operations in one slot at which the watchdog stops the PLC.
const MAX_SLOT_OPERATIONS: usize = 100_000;

/// The reason why the PLC has stopped until the next power-on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum PlcFault {
    /// Watchdog: jumps kept one slot running for more than 100000 instructions.
    Watchdog {
        /// Line of the jump that was executed when the watchdog stopped the scan, from 1.
        line: u32,
    },
}

impl PlcFault {
    /// Returns the message that names the line at which the watchdog stopped the ladder.
    #[must_use]
    pub fn message(&self) -> Message {
        match self {
            Self::Watchdog { line } => say::ladder_loops(line),
        }
    }
}

impl fmt::Display for PlcFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.message().fmt(f)
    }
}

impl std::error::Error for PlcFault {}

/// A PLC: a ladder, its memory and the state of its scan.
///
/// The CNC writes X and F, calls [`Plc::run_slot`] every 8 ms, and reads G and Y.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plc {
    pub(crate) ladder: Arc<Ladder>,
    pub(crate) memory: PlcMemory,
    pub(crate) state: ScanState,
    /// Tracks which rungs the scan may skip because their result cannot change.
    #[serde(skip)]
    pub(crate) skippable: SkippableRungs,
}

/// State of the scan that is not in PLC memory.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct ScanState {
    /// Index of the part of level 2 that the next slot runs, from 0.
    part: usize,
    /// First operation of level 2 in the next slot after a jump beyond the end of a part.
    #[serde(rename = "resume")]
    resume_at: usize,
    timers: Timers,
    /// Previous input state (ACT) of each CTRC.
    #[serde(rename = "edges")]
    counter_inputs: Vec<bool>,
    pub fault: Option<PlcFault>,
    /// Bits that the operator has forced to a value.
    #[serde(default)]
    pub forces: Forces,
    /// Position at which a slot that is run in single-rung steps continues; `None` between two
    /// slots.
    #[serde(default, rename = "place")]
    pub paused_at: Option<ScanPosition>,
}

impl ScanState {
    fn new_at_power_on(code: &Code) -> ScanState {
        ScanState {
            // The previous state starts as 1, so that a contact that is closed at power-on
            // is not an edge.
            counter_inputs: vec![true; code.counter_count],
            ..ScanState::default()
        }
    }
}

impl Plc {
    /// Creates a PLC that has just been switched on. Its retained memory contains only the
    /// initial values of the ladder.
    #[must_use]
    pub fn new(ladder: Arc<Ladder>) -> Plc {
        let mut memory = PlcMemory::new();
        for start in ladder.start_values() {
            if start.address.area.is_entry() {
                memory.set_long(start.address, start.value);
            } else {
                memory.set_byte(start.address, u8::try_from(start.value).unwrap_or(u8::MAX));
            }
        }
        let state = ScanState::new_at_power_on(ladder.code());
        Plc {
            ladder,
            memory,
            state,
            skippable: SkippableRungs::default(),
        }
    }

    /// Switches the PLC off and on: clears volatile memory and the fault, and restarts the
    /// scan. Retained memory does not change.
    pub fn power_on(&mut self) {
        self.memory.clear_volatile();
        self.state = ScanState::new_at_power_on(self.ladder.code());
        self.skippable.invalidate();
    }

    /// Returns the ladder program.
    #[must_use]
    pub fn ladder(&self) -> &Arc<Ladder> {
        &self.ladder
    }

    /// Returns the memory of the PLC with all areas.
    #[must_use]
    pub fn memory(&self) -> &PlcMemory {
        &self.memory
    }

    /// Returns the mutable memory, for X and F, the DT presets of parameters, and the value
    /// pages.
    pub fn memory_mut(&mut self) -> &mut PlcMemory {
        &mut self.memory
    }

    /// Returns the fault that has stopped the PLC; `None` while the PLC runs.
    #[must_use]
    pub fn fault(&self) -> Option<PlcFault> {
        self.state.fault
    }

    /// Returns the index of the part of level 2 that the next slot runs, from 0.
    #[must_use]
    pub fn next_part(&self) -> usize {
        self.state.part
    }

    /// Returns number and text of every message whose request bit is 1, in address order.
    pub fn active_messages(&self) -> impl Iterator<Item = (u16, &str)> {
        self.ladder
            .messages()
            .iter()
            .filter(|message| self.memory.bit(message.bit))
            .map(|message| (message.number, message.text.as_str()))
    }

    /// Runs one slot of 8 ms: level 1 and one part of level 2. Inputs are latched when a
    /// cycle of level 2 starts.
    ///
    /// If [`Plc::step_rung`] has started a slot, this function completes that slot. After a
    /// fault it does nothing.
    pub fn run_slot(&mut self) {
        self.run_until(ScanStop::SlotEnd);
    }

    pub(crate) fn run_until(&mut self, stop: ScanStop) {
        if self.state.fault.is_some() {
            return;
        }
        if let Err(fault) = self.run_slot_to(stop) {
            self.state.fault = Some(fault);
        }
    }

    /// Prepares a slot and returns the position of its first rung.
    fn begin_slot(&mut self, code: &Code) -> ScanPosition {
        // A deserialized state may belong to another ladder.
        self.state.part %= code.part_ends.len().max(1);
        self.advance_timers(code);
        self.state.forces.apply(self.memory.bytes_mut());
        if self.state.part == 0 {
            self.memory.latch_inputs();
            self.state.resume_at = code.end1 + 1;
        }
        ScanPosition::first(code.end1)
    }

    /// Returns the first operation of level 2 in this slot and the end of its part.
    pub(crate) fn part_bounds(&self, code: &Code) -> (usize, usize) {
        let first = match self.state.part.checked_sub(1) {
            None => code.end1 + 1,
            Some(before) => code.part_ends.get(before).copied().unwrap_or(0),
        };
        let end = code.part_ends.get(self.state.part).copied().unwrap_or(0);
        (first.max(self.state.resume_at), end)
    }

    fn run_slot_to(&mut self, stop: ScanStop) -> Result<(), PlcFault> {
        let ladder = Arc::clone(&self.ladder);
        let code = ladder.code();
        let mut position = match self.state.paused_at.take() {
            Some(position) => position,
            None => {
                let position = self.begin_slot(code);
                if let Some(dependencies) = ladder.dependencies() {
                    let written = self.memory.take_changed_length();
                    self.skippable
                        .apply_memory_changes(self.memory.bytes(), written, dependencies);
                }
                position
            }
        };
        if position.level1 {
            position.next_op = self.run_rungs(&ladder, code.end1, &mut position, stop)?;
            let finished = position.next_op >= code.end1;
            if finished {
                position.level1 = false;
                position.next_op = self.part_bounds(code).0;
            }
            if stop == ScanStop::RungEnd
                && (!finished || position.next_op < self.part_bounds(code).1)
            {
                self.state.paused_at = Some(position);
                return Ok(());
            }
        }
        let (first, end) = self.part_bounds(code);
        position.next_op = position.next_op.max(first);
        if position.next_op < end {
            position.next_op = self.run_rungs(&ladder, end, &mut position, stop)?;
            if stop == ScanStop::RungEnd && position.next_op < end {
                self.state.paused_at = Some(position);
                return Ok(());
            }
            self.state.resume_at = position.next_op;
        }
        self.state.part = (self.state.part + 1) % code.part_ends.len().max(1);
        Ok(())
    }

    fn run_rungs(
        &mut self,
        ladder: &Ladder,
        end: usize,
        position: &mut ScanPosition,
        stop: ScanStop,
    ) -> Result<usize, PlcFault> {
        let (first, executed) = (position.next_op, &mut position.executed);
        if stop == ScanStop::RungEnd || !self.state.forces.is_empty() {
            self.skippable.invalidate();
            return self.run_operations::<true>(ladder, first, end, executed, stop);
        }
        match ladder.dependencies() {
            Some(dependencies) if self.skippable.is_tracking() => {
                self.run_active_rungs(ladder, dependencies, first, end, executed)
            }
            _ => self.run_operations::<false>(ladder, first, end, executed, stop),
        }
    }

    /// Runs the rungs whose result may have changed, and returns `end`. The ladder must have no
    /// jumps.
    fn run_active_rungs(
        &mut self,
        ladder: &Ladder,
        dependencies: &RungDependencies,
        first: usize,
        end: usize,
        executed: &mut usize,
    ) -> Result<usize, PlcFault> {
        let rungs = dependencies.first_rung_from(first)..dependencies.first_rung_from(end);
        let result = self.memory.bytes()[RESULT_FLAGS];
        if self.skippable.begin_pass(&rungs, self.state.timers) {
            self.run_pass(ladder, dependencies, &rungs, executed)?;
            let timers = self.state.timers;
            self.skippable.end_pass(&rungs, self.memory.bytes(), timers);
        }
        let bytes = self.memory.bytes_mut();
        self.skippable
            .write_result_flags(rungs, result, bytes, dependencies);
        Ok(end)
    }

    /// Runs the rungs of a range that must run, including those that must run again because another
    /// rung has changed their bytes.
    fn run_pass(
        &mut self,
        ladder: &Ladder,
        dependencies: &RungDependencies,
        rungs: &Range<usize>,
        executed: &mut usize,
    ) -> Result<(), PlcFault> {
        let mut rung = rungs.start;
        while let Some(next) = self.skippable.take_next_awake(rung, rungs.end) {
            let comparison = dependencies.comparison_index(next);
            if comparison.is_some() {
                SkippableRungs::mark_result_flags(self.memory.bytes_mut());
            }
            let (first, end) = dependencies.operation_range(next);
            self.run_operations::<false>(ladder, first, end, executed, ScanStop::SlotEnd)?;
            let edges = &self.state.counter_inputs;
            self.skippable
                .record_run(next, self.memory.bytes(), edges, dependencies);
            if let Some(number) = comparison {
                self.skippable
                    .record_comparison(number, self.memory.bytes());
            }
            rung = next + 1;
        }
        Ok(())
    }

    /// Adds 8 ms to the timers that ran during the last slot.
    fn advance_timers(&mut self, code: &Code) {
        let level2_begins = self.state.part == 0;
        let scope = if level2_begins {
            u128::MAX
        } else {
            code.level1_timers
        };
        self.state.timers.begin_scan(scope);
        for timer in self.state.timers.running() {
            let elapsed = self.memory.t(timer);
            self.memory.set_t(timer, elapsed.saturating_add(SLOT_MS));
        }
    }

    /// Runs operations from `first` until the scan reaches or jumps beyond `end`, or until
    /// `stop`. Returns the index of the next operation.
    ///
    /// Forced bits are applied and rung ends are checked only with `WATCHED`.
    fn run_operations<const WATCHED: bool>(
        &mut self,
        ladder: &Ladder,
        first: usize,
        end: usize,
        executed: &mut usize,
        stop: ScanStop,
    ) -> Result<usize, PlcFault> {
        let code = ladder.code();
        let ops = code.ops.as_slice();
        let bytes = self.memory.bytes_mut();
        let forces = &self.state.forces;
        let rung_of = |at: usize| ladder.statements().get(at).map(|statement| statement.rung);
        let rung = rung_of(first);
        let mut state = FunctionState {
            timers: &mut self.state.timers,
            counter_inputs: &mut self.state.counter_inputs,
        };
        let mut returns = [0usize; MAX_CALL_DEPTH];
        let mut depth = 0;
        // Accumulator stack with its top in bit 0. Bits shifted out on the left belong to
        // earlier rungs.
        let mut stack: u32 = 0;
        let mut limit = end;
        let mut at = first;
        // Only jumps and calls can make a slot long. The count includes the operations
        // before them.
        let mut from = first;
        while at < limit {
            // Runs operations in sequence until one jumps.
            let mut jump_target = None;
            for op in ops.get(at..limit.min(ops.len())).unwrap_or_default() {
                let act = stack & 1 == 1;
                at += 1;
                match *op {
                    Op::Ld(bit) => stack = stack << 1 | u32::from(is_set(bytes, bit)),
                    Op::Ldi(bit) => stack = stack << 1 | u32::from(!is_set(bytes, bit)),
                    Op::And(bit) => stack &= !1 | u32::from(is_set(bytes, bit)),
                    Op::Ani(bit) => stack &= !1 | u32::from(!is_set(bytes, bit)),
                    Op::Or(bit) => stack |= u32::from(is_set(bytes, bit)),
                    Op::Ori(bit) => stack |= u32::from(!is_set(bytes, bit)),
                    Op::Orb => stack = stack >> 1 | stack & 1,
                    Op::Anb => stack = (stack >> 1) & (!1 | stack & 1),
                    Op::Out(bit) => {
                        let byte = &mut bytes[usize::from(bit.at)];
                        // All ones or all zeros, so that the coil needs no branch.
                        let all = 0u8.wrapping_sub(u8::from(act));
                        *byte = *byte & !bit.mask | all & bit.mask;
                    }
                    Op::Set(bit) if act => bytes[usize::from(bit.at)] |= bit.mask,
                    Op::Rst(bit) if act => bytes[usize::from(bit.at)] &= !bit.mask,
                    Op::Function(index) => {
                        if let Some(function) = code.functions.get(usize::from(index)) {
                            execute(function, act, bytes, &mut state);
                        }
                    }
                    Op::Jump(target) if act => jump_target = Some(usize::from(target)),
                    Op::Call(target) if act => {
                        if let Some(position) = returns.get_mut(depth) {
                            *position = at;
                            depth += 1;
                            limit = ops.len();
                            jump_target = Some(usize::from(target));
                        }
                    }
                    Op::Return => {
                        depth = depth.saturating_sub(1);
                        jump_target = Some(returns[depth]);
                        if depth == 0 {
                            limit = end;
                        }
                    }
                    Op::Set(_) | Op::Rst(_) | Op::Jump(_) | Op::Call(_) | Op::Nop => {}
                }
                if WATCHED {
                    forces.apply(bytes);
                    let next = jump_target.unwrap_or(at);
                    if stop == ScanStop::RungEnd && depth == 0 && rung_of(next) != rung {
                        *executed += at - from;
                        return Ok(next);
                    }
                }
                if jump_target.is_some() {
                    break;
                }
            }
            let Some(next) = jump_target else { break };
            if next != at {
                *executed += at - from;
                from = next;
                if *executed > MAX_SLOT_OPERATIONS {
                    return Err(watchdog_fault(ladder, at));
                }
            }
            at = next;
        }
        *executed += at.saturating_sub(from);
        Ok(at)
    }
}

/// Returns the fault of a slot with too many operations; the last of them is the jump before
/// `at`.
#[cold]
fn watchdog_fault(ladder: &Ladder, at: usize) -> PlcFault {
    let jump = ladder.statements().get(at.saturating_sub(1));
    let line = jump.map_or(0, |statement| statement.line);
    PlcFault::Watchdog { line }
}

fn is_set(bytes: &[u8; SIZE], bit: MemoryBit) -> bool {
    bytes[usize::from(bit.at)] & bit.mask != 0
}
