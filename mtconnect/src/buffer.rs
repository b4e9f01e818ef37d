//! Observations with their sequence numbers: the latest ones, and the state before them.

use std::collections::VecDeque;
use std::sync::Arc;

use crate::model::{DATA_ITEMS, ItemCategory, item_index};
use crate::reading::{ActiveFault, FaultLevel, MachineReading};
use crate::time_stamp::TimeStamp;
use crate::value::AgentValue;

/// Greatest number of observations that the agent stores.
pub(crate) const BUFFER_SIZE: usize = 65_536;
/// Shortest time between two recorded observations of one sample item, ms.
const SAMPLE_INTERVAL_MS: u64 = 100;

/// The state of a condition item in an observation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum ConditionState {
    /// Not known whether an alarm is active.
    Unavailable,
    /// No alarm is active; with a number, that alarm has ended.
    Normal(Option<u16>),
    /// An alarm is active.
    Active {
        level: FaultLevel,
        number: u16,
        text: Arc<str>,
    },
}

/// The value of an observation: of a sample or event, of a condition, or of an asset.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum ObservationContent {
    Value(AgentValue),
    Condition(ConditionState),
}

/// A change of one data item.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Observation {
    pub(crate) sequence: u64,
    pub(crate) time: TimeStamp,
    /// Index of the data item in [`DATA_ITEMS`](crate::model::DATA_ITEMS).
    pub(crate) item: usize,
    pub(crate) content: ObservationContent,
}

/// The latest observation of each data item up to a sequence number. A condition may have several.
#[derive(Clone, Debug, Default)]
pub(crate) struct Checkpoint {
    items: Vec<Vec<Observation>>,
}

impl Checkpoint {
    /// Returns the observations of the checkpoint, in the order of the data items.
    pub(crate) fn observations(&self) -> impl Iterator<Item = &Observation> {
        self.items.iter().flatten()
    }

    fn item_observations(&self, item: usize) -> &[Observation] {
        self.items.get(item).map_or(&[], Vec::as_slice)
    }

    fn apply(&mut self, observation: Observation) {
        if self.items.len() <= observation.item {
            self.items.resize(observation.item + 1, Vec::new());
        }
        let active = &mut self.items[observation.item];
        match &observation.content {
            ObservationContent::Condition(ConditionState::Active { number, .. }) => {
                active.retain(|it| active_number(it).is_some_and(|own| own != *number));
                active.push(observation);
            }
            ObservationContent::Condition(ConditionState::Normal(Some(number))) => {
                active.retain(|it| active_number(it).is_some_and(|own| own != *number));
                if active.is_empty() {
                    active.push(Observation {
                        content: ObservationContent::Condition(ConditionState::Normal(None)),
                        ..observation
                    });
                }
            }
            _ => {
                active.clear();
                active.push(observation);
            }
        }
    }
}

/// Returns the number of the alarm that an observation reports as active; `None` if it reports no
/// alarm.
const fn active_number(observation: &Observation) -> Option<u16> {
    match observation.content {
        ObservationContent::Condition(ConditionState::Active { number, .. }) => Some(number),
        _ => None,
    }
}

/// The stored observations of the lathe, at most [`BUFFER_SIZE`].
#[derive(Debug)]
pub(crate) struct ObservationBuffer {
    entries: VecDeque<Observation>,
    next_sequence: u64,
    /// Latest observation of each item before the oldest stored one.
    before: Checkpoint,
    latest: Checkpoint,
    /// Time at which each data item was recorded last, ms since 1970; limits the rate of samples.
    recorded_ms: Vec<u64>,
}

impl ObservationBuffer {
    /// Creates a buffer with one observation of each data item: its value is unavailable.
    pub(crate) fn new(time: TimeStamp) -> Self {
        let mut buffer = Self {
            entries: VecDeque::new(),
            next_sequence: 1,
            before: Checkpoint::default(),
            latest: Checkpoint::default(),
            recorded_ms: vec![0; DATA_ITEMS.len()],
        };
        for (item, row) in DATA_ITEMS.iter().enumerate() {
            let content = match row.category {
                ItemCategory::Condition => {
                    ObservationContent::Condition(ConditionState::Unavailable)
                }
                _ => ObservationContent::Value(AgentValue::Unavailable),
            };
            buffer.push(time, item, content);
        }
        buffer
    }

    /// Returns the sequence number of the oldest stored observation.
    pub(crate) fn first_sequence(&self) -> u64 {
        self.next_sequence - self.entries.len() as u64
    }

    /// Returns the sequence number that the next observation will get.
    pub(crate) const fn next_sequence(&self) -> u64 {
        self.next_sequence
    }

    /// Returns the latest observation of each item.
    pub(crate) const fn latest(&self) -> &Checkpoint {
        &self.latest
    }

    /// Returns the latest observation of each item up to the observation `sequence`; `None` if that
    /// one is not stored.
    pub(crate) fn state_at(&self, sequence: u64) -> Option<Checkpoint> {
        let count = sequence.checked_sub(self.first_sequence())? + 1;
        let count = usize::try_from(count).ok()?;
        if count > self.entries.len() {
            return None;
        }
        let mut state = self.before.clone();
        for observation in self.entries.iter().take(count) {
            state.apply(observation.clone());
        }
        Some(state)
    }

    /// Returns the stored observations from the sequence number `from` on, the oldest first.
    pub(crate) fn since(&self, from: u64) -> impl DoubleEndedIterator<Item = &Observation> {
        let skipped = from.saturating_sub(self.first_sequence());
        let skipped = usize::try_from(skipped).unwrap_or(usize::MAX);
        self.entries.range(skipped.min(self.entries.len())..)
    }

    /// Records the values that differ from the last recorded ones. A sample item is recorded ten
    /// times a second at most; its last value is recorded by a later reading.
    pub(crate) fn record(&mut self, time: TimeStamp, reading: &MachineReading) {
        for (item, row) in DATA_ITEMS.iter().enumerate() {
            if row.category == ItemCategory::Condition {
                self.record_condition(time, item, &reading.faults);
                continue;
            }
            let Some(value) = reading.values.get(item) else {
                continue;
            };
            let is_asset = row.item_type.starts_with("ASSET_");
            let is_early = row.category == ItemCategory::Sample
                && time.0 < self.recorded_ms[item] + SAMPLE_INTERVAL_MS;
            if !is_asset && !is_early {
                self.record_value(time, item, value.clone());
            }
        }
    }

    /// Records that an asset is new, has changed or was removed. `id` is the identifier of the data
    /// item that reports this.
    pub(crate) fn record_asset(
        &mut self,
        time: TimeStamp,
        id: &str,
        element: &'static str,
        asset: &Arc<str>,
    ) {
        if let Some(item) = item_index(id) {
            let value = AgentValue::Asset(element, Arc::clone(asset));
            self.push(time, item, ObservationContent::Value(value));
        }
    }

    fn record_value(&mut self, time: TimeStamp, item: usize, value: AgentValue) {
        let last = self.latest.item_observations(item).first();
        let content = ObservationContent::Value(value);
        if last.is_none_or(|last| last.content != content) {
            self.push(time, item, content);
        }
    }

    fn record_condition(&mut self, time: TimeStamp, item: usize, faults: &[ActiveFault]) {
        let faults = || faults.iter().filter(|fault| fault.item == item);
        let active: Vec<ObservationContent> = (self.latest.item_observations(item).iter())
            .map(|observation| observation.content.clone())
            .collect();
        for content in &active {
            if let ObservationContent::Condition(ConditionState::Active { number, .. }) = content
                && !faults().any(|fault| fault.number == *number)
            {
                let ended = ConditionState::Normal(Some(*number));
                self.push(time, item, ObservationContent::Condition(ended));
            }
        }
        let unavailable = ObservationContent::Condition(ConditionState::Unavailable);
        if faults().next().is_none() && active.contains(&unavailable) {
            let normal = ConditionState::Normal(None);
            self.push(time, item, ObservationContent::Condition(normal));
        }
        // The newest alarm is the first of the list and the last observation.
        let mut listed: Vec<&ActiveFault> = faults().collect();
        listed.reverse();
        for fault in listed {
            let content = ObservationContent::Condition(ConditionState::Active {
                level: fault.level,
                number: fault.number,
                text: Arc::clone(&fault.text),
            });
            if !active.contains(&content) {
                self.push(time, item, content);
            }
        }
    }

    fn push(&mut self, time: TimeStamp, item: usize, content: ObservationContent) {
        let observation = Observation {
            sequence: self.next_sequence,
            time,
            item,
            content,
        };
        self.next_sequence += 1;
        if let Some(recorded) = self.recorded_ms.get_mut(item) {
            *recorded = time.0;
        }
        self.latest.apply(observation.clone());
        self.entries.push_back(observation);
        if self.entries.len() > BUFFER_SIZE
            && let Some(oldest) = self.entries.pop_front()
        {
            self.before.apply(oldest);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fault(number: u16) -> ActiveFault {
        ActiveFault {
            item: item_index("motion").expect("a condition"),
            level: FaultLevel::Fault,
            number,
            text: "text".into(),
            text_zh: "text".into(),
        }
    }

    fn conditions(state: &Checkpoint) -> Vec<ConditionState> {
        let item = item_index("motion").expect("a condition");
        let observations = state.item_observations(item).iter();
        let states = observations.filter_map(|it| match &it.content {
            ObservationContent::Condition(state) => Some(state.clone()),
            ObservationContent::Value(_) => None,
        });
        states.collect()
    }

    #[test]
    fn two_alarms_end_one_after_the_other() {
        let mut buffer = ObservationBuffer::new(TimeStamp(0));
        let mut reading = MachineReading::unavailable();
        let mut numbers = |faults: &[u16]| {
            reading.faults = faults.iter().copied().map(fault).collect();
            buffer.record(TimeStamp(1), &reading);
            let states = conditions(buffer.latest());
            let numbers = states.iter().map(|state| match state {
                ConditionState::Active { number, .. } => *number,
                _ => 0,
            });
            numbers.collect::<Vec<u16>>()
        };
        assert_eq!(numbers(&[]), [0]);
        assert_eq!(numbers(&[11]), [11]);
        assert_eq!(numbers(&[30, 11]), [11, 30]);
        assert_eq!(numbers(&[30]), [30]);
        assert_eq!(numbers(&[]), [0]);
    }

    #[test]
    fn a_full_buffer_forgets_the_oldest_and_keeps_the_state() {
        let mut buffer = ObservationBuffer::new(TimeStamp(0));
        let mut reading = MachineReading::unavailable();
        let line = item_index("line").expect("an item");
        let count = BUFFER_SIZE + 100;
        for number in 0..count {
            reading.values[line] = AgentValue::Number(number as f64);
            buffer.record(TimeStamp(number as u64), &reading);
        }
        assert_eq!(buffer.entries.len(), BUFFER_SIZE);
        let first = buffer.first_sequence();
        assert!(first > 100 && buffer.state_at(first - 1).is_none());
        let sequences = buffer.since(first).map(|it| it.sequence);
        assert!(sequences.eq(first..buffer.next_sequence()));
        let oldest = buffer.state_at(first).expect("the oldest");
        assert_eq!(oldest.observations().count(), DATA_ITEMS.len());
        let value = &oldest.item_observations(line)[0].content;
        let expected = buffer.entries[0].content.clone();
        assert_eq!(*value, expected);
        assert!(buffer.state_at(buffer.next_sequence()).is_none());
    }

    #[test]
    fn samples_are_recorded_ten_times_a_second_and_events_at_once() {
        let mut buffer = ObservationBuffer::new(TimeStamp(0));
        let mut reading = MachineReading::unavailable();
        let before = buffer.next_sequence();
        let (x, line) = (item_index("x_work"), item_index("line"));
        let (x, line) = (x.expect("an item"), line.expect("an item"));
        for tick in 1..=50_u64 {
            reading.values[x] = AgentValue::Number(tick as f64);
            reading.values[line] = AgentValue::Number(tick as f64);
            buffer.record(TimeStamp(1000 + tick * 20), &reading);
        }
        let count_of = |item| buffer.since(before).filter(|it| it.item == item).count();
        assert_eq!(count_of(line), 50);
        assert_eq!(count_of(x), 10);
        // The axis stands: the reading after the interval records where.
        buffer.record(TimeStamp(3000), &reading);
        let last = &buffer.latest().item_observations(x)[0];
        assert_eq!(
            last.content,
            ObservationContent::Value(AgentValue::Number(50.0))
        );
    }
}
