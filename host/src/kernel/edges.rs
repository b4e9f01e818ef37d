//! Queues key edges between the window and the panel.
//!
//! The window sends all edges of one frame together. This queue passes one press a tick,
//! so that the control loses none, and keeps each contact closed and open long enough for
//! the ladder. Edges that stop or release do not wait for others.

use std::collections::{BTreeMap, VecDeque};

use gsk_panel::keys::{Key, KeyRole};
use gsk_panel::panel::KeyEvent;

/// Shortest time for which a key contact stays closed, ticks, so that the ladder detects even a
/// click between two frames.
const MIN_PRESS_TICKS: u64 = 50;
/// Shortest time for which a key contact stays open before the next press of the same key, ticks:
/// three samples of the input filter and two slots of the ladder.
const MIN_REST_TICKS: u64 = 28;
/// Time for which a key that a screen reader presses stays down, ticks.
const TAP_TICKS: u64 = 100;

/// A change of a key by the operator: press, release or tap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum KeyEdge {
    Down(Key),
    Up(Key),
    /// The key is pressed and released again.
    Tap(Key),
    /// A character without a key on the panel is typed.
    Type(char),
}

impl KeyEdge {
    /// Returns the key that this change presses; `None` for a release or a typed character.
    const fn pressed_key(self) -> Option<Key> {
        match self {
            Self::Down(key) | Self::Tap(key) => Some(key),
            Self::Up(_) | Self::Type(_) => None,
        }
    }
}

/// The moment at which the panel receives the release of a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ReleaseTiming {
    /// In the tick after the press: fingers that roll from key to key stay below parameter
    /// No.119, the number of keys accepted at a time.
    NextTick,
    /// When the operator releases the key, in the order of the queue.
    WithEdge,
    /// When the operator releases the key, but at the earliest after `MIN_PRESS_TICKS`; the
    /// release does not wait for other keys.
    Contact,
}

const fn release_timing(key: Key) -> ReleaseTiming {
    match key.row().role {
        KeyRole::Character(..) => ReleaseTiming::NextTick,
        KeyRole::Machine(_) | KeyRole::OvertravelRelease => ReleaseTiming::Contact,
        KeyRole::Edit if matches!(key, Key::Eob) => ReleaseTiming::NextTick,
        // The level of the key starts the MDI block.
        KeyRole::Edit if matches!(key, Key::Output) => ReleaseTiming::Contact,
        KeyRole::Edit | KeyRole::Page | KeyRole::Soft(_) | KeyRole::EmergencyStop => {
            ReleaseTiming::WithEdge
        }
    }
}

/// Whether a key ends a motion. Its press applies all earlier waiting changes at once.
pub(super) const fn ends_motion(key: Key) -> bool {
    matches!(key, Key::Reset | Key::FeedHold | Key::SpindleStop)
}

/// Whether the ladder reads a key, so that its contact must stay closed for some of its slots.
pub(super) const fn is_read_by_ladder(key: Key) -> bool {
    matches!(release_timing(key), ReleaseTiming::Contact)
        || ends_motion(key)
        || matches!(key, Key::EmergencyStop)
}

/// Whether pressing a key can start a motion.
pub(super) const fn starts_motion(key: Key) -> bool {
    matches!(
        key,
        Key::XUp
            | Key::XDown
            | Key::ZLeft
            | Key::ZRight
            | Key::YMinus
            | Key::YPlus
            | Key::CycleStart
            | Key::SpindleForward
            | Key::SpindleReverse
            | Key::ToolChange
            | Key::Output
    )
}

/// Changes of keys that wait for their tick, and the keys that are down.
#[derive(Debug, Default)]
pub(super) struct KeyEdgeQueue {
    pending: VecDeque<KeyEdge>,
    /// Keys that are down, with the tick at which they were pressed.
    down: BTreeMap<Key, u64>,
    /// Planned releases, each with its tick and key.
    releases: Vec<(u64, Key)>,
    /// Tick until which the contact of each released key must stay open.
    open_until: BTreeMap<Key, u64>,
}

impl KeyEdgeQueue {
    /// Adds a change of a key; the release of a machine key that is down is planned at once.
    pub fn push(&mut self, edge: KeyEdge) {
        if let KeyEdge::Up(key) = edge
            && release_timing(key) == ReleaseTiming::Contact
            && self.down.contains_key(&key)
            && !self
                .pending
                .iter()
                .any(|edge| edge.pressed_key() == Some(key))
        {
            // A release ends its motion even if other keys wait.
            self.schedule_release(key, MIN_PRESS_TICKS);
            return;
        }
        self.pending.push_back(edge);
    }

    /// Whether any key of the panel is down.
    pub fn has_key_down(&self) -> bool {
        !self.down.is_empty()
    }

    /// Drops all waiting changes and forgets all keys that are down.
    pub fn clear(&mut self) {
        self.pending.clear();
        self.down.clear();
        self.releases.clear();
        self.open_until.clear();
    }

    /// Removes and returns the events that the panel gets at `tick`.
    pub fn take_due(&mut self, tick: u64) -> Vec<KeyEvent> {
        let mut events = Vec::new();
        if self.releases.is_empty() && self.pending.is_empty() {
            return events;
        }
        self.apply_releases(tick, &mut events);
        let stop = |edge: &KeyEdge| edge.pressed_key().is_some_and(ends_motion);
        for _ in 0..self.pending.iter().rposition(stop).map_or(0, |at| at + 1) {
            self.apply_next(tick, &mut events);
        }
        while let Some(edge) = self.pending.front().copied() {
            if !self.is_due(edge, tick) {
                break;
            }
            self.apply_next(tick, &mut events);
            if !matches!(edge, KeyEdge::Up(_)) {
                break;
            }
        }
        events
    }

    /// Whether a waiting key change may be applied at `tick`.
    fn is_due(&self, edge: KeyEdge, tick: u64) -> bool {
        let rested = |key| self.open_until.get(&key).is_none_or(|until| *until <= tick);
        match edge {
            KeyEdge::Up(_) => true,
            KeyEdge::Type(_) => self.releases.is_empty(),
            KeyEdge::Down(key) | KeyEdge::Tap(key) => self.releases.is_empty() && rested(key),
        }
    }

    fn apply_next(&mut self, tick: u64, events: &mut Vec<KeyEvent>) {
        match self.pending.pop_front() {
            Some(KeyEdge::Down(key)) => {
                self.press(key, tick, events);
                if release_timing(key) == ReleaseTiming::NextTick {
                    self.schedule_release(key, 1);
                }
            }
            Some(KeyEdge::Tap(key)) => {
                self.press(key, tick, events);
                self.schedule_release(key, TAP_TICKS);
            }
            Some(KeyEdge::Up(key)) => {
                let shortest = match release_timing(key) {
                    ReleaseTiming::Contact => MIN_PRESS_TICKS,
                    ReleaseTiming::NextTick | ReleaseTiming::WithEdge => 1,
                };
                self.schedule_release(key, shortest);
                self.apply_releases(tick, events);
            }
            Some(KeyEdge::Type(character)) => events.push(KeyEvent::Type(character)),
            None => {}
        }
    }

    fn press(&mut self, key: Key, tick: u64, events: &mut Vec<KeyEvent>) {
        self.releases.retain(|(_, waiting)| *waiting != key);
        if self.down.insert(key, tick).is_some() {
            // Pressed again before the release was due: two presses, not one.
            events.push(KeyEvent::Up(key));
        }
        events.push(KeyEvent::Down(key));
    }

    fn schedule_release(&mut self, key: Key, shortest: u64) {
        if let Some(since) = self.down.get(&key)
            && !self.releases.iter().any(|(_, waiting)| *waiting == key)
        {
            self.releases.push((since + shortest, key));
        }
    }

    fn apply_releases(&mut self, tick: u64, events: &mut Vec<KeyEvent>) {
        self.open_until.retain(|_, until| *until > tick);
        let due = self.releases.extract_if(.., |(at, _)| *at <= tick);
        for (_, key) in due {
            if self.down.remove(&key).is_some() {
                events.push(KeyEvent::Up(key));
            }
            if release_timing(key) == ReleaseTiming::Contact {
                self.open_until.insert(key, tick + MIN_REST_TICKS);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Collects the panel's events with their ticks, from tick `from` until the queue is
    /// empty.
    fn play(edges: &mut KeyEdgeQueue, from: u64) -> Vec<(u64, KeyEvent)> {
        let mut timed_events = Vec::new();
        for tick in from..from + 2000 {
            timed_events.extend(edges.take_due(tick).into_iter().map(|event| (tick, event)));
        }
        timed_events
    }

    fn downs(timed_events: &[(u64, KeyEvent)]) -> Vec<KeyEvent> {
        let pressed = |event: &KeyEvent| matches!(event, KeyEvent::Down(_) | KeyEvent::Type(_));
        let events = timed_events.iter().map(|(_, event)| *event);
        events.filter(pressed).collect()
    }

    #[test]
    fn keys_of_one_picture_go_down_one_after_the_other() {
        let mut edges = KeyEdgeQueue::default();
        let typed = [Key::G, Key::Digit0, Key::Digit0, Key::X, Key::Eob];
        for key in typed {
            edges.push(KeyEdge::Down(key));
            edges.push(KeyEdge::Up(key));
        }
        edges.push(KeyEdge::Type('Q'));
        let timed_events = play(&mut edges, 7);
        let mut expected = typed.map(KeyEvent::Down).to_vec();
        expected.push(KeyEvent::Type('Q'));
        assert_eq!(downs(&timed_events), expected);
        let mut held = 0;
        let mut last = 0;
        for (tick, event) in timed_events {
            match event {
                KeyEvent::Down(_) => {
                    assert!(tick > last, "one press a tick");
                    last = tick;
                    held += 1;
                }
                KeyEvent::Up(_) => held -= 1,
                _ => {}
            }
            assert!((0..=1).contains(&held), "one key at a time");
        }
        assert!(!edges.has_key_down());
    }

    #[test]
    fn fingers_that_roll_over_hold_one_key_at_a_time() {
        let mut edges = KeyEdgeQueue::default();
        let typed = [Key::X, Key::Digit1, Key::Digit2, Key::Digit5, Key::Eob];
        for edge in [KeyEdge::Down, KeyEdge::Up] {
            for key in typed {
                edges.push(edge(key));
            }
        }
        let timed_events = play(&mut edges, 0);
        assert_eq!(downs(&timed_events), typed.map(KeyEvent::Down));
        assert!(!edges.has_key_down());
    }

    #[test]
    fn a_contact_is_closed_and_open_long_enough() {
        let mut edges = KeyEdgeQueue::default();
        for _ in 0..2 {
            edges.push(KeyEdge::Down(Key::SingleBlock));
            edges.push(KeyEdge::Up(Key::SingleBlock));
        }
        let timed_events = play(&mut edges, 0);
        let [down, up] = [KeyEvent::Down, KeyEvent::Up].map(|event| event(Key::SingleBlock));
        let again = MIN_PRESS_TICKS + MIN_REST_TICKS;
        let expected = [
            (0, down),
            (MIN_PRESS_TICKS, up),
            (again, down),
            (again + MIN_PRESS_TICKS, up),
        ];
        assert_eq!(timed_events, expected);
    }

    #[test]
    fn a_key_held_for_another_is_down_with_it() {
        let mut edges = KeyEdgeQueue::default();
        for edge in [KeyEdge::Down(Key::Cancel), KeyEdge::Down(Key::Reset)] {
            edges.push(edge);
        }
        for edge in [KeyEdge::Up(Key::Reset), KeyEdge::Up(Key::Cancel)] {
            edges.push(edge);
        }
        let events: Vec<_> = play(&mut edges, 0).into_iter().map(|it| it.1).collect();
        let cancel = events
            .iter()
            .position(|it| *it == KeyEvent::Up(Key::Cancel));
        let reset = events
            .iter()
            .position(|it| *it == KeyEvent::Down(Key::Reset));
        assert_eq!(events[0], KeyEvent::Down(Key::Cancel));
        assert!(reset < cancel, "{events:?}");
    }

    #[test]
    fn a_stop_and_the_release_of_a_contact_do_not_wait() {
        let mut edges = KeyEdgeQueue::default();
        edges.push(KeyEdge::Down(Key::ZLeft));
        play(&mut edges, 0);
        for key in [Key::SingleBlock, Key::DryRun, Key::BlockSkip] {
            edges.push(KeyEdge::Down(key));
            edges.push(KeyEdge::Up(key));
        }
        edges.push(KeyEdge::Up(Key::ZLeft));
        assert_eq!(edges.take_due(2000)[0], KeyEvent::Up(Key::ZLeft));
        edges.push(KeyEdge::Down(Key::FeedHold));
        assert!(
            edges
                .take_due(2001)
                .contains(&KeyEvent::Down(Key::FeedHold))
        );
    }

    #[test]
    fn a_key_pressed_and_released_within_one_frame_after_others_is_a_press() {
        let mut edges = KeyEdgeQueue::default();
        edges.push(KeyEdge::Down(Key::Jog));
        edges.push(KeyEdge::Up(Key::Jog));
        edges.push(KeyEdge::Down(Key::ZLeft));
        edges.push(KeyEdge::Up(Key::ZLeft));
        let timed_events = play(&mut edges, 0);
        let expected = [Key::Jog, Key::ZLeft].map(KeyEvent::Down);
        assert_eq!(downs(&timed_events), expected);
        assert!(!edges.has_key_down());
    }
}
