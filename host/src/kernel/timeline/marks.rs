//! What happened in the session, for the marks on the time line.

use std::sync::Arc;

use gsk_history::moment::{HistoryInput, RecordedInput};
use gsk_panel::emulator::EmulatorInput;
use gsk_panel::keys::Key;
use gsk_panel::panel::KeyEvent;

/// Greatest number of marks. When it is exceeded, frequent marks of the older half are removed.
const MAX_MARKS: usize = 20_000;
/// Least distance between marks of blocks, keys or other inputs, ticks; a nearer event gets no
/// mark.
const LEAST_DISTANCE_TICKS: u64 = 200;

/// A mark on the time line for an event of the session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TimelineMark {
    /// Tick of the session at which the event happened.
    pub tick: u64,
    /// The kind of event that happened.
    pub kind: TimelineMarkKind,
}

/// The kind of event that a mark on the time line shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimelineMarkKind {
    /// A block of a program begins.
    Block,
    /// The operator presses this key.
    Key(Key),
    /// Another input of the operator: the handwheel, a program, a setting, a fault.
    Input,
    /// The alarm with this number is raised.
    Alarm(u16),
    /// A tool collides.
    Collision,
}

impl TimelineMarkKind {
    /// Returns the position of the kind in a list of frequent kinds; `None` for a rare kind.
    const fn frequent_index(self) -> Option<usize> {
        match self {
            Self::Block => Some(0),
            Self::Key(_) => Some(1),
            Self::Input => Some(2),
            Self::Alarm(_) | Self::Collision => None,
        }
    }
}

/// The marks of the session, the oldest first.
#[derive(Clone, Debug, Default)]
pub(in crate::kernel) struct MarkList {
    marks: Vec<TimelineMark>,
    /// Tick of the last mark of each frequent kind.
    last_ticks: [Option<u64>; 3],
    /// The marks as shared with the window; `None` after a change.
    shared: Option<Arc<Vec<TimelineMark>>>,
}

impl MarkList {
    /// Adds a mark, unless there is one of the same frequent kind just before it.
    pub(in crate::kernel) fn add(&mut self, tick: u64, kind: TimelineMarkKind) {
        if let Some(last) = (kind.frequent_index()).and_then(|index| self.last_ticks.get_mut(index))
        {
            if last.is_some_and(|last| tick < last + LEAST_DISTANCE_TICKS) {
                return;
            }
            *last = Some(tick);
        }
        self.marks.push(TimelineMark { tick, kind });
        self.shared = None;
        if self.marks.len() > MAX_MARKS {
            self.thin();
        }
    }

    /// Adds the marks for recorded inputs.
    pub(super) fn add_inputs(&mut self, inputs: &[RecordedInput]) {
        for recorded in inputs {
            if let Some(kind) = kind_of_input(&recorded.input) {
                self.add(recorded.tick, kind);
            }
        }
    }

    /// Removes every second frequent mark of the older half, or the oldest quarter if
    /// there are few.
    fn thin(&mut self) {
        let half = self.marks.len() / 2;
        let before = self.marks.len();
        let mut index = 0;
        let mut is_kept = false;
        self.marks.retain(|mark| {
            index += 1;
            if index > half || mark.kind.frequent_index().is_none() {
                return true;
            }
            is_kept = !is_kept;
            is_kept
        });
        if before - self.marks.len() < half / 4 {
            self.marks.drain(..half / 2);
        }
    }

    /// Removes and returns the marks later than a tick.
    pub(super) fn split_after(&mut self, tick: u64) -> Self {
        let remaining = self.marks.partition_point(|mark| mark.tick <= tick);
        self.shared = None;
        self.last_ticks = [None; 3];
        Self {
            marks: self.marks.split_off(remaining),
            ..Self::default()
        }
    }

    /// Appends the marks of `later`, all of which are later than these.
    pub(super) fn append(&mut self, mut later: Self) {
        self.marks.append(&mut later.marks);
        self.last_ticks = later.last_ticks;
        self.shared = None;
    }

    /// Returns the marks in the form that is shared with the window.
    pub(super) fn shared(&mut self) -> Arc<Vec<TimelineMark>> {
        let marks = &self.marks;
        Arc::clone(self.shared.get_or_insert_with(|| Arc::new(marks.clone())))
    }
}

/// Returns the kind of mark for an input; `None` for an input that no operator makes.
fn kind_of_input(input: &HistoryInput) -> Option<TimelineMarkKind> {
    match input {
        HistoryInput::Machine(EmulatorInput::Key(event)) => match event {
            KeyEvent::Down(key) => Some(TimelineMarkKind::Key(*key)),
            KeyEvent::Type(_) | KeyEvent::Wheel(_) => Some(TimelineMarkKind::Input),
            KeyEvent::Up(_) | KeyEvent::ReleaseAll => None,
        },
        HistoryInput::Machine(
            EmulatorInput::Request(_)
            | EmulatorInput::PowerOff
            | EmulatorInput::Fault(..)
            | EmulatorInput::ClearFaults
            | EmulatorInput::ForceInput(..)
            | EmulatorInput::Receive(_)
            | EmulatorInput::Port(_),
        )
        | HistoryInput::Part(_) => Some(TimelineMarkKind::Input),
        HistoryInput::Machine(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_session_keeps_its_rare_marks() {
        let mut list = MarkList::default();
        list.add(1, TimelineMarkKind::Alarm(10));
        for count in 0..200_000 {
            list.add(1000 + count * 100, TimelineMarkKind::Block);
        }
        let marks = list.shared();
        assert!(marks.len() <= MAX_MARKS && marks.len() > MAX_MARKS / 4);
        assert_eq!(marks[0].kind, TimelineMarkKind::Alarm(10));
        assert!(marks.is_sorted_by_key(|mark| mark.tick));
        let later = list.split_after(10_000_000);
        assert!(list.marks.iter().all(|mark| mark.tick <= 10_000_000));
        let count = list.marks.len() + later.marks.len();
        list.append(later);
        assert_eq!(list.shared().len(), count);
    }
}
