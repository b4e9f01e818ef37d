//! Which panel keys are held down, and by which holder: the mouse, fingers, PC keys.
//!
//! A panel key is down while at least one holder is on it. A key without a holder is released,
//! even if its release event was lost.
//!
//! One mouse can press two keys: a right click latches a key for the next one. The latched key
//! goes down just before that key and comes up with it. While it waits it holds nothing.

use std::collections::BTreeMap;

use gsk_host::input_watch::Holders;
use gsk_panel::keys::Key;

/// An input that holds a panel key down.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum KeyHolder {
    Pointer,
    /// The latch of a right click: it holds its key while the key that it waited for is down.
    Latch,
    /// A finger, identified by the ids of device and touch.
    Finger(u64, u64),
    Keyboard(egui::Key),
}

/// The change of a panel key that went down or came up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PanelKeyChange<K> {
    pub key: K,
    /// True if the key went down, false if it came up.
    pub is_down: bool,
}

/// State of the latch with which a right click holds a panel key down.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum KeyLatch<K> {
    #[default]
    Free,
    /// This key is latched until the next key is pressed.
    Waiting(K),
    /// The latched key is down while this other key is down.
    DownWith(K),
}

/// Assigns each holder the key that it holds down, and keeps the latched key.
#[derive(Clone, Debug)]
pub struct HeldKeys<K> {
    by_holder: BTreeMap<KeyHolder, K>,
    latch: KeyLatch<K>,
}

impl<K> Default for HeldKeys<K> {
    fn default() -> Self {
        Self {
            by_holder: BTreeMap::new(),
            latch: KeyLatch::Free,
        }
    }
}

impl HeldKeys<Key> {
    /// Sets the key that `holder` presses and returns the changes. Emergency stop and feed
    /// hold go down alone: a latched key is dropped.
    pub fn press(&mut self, holder: KeyHolder, key: Key) -> Vec<PanelKeyChange<Key>> {
        if matches!(key, Key::EmergencyStop | Key::FeedHold) {
            self.drop_waiting_latch();
        }
        self.set(holder, Some(key))
    }
}

/// Whether a right click may latch this key. Keys that move or start the machine must be held by
/// hand, and the emergency stop latches mechanically.
pub const fn can_be_latched(key: Key) -> bool {
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

impl<K: Copy + PartialEq> HeldKeys<K> {
    /// Sets the key that `holder` is on and returns the resulting changes, releases first.
    pub fn set(&mut self, holder: KeyHolder, key: Option<K>) -> Vec<PanelKeyChange<K>> {
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
            changes.push(PanelKeyChange {
                key: before,
                is_down: false,
            });
            if self.latch == KeyLatch::DownWith(before) {
                changes.extend(self.release_latched());
            }
        }
        if let Some(key) = key
            && self.by_holder.values().filter(|held| **held == key).count() == 1
        {
            changes.extend(self.press_latched(key));
            changes.push(PanelKeyChange { key, is_down: true });
        }
        changes
    }

    /// Presses the latched key together with `with`, the key that it waited for, and returns
    /// the changes, the latched key first.
    fn press_latched(&mut self, with: K) -> Vec<PanelKeyChange<K>> {
        let KeyLatch::Waiting(kept) = self.latch else {
            return Vec::new();
        };
        self.latch = KeyLatch::Free;
        if kept == with {
            return Vec::new();
        }
        let changes = self.set(KeyHolder::Latch, Some(kept));
        self.latch = KeyLatch::DownWith(with);
        changes
    }

    fn release_latched(&mut self) -> Vec<PanelKeyChange<K>> {
        self.latch = KeyLatch::Free;
        self.set(KeyHolder::Latch, None)
    }

    /// Latches a key until the next key is pressed, and returns the changes. `None`, or the
    /// key that is latched already, releases the latch.
    pub fn latch_key(&mut self, key: Option<K>) -> Vec<PanelKeyChange<K>> {
        let before = self.latched_key();
        let changes = self.release_latched();
        if let Some(key) = key.filter(|key| before != Some(*key)) {
            self.latch = KeyLatch::Waiting(key);
        }
        changes
    }

    /// Drops a latched key that still waits for the next one.
    pub fn drop_waiting_latch(&mut self) {
        if matches!(self.latch, KeyLatch::Waiting(_)) {
            self.latch = KeyLatch::Free;
        }
    }

    /// The latched key, whether it waits or is down with the next key; `None` without one.
    pub fn latched_key(&self) -> Option<K> {
        match self.latch {
            KeyLatch::Free => None,
            KeyLatch::Waiting(key) => Some(key),
            KeyLatch::DownWith(_) => self.key_of(KeyHolder::Latch),
        }
    }

    /// Releases all keys and returns the changes, for example when the window has lost the
    /// focus or was hidden.
    pub fn release_all(&mut self) -> Vec<PanelKeyChange<K>> {
        self.drop_waiting_latch();
        let holders: Vec<KeyHolder> = self.by_holder.keys().copied().collect();
        holders
            .into_iter()
            .flat_map(|holder| self.set(holder, None))
            .collect()
    }

    /// Counts the holders by their kind, for the watchdog of the kernel.
    pub fn holders(&self) -> Holders {
        let count = |is: fn(&KeyHolder) -> bool| self.by_holder.keys().filter(|it| is(it)).count();
        Holders {
            keys: count(|it| matches!(it, KeyHolder::Keyboard(_))),
            pointer: count(|it| matches!(it, KeyHolder::Pointer)) > 0,
            fingers: count(|it| matches!(it, KeyHolder::Finger(..))),
        }
    }

    /// The keys that are down; a key with several holders occurs several times.
    pub fn keys(&self) -> impl Iterator<Item = K> {
        self.by_holder.values().copied()
    }

    /// The key that `holder` holds down; `None` if it holds none.
    pub fn key_of(&self, holder: KeyHolder) -> Option<K> {
        self.by_holder.get(&holder).copied()
    }

    /// Whether any key is held.
    pub fn has_any(&self) -> bool {
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

    const fn change(key: char, down: bool) -> PanelKeyChange<char> {
        PanelKeyChange { key, is_down: down }
    }

    #[test]
    fn a_key_is_down_until_the_last_holder_leaves() {
        let mut held = HeldKeys::default();
        let finger = KeyHolder::Finger(0, 1);
        assert_eq!(held.set(KeyHolder::Pointer, Some('a')), [change('a', true)]);
        assert_eq!(held.set(finger, Some('a')), []);
        assert_eq!(held.set(KeyHolder::Pointer, None), []);
        assert_eq!(held.set(finger, None), [change('a', false)]);
        assert_eq!(held.set(finger, None), []);
    }

    #[test]
    fn sliding_to_another_key_releases_the_first() {
        let mut held = HeldKeys::default();
        held.set(KeyHolder::Pointer, Some('a'));
        let changes = held.set(KeyHolder::Pointer, Some('b'));
        assert_eq!(changes, [change('a', false), change('b', true)]);
        assert!(held.is_down('b') && !held.is_down('a'));
    }

    #[test]
    fn a_latched_key_goes_down_and_up_with_the_next_one() {
        let mut held = HeldKeys::default();
        assert_eq!(held.latch_key(Some('c')), []);
        assert!(
            !held.has_any() && held.latched_key() == Some('c'),
            "it holds nothing"
        );
        let pressed = held.set(KeyHolder::Pointer, Some('r'));
        assert_eq!(pressed, [change('c', true), change('r', true)]);
        // A second finger is not the key that the latch waits for.
        let finger = KeyHolder::Finger(0, 1);
        held.set(finger, Some('x'));
        assert_eq!(held.set(finger, None), [change('x', false)]);
        let released = held.set(KeyHolder::Pointer, None);
        assert_eq!(released, [change('r', false), change('c', false)]);
        assert_eq!(held.latched_key(), None);
        let again = held.set(KeyHolder::Keyboard(egui::Key::R), Some('r'));
        assert_eq!(again, [change('r', true)], "for one use");
    }

    #[test]
    fn the_same_key_an_empty_position_and_focus_loss_drop_the_latch() {
        let mut held = HeldKeys::default();
        held.latch_key(Some('c'));
        assert_eq!(held.set(KeyHolder::Pointer, Some('c')), [change('c', true)]);
        assert_eq!(held.set(KeyHolder::Pointer, None), [change('c', false)]);
        for forget in [
            |held: &mut HeldKeys<char>| held.latch_key(Some('c')),
            |held: &mut HeldKeys<char>| held.latch_key(None),
            HeldKeys::release_all,
        ] {
            held.latch_key(Some('c'));
            assert_eq!(forget(&mut held), []);
            assert_eq!(held.latched_key(), None);
        }
        held.latch_key(Some('c'));
        held.set(KeyHolder::Pointer, Some('r'));
        assert_eq!(held.latch_key(None), [change('c', false)]);
    }

    #[test]
    fn a_stop_key_drops_the_latch() {
        let mut held = HeldKeys::default();
        for stop in [Key::EmergencyStop, Key::FeedHold] {
            held.latch_key(Some(Key::Rapid));
            let pressed = held.press(KeyHolder::Pointer, stop);
            assert_eq!(pressed.len(), 1, "{pressed:?}");
            assert_eq!(held.latched_key(), None);
            held.set(KeyHolder::Pointer, None);
        }
    }

    #[test]
    fn losing_the_focus_releases_everything() {
        let mut held = HeldKeys::default();
        held.set(KeyHolder::Finger(0, 1), Some('a'));
        held.set(KeyHolder::Finger(0, 2), Some('b'));
        held.set(KeyHolder::Keyboard(egui::Key::A), Some('b'));
        let released = held.release_all();
        assert_eq!(released, [change('a', false), change('b', false)]);
        assert_eq!(held.release_all(), []);
    }
}
