//! Records written values and returns them for undo.

/// A group of values that were written together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UndoEntry<Label, Change> {
    /// The reason for which the values were written, for example a commissioning step.
    pub label: Label,
    /// The values before they were written.
    pub before: Vec<Change>,
    /// The values that were written.
    pub written: Vec<Change>,
}

/// The groups of values written to the control, the newest last.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UndoList<Label, Change> {
    entries: Vec<UndoEntry<Label, Change>>,
}

impl<Label, Change> Default for UndoList<Label, Change> {
    fn default() -> Self {
        Self {
            entries: Vec::new(),
        }
    }
}

impl<Label, Change: Clone> UndoList<Label, Change> {
    /// Records a group that is about to be written, with the values before it.
    pub fn record(&mut self, label: Label, before: Vec<Change>, written: &[Change]) {
        self.entries.push(UndoEntry {
            label,
            before,
            written: written.to_vec(),
        });
    }

    /// Returns the recorded groups, the newest last.
    pub fn entries(&self) -> &[UndoEntry<Label, Change>] {
        &self.entries
    }

    /// Removes the newest group and returns its values before, in reverse order, which undo
    /// it; `None` if the list is empty.
    pub fn pop(&mut self) -> Option<Vec<Change>> {
        let entry = self.entries.pop()?;
        Some(entry.before.into_iter().rev().collect())
    }
}
