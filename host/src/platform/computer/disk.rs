//! Files on the disk.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind, Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

use super::super::{PathFacts, for_owner_alone, refuse_device};

/// Returns type and length of the file or folder at a path; links are followed.
///
/// # Errors
///
/// Nothing exists there, or the system reports an error.
pub fn path_facts(path: &Path) -> io::Result<PathFacts> {
    refuse_device(path)?;
    let metadata = fs::metadata(path)?;
    Ok(PathFacts {
        is_file: metadata.is_file(),
        is_folder: metadata.is_dir(),
        length: metadata.len(),
    })
}

/// Returns whether a file, folder or link exists at a path, including a broken link.
pub fn is_taken(path: &Path) -> bool {
    path.symlink_metadata().is_ok()
}

/// Whether a path is a symbolic link.
pub fn is_link(path: &Path) -> bool {
    path.symlink_metadata().is_ok_and(|it| it.is_symlink())
}

/// Reads at most the first `most` bytes of a file.
///
/// # Errors
/// An error of the system.
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    refuse_device(path)?;
    let file = File::open(path)?;
    // The length of a pipe is unknown beforehand.
    let length = file.metadata()?.len().min(most);
    let mut bytes = Vec::with_capacity(usize::try_from(length).unwrap_or_default());
    file.take(most).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Lists the paths in a folder, in no order.
///
/// # Errors
/// An error of the system.
pub fn list(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let entries = fs::read_dir(folder)?;
    Ok(entries.flatten().map(|entry| entry.path()).collect())
}

/// Creates a folder and its missing parents.
///
/// # Errors
/// An error of the system.
pub fn make_folder(path: &Path) -> io::Result<()> {
    refuse_device(path)?;
    fs::create_dir_all(path)
}

/// Removes a file.
///
/// # Errors
/// The file does not exist, or an error of the system.
pub fn remove(path: &Path) -> io::Result<()> {
    fs::remove_file(path)
}

/// Removes a folder with its content; of a link to a folder, only the link.
///
/// # Errors
/// The folder does not exist, or an error of the system.
pub fn remove_folder(path: &Path) -> io::Result<()> {
    fs::remove_dir_all(path)
}

/// Renames a file. Replaces an existing file at `to`.
///
/// # Errors
/// An error of the system.
pub fn rename(from: &Path, to: &Path) -> io::Result<()> {
    fs::rename(from, to)
}

/// Writes a new file and waits until it is on the disk. A file left by a killed process,
/// or a link, is removed first: the bytes never go to the target of a link.
///
/// # Errors
/// An error of the system.
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

/// Writes a file to a drive that disconnects when it has all of it: a board in boot mode. `mark` is
/// a file of the drive that exists as long as the drive is connected.
///
/// # Errors
/// An error of the system while the drive is connected.
pub fn write_to_drive(path: &Path, bytes: &[u8], mark: &Path) -> io::Result<()> {
    refuse_device(path)?;
    let mut file = File::create(path)?;
    file.write_all(bytes)?;
    match file.sync_all() {
        // The board has restarted.
        Err(_) if !mark.exists() => Ok(()),
        result => result,
    }
}

/// Makes the renames in a folder durable against a power failure. Systems that cannot open
/// folders as files do so automatically.
pub fn sync_folder(folder: &Path) {
    if let Ok(folder) = File::open(folder) {
        let _ = folder.sync_all();
    }
}

/// Returns true: on a computer the user has folders that a program can read and write.
pub const fn has_folders() -> bool {
    true
}

/// Returns true: on a computer a file still exists at the next start.
pub const fn is_persistent(_path: &Path) -> bool {
    true
}

/// Number of attempts to lock a file that another process has locked. The constant after it is
/// the pause between them.
const LOCK_TRIES: u32 = 15;
const LOCK_PAUSE: Duration = Duration::from_millis(20);

/// The lock of a file, held until dropped: one process holds it alone, or several hold it for
/// reading.
#[derive(Debug)]
pub struct Lock(#[expect(dead_code, reason = "held open, not read")] File);

impl Lock {
    /// Locks a file for this process alone; creates the file if it does not exist.
    ///
    /// # Errors
    /// [`ErrorKind::WouldBlock`]: another process holds it.
    pub fn exclusive(path: &Path) -> io::Result<Self> {
        let mut options = OpenOptions::new();
        let file = options
            .create(true)
            .truncate(false)
            .write(true)
            .open(path)?;
        Self::acquire(file, File::try_lock)
    }

    /// Locks a file for reading, together with other readers.
    ///
    /// # Errors
    /// The file does not exist; [`ErrorKind::WouldBlock`]: another process holds it alone.
    pub fn shared(path: &Path) -> io::Result<Self> {
        let file = File::open(path)?;
        Self::acquire(file, File::try_lock_shared)
    }

    /// Tries to get the lock `LOCK_TRIES` times: a process that ends, or a child that has just been
    /// started, may keep it for a moment. The child inherits the open files of its parent until it
    /// runs its own program. Returns an error if another process holds the lock.
    fn acquire(file: File, lock: fn(&File) -> Result<(), TryLockError>) -> io::Result<Self> {
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
