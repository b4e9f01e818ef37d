//! Files of a page: the browser's storage keeps those under [`STORAGE_FOLDER`], the others exist
//! while the page is open. A file that the program writes for its user becomes a download.

use std::cell::{Cell, RefCell};
use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use gsk_messages::say;
use web_sys::Storage;
use web_time::{Duration, Instant};

use super::super::PathFacts;
use super::course;
use super::download::download;

/// The folder whose files are stored in the browser's storage.
pub const STORAGE_FOLDER: &str = "/data";
/// The folder of the files that the user opens and of those that become downloads.
pub const USER_FOLDER: &str = "/files";
/// Prefix of each file name in the browser's storage.
const KEY_PREFIX: &str = "gsk980td:";
/// A page that has not renewed its lock for this time counts as closed.
const LEASE: Duration = Duration::from_secs(5);
/// Time between two renewals of the lock on the storage.
const RENEW_INTERVAL: Duration = Duration::from_secs(1);

#[derive(Default)]
struct Disk {
    files: BTreeMap<PathBuf, Vec<u8>>,
    folders: BTreeSet<PathBuf>,
}

thread_local! {
    static DISK: RefCell<Option<Disk>> = const { RefCell::new(None) };
    /// Random number that identifies this page among the open ones.
    static PAGE_ID: Cell<f64> = const { Cell::new(0.0) };
    /// The lock that this page holds, and the time of its last renewal; `None` without a lock.
    static HELD_LOCK: RefCell<Option<(PathBuf, Instant)>> = const { RefCell::new(None) };
    /// Set once another page has taken the lock: this page then writes nothing any more.
    static LOCK_LOST: Cell<bool> = const { Cell::new(false) };
}

/// The browser's storage; `None` without one, and for the page of a course: the computers of a
/// school are shared, and the learning platform has the progress.
fn storage() -> Option<Storage> {
    if course::is_packed() {
        return None;
    }
    web_sys::window()?.local_storage().ok()?
}

/// Returns false: the user passes single files to a page.
pub const fn has_folders() -> bool {
    false
}

/// Whether the browser keeps files after the page is closed.
pub fn has_storage() -> bool {
    storage().is_some()
}

fn key(path: &Path) -> String {
    format!("{KEY_PREFIX}{}", path.display())
}

/// Encodes bytes as a text for the storage, one character per byte (U+0000 to U+00FF).
fn encode(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| char::from(*byte)).collect()
}

/// Decodes a text from the storage; `None` if it has a character above U+00FF.
fn decode(text: &str) -> Option<Vec<u8>> {
    let bytes = text
        .chars()
        .map(|character| u8::try_from(u32::from(character)).ok());
    bytes.collect()
}

/// Passes the files to the closure `does` and returns its result; reads the storage before the
/// first call.
fn with_disk<T>(does: impl FnOnce(&mut Disk) -> T) -> T {
    DISK.with_borrow_mut(|disk| does(disk.get_or_insert_with(Disk::read)))
}

impl Disk {
    fn read() -> Self {
        let mut disk = Self::default();
        let storage = storage();
        let count = storage.as_ref().map_or(0, |it| it.length().unwrap_or(0));
        for index in 0..count {
            let Some(storage) = &storage else { break };
            let key = storage.key(index).ok().flatten().unwrap_or_default();
            let Some(path) = key.strip_prefix(KEY_PREFIX) else {
                continue;
            };
            let text = storage.get_item(&key).ok().flatten().unwrap_or_default();
            if let Some(bytes) = decode(&text) {
                disk.put(Path::new(path), bytes);
            }
        }
        disk
    }

    fn put(&mut self, path: &Path, bytes: Vec<u8>) {
        let folders = path.ancestors().skip(1);
        self.folders.extend(folders.map(Path::to_owned));
        self.files.insert(path.to_owned(), bytes);
    }
}

/// Writes a file of [`STORAGE_FOLDER`] to the browser's storage; `None` removes the file there.
/// Returns an error if the storage refuses it.
fn update_storage(path: &Path, bytes: Option<&[u8]>) -> io::Result<()> {
    if !path.starts_with(STORAGE_FOLDER) {
        return Ok(());
    }
    if LOCK_LOST.get() {
        let lost = say::page_open_elsewhere().to_string();
        return Err(io::Error::new(ErrorKind::WouldBlock, lost));
    }
    // Without a storage the page continues; it reports this at its start.
    let Some(storage) = storage() else {
        return Ok(());
    };
    let done = match bytes {
        Some(bytes) => storage.set_item(&key(path), &encode(bytes)),
        None => storage.remove_item(&key(path)),
    };
    done.map_err(|_| ErrorKind::StorageFull.into())
}

/// Returns type and length of the file or folder at a path.
///
/// # Errors
///
/// Nothing exists there.
pub fn path_facts(path: &Path) -> io::Result<PathFacts> {
    with_disk(|disk| {
        let file = disk.files.get(path);
        let is_folder = disk.folders.contains(path);
        if file.is_none() && !is_folder {
            return Err(ErrorKind::NotFound.into());
        }
        Ok(PathFacts {
            is_file: file.is_some(),
            is_folder,
            length: file.map_or(0, |bytes| bytes.len() as u64),
        })
    })
}

/// Returns whether a file or folder exists at a path.
pub fn is_taken(path: &Path) -> bool {
    path_facts(path).is_ok()
}

/// Returns false: a page has no links.
pub const fn is_link(_path: &Path) -> bool {
    false
}

/// Reads at most the first `most` bytes of a file.
///
/// # Errors
/// The file does not exist.
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    with_disk(|disk| {
        let bytes = disk.files.get(path).ok_or(ErrorKind::NotFound)?;
        let most = usize::try_from(most).unwrap_or(usize::MAX);
        Ok(bytes[..bytes.len().min(most)].to_vec())
    })
}

/// Lists the paths in a folder.
///
/// # Errors
/// The folder does not exist.
pub fn list(folder: &Path) -> io::Result<Vec<PathBuf>> {
    with_disk(|disk| {
        if !disk.folders.contains(folder) {
            return Err(ErrorKind::NotFound.into());
        }
        let all = disk.files.keys().chain(&disk.folders);
        let inside = all.filter(|path| path.parent() == Some(folder));
        Ok(inside.cloned().collect())
    })
}

/// Creates a folder and its parents.
///
/// # Errors
/// Never.
pub fn make_folder(path: &Path) -> io::Result<()> {
    let folders = path.ancestors().map(Path::to_owned);
    with_disk(|disk| disk.folders.extend(folders));
    Ok(())
}

/// Removes a file.
///
/// # Errors
/// The file does not exist.
pub fn remove(path: &Path) -> io::Result<()> {
    let found = with_disk(|disk| disk.files.remove(path));
    found.ok_or(ErrorKind::NotFound)?;
    update_storage(path, None)
}

/// Removes a folder with its content.
///
/// # Errors
/// The folder does not exist, or the storage does not remove it.
pub fn remove_folder(path: &Path) -> io::Result<()> {
    let files = with_disk(|disk| {
        if !disk.folders.contains(path) {
            return Err(ErrorKind::NotFound);
        }
        disk.folders.retain(|folder| !folder.starts_with(path));
        let inside = disk.files.keys().filter(|file| file.starts_with(path));
        Ok(inside.cloned().collect::<Vec<_>>())
    })?;
    files.iter().try_for_each(|file| remove(file))
}

/// Renames a file. Replaces an existing file at `to`. A file in [`USER_FOLDER`] becomes a
/// download.
///
/// # Errors
/// The file does not exist, or the storage is full.
pub fn rename(from: &Path, to: &Path) -> io::Result<()> {
    let bytes = with_disk(|disk| disk.files.get(from).cloned()).ok_or(ErrorKind::NotFound)?;
    update_storage(to, Some(&bytes))?;
    with_disk(|disk| {
        disk.files.remove(from);
        disk.put(to, bytes.clone());
    });
    if to.starts_with(USER_FOLDER) {
        download(to, &bytes);
    }
    update_storage(from, None)
}

/// Writes a file. The storage keeps the file only after it has its final name (see
/// [`rename`]): a temporary file would take the space twice.
///
/// # Errors
/// Never.
pub fn write_new(path: &Path, bytes: &[u8], _owner_alone: bool) -> io::Result<()> {
    with_disk(|disk| disk.put(path, bytes.to_vec()));
    Ok(())
}

/// Does nothing: a page writes to the storage at once.
pub const fn sync_folder(_folder: &Path) {}

/// Whether a file still exists when the page is opened again.
pub fn is_persistent(path: &Path) -> bool {
    path.starts_with(STORAGE_FOLDER)
}

/// Writes files into the folder of the user's files and returns the path of the first program, or
/// of the first file; `None` without files.
pub fn add_user_files(files: Vec<(String, Vec<u8>)>) -> Option<PathBuf> {
    let paths = files.into_iter().map(|(name, bytes)| {
        let path = Path::new(USER_FOLDER).join(name);
        with_disk(|disk| disk.put(&path, bytes));
        path
    });
    let paths: Vec<PathBuf> = paths.collect();
    let is_job = |path: &&PathBuf| path.extension().is_some_and(|ending| ending == "ron");
    let program = paths.iter().find(|path| !is_job(path));
    program.or(paths.first()).cloned()
}

/// A lock that only one page holds at a time.
#[derive(Debug)]
pub struct Lock;

impl Lock {
    /// Locks a file for this page alone.
    ///
    /// # Errors
    /// [`ErrorKind::WouldBlock`]: another page holds it.
    pub fn exclusive(path: &Path) -> io::Result<Self> {
        PAGE_ID.set(js_sys::Math::random());
        if lock_holder(path).is_some_and(|(_, age)| age < LEASE.as_secs_f64() * 1e3) {
            let lost = say::page_open_elsewhere().to_string();
            return Err(io::Error::new(ErrorKind::WouldBlock, lost));
        }
        // A page holds one lock at a time.
        release_lock();
        renew_lock(path);
        HELD_LOCK.set(Some((path.to_owned(), Instant::now())));
        Ok(Self)
    }

    /// Locks a file for reading, together with other readers.
    ///
    /// # Errors
    /// The file does not exist.
    pub fn shared(path: &Path) -> io::Result<Self> {
        path_facts(path).map(|_| Self)
    }
}

/// Returns the id of the page that holds a lock, and the age of its last renewal, ms; `None`
/// if no page holds it.
fn lock_holder(path: &Path) -> Option<(f64, f64)> {
    let text = storage()?.get_item(&key(path)).ok()??;
    let (name, renewed) = text.split_once(' ')?;
    let renewed_ms: f64 = renewed.parse().ok()?;
    Some((name.parse().ok()?, js_sys::Date::now() - renewed_ms))
}

/// Stores that this page holds the lock of `path` now.
fn renew_lock(path: &Path) {
    let entry = format!("{} {}", PAGE_ID.get(), js_sys::Date::now());
    if let Some(storage) = storage() {
        // Without a storage no page can take a lock.
        let _ = storage.set_item(&key(path), &entry);
    }
}

/// Renews the lock from time to time, unless another page has taken it meanwhile.
pub fn maintain_lock() {
    let Some((path, renewed)) = HELD_LOCK.take() else {
        return;
    };
    if renewed.elapsed() < RENEW_INTERVAL {
        return HELD_LOCK.set(Some((path, renewed)));
    }
    if lock_holder(&path).is_some_and(|(name, _)| name.total_cmp(&PAGE_ID.get()).is_ne()) {
        return LOCK_LOST.set(true);
    }
    renew_lock(&path);
    HELD_LOCK.set(Some((path, Instant::now())));
}

/// Releases the lock when the page is closed, so that another page may take it.
pub fn release_lock() {
    if let Some((path, _)) = HELD_LOCK.take()
        && let Some(storage) = storage()
    {
        let _ = storage.remove_item(&key(&path));
    }
}
