//! Writes the memory into the files of a data directory.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use gsk_core::plc::Ladder;
use gsk_messages::Message;

use super::Restored;
use super::snapshot::{RetainedSnapshot, parts};
use crate::files::data_dir::{DataDir, to_ladder_change, to_program_change, to_ron_change};
use crate::files::decode::TextEncoding;
use crate::files::mirrored_files::FileChange;

/// Writes those files of the memory that differ from the disk.
pub(super) struct MemoryWriter {
    data: Arc<DataDir>,
    encodings: BTreeMap<u16, TextEncoding>,
    /// Numbers of the programs that were read from the disk or written there; only these can
    /// be deleted.
    programs: BTreeSet<u16>,
    /// The ladder at the last power-on; the ladder file is written only if the ladder differs from
    /// it.
    ladder: Arc<Ladder>,
}

impl MemoryWriter {
    pub(super) fn new(data: Arc<DataDir>, restored: &Restored, ladder: Arc<Ladder>) -> Self {
        Self {
            data,
            encodings: restored.encodings.clone(),
            programs: restored.encodings.keys().copied().collect(),
            ladder,
        }
    }

    /// Sets the encodings of programs that were loaded from a project.
    pub(super) fn set_encodings(&mut self, encodings: &BTreeMap<u16, TextEncoding>) {
        self.encodings.clone_from(encodings);
    }

    /// Writes all changed files; returns one message for each file that could not be written.
    pub(super) fn write(&mut self, now: &RetainedSnapshot) -> Vec<Message> {
        let mut changes = Vec::new();
        let mut failures = Vec::new();
        for change in Self::value_changes(now) {
            match change {
                Ok(change) => changes.push(change),
                Err(message) => failures.push(message),
            }
        }
        // New texts first: a renumbered program is always in at least one file.
        for (number, program) in now.memory.programs.iter() {
            let encoding = self.encodings.get(&number).copied().unwrap_or_default();
            changes.push(to_program_change(number, Some((program.text(), encoding))));
        }
        let programs: BTreeSet<u16> = now
            .memory
            .programs
            .iter()
            .map(|(number, _)| number)
            .collect();
        let gone = self.programs.difference(&programs);
        changes.extend(gone.map(|number| to_program_change(*number, None)));
        if now.ladder != self.ladder {
            changes.push(to_ladder_change(&now.ladder));
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

    /// Returns the changes of all files with values; those of position and panel only if `now`
    /// contains them.
    fn value_changes(now: &RetainedSnapshot) -> Vec<Result<FileChange, Message>> {
        let mut memory = now.memory.clone();
        let mut values: Vec<_> = parts(&mut memory)
            .into_iter()
            .map(|(name, part)| part.to_change(name))
            .collect();
        values.push(to_ron_change("plc", &now.plc));
        values.push(to_ron_change("selected", &now.selected()));
        values.extend(
            now.position
                .map(|position| to_ron_change("standing", &Some(position))),
        );
        values.extend(
            now.panel
                .as_ref()
                .map(|panel| to_ron_change("panel", &Some(panel))),
        );
        values
    }
}
