//! Appends recordings to files and removes the oldest ones.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use gsk_messages::{Message, say};

use super::{MAX_BOARD_FILE_BYTES, MAX_FILE_BYTES, RecordingTarget};
use crate::message_format::describe_io_error;
use crate::platform;

/// Greatest size of all recordings in a folder, bytes.
pub(super) const MAX_FOLDER_BYTES: u64 = 50_000_000;
/// Parts of the name of a file in a folder, around its number.
const NAME_START: &str = "session-";
pub(super) const ENDING: &str = "gskrec";

/// Bytes that the disk thread appends to a recording.
#[derive(Debug)]
pub(super) struct DiskJob {
    /// Whether the bytes begin a new recording.
    pub(super) is_first: bool,
    pub(super) bytes: Vec<u8>,
}

/// Writes the files of recordings on a thread of the disk.
#[derive(Debug)]
pub(super) struct RecordingDisk {
    target: RecordingTarget,
    file: Option<(PathBuf, File)>,
}

impl RecordingDisk {
    pub(super) const fn new(target: RecordingTarget) -> Self {
        Self { target, file: None }
    }

    /// Appends bytes to the file, in one system call where the system permits.
    pub(super) fn execute(&mut self, job: &DiskJob) -> Result<(), Message> {
        if job.is_first || self.file.is_none() {
            self.file = Some(self.open_file()?);
        }
        let Some((path, file)) = &mut self.file else {
            return Ok(());
        };
        file.write_all(&job.bytes)
            .map_err(|error| not_written(path, &error))
    }

    fn open_file(&self) -> Result<(PathBuf, File), Message> {
        let (path, replaces) = match &self.target {
            RecordingTarget::File(path) => (path.clone(), true),
            RecordingTarget::Folder(folder) => {
                let next = prepare_folder(folder).map_err(|error| not_written(folder, &error))?;
                (
                    folder.join(format!("{NAME_START}{next:06}.{ENDING}")),
                    false,
                )
            }
        };
        let open = || {
            platform::refuse_device(&path)?;
            let mut options = OpenOptions::new();
            options.write(true).create(true).truncate(replaces);
            options.create_new(!replaces).open(&path)
        };
        let file = open().map_err(|error| not_written(&path, &error))?;
        Ok((path, file))
    }
}

fn not_written(path: &Path, error: &io::Error) -> Message {
    say::file_not_written(path.display(), describe_io_error(error))
}

/// Creates the folder, removes its oldest recordings until a new file fits, and returns the
/// number of the new one.
pub(super) fn prepare_folder(folder: &Path) -> io::Result<u64> {
    fs::create_dir_all(folder)?;
    let recordings = list_recordings(folder)?;
    let mut total: u64 = recordings.iter().map(|(_, _, length)| length).sum();
    let limit = MAX_FOLDER_BYTES.saturating_sub((MAX_FILE_BYTES + MAX_BOARD_FILE_BYTES) as u64);
    for (_, path, length) in &recordings {
        if total <= limit {
            break;
        }
        fs::remove_file(path)?;
        total -= length;
    }
    Ok(recordings.last().map_or(1, |(number, ..)| number + 1))
}

/// Returns the newest recording in a folder; `None` without one.
pub(super) fn newest_recording(folder: &Path) -> Option<PathBuf> {
    let newest = list_recordings(folder).ok()?.pop();
    newest.map(|(_, path, _)| path)
}

/// Returns the recordings in a folder with number and length, the oldest first.
fn list_recordings(folder: &Path) -> io::Result<Vec<(u64, PathBuf, u64)>> {
    let mut recordings: Vec<_> = platform::list(folder)?
        .into_iter()
        .filter_map(|path| {
            let number = number_of(&path)?;
            let length = platform::path_facts(&path).ok()?.length;
            Some((number, path, length))
        })
        .collect();
    recordings.sort_unstable();
    Ok(recordings)
}

fn number_of(path: &Path) -> Option<u64> {
    if path.extension()? != ENDING {
        return None;
    }
    let stem = path.file_stem()?.to_str()?;
    stem.strip_prefix(NAME_START)?.parse().ok()
}
