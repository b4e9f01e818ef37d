//! The drives that are mounted.

use std::fs;
use std::path::{Path, PathBuf};

/// Where Linux lists what is mounted.
const MOUNTS: &str = "/proc/self/mounts";
/// The folder in which macOS mounts drives.
const VOLUMES: &str = "/Volumes";

/// Lists the folders at which drives are mounted.
pub fn mounted_volumes() -> Vec<PathBuf> {
    match fs::read_to_string(MOUNTS) {
        Ok(mounts) => mounts.lines().filter_map(mount_folder).collect(),
        Err(_) => super::super::list(Path::new(VOLUMES)).unwrap_or_default(),
    }
}

/// Returns the folder of a line of the list: its second word, in which special characters are
/// octal, as `\040`.
fn mount_folder(line: &str) -> Option<PathBuf> {
    let mut parts = line.split(' ').nth(1)?.split('\\');
    let mut folder = parts.next()?.to_owned();
    for part in parts {
        let code = part
            .get(..3)
            .and_then(|code| u8::from_str_radix(code, 8).ok())?;
        folder.push(char::from(code));
        folder.push_str(&part[3..]);
    }
    Some(PathBuf::from(folder))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mounted_folders_are_read() {
        let folder = |line| mount_folder(line);
        assert_eq!(
            folder("/dev/sdb1 /media/me/RPI-RP2 vfat rw 0 0"),
            Some("/media/me/RPI-RP2".into())
        );
        assert_eq!(
            folder(r"/dev/sdb1 /media/my\040drive vfat rw 0 0"),
            Some("/media/my drive".into())
        );
        assert_eq!(folder("nothing"), None);
        assert_eq!(folder(r"x /a\9 y"), None);
    }
}
