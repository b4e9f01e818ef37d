//! Writes the recording of an exam into its file while the learner works.

use std::fs::{File, OpenOptions};
use std::io::{self, Write as _};
use std::path::Path;

use crossbeam::channel::{Receiver, Sender, TrySendError, bounded};
use gsk_messages::{Message, say};

use super::DISK_QUEUE;
use crate::files::atomic;
use crate::message_format::describe_io_error;
use crate::platform::{self, TaskHandle};

/// Appends the recording of a solution to a file while it grows.
#[derive(Debug)]
pub struct SolutionLog {
    to_disk: Option<Sender<Vec<u8>>>,
    failures: Receiver<Message>,
    task: Option<TaskHandle>,
    /// Number of bytes that were handed over to the disk.
    written: usize,
}

impl SolutionLog {
    /// Writes the file anew with the recording so far. After a power failure it has the old
    /// content or the new one.
    ///
    /// # Errors
    /// The file cannot be written, or the system starts no thread.
    pub fn start(path: &Path, recording: &[u8]) -> Result<Self, Message> {
        let mut file = create(path, recording).map_err(|error| not_written(path, &error))?;
        let (to_disk, from_kernel) = bounded::<Vec<u8>>(DISK_QUEUE);
        let (report, failures) = bounded(1);
        let failed = path.to_owned();
        let task = platform::start_task("exam", move || {
            let Ok(bytes) = platform::receive(&from_kernel, None) else {
                return false;
            };
            match file.write_all(&bytes).and_then(|()| file.sync_data()) {
                Ok(()) => true,
                Err(error) => {
                    let _ = report.try_send(not_written(&failed, &error));
                    false
                }
            }
        });
        let task = task.map_err(|error| not_written(path, &error))?;
        Ok(Self {
            to_disk: Some(to_disk),
            failures,
            task: Some(task),
            written: recording.len(),
        })
    }

    /// Hands the new bytes of a recording over to the disk, unless it is busy. Returns once why
    /// the file cannot be written.
    pub fn write(&mut self, recording: &[u8]) -> Option<Message> {
        let new = recording.get(self.written..).unwrap_or_default();
        let to_disk = self.to_disk.as_ref().filter(|_| !new.is_empty())?;
        match to_disk.try_send(new.to_vec()) {
            Ok(()) => {
                self.written = recording.len();
                None
            }
            Err(TrySendError::Full(_)) => None,
            Err(TrySendError::Disconnected(_)) => {
                self.to_disk = None;
                self.failures.try_recv().ok()
            }
        }
    }

    /// Writes the rest of a recording and waits until all of it is on the disk. Returns a message
    /// if it cannot be written; otherwise `None`.
    pub fn finish(mut self, recording: &[u8]) -> Option<Message> {
        let new = recording.get(self.written..).unwrap_or_default();
        if let Some(to_disk) = self.to_disk.take() {
            // A failed disk is reported below.
            let _ = to_disk.send(new.to_vec());
        }
        if let Some(task) = self.task.take() {
            task.finish();
        }
        self.failures.try_recv().ok()
    }
}

fn create(path: &Path, recording: &[u8]) -> io::Result<File> {
    atomic::write(path, recording)?;
    OpenOptions::new().append(true).open(path)
}

fn not_written(path: &Path, error: &io::Error) -> Message {
    say::file_not_written(path.display(), describe_io_error(error))
}
