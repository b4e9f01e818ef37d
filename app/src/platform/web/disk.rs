//! Files of a page: those of its memory are kept in the browser's storage, the others as
//! long as the page is open. A file that the program writes for its user is handed out
//! as a download.

use std::cell::{Cell, RefCell};
use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use gsk_messages::say;
use web_sys::Storage;
use web_time::{Duration, Instant};

use super::super::Facts;
use super::download::download;

/// The folder that the browser keeps.
pub const KEPT: &str = "/data";
/// The folder of files that come from the user and go to him.
pub const HANDED: &str = "/files";
/// Before the name of each file in the storage.
const OWN: &str = "gsk980td:";
/// A page that has said nothing for so long is gone, and has let its files go.
const LEASE: Duration = Duration::from_secs(5);
/// How often it says that it is there.
const BETWEEN: Duration = Duration::from_secs(1);

/// The files of the page.
#[derive(Default)]
struct Disk {
    files: BTreeMap<PathBuf, Vec<u8>>,
    folders: BTreeSet<PathBuf>,
}

thread_local! {
    static DISK: RefCell<Option<Disk>> = const { RefCell::new(None) };
    /// What this page is called among those that are open.
    static NAME: Cell<f64> = const { Cell::new(0.0) };
    /// The lock that this page has, and when it said so last.
    static LOCKED: RefCell<Option<(PathBuf, Instant)>> = const { RefCell::new(None) };
    /// Another page has taken the lock: nothing is written any more.
    static LOST: Cell<bool> = const { Cell::new(false) };
}

fn storage() -> Option<Storage> {
    web_sys::window()?.local_storage().ok()?
}

/// Its user hands single files over.
pub const fn has_folders() -> bool {
    false
}

/// Whether the browser keeps files beyond the page.
pub fn is_kept() -> bool {
    storage().is_some()
}

fn key(path: &Path) -> String {
    format!("{OWN}{}", path.display())
}

/// Bytes as the storage takes them: a character each.
fn packed(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| char::from(*byte)).collect()
}

/// The same back; none of a text that is no such thing.
fn unpacked(text: &str) -> Option<Vec<u8>> {
    let bytes = text
        .chars()
        .map(|character| u8::try_from(u32::from(character)).ok());
    bytes.collect()
}

/// Does something with the files; what the browser has kept is read before the first.
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

/// What the storage is to have of a file from now on.
fn keep(path: &Path, bytes: Option<&[u8]>) -> io::Result<()> {
    if !path.starts_with(KEPT) {
        return Ok(());
    }
    if LOST.get() {
        let lost = say::page_open_elsewhere().to_string();
        return Err(io::Error::new(ErrorKind::WouldBlock, lost));
    }
    // Without a storage the page goes on, and says so at its start.
    let Some(storage) = storage() else {
        return Ok(());
    };
    let done = match bytes {
        Some(bytes) => storage.set_item(&key(path), &packed(bytes)),
        None => storage.remove_item(&key(path)),
    };
    done.map_err(|_| ErrorKind::StorageFull.into())
}

/// What stands at a path.
///
/// # Errors
/// Nothing.
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

/// Whether something stands at a path.
pub fn is_taken(path: &Path) -> bool {
    facts(path).is_ok()
}

/// There are no links.
pub const fn is_link(_path: &Path) -> bool {
    false
}

/// The first bytes of a file, this many at most.
///
/// # Errors
/// There is none.
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    with(|disk| {
        let bytes = disk.files.get(path).ok_or(ErrorKind::NotFound)?;
        let most = usize::try_from(most).unwrap_or(usize::MAX);
        Ok(bytes[..bytes.len().min(most)].to_vec())
    })
}

/// What stands in a folder.
///
/// # Errors
/// There is none.
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

/// Makes a folder and those above it.
///
/// # Errors
/// None here.
pub fn make_folder(path: &Path) -> io::Result<()> {
    let folders = path.ancestors().map(Path::to_owned);
    with(|disk| disk.folders.extend(folders));
    Ok(())
}

/// Removes a file.
///
/// # Errors
/// There is none.
pub fn remove(path: &Path) -> io::Result<()> {
    let found = with(|disk| disk.files.remove(path));
    found.ok_or(ErrorKind::NotFound)?;
    keep(path, None)
}

/// Removes a folder with all that is in it.
///
/// # Errors
/// There is none, or the storage does not let it go.
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

/// Gives a file another name; one that had it is gone.
///
/// # Errors
/// There is none, or the storage is full.
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

/// Writes a file. It is kept once it has its name (see [`rename`]): what is written
/// aside would fill the storage twice.
///
/// # Errors
/// None here.
pub fn write_new(path: &Path, bytes: &[u8], _owner_alone: bool) -> io::Result<()> {
    with(|disk| disk.put(path, bytes.to_vec()));
    Ok(())
}

/// Nothing is written later here.
pub const fn sync_folder(_folder: &Path) {}

/// Whether a file is there when the page is opened again.
pub fn lasts(path: &Path) -> bool {
    path.starts_with(KEPT)
}

/// Puts files where the user's files are, and says where the first one is.
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

/// A file that one page at a time has.
#[derive(Debug)]
pub struct Lock;

impl Lock {
    /// For this page alone.
    ///
    /// # Errors
    /// [`ErrorKind::WouldBlock`]: another one has it.
    pub fn alone(path: &Path) -> io::Result<Self> {
        NAME.set(js_sys::Math::random());
        if holder(path).is_some_and(|(_, age)| age < LEASE.as_secs_f64() * 1e3) {
            let lost = say::page_open_elsewhere().to_string();
            return Err(io::Error::new(ErrorKind::WouldBlock, lost));
        }
        // A page has one memory at a time.
        let_lock_go();
        hold(path);
        LOCKED.set(Some((path.to_owned(), Instant::now())));
        Ok(Self)
    }

    /// Beside others that only read.
    ///
    /// # Errors
    /// There is no such file.
    pub fn beside_readers(path: &Path) -> io::Result<Self> {
        facts(path).map(|_| Self)
    }
}

/// Who has a lock, and how long he has not said so, ms.
fn holder(path: &Path) -> Option<(f64, f64)> {
    let text = storage()?.get_item(&key(path)).ok()??;
    let (name, said) = text.split_once(' ')?;
    let said: f64 = said.parse().ok()?;
    Some((name.parse().ok()?, js_sys::Date::now() - said))
}

/// Says that this page has a lock.
fn hold(path: &Path) {
    let said = format!("{} {}", NAME.get(), js_sys::Date::now());
    if let Some(storage) = storage() {
        // Without a storage nobody takes anything from anybody.
        let _ = storage.set_item(&key(path), &said);
    }
}

/// Says from time to time that this page is there, unless another one has taken its
/// place meanwhile.
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

/// The page is left: another one may have its memory.
pub fn let_lock_go() {
    if let Some((path, _)) = LOCKED.take()
        && let Some(storage) = storage()
    {
        let _ = storage.remove_item(&key(&path));
    }
}
