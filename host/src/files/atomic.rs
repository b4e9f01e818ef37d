//! Writes files atomically: a kill at any moment leaves the old or the new contents.

use std::io;
use std::path::{Path, PathBuf};

use crate::platform;

/// Suffix of the hidden temporary file. No other program uses this name.
const TEMPORARY_SUFFIX: &str = ".gsk980td-new";

/// Who may read a file that is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileAccess {
    /// The file gets the default rights of the operating system.
    Any,
    /// The file can be read by its owner only.
    Owner,
}

/// Writes `bytes` to `path`: into a temporary file that is synced to the disk, then renamed
/// over the old file.
///
/// # Errors
/// The error of the operating system; the old file remains.
pub fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    write_with_access(path, bytes, FileAccess::Any)
}

/// Like [`write()`], with the given access rights.
///
/// # Errors
/// The error of the operating system; the old file remains.
pub fn write_with_access(path: &Path, bytes: &[u8], access: FileAccess) -> io::Result<()> {
    let temporary = temporary_path(path);
    let result = platform::write_new(&temporary, bytes, access == FileAccess::Owner)
        .and_then(|()| platform::rename(&temporary, path));
    if result.is_err() {
        // Only the cause is reported: an unfinished temporary file has no use.
        let _ = platform::remove(&temporary);
        return result;
    }
    if let Some(folder) = path.parent() {
        platform::sync_folder(folder);
    }
    Ok(())
}

/// Removes the temporary files that a killed process has left in a folder. Returns the sorted
/// names of the files that it was writing.
pub fn remove_temporary_files(folder: &Path) -> Vec<String> {
    let mut names = Vec::new();
    for path in platform::list(folder).unwrap_or_default() {
        let name = path.file_name().unwrap_or_default();
        let original = name
            .to_str()
            .and_then(|name| name.strip_prefix('.')?.strip_suffix(TEMPORARY_SUFFIX));
        if let Some(original) = original {
            names.push(original.to_owned());
            // The next write replaces a file that cannot be removed.
            let _ = platform::remove(&path);
        }
    }
    names.sort();
    names
}

/// Renames a damaged file to a free name beside it, with the suffix `.damaged`, and returns
/// the new path.
///
/// # Errors
/// The error of the operating system; the file keeps its name.
pub fn rename_damaged(path: &Path) -> io::Result<PathBuf> {
    let name = |ending: &str| {
        let mut name = path.file_name().unwrap_or_default().to_owned();
        name.push(ending);
        path.with_file_name(name)
    };
    let mut target = name(".damaged");
    let mut count = 1;
    while platform::is_taken(&target) {
        count += 1;
        target = name(&format!(".damaged{count}"));
    }
    platform::rename(path, &target)?;
    Ok(target)
}

fn temporary_path(path: &Path) -> PathBuf {
    let mut name = std::ffi::OsString::from(".");
    name.push(path.file_name().unwrap_or_default());
    name.push(TEMPORARY_SUFFIX);
    path.with_file_name(name)
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn a_write_replaces_the_old_file() {
        let folder = gsk_tests::test_folder("atomic");
        let path = folder.join("a.ron");
        write(&path, b"one").expect("first");
        write(&path, b"two").expect("second");
        assert_eq!(fs::read(&path).expect("read"), b"two");
        assert_eq!(fs::read_dir(&folder).expect("list").count(), 1);
        let first = rename_damaged(&path).expect("aside");
        assert!(first.ends_with("a.ron.damaged"));
        write(&path, b"three").expect("third");
        assert!(
            rename_damaged(&path)
                .expect("aside")
                .ends_with("a.ron.damaged2")
        );
    }

    #[test]
    fn only_temporary_files_of_this_program_are_removed() {
        let folder = gsk_tests::test_folder("atomic-left");
        for name in [".O0003.CNC.gsk980td-new", "O0004.CNC.new", "write-test"] {
            fs::write(folder.join(name), "").expect("write");
        }
        assert_eq!(remove_temporary_files(&folder), ["O0003.CNC"]);
        assert_eq!(fs::read_dir(&folder).expect("list").count(), 2);
    }
}
