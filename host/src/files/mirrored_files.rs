//! Files kept twice under a manifest: damage and loss are detected, and the copy is read
//! instead.
//!
//! ```text
//! manifest.ron             what every file must be
//! NAME                     the file
//! copies/manifest.ron
//! copies/NAME              its copy
//! ```

use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use gsk_messages::{Message, say};

use super::atomic::{self, FileAccess};
use super::manifest::{ContentMark, FileState, Manifest};
use crate::message_format::describe_io_error;
use crate::platform;

const MANIFEST: &str = "manifest.ron";
const COPIES: &str = "copies";

/// Size limit of the manifest, bytes.
const MAX_MANIFEST_BYTES: u64 = 16 * 1024 * 1024;

/// The files of one folder with their copies and manifest.
#[derive(Debug)]
pub struct MirroredFiles {
    folder: PathBuf,
    /// Whether the files are only read, and none is renamed or written.
    read_only: bool,
    manifest: Mutex<Manifest>,
    /// The damage of the manifest itself; `None` if it was intact.
    manifest_damage: Option<FileDamage>,
}

/// The damage of a file that was found while reading.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileDamage {
    /// The name of the file, without its folder.
    pub file_name: String,
    /// Message about what is damaged, and which contents are used instead.
    pub message: Message,
}

impl FileDamage {
    /// Creates the damage of the file at `path`.
    pub fn new(path: &Path, message: Message) -> Self {
        let name = path.file_name().unwrap_or_default();
        Self {
            file_name: name.to_string_lossy().into_owned(),
            message,
        }
    }
}

/// A change of a file: its new contents, or its deletion.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileChange {
    /// Name of the changed file in its folder.
    pub name: String,
    /// New contents of the file; `None` deletes the file.
    pub contents: Option<Vec<u8>>,
    /// Who may read the file after it is written.
    pub readers: FileAccess,
}

/// The contents of a file that was read, or its damage.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileReadResult {
    /// The contents of the file or of its copy; `None` if neither is usable.
    pub contents: Option<Vec<u8>>,
    /// The damage; `None` if the file is intact or never existed.
    pub damage: Option<FileDamage>,
}

impl MirroredFiles {
    /// Opens a folder with its manifest.
    pub fn open(folder: &Path, read_only: bool) -> Self {
        let (manifest, manifest_damage) = match read_manifest(folder) {
            Ok(manifest) => (manifest, None),
            Err((manifest, complaint)) => (manifest, Some(complaint)),
        };
        Self {
            folder: folder.to_owned(),
            read_only,
            manifest: Mutex::new(manifest),
            manifest_damage,
        }
    }

    pub const fn manifest_damage(&self) -> Option<&FileDamage> {
        self.manifest_damage.as_ref()
    }

    /// Returns the names of all files in the manifest.
    pub fn names(&self) -> Vec<String> {
        self.manifest().names().map(str::to_owned).collect()
    }

    /// Reads a file of at most `max_bytes` bytes. A damaged file is renamed and its copy is
    /// read.
    pub fn read(&self, name: &str, max_bytes: u64) -> FileReadResult {
        let path = self.folder.join(name);
        let (contents, reason) = match read_regular_file(&path, max_bytes) {
            Ok(found) => (found, None),
            Err(reason) => (None, Some(reason)),
        };
        let state = contents.as_deref().map(ContentMark::from_bytes);
        let mut manifest = self.manifest();
        let reason = match reason {
            None if manifest.allows(name, state) => {
                manifest.record_found_state(name, state);
                return FileReadResult {
                    contents,
                    damage: None,
                };
            }
            None if contents.is_none() => None,
            None => Some(say::file_checksum_wrong()),
            reason => reason,
        };
        let copy = read_regular_file(&self.folder.join(COPIES).join(name), max_bytes)
            .ok()
            .flatten()
            .filter(|bytes| {
                manifest.state(name).is_some()
                    && manifest.allows(name, Some(ContentMark::from_bytes(bytes)))
            });
        // The next commit writes the file again, whatever its state is.
        manifest.record_state(name, None);
        FileReadResult {
            damage: Some(self.report_damage(&path, reason, copy.is_some())),
            contents: copy,
        }
    }

    /// Marks a file whose checksum is good as damaged, because its contents cannot be used for
    /// `reason`; returns its damage.
    pub fn mark_damaged(&self, name: &str, reason: Message) -> FileDamage {
        self.manifest().record_state(name, None);
        self.report_damage(&self.folder.join(name), Some(reason), false)
    }

    /// Renames a damaged file and returns its damage, with the contents that are used instead:
    /// the copy or the default. `reason` is `None` if the file is missing.
    fn report_damage(&self, path: &Path, reason: Option<Message>, has_copy: bool) -> FileDamage {
        let replacement = match has_copy {
            true => say::file_copy_used(),
            false => say::file_as_delivered(),
        };
        let shown = path.display();
        let message = match reason {
            None => say::file_missing(shown, replacement),
            Some(reason) if self.read_only => say::file_damaged(shown, reason, replacement),
            Some(reason) => match atomic::rename_damaged(path) {
                Ok(kept) => say::file_damaged_kept(shown, reason, kept.display(), replacement),
                Err(error) => say::file_damaged_not_renamed(
                    shown,
                    reason,
                    describe_io_error(&error),
                    replacement,
                ),
            },
        };
        FileDamage::new(path, message)
    }

    /// Writes the changes whose contents are new, each file independently. Returns one
    /// message for each file that cannot be written.
    pub fn commit(&self, changes: Vec<FileChange>) -> Vec<Message> {
        let mut manifest = self.manifest();
        let changes: Vec<(FileChange, FileState)> = changes
            .into_iter()
            .map(|change| {
                let state = change.contents.as_deref().map(ContentMark::from_bytes);
                (change, state)
            })
            .filter(|(change, state)| manifest.state(&change.name) != Some(*state))
            .collect();
        if changes.is_empty() {
            return Vec::new();
        }
        let before: Vec<Option<FileState>> = changes
            .iter()
            .map(|(change, _)| manifest.state(&change.name))
            .collect();
        for (change, state) in &changes {
            manifest.begin_write(&change.name, *state);
        }
        let mut failures = Vec::new();
        failures.extend(self.write_manifest(&manifest).err());
        let with_manifest = failures.is_empty();
        for ((change, state), before) in changes.iter().zip(before) {
            match self.write_change(change) {
                Ok(()) => manifest.record_state(&change.name, *state),
                Err(failure) => {
                    failures.push(failure);
                    match before {
                        Some(before) => manifest.record_state(&change.name, before),
                        None => manifest.record_unknown_state(&change.name),
                    }
                }
            }
        }
        if with_manifest {
            failures.extend(self.write_manifest(&manifest).err());
        }
        failures
    }

    fn write_change(&self, change: &FileChange) -> Result<(), Message> {
        let path = self.folder.join(&change.name);
        let copy = self.folder.join(COPIES).join(&change.name);
        let Some(content) = &change.contents else {
            return remove(&path).and_then(|()| remove(&copy));
        };
        write(&path, content, change.readers)?;
        write(&copy, content, change.readers)
    }

    /// Writes the manifest and its copy. If that fails, removes both, because an outdated
    /// manifest would reject good files.
    fn write_manifest(&self, manifest: &Manifest) -> Result<(), Message> {
        let (path, copy) = (
            self.folder.join(MANIFEST),
            self.folder.join(COPIES).join(MANIFEST),
        );
        let text = manifest.to_text().map_err(say::as_written)?;
        let written = write(&path, text.as_bytes(), FileAccess::Any)
            .and_then(|()| write(&copy, text.as_bytes(), FileAccess::Any));
        if written.is_err() {
            let _ = remove(&path);
            let _ = remove(&copy);
        }
        written
    }

    fn manifest(&self) -> MutexGuard<'_, Manifest> {
        self.manifest.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Reads the manifest or its copy. The error holds the usable manifest and the damage.
fn read_manifest(folder: &Path) -> Result<Manifest, (Manifest, FileDamage)> {
    let read = |path: &Path| match read_regular_file(path, MAX_MANIFEST_BYTES) {
        Ok(None) => Ok(None),
        Ok(Some(bytes)) => String::from_utf8(bytes)
            .ok()
            .and_then(|text| Manifest::from_text(&text))
            .map(Some)
            .ok_or(()),
        Err(_) => Err(()),
    };
    let path = folder.join(MANIFEST);
    let (main, copy) = (read(&path), read(&folder.join(COPIES).join(MANIFEST)));
    match (main, copy) {
        (Ok(Some(manifest)), _) => Ok(manifest),
        // A directory of a version without manifest, or a new one.
        (Ok(None), Ok(None)) => Ok(Manifest::default()),
        (main, Ok(Some(manifest))) => {
            let (shown, instead) = (path.display(), say::file_copy_used());
            let message = match main {
                Ok(_) => say::file_missing(shown, instead),
                Err(()) => say::file_damaged(shown, say::file_checksum(), instead),
            };
            Err((manifest, FileDamage::new(&path, message)))
        }
        (_, _) => {
            let message = say::file_and_copy_damaged(path.display());
            Err((Manifest::default(), FileDamage::new(&path, message)))
        }
    }
}

/// Reads a regular file; `None` if it does not exist. Returns a message as error if it cannot be
/// read or is larger than `max_bytes`.
fn read_regular_file(path: &Path, max_bytes: u64) -> Result<Option<Vec<u8>>, Message> {
    let facts = match platform::path_facts(path) {
        Ok(facts) => facts,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(say::as_written(error)),
    };
    // Reading a pipe would wait for its writer.
    if !facts.is_file {
        return Err(say::file_not_plain());
    }
    let bytes = platform::read(path, max_bytes + 1).map_err(say::as_written)?;
    if bytes.len() as u64 > max_bytes {
        return Err(say::file_larger_than(max_bytes));
    }
    Ok(Some(bytes))
}

fn write(path: &Path, bytes: &[u8], readers: FileAccess) -> Result<(), Message> {
    let to_message =
        |error: io::Error| say::file_not_written(path.display(), describe_io_error(&error));
    if let Some(folder) = path.parent() {
        platform::make_folder(folder).map_err(to_message)?;
    }
    atomic::write_with_access(path, bytes, readers).map_err(to_message)
}

fn remove(path: &Path) -> Result<(), Message> {
    match platform::remove(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(say::file_not_deleted(
            path.display(),
            describe_io_error(&error),
        )),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use gsk_tests::{TestFolder, test_folder};

    const LARGEST: u64 = 1000;

    fn change(name: &str, content: &str) -> FileChange {
        FileChange {
            name: name.to_owned(),
            contents: Some(content.as_bytes().to_vec()),
            readers: FileAccess::Any,
        }
    }

    fn folder_with(name: &str, files: &[(&str, &str)]) -> TestFolder {
        let folder = test_folder(name);
        let changes = files
            .iter()
            .map(|(name, text)| change(name, text))
            .collect();
        assert_eq!(MirroredFiles::open(&folder, false).commit(changes), []);
        folder
    }

    #[test]
    fn damage_and_deletion_are_detected_and_the_copy_is_used() {
        let folder = folder_with("kept-damage", &[("a.ron", "(24: 584)"), ("b.ron", "()")]);
        type Damage = fn(&Path);
        let damages: [(&str, Damage); 3] = [
            ("checksum is wrong", |path| {
                fs::write(path, "(24: 585)").unwrap();
            }),
            ("checksum is wrong", |path| {
                fs::write(path, "(24").unwrap();
            }),
            ("a.ron is missing", |path| fs::remove_file(path).unwrap()),
        ];
        for (reason, damage) in damages {
            damage(&folder.join("a.ron"));
            let kept = MirroredFiles::open(&folder, false);
            let found = kept.read("a.ron", LARGEST);
            assert_eq!(found.contents.as_deref(), Some(b"(24: 584)".as_slice()));
            let sentence = found.damage.unwrap().message.to_string();
            assert!(sentence.contains(reason), "{sentence}");
            assert!(sentence.contains("last good copy is used"), "{sentence}");
            assert_eq!(kept.read("b.ron", LARGEST).damage, None);
            // The damage is reported once: the next commit writes the file again.
            assert_eq!(kept.commit(vec![change("a.ron", "(24: 584)")]), []);
            assert_eq!(
                MirroredFiles::open(&folder, false)
                    .read("a.ron", LARGEST)
                    .damage,
                None
            );
        }
        assert!(folder.join("a.ron.damaged2").exists());
    }

    #[test]
    fn a_read_only_folder_is_not_changed() {
        let folder = folder_with("kept-read", &[("a.ron", "one")]);
        fs::write(folder.join("a.ron"), "two").unwrap();
        for _ in 0..2 {
            let found = MirroredFiles::open(&folder, true).read("a.ron", LARGEST);
            assert_eq!(found.contents.as_deref(), Some(b"one".as_slice()));
            assert!(found.damage.is_some());
        }
        assert_eq!(fs::read(folder.join("a.ron")).unwrap(), b"two");
    }

    #[test]
    fn a_file_that_cannot_be_written_does_not_block_others() {
        let folder = folder_with("kept-each", &[("a", "1"), ("b", "1"), ("c", "1")]);
        fs::remove_file(folder.join("b")).unwrap();
        fs::create_dir(folder.join("b")).unwrap();
        fs::write(folder.join("b/in-the-way"), "").unwrap();
        let kept = MirroredFiles::open(&folder, false);
        let failures = kept.commit(vec![change("a", "2"), change("b", "2"), change("c", "2")]);
        assert_eq!(failures.len(), 1, "{failures:?}");
        let message = failures[0].to_string();
        assert!(message.contains("b cannot be written"), "{message}");
        for name in ["a", "c"] {
            assert_eq!(fs::read(folder.join(name)).unwrap(), b"2");
            assert_eq!(
                MirroredFiles::open(&folder, false)
                    .read(name, LARGEST)
                    .damage,
                None
            );
        }
    }

    #[test]
    fn a_damaged_manifest_is_replaced_by_its_copy() {
        let folder = folder_with("kept-manifest", &[("a", "1")]);
        fs::write(folder.join("manifest.ron"), "// 0\n").unwrap();
        let kept = MirroredFiles::open(&folder, false);
        let message = kept.manifest_damage().unwrap().message.to_string();
        assert!(message.contains("is damaged"), "{message}");
        fs::write(folder.join("a"), "2").unwrap();
        assert!(kept.read("a", LARGEST).damage.is_some());
    }

    /// A kill between the first manifest and the files leaves the old files. The next commit
    /// writes them, although the manifest already lists their new state.
    #[test]
    fn the_next_commit_completes_a_killed_one() {
        let deletion = |name: &str| FileChange {
            contents: None,
            ..change(name, "")
        };
        let folder = folder_with("kept-killed", &[("a", "old"), ("b", "old"), ("c", "old")]);
        let kept = MirroredFiles::open(&folder, false);
        let mut manifest = kept.manifest().clone();
        manifest.begin_write("a", Some(ContentMark::from_bytes(b"new")));
        manifest.begin_write("b", None);
        manifest.begin_write("c", None);
        kept.write_manifest(&manifest).unwrap();
        // The third file was deleted, but not its copy.
        fs::remove_file(folder.join("c")).unwrap();
        let kept = MirroredFiles::open(&folder, false);
        let contents = ["a", "b", "c"].map(|name| kept.read(name, LARGEST));
        let old = Some(b"old".to_vec());
        assert_eq!(contents.each_ref().map(|found| &found.damage), [&None; 3]);
        assert_eq!(
            contents.map(|found| found.contents),
            [old.clone(), old, None]
        );
        let changes = vec![change("a", "new"), deletion("b"), deletion("c")];
        assert_eq!(kept.commit(changes), []);
        for folder_path in [folder.to_path_buf(), folder.join(COPIES)] {
            assert_eq!(fs::read(folder_path.join("a")).unwrap(), b"new");
            assert!(!folder_path.join("b").exists() && !folder_path.join("c").exists());
        }
        assert_eq!(MirroredFiles::open(&folder, false).names(), ["a"]);
    }
}
