//! The scan: one 8 ms slot after another, level 1 whole and level 2 in parts.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

use crate::check::CALL_DEPTH;
use crate::code::{Bit, Code, Op};
use crate::force::Forces;
use crate::function::{Remembered, execute};
use crate::ladder::Ladder;
use crate::memory::{Memory, RESULT_FLAGS, SIZE};
use crate::place::{Place, Stop};
use crate::reach::Reach;
use crate::settled::Settled;
use crate::timer::{SLOT_MS, Timers};

/// Operations of one slot after which the program is taken to hang.
const WATCHDOG: usize = 100_000;

/// Why the PLC stands still until the next power-on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Fault {
    /// Jumps kept one slot busy for more than 100000 instructions.
    Watchdog {
        /// Line of the ladder's text with the jump that was one too many.
        line: u32,
    },
}

impl Fault {
    /// What has happened.
    #[must_use]
    pub fn message(&self) -> Message {
        match self {
            Self::Watchdog { line } => say::ladder_loops(line),
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.message().fmt(f)
    }
}

impl std::error::Error for Fault {}

/// A PLC: a ladder, its memory and the state of its scan.
///
/// The CNC writes X and F, calls [`Plc::slot`] every 8 ms, and reads G and Y.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plc {
    pub(crate) ladder: Arc<Ladder>,
    pub(crate) memory: Memory,
    pub(crate) state: State,
    /// Rungs that need not run.
    #[serde(skip)]
    pub(crate) settled: Settled,
}

/// What the scan remembers beside memory.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct State {
    /// Part of level 2 that is next, from 0.
    part: usize,
    /// A jump went beyond its part: operation that level 2 goes on with.
    resume: usize,
    timers: Timers,
    /// Last ACT of each CTRC.
    edges: Vec<bool>,
    pub fault: Option<Fault>,
    /// Bits held at a value by hand.
    #[serde(default)]
    pub forces: Forces,
    /// Where a slot that is stepped through goes on.
    #[serde(default)]
    pub place: Option<Place>,
}

impl State {
    fn at_power_on(code: &Code) -> State {
        State {
            // Taken as 1, so that a contact closed at power-on is no edge.
            edges: vec![true; code.counters],
            ..State::default()
        }
    }
}

impl Plc {
    /// A PLC just switched on, its retained store blank but for the ladder's
    /// start values.
    #[must_use]
    pub fn new(ladder: Arc<Ladder>) -> Plc {
        let mut memory = Memory::new();
        for start in ladder.start_values() {
            if start.address.area.is_entry() {
                memory.set_long(start.address, start.value);
            } else {
                memory.set_byte(start.address, u8::try_from(start.value).unwrap_or(u8::MAX));
            }
        }
        let state = State::at_power_on(ladder.code());
        Plc {
            ladder,
            memory,
            state,
            settled: Settled::default(),
        }
    }

    /// Switches off and on: volatile memory is cleared, the scan begins anew,
    /// a fault is gone. Retained memory stays.
    pub fn power_on(&mut self) {
        self.memory.clear_volatile();
        self.state = State::at_power_on(self.ladder.code());
        self.settled.forget();
    }

    /// The program.
    #[must_use]
    pub fn ladder(&self) -> &Arc<Ladder> {
        &self.ladder
    }

    /// All memory.
    #[must_use]
    pub fn memory(&self) -> &Memory {
        &self.memory
    }

    /// All memory, for writing X and F, parameters' DT, and the value pages.
    pub fn memory_mut(&mut self) -> &mut Memory {
        &mut self.memory
    }

    /// Why the PLC stands still, if it does.
    #[must_use]
    pub fn fault(&self) -> Option<Fault> {
        self.state.fault
    }

    /// Part of level 2 that the next slot runs, from 0.
    #[must_use]
    pub fn part(&self) -> usize {
        self.state.part
    }

    /// Number and text of every message whose request bit is 1, in address order.
    pub fn active_messages(&self) -> impl Iterator<Item = (u16, &str)> {
        self.ladder
            .messages()
            .iter()
            .filter(|message| self.memory.bit(message.bit))
            .map(|message| (message.number, message.text.as_str()))
    }

    /// One slot of 8 ms: input latch when a level-2 cycle begins, level 1,
    /// one part of level 2. A slot that was begun in steps is finished. After
    /// a fault nothing happens.
    pub fn slot(&mut self) {
        self.advance(Stop::AtEnd);
    }

    pub(crate) fn advance(&mut self, stop: Stop) {
        if self.state.fault.is_some() {
            return;
        }
        if let Err(fault) = self.run_slot(stop) {
            self.state.fault = Some(fault);
        }
    }

    /// Before the first rung of a slot.
    fn begin_slot(&mut self, code: &Code) -> Place {
        // A restored state may come from elsewhere.
        self.state.part %= code.part_ends.len().max(1);
        self.advance_timers(code);
        self.state.forces.apply(self.memory.bytes_mut());
        if self.state.part == 0 {
            self.memory.latch_inputs();
            self.state.resume = code.end1 + 1;
        }
        Place::first(code.end1)
    }

    /// Where level 2 begins in this slot, and where its part ends.
    pub(crate) fn part_bounds(&self, code: &Code) -> (usize, usize) {
        let first = match self.state.part.checked_sub(1) {
            None => code.end1 + 1,
            Some(before) => code.part_ends.get(before).copied().unwrap_or(0),
        };
        let end = code.part_ends.get(self.state.part).copied().unwrap_or(0);
        (first.max(self.state.resume), end)
    }

    fn run_slot(&mut self, stop: Stop) -> Result<(), Fault> {
        let ladder = Arc::clone(&self.ladder);
        let code = ladder.code();
        let mut place = match self.state.place.take() {
            Some(place) => place,
            None => {
                let place = self.begin_slot(code);
                if let Some(reach) = ladder.reach() {
                    let written = self.memory.take_written();
                    self.settled.follow(self.memory.bytes(), written, reach);
                }
                place
            }
        };
        if place.level1 {
            place.at = self.run_rungs(&ladder, code.end1, &mut place, stop)?;
            let over = place.at >= code.end1;
            if over {
                place.level1 = false;
                place.at = self.part_bounds(code).0;
            }
            if stop == Stop::AfterRung && (!over || place.at < self.part_bounds(code).1) {
                self.state.place = Some(place);
                return Ok(());
            }
        }
        let (first, end) = self.part_bounds(code);
        place.at = place.at.max(first);
        if place.at < end {
            place.at = self.run_rungs(&ladder, end, &mut place, stop)?;
            if stop == Stop::AfterRung && place.at < end {
                self.state.place = Some(place);
                return Ok(());
            }
            self.state.resume = place.at;
        }
        self.state.part = (self.state.part + 1) % code.part_ends.len().max(1);
        Ok(())
    }

    fn run_rungs(
        &mut self,
        ladder: &Ladder,
        end: usize,
        place: &mut Place,
        stop: Stop,
    ) -> Result<usize, Fault> {
        let (first, executed) = (place.at, &mut place.executed);
        if stop == Stop::AfterRung || !self.state.forces.is_empty() {
            self.settled.forget();
            return self.run::<true>(ladder, first, end, executed, stop);
        }
        match ladder.reach() {
            Some(reach) if self.settled.follows() => {
                self.run_unsettled(ladder, reach, first, end, executed)
            }
            _ => self.run::<false>(ladder, first, end, executed, stop),
        }
    }

    /// Runs the rungs of a ladder without jumps that may change something.
    fn run_unsettled(
        &mut self,
        ladder: &Ladder,
        reach: &Reach,
        first: usize,
        end: usize,
        executed: &mut usize,
    ) -> Result<usize, Fault> {
        let rungs = reach.rung_from(first)..reach.rung_from(end);
        let result = self.memory.bytes()[RESULT_FLAGS];
        if self.settled.begin_pass(&rungs, self.state.timers) {
            self.pass(ladder, reach, &rungs, executed)?;
            let timers = self.state.timers;
            self.settled.end_pass(&rungs, self.memory.bytes(), timers);
        }
        let bytes = self.memory.bytes_mut();
        self.settled.leave_result(rungs, result, bytes, reach);
        Ok(end)
    }

    /// Runs those of some rungs that may change something, and those woken by it.
    fn pass(
        &mut self,
        ladder: &Ladder,
        reach: &Reach,
        rungs: &Range<usize>,
        executed: &mut usize,
    ) -> Result<(), Fault> {
        let mut rung = rungs.start;
        while let Some(next) = self.settled.take_next(rung, rungs.end) {
            let comparison = reach.comparison(next);
            if comparison.is_some() {
                Settled::before_comparison(self.memory.bytes_mut());
            }
            let (first, end) = reach.operations(next);
            self.run::<false>(ladder, first, end, executed, Stop::AtEnd)?;
            let edges = &self.state.edges;
            self.settled.ran(next, self.memory.bytes(), edges, reach);
            if let Some(number) = comparison {
                self.settled.compared(number, self.memory.bytes());
            }
            rung = next + 1;
        }
        Ok(())
    }

    /// The timers that ran during the last 8 ms are 8 ms older.
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

    /// Runs operations from `first` until `end` is reached or jumped over, or
    /// `stop` asks to stop; returns where it stopped. Only the `WATCHED` form
    /// looks after forced bits and the end of each rung.
    fn run<const WATCHED: bool>(
        &mut self,
        ladder: &Ladder,
        first: usize,
        end: usize,
        executed: &mut usize,
        stop: Stop,
    ) -> Result<usize, Fault> {
        let code = ladder.code();
        let ops = code.ops.as_slice();
        let bytes = self.memory.bytes_mut();
        let forces = &self.state.forces;
        let rung_of = |at: usize| ladder.statements().get(at).map(|statement| statement.rung);
        let rung = rung_of(first);
        let mut remembered = Remembered {
            timers: &mut self.state.timers,
            edges: &mut self.state.edges,
        };
        let mut returns = [0usize; CALL_DEPTH];
        let mut depth = 0;
        // Top of the accumulator stack in bit 0; what is shifted out on the
        // left belongs to earlier rungs.
        let mut stack: u32 = 0;
        let mut limit = end;
        let mut at = first;
        // Only jumps and calls can make a slot long, so only they are counted,
        // with the operations that led to them.
        let mut from = first;
        while at < limit {
            // Straight on, until an operation leads elsewhere.
            let mut leads_to = None;
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
                            execute(function, act, bytes, &mut remembered);
                        }
                    }
                    Op::Jump(target) if act => leads_to = Some(usize::from(target)),
                    Op::Call(target) if act => {
                        if let Some(place) = returns.get_mut(depth) {
                            *place = at;
                            depth += 1;
                            limit = ops.len();
                            leads_to = Some(usize::from(target));
                        }
                    }
                    Op::Return => {
                        depth = depth.saturating_sub(1);
                        leads_to = Some(returns[depth]);
                        if depth == 0 {
                            limit = end;
                        }
                    }
                    Op::Set(_) | Op::Rst(_) | Op::Jump(_) | Op::Call(_) | Op::Mark => {}
                }
                if WATCHED {
                    forces.apply(bytes);
                    let next = leads_to.unwrap_or(at);
                    if stop == Stop::AfterRung && depth == 0 && rung_of(next) != rung {
                        *executed += at - from;
                        return Ok(next);
                    }
                }
                if leads_to.is_some() {
                    break;
                }
            }
            let Some(next) = leads_to else { break };
            if next != at {
                *executed += at - from;
                from = next;
                if *executed > WATCHDOG {
                    let jump = ladder.statements().get(at.saturating_sub(1));
                    let line = jump.map_or(0, |statement| statement.line);
                    return Err(Fault::Watchdog { line });
                }
            }
            at = next;
        }
        *executed += at.saturating_sub(from);
        Ok(at)
    }
}

fn is_set(bytes: &[u8; SIZE], bit: Bit) -> bool {
    bytes[usize::from(bit.at)] & bit.mask != 0
}
