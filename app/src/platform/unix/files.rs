//! Files by their place on the disk and their rights.

use std::fs::{self, OpenOptions};
use std::os::unix::fs::{FileTypeExt, MetadataExt, OpenOptionsExt};
use std::path::Path;

/// Whether two names, links included, are one plain file.
pub fn same_file(one: &Path, other: &Path) -> bool {
    let plain = |path| fs::metadata(path).ok().filter(fs::Metadata::is_file);
    plain(one)
        .zip(plain(other))
        .is_some_and(|(one, other)| one.dev() == other.dev() && one.ino() == other.ino())
}

/// A file that is made with these options is read by its owner alone.
pub fn for_owner_alone(options: &mut OpenOptions) {
    const OWNER_READS_AND_WRITES: u32 = 0o600;
    options.mode(OWNER_READS_AND_WRITES);
}

/// Whether a name is that of a serial port.
pub fn is_serial_port(name: &Path) -> bool {
    fs::metadata(name).is_ok_and(|data| data.file_type().is_char_device())
}

/// No name of a file is that of a device.
pub const fn is_device(_path: &Path) -> bool {
    false
}
