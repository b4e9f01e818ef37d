//! Reads the data directory as a project, and writes a project into it.

use std::collections::BTreeMap;
use std::sync::Arc;

use gsk_core::battery::BatteryMemory;
use gsk_core::setup::Setup;
use gsk_messages::Message;
use gsk_panel::emulator::Emulator;
use gsk_project::ProjectState;

use super::snapshot::RetainedSnapshot;
use super::writer::MemoryWriter;
use super::{NotSaved, Restored, load};
use crate::files::data_dir::DataDir;
use crate::files::decode::TextEncoding;

/// The content of a data directory.
#[derive(Debug)]
pub struct DataDirContent {
    /// The content in the form of a project.
    pub state: ProjectState,
    /// The battery-backed memory, with operation level and passwords.
    pub memory: BatteryMemory,
    restored: Restored,
}

/// Reads a data directory; missing files take their values from `setup`.
pub fn read_content(data: &DataDir, mut setup: Setup) -> DataDirContent {
    let restored = load(data, &mut setup);
    DataDirContent {
        state: ProjectState::from_setup(&setup).with_panel(restored.panel),
        memory: setup.memory,
        restored,
    }
}

/// Returns the state of a running control, with a text that is being typed.
pub fn state_of_emulator(emulator: &Emulator) -> ProjectState {
    let now = RetainedSnapshot::from_emulator(emulator);
    ProjectState::new(&now.memory, Some(&now.plc), now.ladder, now.panel)
}

impl DataDirContent {
    /// Returns the messages for damaged files of the directory.
    pub fn complaints(&self) -> &[Message] {
        &self.restored.complaints
    }

    /// Returns the encodings of the programs, by number.
    pub const fn encodings(&self) -> &BTreeMap<u16, TextEncoding> {
        &self.restored.encodings
    }

    /// Writes the state `now` into the directory. Operation level, passwords and the position
    /// of the slides remain.
    ///
    /// # Errors
    /// The files that could not be written; all others are written.
    pub fn replace(
        mut self,
        data: DataDir,
        now: &ProjectState,
        encodings: &BTreeMap<u16, TextEncoding>,
    ) -> Result<(), NotSaved> {
        let mut memory = now.memory().clone();
        memory.authority = self.memory.authority;
        let snapshot = RetainedSnapshot {
            memory,
            plc: now.retained().clone(),
            position: None,
            panel: now.panel(),
            ladder: Arc::clone(now.ladder()),
        };
        let before = Arc::clone(self.state.ladder());
        let mut writer = MemoryWriter::new(Arc::new(data), &self.restored, before);
        self.restored.encodings.extend(encodings);
        writer.set_encodings(&self.restored.encodings);
        let failures = writer.write(&snapshot);
        if failures.is_empty() {
            Ok(())
        } else {
            Err(NotSaved(failures))
        }
    }
}
