//! What differs from one control to another, and taking it over.

use std::collections::BTreeSet;

use gsk_core::command::ProgramId;

use crate::build::{Fault, build};
use crate::key::{Key, Section};
use crate::state::State;
use crate::value::Value;

/// A value that is another.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// Which value.
    pub key: Key,
    /// What it is; none where there is no such thing.
    pub old: Option<Value>,
    /// What it is to be.
    pub new: Option<Value>,
}

impl Difference {
    /// Where it belongs.
    pub const fn section(&self) -> Section {
        Section::of(self.key)
    }
}

/// What differs, in the order of the files. Machine file and jobs are compared where both
/// have such files: a control has none. Where `new` says nothing of the panel, nothing of it
/// differs.
pub fn diff(old: &State, new: &State) -> Vec<Difference> {
    let with_texts = old.texts().is_some() && new.texts().is_some();
    let with_panel = new.panel().is_some();
    let [mut before, mut after] = [old, new].map(State::entries);
    let keys: BTreeSet<Key> = before.keys().chain(after.keys()).copied().collect();
    keys.into_iter()
        .filter(|key| match Section::of(*key) {
            Section::Machine | Section::Jobs => with_texts,
            Section::Panel => with_panel,
            _ => true,
        })
        .map(|key| Difference {
            key,
            old: before.remove(&key),
            new: after.remove(&key),
        })
        .filter(|difference| difference.old != difference.new)
        .collect()
}

/// A control with some of its values changed. Where the selected program is gone, the first
/// one is selected, as the control does it.
///
/// # Errors
/// The rules that the whole would break: a disk that would lack some of its values, a memory
/// that would be too full.
pub fn apply(state: &State, differences: &[Difference]) -> Result<State, Vec<Fault>> {
    let mut entries = state.entries();
    for difference in differences {
        match &difference.new {
            Some(value) => entries.insert(difference.key, value.clone()),
            None => entries.remove(&difference.key),
        };
    }
    if let Some(Value::Selected(Some(number))) = entries.get(&Key::Selected)
        && !entries.contains_key(&Key::Program(*number))
    {
        let programs = state.memory().programs.current();
        let before = programs.and_then(|id| match id {
            ProgramId::Stored(number) => Some(number),
            _ => None,
        });
        let kept = before.filter(|number| entries.contains_key(&Key::Program(*number)));
        let first = entries.keys().find_map(|key| match key {
            Key::Program(number) => Some(*number),
            _ => None,
        });
        entries.insert(Key::Selected, Value::Selected(kept.or(first)));
    }
    let changed = build(&entries)?;
    Ok(match state.texts() {
        Some(_) => changed,
        None => changed.without_texts(),
    })
}
