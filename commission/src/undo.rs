//! What was written so far, to be taken back.

use gsk_core::memory::{Parameters, PitchTable};

use crate::change::Change;
use crate::steps::Step;

/// What was written by a step, to be taken back.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Undone {
    /// The step.
    pub step: Step,
    /// What stood there before.
    pub before: Vec<Change>,
    /// What was written.
    pub written: Vec<Change>,
}

/// What was written so far, the newest last.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Undo {
    entries: Vec<Undone>,
}

impl Undo {
    /// Notes what is about to be written over these values.
    pub fn note(
        &mut self,
        step: Step,
        changes: &[Change],
        parameters: &Parameters,
        pitch: &PitchTable,
    ) {
        let before = changes.iter().map(|change| change.now(parameters, pitch));
        self.entries.push(Undone {
            step,
            before: before.collect(),
            written: changes.to_vec(),
        });
    }

    /// What was written, the newest last.
    pub fn entries(&self) -> &[Undone] {
        &self.entries
    }

    /// Takes the newest entry: what has to be written to take it back, in reverse.
    pub fn take(&mut self) -> Option<Vec<Change>> {
        let entry = self.entries.pop()?;
        Some(entry.before.into_iter().rev().collect())
    }
}
