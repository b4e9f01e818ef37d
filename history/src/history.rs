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

/// A seek that is made in slices: the machine on its way to a tick.
#[derive(Clone, Debug)]
pub struct HistorySeek {
    moment: MachineMoment,
    next_input: usize,
    target: u64,
}

impl HistorySeek {
    /// Returns the machine at the tick that the seek has reached.
    pub const fn moment(&self) -> &MachineMoment {
        &self.moment
    }

    /// Returns the machine at the tick that the seek has reached.
    pub fn into_moment(self) -> MachineMoment {
        self.moment
    }
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
        self.input_bytes += count_bytes(core::slice::from_ref(&recorded));
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

    /// Stores a full state now: before an input that is expensive to repeat, or of a machine
    /// whose exchange with a pulse board cannot be repeated.
    pub fn store_state(&mut self, emulator: &Emulator, part: &MachinePart) {
        self.end = emulator.ticks();
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
            let dropped: Vec<_> = self.inputs.drain(unused).collect();
            self.input_bytes -= count_bytes(&dropped);
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
        let mut seek = self.begin_seek(tick)?;
        while !self.advance_seek(&mut seek, u64::MAX) {}
        Some(seek.into_moment())
    }

    /// Starts to seek a tick in slices; `None` outside the session. The history must not change
    /// until the seek is complete.
    pub fn begin_seek(&self, tick: u64) -> Option<HistorySeek> {
        let state = self.state_before(tick)?;
        Some(HistorySeek {
            moment: state.moment.clone(),
            next_input: state.next_input,
            target: tick,
        })
    }

    /// Continues a seek to a later tick, if that takes fewer ticks than a new one; otherwise
    /// starts a new one. `None` outside the session.
    pub fn redirect_seek(&self, seek: HistorySeek, tick: u64) -> Option<HistorySeek> {
        let state = self.state_before(tick)?;
        let reached = seek.moment.ticks();
        if reached < tick && reached >= state.tick() {
            return Some(HistorySeek {
                target: tick,
                ..seek
            });
        }
        self.begin_seek(tick)
    }

    /// Simulates at most `max_ticks` of a seek; returns `true` once it is complete.
    pub fn advance_seek(&self, seek: &mut HistorySeek, max_ticks: u64) -> bool {
        let mut remaining = max_ticks;
        loop {
            let input = self.inputs.get(seek.next_input);
            let due = input.filter(|input| input.tick < seek.target);
            let stop = due.map_or(seek.target, |input| input.tick);
            while seek.moment.ticks() < stop {
                if remaining == 0 {
                    return false;
                }
                remaining -= 1;
                seek.moment.tick();
            }
            let Some(due) = due else { return true };
            seek.moment.apply(due.input.clone());
            seek.next_input += 1;
        }
    }

    /// Returns control, panel and lathe at a tick, without the part, which takes most of the
    /// time of a seek. `None` outside the session.
    pub fn seek_machine(&self, tick: u64) -> Option<Emulator> {
        let state = self.state_before(tick)?;
        let mut emulator = state.moment.emulator.clone();
        for recorded in self
            .inputs
            .get(state.next_input..self.inputs_before(tick))?
        {
            while emulator.ticks() < recorded.tick {
                emulator.tick();
            }
            if let HistoryInput::Machine(input) = &recorded.input {
                emulator.apply(input.clone());
            }
        }
        while emulator.ticks() < tick {
            emulator.tick();
        }
        Some(emulator)
    }

    /// Returns the last full state at or before a tick without simulating anything, the first
    /// one if there is none before; `None` after the end of the session.
    pub fn stored_state(&self, tick: u64) -> Option<MachineMoment> {
        if tick > self.end {
            return None;
        }
        let state = self.states.last_before(tick, self.inputs.len());
        let state = state.or_else(|| self.states.first())?;
        Some(state.moment.clone())
    }

    fn state_before(&self, tick: u64) -> Option<&StoredState> {
        if tick > self.end {
            return None;
        }
        self.states.last_before(tick, self.inputs_before(tick))
    }

    /// Returns the session from the last full state at or before a tick, or from its first
    /// state, without the abandoned future.
    pub fn since(&self, tick: u64) -> Self {
        let (states, first_input) = self.states.since(tick);
        let inputs = self.inputs.get(first_input..).unwrap_or_default().to_vec();
        Self {
            budget_bytes: self.budget_bytes,
            states,
            input_bytes: count_bytes(&inputs),
            inputs,
            end: self.end,
            branch: None,
        }
    }

    /// Returns the states with the inputs before each of them, the oldest first.
    pub(crate) fn states(&self) -> impl Iterator<Item = (&MachineMoment, usize)> {
        self.states.iter()
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
        self.input_bytes -= count_bytes(&inputs);
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

/// Returns the estimated memory of inputs, bytes.
fn count_bytes(inputs: &[RecordedInput]) -> usize {
    let bytes = |recorded: &RecordedInput| INPUT_BYTES + recorded.input.text_bytes();
    inputs.iter().map(bytes).sum()
}
