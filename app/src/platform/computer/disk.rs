//! Files on the disk.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind, Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

use super::super::{Facts, for_owner_alone, refuse_device};

/// What stands at a path, links followed.
///
/// # Errors
/// Nothing, or what the system says.
pub fn facts(path: &Path) -> io::Result<Facts> {
    refuse_device(path)?;
    let facts = fs::metadata(path)?;
    Ok(Facts {
        is_file: facts.is_file(),
        is_folder: facts.is_dir(),
        length: facts.len(),
    })
}

/// Whether something stands at a path, a link that leads nowhere included.
pub fn is_taken(path: &Path) -> bool {
    path.symlink_metadata().is_ok()
}

/// Whether it is a link to what stands elsewhere.
pub fn is_link(path: &Path) -> bool {
    path.symlink_metadata().is_ok_and(|it| it.is_symlink())
}

/// The first bytes of a file, this many at most: what it has more is not read.
///
/// # Errors
/// What the system says.
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    refuse_device(path)?;
    let file = File::open(path)?;
    // Of a pipe nobody knows beforehand how much it has.
    let length = file.metadata()?.len().min(most);
    let mut bytes = Vec::with_capacity(usize::try_from(length).unwrap_or_default());
    file.take(most).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// What stands in a folder, in no order.
///
/// # Errors
/// What the system says.
pub fn list(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let entries = fs::read_dir(folder)?;
    Ok(entries.flatten().map(|entry| entry.path()).collect())
}

/// Makes a folder and those above it, where they are not there.
///
/// # Errors
/// What the system says.
pub fn make_folder(path: &Path) -> io::Result<()> {
    refuse_device(path)?;
    fs::create_dir_all(path)
}

/// Removes a file.
///
/// # Errors
/// There is none, or what the system says.
pub fn remove(path: &Path) -> io::Result<()> {
    fs::remove_file(path)
}

/// Removes a folder with all that is in it; a link to one goes alone.
///
/// # Errors
/// There is none, or what the system says.
pub fn remove_folder(path: &Path) -> io::Result<()> {
    fs::remove_dir_all(path)
}

/// Gives a file another name; one that had it is gone.
///
/// # Errors
/// What the system says.
pub fn rename(from: &Path, to: &Path) -> io::Result<()> {
    fs::rename(from, to)
}

/// Writes a file that was not there, to the disk. What is left of a killed process, or a
/// link that leads elsewhere, goes first; it is never written through.
///
/// # Errors
/// What the system says.
pub fn write_new(path: &Path, bytes: &[u8], owner_alone: bool) -> io::Result<()> {
    refuse_device(path)?;
    let mut options = OpenOptions::new();
    options.write(true).create_new(true);
    if owner_alone {
        for_owner_alone(&mut options);
    }
    let mut file = match options.open(path) {
        Err(error) if error.kind() == ErrorKind::AlreadyExists => {
            fs::remove_file(path)?;
            options.open(path)?
        }
        opened => opened?,
    };
    file.write_all(bytes)?;
    file.sync_all()
}

/// Makes what was renamed in a folder lasting; where folders cannot be opened as files
/// the system does it by itself.
pub fn sync_folder(folder: &Path) {
    if let Ok(folder) = File::open(folder) {
        let _ = folder.sync_all();
    }
}

/// Whether its user has folders that a program may write and read.
pub const fn has_folders() -> bool {
    true
}

/// Whether a file is there at the next start, too, for all that the program knows.
pub const fn lasts(_path: &Path) -> bool {
    true
}

/// How often a file that another one has is asked for again, and after what pause.
const LOCK_TRIES: u32 = 15;
const LOCK_PAUSE: Duration = Duration::from_millis(20);

/// A file that one process at a time has, or several that only read.
#[derive(Debug)]
pub struct Lock(#[expect(dead_code, reason = "held open, not read")] File);

impl Lock {
    /// For this process alone; the file is made if it is not there.
    ///
    /// # Errors
    /// [`ErrorKind::WouldBlock`]: another one has it.
    pub fn alone(path: &Path) -> io::Result<Self> {
        let mut options = OpenOptions::new();
        let file = options
            .create(true)
            .truncate(false)
            .write(true)
            .open(path)?;
        Self::held(file, File::try_lock)
    }

    /// Beside others that only read.
    ///
    /// # Errors
    /// There is no such file; [`ErrorKind::WouldBlock`]: another process has it alone.
    pub fn beside_readers(path: &Path) -> io::Result<Self> {
        let file = File::open(path)?;
        Self::held(file, File::try_lock_shared)
    }

    /// Waits a moment for one that is just letting go: a process that ends, or one just
    /// started, which has the open files of its parent until its own program runs.
    fn held(file: File, lock: fn(&File) -> Result<(), TryLockError>) -> io::Result<Self> {
        let mut left = LOCK_TRIES;
        loop {
            match lock(&file) {
                Ok(()) => return Ok(Self(file)),
                Err(TryLockError::WouldBlock) if left > 0 => left -= 1,
                Err(TryLockError::WouldBlock) => return Err(ErrorKind::WouldBlock.into()),
                Err(TryLockError::Error(error)) => return Err(error),
            }
            thread::sleep(LOCK_PAUSE);
        }
    }
}
