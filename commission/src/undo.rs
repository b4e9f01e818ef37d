//! What was written so far, to be taken back.

/// What was written at once, to be taken back.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Undone<Label, Change> {
    /// What it was written for, as a step.
    pub label: Label,
    /// What stood there before.
    pub before: Vec<Change>,
    /// What was written.
    pub written: Vec<Change>,
}

/// What was written so far, the newest last.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Undo<Label, Change> {
    entries: Vec<Undone<Label, Change>>,
}

impl<Label, Change> Default for Undo<Label, Change> {
    fn default() -> Self {
        Self {
            entries: Vec::new(),
        }
    }
}

impl<Label, Change: Clone> Undo<Label, Change> {
    /// Notes what is about to be written, and for each of it what stands there.
    pub fn note(&mut self, label: Label, before: Vec<Change>, written: &[Change]) {
        self.entries.push(Undone {
            label,
            before,
            written: written.to_vec(),
        });
    }

    /// What was written, the newest last.
    pub fn entries(&self) -> &[Undone<Label, Change>] {
        &self.entries
    }

    /// Takes the newest entry: what has to be written to take it back, in reverse.
    pub fn take(&mut self) -> Option<Vec<Change>> {
        let entry = self.entries.pop()?;
        Some(entry.before.into_iter().rev().collect())
    }
}
