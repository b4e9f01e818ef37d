//! Compares two project states and applies differences.

use std::collections::BTreeSet;

use gsk_core::command::ProgramId;

use crate::builder::{InvalidValue, build_state};
use crate::key::{ProjectKey, ProjectSection};
use crate::project_state::ProjectState;
use crate::value::ProjectValue;

/// A value that differs between an old and a new project state.
#[derive(Clone, Debug, PartialEq)]
pub struct ProjectDifference {
    /// Key of the differing value.
    pub key: ProjectKey,
    /// Value in the old state; `None` if it is missing there.
    pub old: Option<ProjectValue>,
    /// Value in the new state; `None` if it is missing there.
    pub new: Option<ProjectValue>,
}

impl ProjectDifference {
    /// Returns the section of the project to which the value belongs.
    pub const fn section(&self) -> ProjectSection {
        ProjectSection::from_key(self.key)
    }
}

/// Lists the values that differ, in the order of the files. Machine file and jobs are compared
/// only if both states have them: a control has none. Panel settings are compared only if
/// `new` has them.
pub fn diff(old: &ProjectState, new: &ProjectState) -> Vec<ProjectDifference> {
    let with_texts = old.texts().is_some() && new.texts().is_some();
    let with_panel = new.panel().is_some();
    let [mut before, mut after] = [old, new].map(ProjectState::entries);
    let keys: BTreeSet<ProjectKey> = before.keys().chain(after.keys()).copied().collect();
    keys.into_iter()
        .filter(|key| match ProjectSection::from_key(*key) {
            ProjectSection::Machine | ProjectSection::Jobs => with_texts,
            ProjectSection::Panel => with_panel,
            _ => true,
        })
        .map(|key| ProjectDifference {
            key,
            old: before.remove(&key),
            new: after.remove(&key),
        })
        .filter(|difference| difference.old != difference.new)
        .collect()
}

/// Returns the state with the differences applied. If the selected program no longer exists,
/// the program that was selected before stays selected, or else the first one is.
///
/// # Errors
/// The values that would be invalid afterwards: a disk with missing values, a program that
/// exceeds the program memory.
pub fn apply(
    state: &ProjectState,
    differences: &[ProjectDifference],
) -> Result<ProjectState, Vec<InvalidValue>> {
    let mut entries = state.entries();
    for difference in differences {
        match &difference.new {
            Some(value) => entries.insert(difference.key, value.clone()),
            None => entries.remove(&difference.key),
        };
    }
    if let Some(ProjectValue::Selected(Some(number))) = entries.get(&ProjectKey::Selected)
        && !entries.contains_key(&ProjectKey::Program(*number))
    {
        let programs = state.memory().programs.selected();
        let before = programs.and_then(|id| match id {
            ProgramId::Stored(number) => Some(number),
            _ => None,
        });
        let kept = before.filter(|number| entries.contains_key(&ProjectKey::Program(*number)));
        let first = entries.keys().find_map(|key| match key {
            ProjectKey::Program(number) => Some(*number),
            _ => None,
        });
        entries.insert(ProjectKey::Selected, ProjectValue::Selected(kept.or(first)));
    }
    let changed = build_state(&entries)?;
    Ok(match state.texts() {
        Some(_) => changed,
        None => changed.without_texts(),
    })
}
