//! A session from its first state to the present: inputs, full states, and one abandoned
//! future.

use gsk_panel::emulator::{Emulator, StampedInput};

use crate::machine_part::{MachinePart, PartInput};
use crate::moment::{HistoryInput, MachineMoment, RecordedInput};
use crate::state_list::{StateList, StoredState};

/// Interval between two full states, ticks (ms of machine time).
pub const STATE_INTERVAL_TICKS: u64 = 10_000;
/// Memory for states and inputs unless another budget is set, bytes.
pub const DEFAULT_BUDGET_BYTES: usize = 128 * 1024 * 1024;

/// Size of an input without its texts, bytes.
const INPUT_BYTES: usize = size_of::<RecordedInput>();

/// The future that was abandoned when the machine continued from a past moment.
#[derive(Clone, Debug)]
struct HistoryBranch {
    from: u64,
    end: u64,
    inputs: Vec<RecordedInput>,
    states: StateList,
}

/// The recorded session of a machine. Every moment of it can be reached again.
///
/// A moment of tick `t` is the machine as tick `t` has left it, before the inputs with the stamp
/// `t`.
#[derive(Clone, Debug)]
pub struct History {
    budget_bytes: usize,
    states: StateList,
    inputs: Vec<RecordedInput>,
    input_bytes: usize,
    /// The last tick of the session.
    end: u64,
    branch: Option<HistoryBranch>,
}

impl History {
    /// Starts the history of a machine in its current state. It uses about `budget_bytes` of
    /// memory.
    pub fn new(start: MachineMoment, budget_bytes: usize) -> Self {
        let end = start.ticks();
        let mut states = StateList::default();
        states.push(start, 0);
        Self {
            budget_bytes,
            states,
            inputs: Vec::new(),
            input_bytes: 0,
            end,
            branch: None,
        }
    }

    /// Adds an input that has been applied to the machine.
    pub fn record(&mut self, recorded: RecordedInput) {
        self.end = self.end.max(recorded.tick);
        self.input_bytes += INPUT_BYTES + recorded.input.text_bytes();
        self.inputs.push(recorded);
    }

    /// Adds inputs that [`Emulator::take_inputs`] has returned.
    pub fn record_machine(&mut self, inputs: impl IntoIterator<Item = StampedInput>) {
        for StampedInput { tick, input } in inputs {
            self.record(RecordedInput {
                tick,
                input: HistoryInput::Machine(input),
            });
        }
    }

    /// Adds an input of the part, applied after the given tick of the machine.
    pub fn record_part(&mut self, tick: u64, input: PartInput) {
        let input = HistoryInput::Part(input);
        self.record(RecordedInput { tick, input });
    }

    /// Follows the machine after a tick, when its inputs up to now have been recorded. Stores
    /// a full state if one is due.
    pub fn follow(&mut self, emulator: &Emulator, part: &MachinePart) {
        self.end = emulator.ticks();
        let last = self.states.last().map_or(0, StoredState::tick);
        if self.end >= last + STATE_INTERVAL_TICKS {
            self.store_state(emulator, part);
        }
    }

    /// Stores a full state now: before an input that is expensive to repeat.
    pub fn store_state(&mut self, emulator: &Emulator, part: &MachinePart) {
        let moment = MachineMoment {
            emulator: emulator.clone(),
            part: part.clone(),
        };
        self.states.push(moment, self.inputs.len());
        self.keep_budget();
    }

    /// Removes old states, then the oldest part of the session, until the budget is kept.
    fn keep_budget(&mut self) {
        while self.bytes() > self.budget_bytes {
            if self.branch.take().is_some() || self.states.thin() {
                continue;
            }
            let Some(unused) = self.states.drop_first() else {
                return;
            };
            let dropped = self.inputs.drain(unused);
            let bytes: usize = dropped
                .map(|dropped| INPUT_BYTES + dropped.input.text_bytes())
                .sum();
            self.input_bytes -= bytes;
        }
    }

    /// Returns the estimated memory of states and inputs, bytes.
    pub fn bytes(&self) -> usize {
        let of_branch = self.branch.as_ref().map_or(0, |branch| {
            branch.states.bytes() + branch.inputs.len() * INPUT_BYTES
        });
        self.states.bytes() + self.input_bytes + of_branch
    }

    /// Returns the number of full states.
    pub const fn state_count(&self) -> usize {
        self.states.len()
    }

    /// Returns the recorded inputs, the oldest first.
    pub fn inputs(&self) -> &[RecordedInput] {
        &self.inputs
    }

    /// Returns the first tick that can be reached.
    pub fn start(&self) -> u64 {
        self.states.first().map_or(self.end, StoredState::tick)
    }

    /// Returns the last tick of the session.
    pub const fn end(&self) -> u64 {
        self.end
    }

    /// Returns the machine at a tick: the last state before it, and the inputs since then.
    /// `None` outside the session.
    pub fn seek(&self, tick: u64) -> Option<MachineMoment> {
        if tick > self.end {
            return None;
        }
        let input_count = self.inputs_before(tick);
        let state = self.states.last_before(tick, input_count)?;
        let mut moment = state.moment.clone();
        for recorded in self.inputs.get(state.next_input..input_count)? {
            while moment.ticks() < recorded.tick {
                moment.tick();
            }
            moment.apply(recorded.input.clone());
        }
        while moment.ticks() < tick {
            moment.tick();
        }
        Some(moment)
    }

    /// Returns the machine at the end of the session, with the inputs after the last tick.
    pub fn present(&self) -> Option<MachineMoment> {
        let mut moment = self.seek(self.end)?;
        let last = self.inputs.get(self.inputs_before(self.end)..)?;
        for recorded in last {
            moment.apply(recorded.input.clone());
        }
        Some(moment)
    }

    /// Ends the session at a past tick and returns the machine there, from which it continues.
    /// The abandoned future becomes the branch, in place of an earlier one. `None` outside the
    /// session.
    pub fn continue_from(&mut self, tick: u64) -> Option<MachineMoment> {
        let moment = self.seek(tick)?;
        let input_count = self.inputs_before(tick);
        let inputs = self.inputs.split_off(input_count);
        let bytes: usize = inputs
            .iter()
            .map(|recorded| INPUT_BYTES + recorded.input.text_bytes())
            .sum();
        self.input_bytes -= bytes;
        self.branch = Some(HistoryBranch {
            from: tick,
            end: self.end,
            inputs,
            states: self.states.split_after(tick, input_count),
        });
        self.end = tick;
        Some(moment)
    }

    /// Returns first and last tick of the abandoned future; `None` if there is none.
    pub fn branch(&self) -> Option<(u64, u64)> {
        self.branch.as_ref().map(|branch| (branch.from, branch.end))
    }

    /// Returns to the end of the abandoned future and returns the machine there. What was
    /// recorded since the branch point becomes the branch. `None` without a branch.
    pub fn return_to_branch(&mut self) -> Option<MachineMoment> {
        let branch = self.branch.take()?;
        // `None` also if the branch point has left the budget.
        self.continue_from(branch.from)?;
        for recorded in branch.inputs {
            self.record(recorded);
        }
        self.states.append(branch.states);
        self.end = branch.end;
        self.present()
    }

    /// Returns the number of inputs that act before a tick is over.
    fn inputs_before(&self, tick: u64) -> usize {
        self.inputs.partition_point(|input| input.tick < tick)
    }
}
