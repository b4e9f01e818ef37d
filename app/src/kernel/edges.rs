//! Queues key edges between the window and the panel.
//!
//! The window sends all edges of one frame together. This queue passes one press a tick,
//! so that the control loses none, and keeps each contact closed and open long enough for
//! the ladder. Edges that stop or release do not wait for others.

use std::collections::{BTreeMap, VecDeque};

use gsk_panel::keys::{Key, KeyRole};
use gsk_panel::panel::KeyEvent;

/// Shortest time a contact stays closed, ticks: the ladder sees a click between two
/// frames.
const SHORTEST_PRESS: u64 = 50;
/// Shortest time a contact stays open before the next press of the same key, ticks: three
/// samples of the input filter and two slots of the ladder.
const SHORTEST_REST: u64 = 28;
/// How long a key pressed by a screen reader stays down, ticks.
const TAP: u64 = 100;

/// A change of a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Edge {
    Down(Key),
    Up(Key),
    /// Pressed and released.
    Tap(Key),
    /// A typed character that has no key on the panel.
    Type(char),
}

impl Edge {
    /// Returns the key that goes down.
    const fn pressed(self) -> Option<Key> {
        match self {
            Self::Down(key) | Self::Tap(key) => Some(key),
            Self::Up(_) | Self::Type(_) => None,
        }
    }
}

/// When a key is released.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Release {
    /// With the next tick after its press: fingers that roll from key to key stay below
    /// No.119, the number of keys accepted at a time.
    ByItself,
    /// With its edge.
    WithEdge,
    /// With its edge, after the shortest press; it waits for no other key.
    Contact,
}

const fn release(key: Key) -> Release {
    match key.row().role {
        KeyRole::Character(..) => Release::ByItself,
        KeyRole::Machine(_) | KeyRole::OvertravelRelease => Release::Contact,
        KeyRole::Edit if matches!(key, Key::Eob) => Release::ByItself,
        // The level of the key starts the MDI block.
        KeyRole::Edit if matches!(key, Key::Output) => Release::Contact,
        KeyRole::Edit | KeyRole::Page | KeyRole::EmergencyStop => Release::WithEdge,
    }
}

/// Whether a key ends a motion: it takes all earlier presses with it at once.
const fn stops(key: Key) -> bool {
    matches!(key, Key::Reset | Key::FeedHold | Key::SpindleStop)
}

/// Whether a key starts a motion.
pub(super) const fn moves(key: Key) -> bool {
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

/// Edges that wait, and keys that are down.
#[derive(Debug, Default)]
pub(super) struct Edges {
    waiting: VecDeque<Edge>,
    /// Keys that are down, with the tick of their press.
    down: BTreeMap<Key, u64>,
    /// Ticks at which keys come up.
    releases: Vec<(u64, Key)>,
    /// Contacts that stay open until a tick.
    rests: BTreeMap<Key, u64>,
}

impl Edges {
    /// Adds a change of a key.
    pub fn push(&mut self, edge: Edge) {
        if let Edge::Up(key) = edge
            && release(key) == Release::Contact
            && self.down.contains_key(&key)
            && !self.waiting.iter().any(|edge| edge.pressed() == Some(key))
        {
            // A release ends its motion even if other keys wait.
            self.let_go(key, SHORTEST_PRESS);
            return;
        }
        self.waiting.push_back(edge);
    }

    /// Whether a key is down.
    pub fn any_down(&self) -> bool {
        !self.down.is_empty()
    }

    /// Drops all edges and releases all keys.
    pub fn clear(&mut self) {
        self.waiting.clear();
        self.down.clear();
        self.releases.clear();
        self.rests.clear();
    }

    /// Returns the events for the panel at a tick.
    pub fn due(&mut self, tick: u64) -> Vec<KeyEvent> {
        let mut events = Vec::new();
        if self.releases.is_empty() && self.waiting.is_empty() {
            return events;
        }
        self.come_up(tick, &mut events);
        let stop = |edge: &Edge| edge.pressed().is_some_and(stops);
        for _ in 0..self.waiting.iter().rposition(stop).map_or(0, |at| at + 1) {
            self.next(tick, &mut events);
        }
        while let Some(edge) = self.waiting.front().copied() {
            if !self.may(edge, tick) {
                break;
            }
            self.next(tick, &mut events);
            if !matches!(edge, Edge::Up(_)) {
                break;
            }
        }
        events
    }

    /// Whether an edge is due at a tick.
    fn may(&self, edge: Edge, tick: u64) -> bool {
        let rested = |key| self.rests.get(&key).is_none_or(|until| *until <= tick);
        match edge {
            Edge::Up(_) => true,
            Edge::Type(_) => self.releases.is_empty(),
            Edge::Down(key) | Edge::Tap(key) => self.releases.is_empty() && rested(key),
        }
    }

    fn next(&mut self, tick: u64, events: &mut Vec<KeyEvent>) {
        match self.waiting.pop_front() {
            Some(Edge::Down(key)) => {
                self.press(key, tick, events);
                if release(key) == Release::ByItself {
                    self.let_go(key, 1);
                }
            }
            Some(Edge::Tap(key)) => {
                self.press(key, tick, events);
                self.let_go(key, TAP);
            }
            Some(Edge::Up(key)) => {
                let shortest = match release(key) {
                    Release::Contact => SHORTEST_PRESS,
                    Release::ByItself | Release::WithEdge => 1,
                };
                self.let_go(key, shortest);
                self.come_up(tick, events);
            }
            Some(Edge::Type(character)) => events.push(KeyEvent::Type(character)),
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

    fn let_go(&mut self, key: Key, shortest: u64) {
        if let Some(since) = self.down.get(&key)
            && !self.releases.iter().any(|(_, waiting)| *waiting == key)
        {
            self.releases.push((since + shortest, key));
        }
    }

    fn come_up(&mut self, tick: u64, events: &mut Vec<KeyEvent>) {
        self.rests.retain(|_, until| *until > tick);
        let due = self.releases.extract_if(.., |(at, _)| *at <= tick);
        for (_, key) in due {
            if self.down.remove(&key).is_some() {
                events.push(KeyEvent::Up(key));
            }
            if release(key) == Release::Contact {
                self.rests.insert(key, tick + SHORTEST_REST);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Collects the panel's events with their ticks until the queue is empty.
    fn played(edges: &mut Edges, from: u64) -> Vec<(u64, KeyEvent)> {
        let mut told = Vec::new();
        for tick in from..from + 2000 {
            told.extend(edges.due(tick).into_iter().map(|event| (tick, event)));
        }
        told
    }

    fn downs(told: &[(u64, KeyEvent)]) -> Vec<KeyEvent> {
        let pressed = |event: &KeyEvent| matches!(event, KeyEvent::Down(_) | KeyEvent::Type(_));
        let events = told.iter().map(|(_, event)| *event);
        events.filter(pressed).collect()
    }

    #[test]
    fn keys_of_one_picture_go_down_one_after_the_other() {
        let mut edges = Edges::default();
        let typed = [Key::G, Key::Digit0, Key::Digit0, Key::X, Key::Eob];
        for key in typed {
            edges.push(Edge::Down(key));
            edges.push(Edge::Up(key));
        }
        edges.push(Edge::Type('Q'));
        let told = played(&mut edges, 7);
        let mut expected = typed.map(KeyEvent::Down).to_vec();
        expected.push(KeyEvent::Type('Q'));
        assert_eq!(downs(&told), expected);
        let mut held = 0;
        let mut last = 0;
        for (tick, event) in told {
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
        assert!(!edges.any_down());
    }

    #[test]
    fn fingers_that_roll_over_hold_one_key_at_a_time() {
        let mut edges = Edges::default();
        let typed = [Key::X, Key::Digit1, Key::Digit2, Key::Digit5, Key::Eob];
        for edge in [Edge::Down, Edge::Up] {
            for key in typed {
                edges.push(edge(key));
            }
        }
        let told = played(&mut edges, 0);
        assert_eq!(downs(&told), typed.map(KeyEvent::Down));
        assert!(!edges.any_down());
    }

    #[test]
    fn a_contact_is_closed_and_open_long_enough() {
        let mut edges = Edges::default();
        for _ in 0..2 {
            edges.push(Edge::Down(Key::SingleBlock));
            edges.push(Edge::Up(Key::SingleBlock));
        }
        let told = played(&mut edges, 0);
        let [down, up] = [KeyEvent::Down, KeyEvent::Up].map(|event| event(Key::SingleBlock));
        let again = SHORTEST_PRESS + SHORTEST_REST;
        let expected = [
            (0, down),
            (SHORTEST_PRESS, up),
            (again, down),
            (again + SHORTEST_PRESS, up),
        ];
        assert_eq!(told, expected);
    }

    #[test]
    fn a_key_held_for_another_is_down_with_it() {
        let mut edges = Edges::default();
        for edge in [Edge::Down(Key::Cancel), Edge::Down(Key::Reset)] {
            edges.push(edge);
        }
        for edge in [Edge::Up(Key::Reset), Edge::Up(Key::Cancel)] {
            edges.push(edge);
        }
        let events: Vec<_> = played(&mut edges, 0).into_iter().map(|it| it.1).collect();
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
    fn a_stop_and_the_release_of_a_contact_wait_behind_nothing() {
        let mut edges = Edges::default();
        edges.push(Edge::Down(Key::ZLeft));
        played(&mut edges, 0);
        for key in [Key::SingleBlock, Key::DryRun, Key::BlockSkip] {
            edges.push(Edge::Down(key));
            edges.push(Edge::Up(key));
        }
        edges.push(Edge::Up(Key::ZLeft));
        assert_eq!(edges.due(2000)[0], KeyEvent::Up(Key::ZLeft));
        edges.push(Edge::Down(Key::FeedHold));
        assert!(edges.due(2001).contains(&KeyEvent::Down(Key::FeedHold)));
    }

    #[test]
    fn a_key_pressed_and_let_go_within_one_picture_behind_others_is_a_press() {
        let mut edges = Edges::default();
        edges.push(Edge::Down(Key::Jog));
        edges.push(Edge::Up(Key::Jog));
        edges.push(Edge::Down(Key::ZLeft));
        edges.push(Edge::Up(Key::ZLeft));
        let told = played(&mut edges, 0);
        let expected = [Key::Jog, Key::ZLeft].map(KeyEvent::Down);
        assert_eq!(downs(&told), expected);
        assert!(!edges.any_down());
    }
}
