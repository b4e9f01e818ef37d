//! Identity of files and their access rights.

use std::fs::{self, OpenOptions};
use std::os::unix::fs::{FileTypeExt, MetadataExt, OpenOptionsExt};
use std::path::Path;

/// Whether two paths, links followed, lead to the same plain file.
pub fn same_file(one: &Path, other: &Path) -> bool {
    let plain = |path| fs::metadata(path).ok().filter(fs::Metadata::is_file);
    plain(one)
        .zip(plain(other))
        .is_some_and(|(one, other)| one.dev() == other.dev() && one.ino() == other.ino())
}

/// Makes the files that `options` creates readable for their owner only.
pub fn for_owner_alone(options: &mut OpenOptions) {
    const OWNER_READS_AND_WRITES: u32 = 0o600;
    options.mode(OWNER_READS_AND_WRITES);
}

/// Whether a path leads to a serial port: a character device.
pub fn is_serial_port(name: &Path) -> bool {
    fs::metadata(name).is_ok_and(|data| data.file_type().is_char_device())
}

/// Returns false: on Unix no file name is reserved for a device.
pub const fn is_device(_path: &Path) -> bool {
    false
}
