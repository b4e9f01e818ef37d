//! Edges of keys on their way from the window to the panel.
//!
//! The window hands over what happened within a picture in one go. Here each press
//! waits for the one before it, so that a hand faster than the control's eye loses
//! none: one press a tick, a contact closed and open long enough for the ladder.
//! Nothing that stops or lets go waits behind them.

use std::collections::{BTreeMap, VecDeque};

use gsk_panel::keys::{Key, KeyRole};
use gsk_panel::panel::KeyEvent;

/// A contact stays closed at least so long, ticks: a click between two pictures is
/// still seen by the ladder.
const SHORTEST_PRESS: u64 = 50;
/// It stays open at least so long before the next press of the same key, ticks: three
/// samples of the input filter and two slots of the ladder.
const SHORTEST_REST: u64 = 28;
/// How long a key pressed by a screen reader stays down, ticks.
const TAP: u64 = 100;

/// What happened to a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Edge {
    /// It went down.
    Down(Key),
    /// It came up.
    Up(Key),
    /// It was pressed and let go.
    Tap(Key),
    /// A character was typed that has no key of its own.
    Type(char),
}

impl Edge {
    /// The key that goes down.
    const fn pressed(self) -> Option<Key> {
        match self {
            Self::Down(key) | Self::Tap(key) => Some(key),
            Self::Up(_) | Self::Type(_) => None,
        }
    }
}

/// How a key is let go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Release {
    /// It acts when it goes down and comes up by itself with the next tick: fingers
    /// that roll from key to key stay below No.119, the keys accepted at a time.
    ByItself,
    /// With its edge.
    WithEdge,
    /// With its edge, after the shortest press; it waits behind no other key.
    Contact,
}

const fn release(key: Key) -> Release {
    match key.row().role {
        KeyRole::Character(..) => Release::ByItself,
        KeyRole::Machine(_) | KeyRole::OvertravelRelease => Release::Contact,
        KeyRole::Edit if matches!(key, Key::Eob) => Release::ByItself,
        // Its level starts the MDI block.
        KeyRole::Edit if matches!(key, Key::Output) => Release::Contact,
        KeyRole::Edit | KeyRole::Page | KeyRole::EmergencyStop => Release::WithEdge,
    }
}

/// Keys that end a motion: what was pressed before them goes with them at once.
const fn stops(key: Key) -> bool {
    matches!(key, Key::Reset | Key::FeedHold | Key::SpindleStop)
}

/// Keys that move or start something by themselves.
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

/// The edges that wait, and the keys that are down.
#[derive(Debug, Default)]
pub(super) struct Edges {
    waiting: VecDeque<Edge>,
    /// Keys that are down, with the tick they went down at.
    down: BTreeMap<Key, u64>,
    /// Keys that come up at a tick.
    releases: Vec<(u64, Key)>,
    /// Contacts that are to stay open until a tick.
    rests: BTreeMap<Key, u64>,
}

impl Edges {
    /// Something happened to a key.
    pub fn push(&mut self, edge: Edge) {
        if let Edge::Up(key) = edge
            && release(key) == Release::Contact
            && self.down.contains_key(&key)
            && !self.waiting.iter().any(|edge| edge.pressed() == Some(key))
        {
            // No motion goes on because other keys wait.
            self.let_go(key, SHORTEST_PRESS);
            return;
        }
        self.waiting.push_back(edge);
    }

    /// Whether a key is down.
    pub fn any_down(&self) -> bool {
        !self.down.is_empty()
    }

    /// Forgets everything: every key is let go.
    pub fn clear(&mut self) {
        self.waiting.clear();
        self.down.clear();
        self.releases.clear();
        self.rests.clear();
    }

    /// What the panel is told at a tick.
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

    /// Whether an edge need not wait any more.
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

    /// What the panel is told, with the tick, until nothing waits any more.
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
