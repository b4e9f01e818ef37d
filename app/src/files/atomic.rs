//! Writing a file so that a kill at any moment leaves the old or the new one.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Writes `bytes` to `path`: aside, to the disk, then renamed over the old file.
pub fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let aside = beside(path, "new");
    let result = write_aside(&aside, bytes).and_then(|()| fs::rename(&aside, path));
    if result.is_err() {
        // The half-written file is of no use; the cause is what is reported.
        let _ = fs::remove_file(&aside);
        return result;
    }
    sync_folder(path);
    Ok(())
}

fn write_aside(aside: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = File::create(aside)?;
    file.write_all(bytes)?;
    file.sync_all()
}

/// Makes the rename itself lasting; where folders cannot be opened as files
/// (Windows) the system does it by itself.
fn sync_folder(path: &Path) {
    if let Some(folder) = path.parent()
        && let Ok(folder) = File::open(folder)
    {
        let _ = folder.sync_all();
    }
}

/// Moves a damaged file to a free name beside it and returns that name.
pub fn set_aside(path: &Path) -> io::Result<PathBuf> {
    let mut target = beside(path, "damaged");
    let mut count = 1;
    while target.exists() {
        count += 1;
        target = beside(path, &format!("damaged{count}"));
    }
    fs::rename(path, &target)?;
    Ok(target)
}

fn beside(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".");
    name.push(ending);
    path.with_file_name(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_old_file_gives_way_to_the_new_one() {
        let folder = crate::files::test_folder("atomic");
        let path = folder.join("a.ron");
        write(&path, b"one").expect("first");
        write(&path, b"two").expect("second");
        assert_eq!(fs::read(&path).expect("read"), b"two");
        assert_eq!(fs::read_dir(&folder).expect("list").count(), 1);
        let first = set_aside(&path).expect("aside");
        assert!(first.ends_with("a.ron.damaged"));
        write(&path, b"three").expect("third");
        assert!(set_aside(&path).expect("aside").ends_with("a.ron.damaged2"));
        fs::remove_dir_all(folder).expect("clean");
    }
}
