//! Reproducible archives: the bytes depend only on names and contents.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use flate2::{Compression, GzBuilder};
use lzma_rust2::{LzipOptions, LzipWriter};
use tar::{Builder, EntryType, Header};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use super::with_path;
use crate::error::TaskError;

/// A file to archive: its name in the archive and its path on disk.
pub type ArchiveEntry = (String, PathBuf);

/// A file of an archive for Linux, with its contents in memory.
#[derive(Debug)]
pub struct Item {
    /// Path of the file in the archive, without a slash before it.
    pub name: String,
    /// Its contents.
    pub bytes: Vec<u8>,
    /// Whether the file is executable.
    pub program: bool,
}

impl Item {
    /// Makes an item that is not executable.
    pub fn text(name: impl Into<String>, bytes: impl Into<Vec<u8>>) -> Self {
        Self {
            name: name.into(),
            bytes: bytes.into(),
            program: false,
        }
    }
}

/// Compresses bytes with gzip, without name and time in the header.
pub fn gz(bytes: &[u8]) -> io::Result<Vec<u8>> {
    let mut packed = GzBuilder::new().write(Vec::new(), Compression::best());
    packed.write_all(bytes)?;
    packed.finish()
}

/// Compresses bytes with lzip, as small as it can.
pub fn lz(bytes: &[u8]) -> io::Result<Vec<u8>> {
    let mut packed = LzipWriter::new(Vec::new(), LzipOptions::with_preset(9));
    packed.write_all(bytes)?;
    packed.finish()
}

/// Makes a .tar.gz: folders, then files, each sorted by name and below `root` (`./`,
/// `name/`). All belong to the user root and have the same `time`, in seconds since 1970.
pub fn tar_gz(root: &str, items: &[Item], time: u64) -> io::Result<Vec<u8>> {
    let mut folders = BTreeSet::from([String::new()]);
    for item in items {
        let ends = item.name.match_indices('/');
        folders.extend(ends.map(|(at, _)| item.name[..=at].to_owned()));
    }
    let mut sorted: Vec<_> = items.iter().collect();
    sorted.sort_by(|one, other| one.name.cmp(&other.name));
    let mut archive = Builder::new(Vec::new());
    let mut add = |name: String, kind, mode, bytes: &[u8]| {
        let mut header = Header::new_gnu();
        header.set_entry_type(kind);
        header.set_mode(mode);
        header.set_uid(0);
        header.set_gid(0);
        header.set_mtime(time);
        header.set_size(bytes.len() as u64);
        header.set_username("root")?;
        header.set_groupname("root")?;
        // `set_path` would remove the `./` that dpkg requires.
        let field = header
            .as_old_mut()
            .name
            .get_mut(..name.len())
            .ok_or_else(|| io::Error::other(format!("{name}: longer than 100 bytes")))?;
        field.copy_from_slice(name.as_bytes());
        header.set_cksum();
        archive.append(&header, bytes)
    };
    for folder in folders {
        add(format!("{root}{folder}"), EntryType::Directory, 0o755, &[])?;
    }
    for item in sorted {
        let mode = if item.program { 0o755 } else { 0o644 };
        let name = format!("{root}{}", item.name);
        add(name, EntryType::Regular, mode, &item.bytes)?;
    }
    gz(&archive.into_inner()?)
}

/// Makes an `ar` archive, the outer form of a .deb: names of at most 16 bytes, owner root,
/// one `time` for all members in seconds since 1970.
pub fn ar(members: &[(&str, Vec<u8>)], time: u64) -> Vec<u8> {
    let mut out = b"!<arch>\n".to_vec();
    for (name, bytes) in members {
        let size = bytes.len();
        let header = format!(
            "{name:<16}{time:<12}{:<6}{:<6}{:<8}{size:<10}`\n",
            0, 0, 100_644
        );
        out.extend_from_slice(header.as_bytes());
        out.extend_from_slice(bytes);
        if size % 2 == 1 {
            out.push(b'\n');
        }
    }
    out
}

/// Lists the files of a path with their names below `root`; a folder is listed recursively,
/// sorted by name.
pub fn entries(root: &Path, path: &str) -> Result<Vec<ArchiveEntry>, TaskError> {
    let at = root.join(path);
    if !at.is_dir() {
        return Ok(vec![(path.to_owned(), at)]);
    }
    let mut names = Vec::new();
    for entry in with_path(&at, fs::read_dir(&at))? {
        names.push(
            with_path(&at, entry)?
                .file_name()
                .to_string_lossy()
                .into_owned(),
        );
    }
    names.sort();
    let files = names
        .iter()
        .map(|name| entries(root, &format!("{path}/{name}")));
    Ok(files.collect::<Result<Vec<_>, _>>()?.concat())
}

/// The compression level of a .zip file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effort {
    /// Compresses in one or two seconds.
    Quick,
    /// Compresses with Zopfli: about 5 % smaller, at half a megabyte per second.
    Small,
}

/// Writes a .zip in which every file has the time 1980-01-01.
pub fn zip(
    path: &Path,
    folder: &str,
    entries: &[ArchiveEntry],
    effort: Effort,
) -> Result<(), TaskError> {
    let failed = |error| TaskError::Archive {
        path: path.to_owned(),
        error,
    };
    let mut archive = ZipWriter::new(with_path(path, File::create(path))?);
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        // Levels above 9 select zopfli; the excess is its number of iterations.
        .compression_level((effort == Effort::Small).then_some(14))
        .last_modified_time(DateTime::default())
        .unix_permissions(0o644);
    for (name, from) in entries {
        let bytes = with_path(from, fs::read(from))?;
        archive
            .start_file(format!("{folder}/{name}"), options)
            .map_err(failed)?;
        with_path(path, archive.write_all(&bytes))?;
    }
    archive.finish().map(drop).map_err(failed)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

    use super::*;

    #[test]
    fn tar_lists_folders_first_with_one_time() {
        let items = [
            Item::text("b/c/2", "two"),
            Item {
                name: "b/1".to_owned(),
                bytes: b"one".to_vec(),
                program: true,
            },
        ];
        let bytes = tar_gz("./", &items, 86_400).unwrap();
        assert_eq!(bytes[4..8], [0; 4], "gzip's time");
        let mut tar = tar::Archive::new(flate2::read::GzDecoder::new(bytes.as_slice()));
        let entries = tar.entries().unwrap().map(|entry| {
            let entry = entry.unwrap();
            let header = entry.header();
            assert_eq!((header.uid().unwrap(), header.gid().unwrap()), (0, 0));
            assert_eq!(header.mtime().unwrap(), 86_400);
            let name = String::from_utf8(entry.path_bytes().into_owned()).unwrap();
            (name, header.mode().unwrap(), header.size().unwrap())
        });
        let entries: Vec<_> = entries.collect();
        let expected = [
            ("./", 0o755, 0),
            ("./b/", 0o755, 0),
            ("./b/c/", 0o755, 0),
            ("./b/1", 0o755, 3),
            ("./b/c/2", 0o644, 3),
        ];
        assert_eq!(
            entries,
            expected.map(|(name, mode, size)| (name.to_owned(), mode, size))
        );
        let reversed: Vec<_> = items.into_iter().rev().collect();
        assert_eq!(tar_gz("./", &reversed, 86_400).unwrap(), bytes);
        assert!(tar_gz("./", &[Item::text("x".repeat(99), "")], 0).is_err());
    }

    #[test]
    fn ar_members_begin_at_even_bytes() {
        let bytes = ar(&[("one", b"abc".to_vec()), ("two", b"de".to_vec())], 7);
        let header = "one             7           0     0     100644  3         `\n";
        assert_eq!(bytes[8..68], *header.as_bytes());
        assert_eq!(bytes[68..72], *b"abc\n");
        assert_eq!(bytes[72..75], *b"two");
        assert_eq!(bytes.len(), 72 + 60 + 2);
    }

    #[test]
    fn zip_is_reproducible() {
        let folder = std::env::temp_dir().join(format!("xtask-zip-{}", std::process::id()));
        fs::create_dir_all(folder.join("b")).unwrap();
        let archive = folder.join("out.zip");
        let make = || {
            // Rewritten: other times and another order in the folder.
            for name in ["b/2", "b/1", "a"] {
                let _ = fs::remove_file(folder.join(name));
                fs::write(folder.join(name), name.repeat(100)).unwrap();
            }
            let files = ["b", "a"].map(|name| entries(&folder, name).unwrap());
            zip(&archive, "inside", &files.concat(), Effort::Small).unwrap();
            (files.concat(), fs::read(&archive).unwrap())
        };
        let (files, first) = make();
        let names: Vec<_> = files.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["b/1", "b/2", "a"]);
        std::thread::sleep(std::time::Duration::from_millis(20));
        assert_eq!(make().1, first);
        fs::remove_dir_all(folder).unwrap();
    }
}
