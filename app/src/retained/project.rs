//! The data directory as a project, and a project into the data directory.

use std::collections::BTreeMap;
use std::sync::Arc;

use gsk_core::battery::Memory;
use gsk_core::setup::Setup;
use gsk_messages::Message;
use gsk_panel::emulator::Emulator;
use gsk_project::ProjectState;

use super::snapshot::Snapshot;
use super::writer::Writer;
use super::{NotSaved, Restored, load};
use crate::files::data_dir::DataDir;
use crate::files::decode::Encoding;

/// What a data directory holds.
#[derive(Debug)]
pub struct Held {
    /// The same as a project has it.
    pub state: ProjectState,
    /// All that the battery keeps, with operation level and passwords.
    pub memory: Memory,
    restored: Restored,
}

/// Reads a data directory; what is not in it is as in `setup`.
pub fn held(data: &DataDir, mut setup: Setup) -> Held {
    let restored = load(data, &mut setup);
    Held {
        state: ProjectState::from_setup(&setup).with_panel(restored.panel),
        memory: setup.memory,
        restored,
    }
}

/// What a control that is on holds, with a text that is being typed.
pub fn of_emulator(emulator: &Emulator) -> ProjectState {
    let now = Snapshot::of_emulator(emulator);
    ProjectState::new(&now.memory, Some(&now.plc), now.ladder, now.panel)
}

impl Held {
    /// What is wrong with files of the directory.
    pub fn complaints(&self) -> &[Message] {
        &self.restored.complaints
    }

    /// How the programs are written down.
    pub const fn encodings(&self) -> &BTreeMap<u16, Encoding> {
        &self.restored.encodings
    }

    /// Writes another state into the directory it was read from. Operation level, passwords
    /// and the position of the slides stay.
    ///
    /// # Errors
    /// What could not be written; the rest is.
    pub fn replace(
        mut self,
        data: DataDir,
        now: &ProjectState,
        encodings: &BTreeMap<u16, Encoding>,
    ) -> Result<(), NotSaved> {
        let mut memory = now.memory().clone();
        memory.authority = self.memory.authority;
        let snapshot = Snapshot {
            memory,
            plc: now.retained().clone(),
            standing: None,
            panel: now.panel(),
            ladder: Arc::clone(now.ladder()),
        };
        let before = Arc::clone(self.state.ladder());
        let mut writer = Writer::new(Arc::new(data), &self.restored, before);
        self.restored.encodings.extend(encodings);
        writer.written_as(&self.restored.encodings);
        let failures = writer.write(&snapshot);
        if failures.is_empty() {
            Ok(())
        } else {
            Err(NotSaved(failures))
        }
    }
}
