//! Identity of files, their access rights and device names.

use std::fs::OpenOptions;
use std::path::Path;

/// Whether two paths, links followed, lead to the same plain file.
pub fn same_file(take_turn: &Path, other: &Path) -> bool {
    take_turn.is_file()
        && other.is_file()
        && same_file::is_same_file(take_turn, other).unwrap_or(false)
}

/// Does nothing: only the owner can read a user's data folder on Windows.
pub const fn for_owner_alone(_options: &mut OpenOptions) {}

/// Whether the file name of a path is a device: `CON`, `nul.nc`.
pub fn is_device(path: &Path) -> bool {
    let name = path.file_name().and_then(|name| name.to_str());
    name.is_some_and(gsk_transfer::is_device_name) && !is_serial_port(path)
}

/// Whether a path names a serial port: `COM3`, `\\.\COM12`.
pub fn is_serial_port(name: &Path) -> bool {
    let name = name.to_string_lossy().to_ascii_uppercase();
    let number = name.strip_prefix(r"\\.\").unwrap_or(&name);
    number
        .strip_prefix("COM")
        .is_some_and(|number| number.parse::<u8>().is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ports_are_known_by_their_name() {
        for port in ["COM1", "com3", r"\\.\COM12"] {
            assert!(is_serial_port(Path::new(port)), "{port}");
        }
        for file in ["COM", "COMMON.nc", "COM1.nc", r"C:\COM1"] {
            assert!(!is_serial_port(Path::new(file)), "{file}");
        }
    }

    #[test]
    fn devices_are_no_files() {
        for name in ["CON", "con.nc", r"C:\parts\NUL.CNC", "COM1.CNC"] {
            assert!(
                super::super::super::refuse_device(Path::new(name)).is_err(),
                "{name}"
            );
        }
        for name in ["COM3", "CONE.nc", r"C:\con\part.nc"] {
            assert!(!is_device(Path::new(name)), "{name}");
        }
    }
}
