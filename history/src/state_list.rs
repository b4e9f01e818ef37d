//! Full states of a session in the order of time, within a budget of bytes.

use core::ops::Range;

use crate::moment::MachineMoment;

/// Size of a state without its texts, bytes. Copies share slabs of the part and chunks of the
/// path; 26 KB (a short program) to 42 KB (a part of 20 000 corners) were measured.
const BASE_STATE_BYTES: usize = 42_000;

/// A full state, and the number of inputs that were applied before it.
#[derive(Clone, Debug)]
pub(crate) struct StoredState {
    pub(crate) moment: MachineMoment,
    /// Index of the first input after the state.
    pub(crate) next_input: usize,
    bytes: usize,
}

impl StoredState {
    pub(crate) const fn tick(&self) -> u64 {
        self.moment.ticks()
    }
}

/// The states of a session, the oldest first.
#[derive(Clone, Debug, Default)]
pub(crate) struct StateList {
    states: Vec<StoredState>,
    bytes: usize,
    /// Index at which the next state is removed, if the budget is exceeded.
    thinning: usize,
}

impl StateList {
    pub(crate) fn push(&mut self, moment: MachineMoment, next_input: usize) {
        let texts = unshared_text_bytes(&moment, self.states.last().map(|last| &last.moment));
        let bytes = BASE_STATE_BYTES + texts;
        self.bytes += bytes;
        self.states.push(StoredState {
            moment,
            next_input,
            bytes,
        });
    }

    pub(crate) fn first(&self) -> Option<&StoredState> {
        self.states.first()
    }

    /// Returns the states from the last one at or before a tick, or from the first one, and the
    /// number of inputs before them.
    pub(crate) fn since(&self, tick: u64) -> (Self, usize) {
        let later = self.states.partition_point(|state| state.tick() <= tick);
        let kept = self.states.get(later.saturating_sub(1)..);
        let mut states = kept.unwrap_or_default().to_vec();
        let first_input = states.first().map_or(0, |first| first.next_input);
        for state in &mut states {
            state.next_input -= first_input;
        }
        let list = Self {
            bytes: states.iter().map(|state| state.bytes).sum(),
            states,
            thinning: 0,
        };
        (list, first_input)
    }

    /// Returns the states with the index of the first input after each.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (&MachineMoment, usize)> {
        let states = self.states.iter();
        states.map(|state| (&state.moment, state.next_input))
    }

    pub(crate) fn last(&self) -> Option<&StoredState> {
        self.states.last()
    }

    pub(crate) const fn len(&self) -> usize {
        self.states.len()
    }

    pub(crate) const fn bytes(&self) -> usize {
        self.bytes
    }

    /// Returns the last state at or before a tick that contains no input after `input_count`.
    pub(crate) fn last_before(&self, tick: u64, input_count: usize) -> Option<&StoredState> {
        let end = self
            .states
            .partition_point(|state| state.tick() <= tick && state.next_input <= input_count);
        self.states.get(end.checked_sub(1)?)
    }

    /// Removes and returns the states that are later than a tick or contain an input after
    /// `input_count`.
    pub(crate) fn split_after(&mut self, tick: u64, input_count: usize) -> Self {
        let end = self
            .states
            .partition_point(|state| state.tick() <= tick && state.next_input <= input_count);
        let states = self.states.split_off(end);
        let bytes = states.iter().map(|state| state.bytes).sum();
        self.bytes -= bytes;
        self.thinning = 0;
        Self {
            states,
            bytes,
            thinning: 0,
        }
    }

    /// Appends the states of another list, which are later than these.
    pub(crate) fn append(&mut self, mut later: Self) {
        self.states.append(&mut later.states);
        self.bytes += later.bytes;
    }

    /// Removes one of the oldest states, every second one in turn; the first and the last
    /// remain. Returns `false` if only these are left.
    pub(crate) fn thin(&mut self) -> bool {
        if self.states.len() <= 2 {
            return false;
        }
        // The newer half keeps its interval as long as the older one has states to remove.
        self.thinning += 1;
        if self.thinning + 1 >= self.states.len().div_ceil(2).max(3) {
            self.thinning = 1;
        }
        let removed = self.states.remove(self.thinning);
        self.bytes -= removed.bytes;
        true
    }

    /// Removes the first state, if a later one remains. Returns the indices of the inputs that
    /// no remaining state needs.
    pub(crate) fn drop_first(&mut self) -> Option<Range<usize>> {
        let unused = self.states.first()?.next_input..self.states.get(1)?.next_input;
        let removed = self.states.remove(0);
        self.bytes -= removed.bytes;
        for state in &mut self.states {
            state.next_input -= unused.len();
        }
        Some(unused)
    }
}

/// Returns the length of the program texts that a state does not share with the one before it,
/// bytes.
fn unshared_text_bytes(moment: &MachineMoment, before: Option<&MachineMoment>) -> usize {
    let address = |text: &str| (text.as_ptr().addr(), text.len());
    let mut shared: Vec<_> = before
        .into_iter()
        .flat_map(|before| before.emulator.cnc().programs().iter())
        .map(|(_, program)| address(program.text()))
        .collect();
    shared.sort_unstable();
    let programs = moment.emulator.cnc().programs().iter();
    programs
        .map(|(_, program)| program.text())
        .filter(|text| shared.binary_search(&address(text)).is_err())
        .map(str::len)
        .sum()
}
