//! Saves the memory of a running control to the disk.

use std::sync::Arc;

use crossbeam::channel::{Receiver, RecvTimeoutError, Sender, bounded};
use gsk_messages::Message;
use gsk_panel::emulator::Emulator;

use super::snapshot::RetainedSnapshot;
use super::writer::MemoryWriter;
use super::{Restored, SavedPosition};
use crate::files::data_dir::DataDir;
use crate::output;
use crate::platform::{self, TaskHandle};

/// Number of checks between two saves of the counters and the position, which change
/// constantly in a run.
const COUNTER_CHECKS: u32 = 100;

/// Number of checks between two saves of a text that is being typed.
pub(super) const TEXT_CHECKS: u32 = 5;

/// A snapshot to write, and a channel that signals its end to a caller that waits.
type WriteJob = (RetainedSnapshot, Option<Sender<()>>);

/// Saves changes of the memory in a separate thread: a slow disk never holds up the
/// kernel.
pub struct Keeper {
    last_written: RetainedSnapshot,
    checks: u32,
    pub(super) to_disk: Option<Sender<WriteJob>>,
    complaints: Receiver<Message>,
    pub(super) task: Option<TaskHandle>,
}

impl Keeper {
    /// Starts to save the memory of `emulator` in the data directory. `restored` was loaded
    /// from it.
    ///
    /// # Errors
    /// The system starts no thread.
    pub fn start(
        data: Arc<DataDir>,
        restored: &Restored,
        emulator: &Emulator,
    ) -> std::io::Result<Self> {
        let (to_disk, from_kernel) = bounded::<WriteJob>(1);
        let (say, complaints) = bounded(16);
        let last = RetainedSnapshot::from_emulator(emulator);
        let mut writer = MemoryWriter::new(data, restored, Arc::clone(&last.ladder));
        let task = platform::start_task("memory", move || {
            let (snapshot, waiting) = match platform::receive(&from_kernel, None) {
                Ok(job) => job,
                Err(none) => return none == RecvTimeoutError::Timeout,
            };
            for complaint in writer.write(&snapshot) {
                let _ = say.try_send(complaint);
            }
            if let Some(waiting) = waiting {
                let _ = waiting.send(());
            }
            true
        })?;
        Ok(Self {
            last_written: last,
            checks: 0,
            to_disk: Some(to_disk),
            complaints,
            task: Some(task),
        })
    }

    /// Saves the memory if it has changed.
    pub fn save_if_changed(&mut self, emulator: &Emulator) {
        self.checks += 1;
        let now = RetainedSnapshot::from_emulator(emulator);
        if now == self.last_written {
            return;
        }
        // A machine zero set by hand is saved at once, unlike the position.
        let keep_position = |(now, last): (SavedPosition, SavedPosition)| SavedPosition {
            zero_kept: now.zero_kept,
            ..last
        };
        let mut rest = RetainedSnapshot {
            position: now
                .position
                .zip(self.last_written.position)
                .map(keep_position),
            ..now.clone()
        };
        rest.memory.counters = self.last_written.memory.counters;
        if rest == self.last_written && self.checks < COUNTER_CHECKS {
            return;
        }
        if emulator.panel().edited().is_some() && self.checks < TEXT_CHECKS {
            rest.memory
                .programs
                .clone_from(&self.last_written.memory.programs);
            if rest == self.last_written {
                return;
            }
        }
        // A disk that still writes the last snapshot gets this one at the next check.
        if let Some(to_disk) = &self.to_disk
            && to_disk.try_send((now.clone(), None)).is_ok()
        {
            self.last_written = now;
            self.checks = 0;
        }
    }

    /// Saves the memory and waits until it is on the disk.
    pub fn save_and_wait(&mut self, emulator: &Emulator) {
        let (done, written) = bounded(1);
        let now = RetainedSnapshot::from_emulator(emulator);
        if let Some(to_disk) = &self.to_disk
            && to_disk.send((now.clone(), Some(done))).is_ok()
            && written.recv().is_ok()
        {
            self.last_written = now;
            self.checks = 0;
        }
    }

    /// Returns the messages about failed saves since the last call.
    pub fn complaints(&self) -> Vec<Message> {
        self.complaints.try_iter().collect()
    }

    /// Saves the memory, waits until it is on the disk and ends the thread.
    pub fn finish(mut self, emulator: &Emulator) {
        if let Some(to_disk) = self.to_disk.take() {
            let _ = to_disk.send((RetainedSnapshot::from_emulator(emulator), None));
        }
        if let Some(task) = self.task.take() {
            task.finish();
        }
        for complaint in self.complaints() {
            output::report_error(&complaint);
        }
    }
}
