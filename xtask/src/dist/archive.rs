//! Archives whose bytes depend on nothing but what is in them.

use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use super::on;
use crate::error::TaskError;

/// A file in an archive: its name there and where it comes from.
pub type Entry = (String, PathBuf);

/// The files of a path, a folder's in the order of their names, as they are called below
/// `root`.
pub fn entries(root: &Path, path: &str) -> Result<Vec<Entry>, TaskError> {
    let at = root.join(path);
    if !at.is_dir() {
        return Ok(vec![(path.to_owned(), at)]);
    }
    let mut names = Vec::new();
    for entry in on(&at, fs::read_dir(&at))? {
        names.push(on(&at, entry)?.file_name().to_string_lossy().into_owned());
    }
    names.sort();
    let files = names
        .iter()
        .map(|name| entries(root, &format!("{path}/{name}")));
    Ok(files.collect::<Result<Vec<_>, _>>()?.concat())
}

/// Writes a .zip; every file has the same time, 1980-01-01.
pub fn zip(path: &Path, folder: &str, entries: &[Entry]) -> Result<(), TaskError> {
    let failed = |error| TaskError::Archive {
        path: path.to_owned(),
        error,
    };
    let mut archive = ZipWriter::new(on(path, File::create(path))?);
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::default())
        .unix_permissions(0o644);
    for (name, from) in entries {
        let bytes = on(from, fs::read(from))?;
        archive
            .start_file(format!("{folder}/{name}"), options)
            .map_err(failed)?;
        on(path, archive.write_all(&bytes))?;
    }
    archive.finish().map(drop).map_err(failed)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

    use super::*;

    #[test]
    fn the_same_files_give_the_same_bytes() {
        let folder = std::env::temp_dir().join(format!("xtask-zip-{}", std::process::id()));
        fs::create_dir_all(folder.join("b")).unwrap();
        let archive = folder.join("out.zip");
        let make = || {
            // Written anew: another time, another place in the folder.
            for name in ["b/2", "b/1", "a"] {
                let _ = fs::remove_file(folder.join(name));
                fs::write(folder.join(name), name.repeat(100)).unwrap();
            }
            let files = ["b", "a"].map(|name| entries(&folder, name).unwrap());
            zip(&archive, "inside", &files.concat()).unwrap();
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
