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

use super::atomic::{self, Readers};
use super::manifest::{Manifest, Mark, State};
use crate::platform;
use crate::saying::of_system;

const MANIFEST: &str = "manifest.ron";
const COPIES: &str = "copies";

/// Size limit of the manifest, bytes.
const LARGEST_MANIFEST: u64 = 16 * 1024 * 1024;

/// The files of one folder with their copies and manifest.
#[derive(Debug)]
pub struct Kept {
    folder: PathBuf,
    /// Rename and write nothing.
    read_only: bool,
    manifest: Mutex<Manifest>,
    /// The damage of the manifest itself.
    complaint: Option<Complaint>,
}

/// The damage of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Complaint {
    /// The name of the file, without its folder.
    pub name: String,
    /// The damage, and what is used instead.
    pub said: Message,
}

impl Complaint {
    /// The damage of the file at a path.
    pub fn new(path: &Path, said: Message) -> Self {
        let name = path.file_name().unwrap_or_default();
        Self {
            name: name.to_string_lossy().into_owned(),
            said,
        }
    }
}

/// The new contents of a file, or its deletion.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Change {
    /// Name of the file in its folder.
    pub name: String,
    /// `None` deletes the file.
    pub content: Option<Vec<u8>>,
    /// Access rights of the file.
    pub readers: Readers,
}

/// The result of reading a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Found {
    /// The contents of the file or of its copy; `None` if neither is usable.
    pub content: Option<Vec<u8>>,
    /// `None` if the file is intact or never existed.
    pub damage: Option<Complaint>,
}

impl Kept {
    /// Opens a folder and reads its manifest.
    pub fn open(folder: &Path, read_only: bool) -> Self {
        let (manifest, complaint) = match read_manifest(folder) {
            Ok(manifest) => (manifest, None),
            Err((manifest, complaint)) => (manifest, Some(complaint)),
        };
        Self {
            folder: folder.to_owned(),
            read_only,
            manifest: Mutex::new(manifest),
            complaint,
        }
    }

    pub const fn complaint(&self) -> Option<&Complaint> {
        self.complaint.as_ref()
    }

    /// The file names in the manifest.
    pub fn names(&self) -> Vec<String> {
        self.manifest().names().map(str::to_owned).collect()
    }

    /// Reads a file of at most `largest` bytes. A damaged file is renamed and its copy is
    /// read.
    pub fn read(&self, name: &str, largest: u64) -> Found {
        let path = self.folder.join(name);
        let (found, reason) = match read_plain(&path, largest) {
            Ok(found) => (found, None),
            Err(reason) => (None, Some(reason)),
        };
        let state = found.as_deref().map(Mark::of);
        let mut manifest = self.manifest();
        let reason = match reason {
            None if manifest.allows(name, state) => {
                manifest.found(name, state);
                return Found {
                    content: found,
                    damage: None,
                };
            }
            None if found.is_none() => None,
            None => Some(say::file_checksum_wrong()),
            reason => reason,
        };
        let copy = read_plain(&self.folder.join(COPIES).join(name), largest)
            .ok()
            .flatten()
            .filter(|bytes| {
                manifest.state(name).is_some() && manifest.allows(name, Some(Mark::of(bytes)))
            });
        // The next commit writes the file again, whatever its state is.
        manifest.settle(name, None);
        Found {
            damage: Some(self.complain_of(&path, reason, copy.is_some())),
            content: copy,
        }
    }

    /// Marks a file with a good checksum as damaged, because its contents cannot be used.
    pub fn reject(&self, name: &str, reason: Message) -> Complaint {
        self.manifest().settle(name, None);
        self.complain_of(&self.folder.join(name), Some(reason), false)
    }

    /// Reports the damage of a file (`reason`; `None`: it is missing) and what is used
    /// instead.
    fn complain_of(&self, path: &Path, reason: Option<Message>, copy: bool) -> Complaint {
        let instead = match copy {
            true => say::file_copy_used(),
            false => say::file_as_delivered(),
        };
        let shown = path.display();
        let said = match reason {
            None => say::file_missing(shown, instead),
            Some(reason) if self.read_only => say::file_damaged(shown, reason, instead),
            Some(reason) => match atomic::set_aside(path) {
                Ok(kept) => say::file_damaged_kept(shown, reason, kept.display(), instead),
                Err(error) => {
                    say::file_damaged_not_renamed(shown, reason, of_system(&error), instead)
                }
            },
        };
        Complaint::new(path, said)
    }

    /// Writes the changes whose contents are new, each file independently. Returns one
    /// message for each file that cannot be written.
    pub fn commit(&self, changes: Vec<Change>) -> Vec<Message> {
        let mut manifest = self.manifest();
        let changes: Vec<(Change, State)> = changes
            .into_iter()
            .map(|change| {
                let state = change.content.as_deref().map(Mark::of);
                (change, state)
            })
            .filter(|(change, state)| manifest.state(&change.name) != Some(*state))
            .collect();
        if changes.is_empty() {
            return Vec::new();
        }
        let before: Vec<Option<State>> = changes
            .iter()
            .map(|(change, _)| manifest.state(&change.name))
            .collect();
        for (change, state) in &changes {
            manifest.begin(&change.name, *state);
        }
        let mut failures = Vec::new();
        failures.extend(self.write_manifest(&manifest).err());
        let with_manifest = failures.is_empty();
        for ((change, state), before) in changes.iter().zip(before) {
            match self.make(change) {
                Ok(()) => manifest.settle(&change.name, *state),
                Err(failure) => {
                    failures.push(failure);
                    match before {
                        Some(before) => manifest.settle(&change.name, before),
                        None => manifest.adopt(&change.name),
                    }
                }
            }
        }
        if with_manifest {
            failures.extend(self.write_manifest(&manifest).err());
        }
        failures
    }

    fn make(&self, change: &Change) -> Result<(), Message> {
        let path = self.folder.join(&change.name);
        let copy = self.folder.join(COPIES).join(&change.name);
        let Some(content) = &change.content else {
            return remove(&path).and_then(|()| remove(&copy));
        };
        write(&path, content, change.readers)?;
        write(&copy, content, change.readers)
    }

    /// Removes a manifest that cannot be written: a wrong one would reject good files.
    fn write_manifest(&self, manifest: &Manifest) -> Result<(), Message> {
        let (path, copy) = (
            self.folder.join(MANIFEST),
            self.folder.join(COPIES).join(MANIFEST),
        );
        let text = manifest.to_text().map_err(say::as_written)?;
        let written = write(&path, text.as_bytes(), Readers::Any)
            .and_then(|()| write(&copy, text.as_bytes(), Readers::Any));
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
fn read_manifest(folder: &Path) -> Result<Manifest, (Manifest, Complaint)> {
    let read = |path: &Path| match read_plain(path, LARGEST_MANIFEST) {
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
            let said = match main {
                Ok(_) => say::file_missing(shown, instead),
                Err(()) => say::file_damaged(shown, say::file_checksum(), instead),
            };
            Err((manifest, Complaint::new(&path, said)))
        }
        (_, _) => {
            let said = say::file_and_copy_damaged(path.display());
            Err((Manifest::default(), Complaint::new(&path, said)))
        }
    }
}

/// Reads a regular file; `None` if it does not exist.
fn read_plain(path: &Path, largest: u64) -> Result<Option<Vec<u8>>, Message> {
    let facts = match platform::facts(path) {
        Ok(facts) => facts,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(say::as_written(error)),
    };
    // Reading a pipe would wait for its writer.
    if !facts.is_file {
        return Err(say::file_not_plain());
    }
    let bytes = platform::read(path, largest + 1).map_err(say::as_written)?;
    if bytes.len() as u64 > largest {
        return Err(say::file_larger_than(largest));
    }
    Ok(Some(bytes))
}

fn write(path: &Path, bytes: &[u8], readers: Readers) -> Result<(), Message> {
    let said = |error: io::Error| say::file_not_written(path.display(), of_system(&error));
    if let Some(folder) = path.parent() {
        platform::make_folder(folder).map_err(said)?;
    }
    atomic::write_for(path, bytes, readers).map_err(said)
}

fn remove(path: &Path) -> Result<(), Message> {
    match platform::remove(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => {
            Err(say::file_not_deleted(path.display(), of_system(&error)))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::files::{TestFolder, test_folder};

    const LARGEST: u64 = 1000;

    fn change(name: &str, content: &str) -> Change {
        Change {
            name: name.to_owned(),
            content: Some(content.as_bytes().to_vec()),
            readers: Readers::Any,
        }
    }

    fn folder_with(name: &str, files: &[(&str, &str)]) -> TestFolder {
        let folder = test_folder(name);
        let changes = files
            .iter()
            .map(|(name, text)| change(name, text))
            .collect();
        assert_eq!(Kept::open(&folder, false).commit(changes), []);
        folder
    }

    #[test]
    fn a_flipped_bit_a_cut_and_a_deletion_are_noticed_and_mended_by_the_copy() {
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
        for (said, damage) in damages {
            damage(&folder.join("a.ron"));
            let kept = Kept::open(&folder, false);
            let found = kept.read("a.ron", LARGEST);
            assert_eq!(found.content.as_deref(), Some(b"(24: 584)".as_slice()));
            let sentence = found.damage.unwrap().said.to_string();
            assert!(sentence.contains(said), "{sentence}");
            assert!(sentence.contains("last good copy is used"), "{sentence}");
            assert_eq!(kept.read("b.ron", LARGEST).damage, None);
            // The damage is reported once: the next commit writes the file again.
            assert_eq!(kept.commit(vec![change("a.ron", "(24: 584)")]), []);
            assert_eq!(
                Kept::open(&folder, false).read("a.ron", LARGEST).damage,
                None
            );
        }
        assert!(folder.join("a.ron.damaged2").exists());
    }

    #[test]
    fn who_only_reads_changes_nothing() {
        let folder = folder_with("kept-read", &[("a.ron", "one")]);
        fs::write(folder.join("a.ron"), "two").unwrap();
        for _ in 0..2 {
            let found = Kept::open(&folder, true).read("a.ron", LARGEST);
            assert_eq!(found.content.as_deref(), Some(b"one".as_slice()));
            assert!(found.damage.is_some());
        }
        assert_eq!(fs::read(folder.join("a.ron")).unwrap(), b"two");
    }

    #[test]
    fn one_file_that_cannot_be_written_keeps_no_other_from_it() {
        let folder = folder_with("kept-each", &[("a", "1"), ("b", "1"), ("c", "1")]);
        fs::remove_file(folder.join("b")).unwrap();
        fs::create_dir(folder.join("b")).unwrap();
        fs::write(folder.join("b/in-the-way"), "").unwrap();
        let kept = Kept::open(&folder, false);
        let failures = kept.commit(vec![change("a", "2"), change("b", "2"), change("c", "2")]);
        assert_eq!(failures.len(), 1, "{failures:?}");
        let said = failures[0].to_string();
        assert!(said.contains("b cannot be written"), "{said}");
        for name in ["a", "c"] {
            assert_eq!(fs::read(folder.join(name)).unwrap(), b"2");
            assert_eq!(Kept::open(&folder, false).read(name, LARGEST).damage, None);
        }
    }

    #[test]
    fn a_damaged_manifest_is_replaced_by_its_copy() {
        let folder = folder_with("kept-manifest", &[("a", "1")]);
        fs::write(folder.join("manifest.ron"), "// 0\n").unwrap();
        let kept = Kept::open(&folder, false);
        let said = kept.complaint().unwrap().said.to_string();
        assert!(said.contains("is damaged"), "{said}");
        fs::write(folder.join("a"), "2").unwrap();
        assert!(kept.read("a", LARGEST).damage.is_some());
    }

    /// A kill between the first manifest and the files leaves the old files. The next commit
    /// writes them, although the manifest already lists their new state.
    #[test]
    fn what_a_kill_left_undone_is_done_by_the_next_commit() {
        let deletion = |name: &str| Change {
            content: None,
            ..change(name, "")
        };
        let folder = folder_with("kept-killed", &[("a", "old"), ("b", "old"), ("c", "old")]);
        let kept = Kept::open(&folder, false);
        let mut manifest = kept.manifest().clone();
        manifest.begin("a", Some(Mark::of(b"new")));
        manifest.begin("b", None);
        manifest.begin("c", None);
        kept.write_manifest(&manifest).unwrap();
        // The third file was deleted, but not its copy.
        fs::remove_file(folder.join("c")).unwrap();
        let kept = Kept::open(&folder, false);
        let contents = ["a", "b", "c"].map(|name| kept.read(name, LARGEST));
        let old = Some(b"old".to_vec());
        assert_eq!(contents.each_ref().map(|found| &found.damage), [&None; 3]);
        assert_eq!(
            contents.map(|found| found.content),
            [old.clone(), old, None]
        );
        let changes = vec![change("a", "new"), deletion("b"), deletion("c")];
        assert_eq!(kept.commit(changes), []);
        for place in [folder.to_path_buf(), folder.join(COPIES)] {
            assert_eq!(fs::read(place.join("a")).unwrap(), b"new");
            assert!(!place.join("b").exists() && !place.join("c").exists());
        }
        assert_eq!(Kept::open(&folder, false).names(), ["a"]);
    }
}
