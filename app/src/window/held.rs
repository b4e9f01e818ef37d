//! Which panel keys are held down, and by which holder: the mouse, fingers, PC keys.
//!
//! A panel key is down while at least one holder is on it. A key without a holder is released,
//! even if its release event was lost.
//!
//! One mouse can press two keys: a right click latches a key for the next one. The latched key
//! goes down just before that key and comes up with it. While it waits it holds nothing.

use std::collections::BTreeMap;

use gsk_panel::keys::Key;

use crate::input_watch::Holders;

/// What holds a panel key down.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Holder {
    Pointer,
    /// The latch of a right click, while the key it waited for is down.
    Latch,
    /// A finger, by the ids of device and touch.
    Finger(u64, u64),
    Keyboard(egui::Key),
}

/// A panel key went down or came up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Change<K> {
    pub key: K,
    /// Whether it is down now.
    pub down: bool,
}

/// The key that a right click has latched.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Latch<K> {
    #[default]
    Free,
    /// This key waits for the next one.
    Waits(K),
    /// The latched key is down while this key is.
    DownWith(K),
}

/// Assigns each holder the key that it holds down.
#[derive(Clone, Debug)]
pub struct Held<K> {
    by_holder: BTreeMap<Holder, K>,
    latch: Latch<K>,
}

impl<K> Default for Held<K> {
    fn default() -> Self {
        Self {
            by_holder: BTreeMap::new(),
            latch: Latch::Free,
        }
    }
}

impl Held<Key> {
    /// Sets the key that `holder` presses. Emergency stop and feed hold go down alone: a
    /// latched key is dropped.
    pub fn press(&mut self, holder: Holder, key: Key) -> Vec<Change<Key>> {
        if matches!(key, Key::EmergencyStop | Key::FeedHold) {
            self.forget_kept();
        }
        self.set(holder, Some(key))
    }
}

/// Whether a right click may latch this key. Keys that move or start something must be pressed
/// by hand, and the emergency stop latches mechanically.
pub const fn may_be_kept(key: Key) -> bool {
    !matches!(
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
            | Key::Lubrication
            | Key::ToolChange
            | Key::EmergencyStop
    )
}

impl<K: Copy + PartialEq> Held<K> {
    /// Sets the key that `holder` is on and returns the resulting changes, releases first.
    pub fn set(&mut self, holder: Holder, key: Option<K>) -> Vec<Change<K>> {
        let before = match key {
            Some(key) => self.by_holder.insert(holder, key),
            None => self.by_holder.remove(&holder),
        };
        if before == key {
            return Vec::new();
        }
        let mut changes = Vec::new();
        if let Some(before) = before
            && !self.is_down(before)
        {
            changes.push(Change {
                key: before,
                down: false,
            });
            if self.latch == Latch::DownWith(before) {
                changes.extend(self.end_latch());
            }
        }
        if let Some(key) = key
            && self.by_holder.values().filter(|held| **held == key).count() == 1
        {
            changes.extend(self.begin_latch(key));
            changes.push(Change { key, down: true });
        }
        changes
    }

    /// Presses the latched key before `with`, the key that it waited for.
    fn begin_latch(&mut self, with: K) -> Vec<Change<K>> {
        let Latch::Waits(kept) = self.latch else {
            return Vec::new();
        };
        self.latch = Latch::Free;
        if kept == with {
            return Vec::new();
        }
        let changes = self.set(Holder::Latch, Some(kept));
        self.latch = Latch::DownWith(with);
        changes
    }

    fn end_latch(&mut self) -> Vec<Change<K>> {
        self.latch = Latch::Free;
        self.set(Holder::Latch, None)
    }

    /// Latches a key for the next one. The latched key itself, or `None`, releases the latch.
    pub fn keep(&mut self, key: Option<K>) -> Vec<Change<K>> {
        let before = self.kept();
        let changes = self.end_latch();
        if let Some(key) = key.filter(|key| before != Some(*key)) {
            self.latch = Latch::Waits(key);
        }
        changes
    }

    /// Drops a latched key that still waits for the next one.
    pub fn forget_kept(&mut self) {
        if matches!(self.latch, Latch::Waits(_)) {
            self.latch = Latch::Free;
        }
    }

    /// The latched key, waiting or down with the next one.
    pub fn kept(&self) -> Option<K> {
        match self.latch {
            Latch::Free => None,
            Latch::Waits(key) => Some(key),
            Latch::DownWith(_) => self.of(Holder::Latch),
        }
    }

    /// Releases all keys, for example when the window has lost the focus or was hidden.
    pub fn release_all(&mut self) -> Vec<Change<K>> {
        self.forget_kept();
        let holders: Vec<Holder> = self.by_holder.keys().copied().collect();
        holders
            .into_iter()
            .flat_map(|holder| self.set(holder, None))
            .collect()
    }

    /// Counts the holders by their kind, for the watchdog of the kernel.
    pub fn holders(&self) -> Holders {
        let count = |is: fn(&Holder) -> bool| self.by_holder.keys().filter(|it| is(it)).count();
        Holders {
            keys: count(|it| matches!(it, Holder::Keyboard(_))),
            pointer: count(|it| matches!(it, Holder::Pointer)) > 0,
            fingers: count(|it| matches!(it, Holder::Finger(..))),
        }
    }

    /// The keys that are down; a key with several holders occurs several times.
    pub fn keys(&self) -> impl Iterator<Item = K> {
        self.by_holder.values().copied()
    }

    /// The key that `holder` holds down.
    pub fn of(&self, holder: Holder) -> Option<K> {
        self.by_holder.get(&holder).copied()
    }

    /// Whether any key is held.
    pub fn any(&self) -> bool {
        !self.by_holder.is_empty()
    }

    /// Whether any holder holds `key`.
    pub fn is_down(&self, key: K) -> bool {
        self.by_holder.values().any(|held| *held == key)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn change(key: char, down: bool) -> Change<char> {
        Change { key, down }
    }

    #[test]
    fn a_key_is_down_until_the_last_holder_leaves() {
        let mut held = Held::default();
        let finger = Holder::Finger(0, 1);
        assert_eq!(held.set(Holder::Pointer, Some('a')), [change('a', true)]);
        assert_eq!(held.set(finger, Some('a')), []);
        assert_eq!(held.set(Holder::Pointer, None), []);
        assert_eq!(held.set(finger, None), [change('a', false)]);
        assert_eq!(held.set(finger, None), []);
    }

    #[test]
    fn sliding_to_another_key_releases_the_first() {
        let mut held = Held::default();
        held.set(Holder::Pointer, Some('a'));
        let changes = held.set(Holder::Pointer, Some('b'));
        assert_eq!(changes, [change('a', false), change('b', true)]);
        assert!(held.is_down('b') && !held.is_down('a'));
    }

    #[test]
    fn a_kept_key_goes_down_with_the_next_one_and_comes_up_with_it() {
        let mut held = Held::default();
        assert_eq!(held.keep(Some('c')), []);
        assert!(!held.any() && held.kept() == Some('c'), "it holds nothing");
        let pressed = held.set(Holder::Pointer, Some('r'));
        assert_eq!(pressed, [change('c', true), change('r', true)]);
        // A second finger is not the key that the latch waits for.
        let finger = Holder::Finger(0, 1);
        held.set(finger, Some('x'));
        assert_eq!(held.set(finger, None), [change('x', false)]);
        let released = held.set(Holder::Pointer, None);
        assert_eq!(released, [change('r', false), change('c', false)]);
        assert_eq!(held.kept(), None);
        let again = held.set(Holder::Keyboard(egui::Key::R), Some('r'));
        assert_eq!(again, [change('r', true)], "for one use");
    }

    #[test]
    fn a_kept_key_is_given_up_by_itself_by_a_place_without_key_and_by_the_focus() {
        let mut held = Held::default();
        held.keep(Some('c'));
        assert_eq!(held.set(Holder::Pointer, Some('c')), [change('c', true)]);
        assert_eq!(held.set(Holder::Pointer, None), [change('c', false)]);
        for forget in [
            |held: &mut Held<char>| held.keep(Some('c')),
            |held: &mut Held<char>| held.keep(None),
            Held::release_all,
        ] {
            held.keep(Some('c'));
            assert_eq!(forget(&mut held), []);
            assert_eq!(held.kept(), None);
        }
        held.keep(Some('c'));
        held.set(Holder::Pointer, Some('r'));
        assert_eq!(held.keep(None), [change('c', false)]);
    }

    #[test]
    fn a_stop_takes_nothing_with_it() {
        let mut held = Held::default();
        for stop in [Key::EmergencyStop, Key::FeedHold] {
            held.keep(Some(Key::Rapid));
            let pressed = held.press(Holder::Pointer, stop);
            assert_eq!(pressed.len(), 1, "{pressed:?}");
            assert_eq!(held.kept(), None);
            held.set(Holder::Pointer, None);
        }
    }

    #[test]
    fn losing_the_focus_releases_everything() {
        let mut held = Held::default();
        held.set(Holder::Finger(0, 1), Some('a'));
        held.set(Holder::Finger(0, 2), Some('b'));
        held.set(Holder::Keyboard(egui::Key::A), Some('b'));
        let released = held.release_all();
        assert_eq!(released, [change('a', false), change('b', false)]);
        assert_eq!(held.release_all(), []);
    }
}
