//! Files of a page: the browser's storage keeps those under [`KEPT`], the others exist
//! while the page is open. A file that the program writes for its user becomes a download.

use std::cell::{Cell, RefCell};
use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use gsk_messages::say;
use web_sys::Storage;
use web_time::{Duration, Instant};

use super::super::Facts;
use super::download::download;

/// The folder that the browser's storage keeps.
pub const KEPT: &str = "/data";
/// The folder of files that the user opens and downloads.
pub const HANDED: &str = "/files";
/// Prefix of each file name in the storage.
const OWN: &str = "gsk980td:";
/// A page that has not renewed its lock for this time is gone.
const LEASE: Duration = Duration::from_secs(5);
/// Time between two renewals of the lock.
const BETWEEN: Duration = Duration::from_secs(1);

#[derive(Default)]
struct Disk {
    files: BTreeMap<PathBuf, Vec<u8>>,
    folders: BTreeSet<PathBuf>,
}

thread_local! {
    static DISK: RefCell<Option<Disk>> = const { RefCell::new(None) };
    /// Random number that identifies this page among the open ones.
    static NAME: Cell<f64> = const { Cell::new(0.0) };
    /// The lock that this page holds, and when it renewed it last.
    static LOCKED: RefCell<Option<(PathBuf, Instant)>> = const { RefCell::new(None) };
    /// Another page has taken the lock: this page writes nothing any more.
    static LOST: Cell<bool> = const { Cell::new(false) };
}

fn storage() -> Option<Storage> {
    web_sys::window()?.local_storage().ok()?
}

/// Returns false: the user passes single files to a page.
pub const fn has_folders() -> bool {
    false
}

/// Whether the browser keeps files after the page is closed.
pub fn is_kept() -> bool {
    storage().is_some()
}

fn key(path: &Path) -> String {
    format!("{OWN}{}", path.display())
}

/// Encodes bytes for the storage, one character each.
fn packed(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| char::from(*byte)).collect()
}

/// Decodes a text from the storage; `None` if it is not of that form.
fn unpacked(text: &str) -> Option<Vec<u8>> {
    let bytes = text
        .chars()
        .map(|character| u8::try_from(u32::from(character)).ok());
    bytes.collect()
}

/// Passes the files to a closure; reads the storage before the first call.
fn with<T>(does: impl FnOnce(&mut Disk) -> T) -> T {
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
            let Some(path) = key.strip_prefix(OWN) else {
                continue;
            };
            let text = storage.get_item(&key).ok().flatten().unwrap_or_default();
            if let Some(bytes) = unpacked(&text) {
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

/// Writes a file of [`KEPT`] to the storage; `None` removes it there.
fn keep(path: &Path, bytes: Option<&[u8]>) -> io::Result<()> {
    if !path.starts_with(KEPT) {
        return Ok(());
    }
    if LOST.get() {
        let lost = say::page_open_elsewhere().to_string();
        return Err(io::Error::new(ErrorKind::WouldBlock, lost));
    }
    // Without a storage the page continues; it reports this at its start.
    let Some(storage) = storage() else {
        return Ok(());
    };
    let done = match bytes {
        Some(bytes) => storage.set_item(&key(path), &packed(bytes)),
        None => storage.remove_item(&key(path)),
    };
    done.map_err(|_| ErrorKind::StorageFull.into())
}

/// Returns what exists at a path.
///
/// # Errors
/// Nothing exists there.
pub fn facts(path: &Path) -> io::Result<Facts> {
    with(|disk| {
        let file = disk.files.get(path);
        let is_folder = disk.folders.contains(path);
        if file.is_none() && !is_folder {
            return Err(ErrorKind::NotFound.into());
        }
        Ok(Facts {
            is_file: file.is_some(),
            is_folder,
            length: file.map_or(0, |bytes| bytes.len() as u64),
        })
    })
}

/// Whether something exists at a path.
pub fn is_taken(path: &Path) -> bool {
    facts(path).is_ok()
}

/// Returns false: a page has no links.
pub const fn is_link(_path: &Path) -> bool {
    false
}

/// Reads the first bytes of a file, at most this number.
///
/// # Errors
/// The file does not exist.
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    with(|disk| {
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
    with(|disk| {
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
    with(|disk| disk.folders.extend(folders));
    Ok(())
}

/// Removes a file.
///
/// # Errors
/// The file does not exist.
pub fn remove(path: &Path) -> io::Result<()> {
    let found = with(|disk| disk.files.remove(path));
    found.ok_or(ErrorKind::NotFound)?;
    keep(path, None)
}

/// Removes a folder with its content.
///
/// # Errors
/// The folder does not exist, or the storage does not remove it.
pub fn remove_folder(path: &Path) -> io::Result<()> {
    let files = with(|disk| {
        if !disk.folders.contains(path) {
            return Err(ErrorKind::NotFound);
        }
        disk.folders.retain(|folder| !folder.starts_with(path));
        let inside = disk.files.keys().filter(|file| file.starts_with(path));
        Ok(inside.cloned().collect::<Vec<_>>())
    })?;
    files.iter().try_for_each(|file| remove(file))
}

/// Renames a file; replaces a file of the new name. A file in [`HANDED`] becomes a
/// download.
///
/// # Errors
/// The file does not exist, or the storage is full.
pub fn rename(from: &Path, to: &Path) -> io::Result<()> {
    let bytes = with(|disk| disk.files.get(from).cloned()).ok_or(ErrorKind::NotFound)?;
    keep(to, Some(&bytes))?;
    with(|disk| {
        disk.files.remove(from);
        disk.put(to, bytes.clone());
    });
    if to.starts_with(HANDED) {
        download(to, &bytes);
    }
    keep(from, None)
}

/// Writes a file. The storage keeps it once it has its final name (see [`rename`]): a
/// temporary file would take the space twice.
///
/// # Errors
/// Never.
pub fn write_new(path: &Path, bytes: &[u8], _owner_alone: bool) -> io::Result<()> {
    with(|disk| disk.put(path, bytes.to_vec()));
    Ok(())
}

/// Does nothing: a page writes at once.
pub const fn sync_folder(_folder: &Path) {}

/// Whether a file still exists when the page is opened again.
pub fn lasts(path: &Path) -> bool {
    path.starts_with(KEPT)
}

/// Puts files into the folder of the user's files and returns the path of the first
/// program, or of the first file.
pub fn hand_in(files: Vec<(String, Vec<u8>)>) -> Option<PathBuf> {
    let paths = files.into_iter().map(|(name, bytes)| {
        let path = Path::new(HANDED).join(name);
        with(|disk| disk.put(&path, bytes));
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
    pub fn alone(path: &Path) -> io::Result<Self> {
        NAME.set(js_sys::Math::random());
        if holder(path).is_some_and(|(_, age)| age < LEASE.as_secs_f64() * 1e3) {
            let lost = say::page_open_elsewhere().to_string();
            return Err(io::Error::new(ErrorKind::WouldBlock, lost));
        }
        // A page holds one lock at a time.
        let_lock_go();
        hold(path);
        LOCKED.set(Some((path.to_owned(), Instant::now())));
        Ok(Self)
    }

    /// Locks a file for reading, together with other readers.
    ///
    /// # Errors
    /// The file does not exist.
    pub fn beside_readers(path: &Path) -> io::Result<Self> {
        facts(path).map(|_| Self)
    }
}

/// Returns the page that holds a lock, and the age of its last renewal, ms.
fn holder(path: &Path) -> Option<(f64, f64)> {
    let text = storage()?.get_item(&key(path)).ok()??;
    let (name, said) = text.split_once(' ')?;
    let said: f64 = said.parse().ok()?;
    Some((name.parse().ok()?, js_sys::Date::now() - said))
}

/// Records that this page holds a lock.
fn hold(path: &Path) {
    let said = format!("{} {}", NAME.get(), js_sys::Date::now());
    if let Some(storage) = storage() {
        // Without a storage no page can take a lock.
        let _ = storage.set_item(&key(path), &said);
    }
}

/// Renews the lock from time to time, unless another page has taken it meanwhile.
pub fn keep_lock() {
    let Some((path, said)) = LOCKED.take() else {
        return;
    };
    if said.elapsed() < BETWEEN {
        return LOCKED.set(Some((path, said)));
    }
    if holder(&path).is_some_and(|(name, _)| name.total_cmp(&NAME.get()).is_ne()) {
        return LOST.set(true);
    }
    hold(&path);
    LOCKED.set(Some((path, Instant::now())));
}

/// Releases the lock when the page is left: another page may take it.
pub fn let_lock_go() {
    if let Some((path, _)) = LOCKED.take()
        && let Some(storage) = storage()
    {
        let _ = storage.remove_item(&key(&path));
    }
}
