//! Which panel keys are held down, and by what: the mouse, fingers, PC keys.
//!
//! A panel key is down as long as at least one holder is on it. What is not
//! held any more is released whatever became of the release event.

use std::collections::BTreeMap;

/// Something that holds a panel key down.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Holder {
    /// The mouse.
    Pointer,
    /// The mouse's right button: it holds its key until it clicks there again.
    Latch,
    /// A finger, by its device and number.
    Finger(u64, u64),
    /// A key of the PC keyboard.
    Keyboard(egui::Key),
}

/// A panel key went down or came up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Change<K> {
    /// The key.
    pub key: K,
    /// Whether it is down now.
    pub down: bool,
}

/// The held keys.
#[derive(Clone, Debug)]
pub struct Held<K> {
    by_holder: BTreeMap<Holder, K>,
}

impl<K> Default for Held<K> {
    fn default() -> Self {
        Self {
            by_holder: BTreeMap::new(),
        }
    }
}

impl<K: Copy + PartialEq> Held<K> {
    /// The key a holder is on from now on; tells what changed, releases first.
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
        }
        if let Some(key) = key
            && self.by_holder.values().filter(|held| **held == key).count() == 1
        {
            changes.push(Change { key, down: true });
        }
        changes
    }

    /// Lets everything go: the window lost the focus, was hidden, …
    pub fn release_all(&mut self) -> Vec<Change<K>> {
        let holders: Vec<Holder> = self.by_holder.keys().copied().collect();
        holders
            .into_iter()
            .flat_map(|holder| self.set(holder, None))
            .collect()
    }

    /// The keys that are down; one with several holders comes several times.
    pub fn keys(&self) -> impl Iterator<Item = K> {
        self.by_holder.values().copied()
    }

    /// What a holder is on.
    pub fn of(&self, holder: Holder) -> Option<K> {
        self.by_holder.get(&holder).copied()
    }

    /// Whether anything is held.
    pub fn any(&self) -> bool {
        !self.by_holder.is_empty()
    }

    /// Whether a key is held by anything.
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
