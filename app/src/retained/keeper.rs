//! Saves the memory of a running control to the disk.

use std::sync::Arc;

use crossbeam::channel::{Receiver, RecvTimeoutError, Sender, bounded};
use gsk_messages::Message;
use gsk_panel::emulator::Emulator;

use super::snapshot::Snapshot;
use super::writer::Writer;
use super::{Restored, Standing};
use crate::files::data_dir::DataDir;
use crate::output;
use crate::platform::{self, Turning};

/// Number of checks between two saves of what changes constantly in a run: counters and
/// position.
const COUNTER_LOOKS: u32 = 100;

/// Number of checks between two saves of a text that is being typed.
pub(super) const TEXT_LOOKS: u32 = 5;

/// A snapshot to write, and a channel for a caller that waits for it.
type Job = (Snapshot, Option<Sender<()>>);

/// Saves changes of the memory in a separate thread: a slow disk never holds up the
/// kernel.
pub struct Keeper {
    last: Snapshot,
    looks: u32,
    pub(super) to_disk: Option<Sender<Job>>,
    complaints: Receiver<Message>,
    pub(super) turning: Option<Turning>,
}

impl Keeper {
    /// Starts to save the memory of a control in a directory.
    ///
    /// # Errors
    /// The system starts no thread.
    pub fn start(
        data: Arc<DataDir>,
        restored: &Restored,
        emulator: &Emulator,
    ) -> std::io::Result<Self> {
        let (to_disk, from_kernel) = bounded::<Job>(1);
        let (say, complaints) = bounded(16);
        let last = Snapshot::of_emulator(emulator);
        let mut writer = Writer::new(data, restored, Arc::clone(&last.ladder));
        let turning = platform::turn("memory", move || {
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
            last,
            looks: 0,
            to_disk: Some(to_disk),
            complaints,
            turning: Some(turning),
        })
    }

    /// Saves the memory if it has changed.
    pub fn look(&mut self, emulator: &Emulator) {
        self.looks += 1;
        let now = Snapshot::of_emulator(emulator);
        if now == self.last {
            return;
        }
        // A machine zero set by hand is saved at once, unlike the position.
        let places = |(now, last): (Standing, Standing)| Standing {
            zero_kept: now.zero_kept,
            ..last
        };
        let mut rest = Snapshot {
            standing: now.standing.zip(self.last.standing).map(places),
            ..now.clone()
        };
        rest.memory.counters = self.last.memory.counters;
        if rest == self.last && self.looks < COUNTER_LOOKS {
            return;
        }
        if emulator.panel.edited().is_some() && self.looks < TEXT_LOOKS {
            rest.memory.programs.clone_from(&self.last.memory.programs);
            if rest == self.last {
                return;
            }
        }
        // A disk that still writes the last snapshot gets this one at the next check.
        if let Some(to_disk) = &self.to_disk
            && to_disk.try_send((now.clone(), None)).is_ok()
        {
            self.last = now;
            self.looks = 0;
        }
    }

    /// Saves everything and waits until it is on the disk.
    pub fn settle(&mut self, emulator: &Emulator) {
        let (done, written) = bounded(1);
        let now = Snapshot::of_emulator(emulator);
        if let Some(to_disk) = &self.to_disk
            && to_disk.send((now.clone(), Some(done))).is_ok()
            && written.recv().is_ok()
        {
            self.last = now;
            self.looks = 0;
        }
    }

    /// Returns the messages for failed saves since the last call.
    pub fn complaints(&self) -> Vec<Message> {
        self.complaints.try_iter().collect()
    }

    /// Saves everything, waits until it is on the disk and ends the thread.
    pub fn finish(mut self, emulator: &Emulator) {
        if let Some(to_disk) = self.to_disk.take() {
            let _ = to_disk.send((Snapshot::of_emulator(emulator), None));
        }
        if let Some(turning) = self.turning.take() {
            turning.finish();
        }
        for complaint in self.complaints() {
            output::complain_of(&complaint);
        }
    }
}
