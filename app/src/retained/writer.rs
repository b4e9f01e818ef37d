//! Writes the memory into the files of a data directory.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use gsk_core::plc::Ladder;
use gsk_messages::Message;

use super::Restored;
use super::snapshot::{Snapshot, parts};
use crate::files::data_dir::{DataDir, as_ladder, as_program, as_ron};
use crate::files::decode::Encoding;
use crate::files::kept::Change;

/// Writes the files that differ from the disk.
pub(super) struct Writer {
    data: Arc<DataDir>,
    encodings: BTreeMap<u16, Encoding>,
    /// Programs read from the disk or written there: only these can be deleted.
    programs: BTreeSet<u16>,
    /// The ladder of the last power-on: only another one is written.
    ladder: Arc<Ladder>,
}

impl Writer {
    pub(super) fn new(data: Arc<DataDir>, restored: &Restored, ladder: Arc<Ladder>) -> Self {
        Self {
            data,
            encodings: restored.encodings.clone(),
            programs: restored.encodings.keys().copied().collect(),
            ladder,
        }
    }

    /// Sets the encodings of programs from elsewhere.
    pub(super) fn written_as(&mut self, encodings: &BTreeMap<u16, Encoding>) {
        self.encodings.clone_from(encodings);
    }

    /// Writes all changed files; returns messages for those that could not be written.
    pub(super) fn write(&mut self, now: &Snapshot) -> Vec<Message> {
        let mut changes = Vec::new();
        let mut failures = Vec::new();
        for change in Self::values(now) {
            match change {
                Ok(change) => changes.push(change),
                Err(said) => failures.push(said),
            }
        }
        // New texts first: a renumbered program is always in at least one file.
        for (number, program) in now.memory.programs.iter() {
            let encoding = self.encodings.get(&number).copied().unwrap_or_default();
            changes.push(as_program(number, Some((program.text(), encoding))));
        }
        let programs: BTreeSet<u16> = now
            .memory
            .programs
            .iter()
            .map(|(number, _)| number)
            .collect();
        let gone = self.programs.difference(&programs);
        changes.extend(gone.map(|number| as_program(*number, None)));
        if now.ladder != self.ladder {
            changes.push(as_ladder(&now.ladder));
            self.ladder = Arc::clone(&now.ladder);
        }
        failures.extend(self.data.commit(changes));
        if failures.is_empty() {
            self.programs = programs;
        } else {
            self.programs.extend(programs);
        }
        failures
    }

    /// Returns the changed value files. Without a window its own files stay unchanged.
    fn values(now: &Snapshot) -> Vec<Result<Change, Message>> {
        let mut memory = now.memory.clone();
        let mut values: Vec<_> = parts(&mut memory)
            .into_iter()
            .map(|(name, part)| part.file(name))
            .collect();
        values.push(as_ron("plc", &now.plc));
        values.push(as_ron("selected", &now.selected()));
        values.extend(
            now.standing
                .map(|standing| as_ron("standing", &Some(standing))),
        );
        values.extend(
            now.panel
                .as_ref()
                .map(|panel| as_ron("panel", &Some(panel))),
        );
        values
    }
}
