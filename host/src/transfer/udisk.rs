//! The U disk of a control model as a folder of the data directory.

use std::path::Path;

use gsk_panel::pages::UdiskFile;
use gsk_panel::panel::SerialFile;

use crate::{platform, transfer};

/// Name of the folder in the data directory that holds the U disk's files.
pub const FOLDER: &str = "udisk";
/// Greatest number of files that the control lists.
const MAX_FILES: usize = 500;
/// Greatest length of a file name that the LCD shows.
const MAX_NAME: usize = 30;

/// Reads the programs in the folder; `None` if it cannot be read. Other files are left out.
pub fn read_folder(folder: &Path) -> Option<Vec<UdiskFile>> {
    let mut paths = platform::list(folder).ok()?;
    paths.sort();
    let files = paths.iter().filter_map(|path| {
        let SerialFile { name, text } = transfer::read_serial_file(path).ok()?;
        (name.chars().count() <= MAX_NAME).then_some(UdiskFile { name, text })
    });
    Some(files.take(MAX_FILES).collect())
}

/// Converts files of the U disk to files that [`transfer::write_files`] writes.
pub fn to_serial_files(files: Vec<UdiskFile>) -> Vec<SerialFile> {
    let files = files.into_iter();
    let converted = files.map(|UdiskFile { name, text }| SerialFile { name, text });
    converted.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_tests::test_folder;

    #[test]
    fn stored_files_are_read_again() {
        let folder = test_folder("udisk").join(FOLDER);
        assert_eq!(read_folder(&folder), None);
        let file = UdiskFile {
            name: "O0007.CNC".to_owned(),
            text: "O0007;\nM30;\n".to_owned(),
        };
        transfer::write_files(&folder, &to_serial_files(vec![file.clone()])).expect("written");
        assert_eq!(read_folder(&folder), Some(vec![file]));
    }
}
