//! Files by their place on the disk and their rights: there is neither.

use std::fs::OpenOptions;
use std::path::Path;

/// Whether two names are one file.
pub fn same_file(one: &Path, other: &Path) -> bool {
    one == other
}

/// What the browser stores is its user's alone.
pub const fn for_owner_alone(_options: &mut OpenOptions) {}

/// There are no serial ports.
pub const fn is_serial_port(_name: &Path) -> bool {
    false
}
