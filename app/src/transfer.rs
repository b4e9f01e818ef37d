//! The partner at the control's serial port: a folder of the data directory takes
//! what the control sends; files come from wherever the user has them.

use std::io;
use std::path::{Path, PathBuf};

use gsk_messages::{Message, say};
use gsk_panel::panel::SerialFile;

use crate::files::atomic;
use crate::files::program_file::{self, FileError};
use crate::platform;
use crate::saying::of_system;

/// The folder in the data directory.
pub const FOLDER: &str = "transfer";

/// What the control has sent cannot be stored.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub struct TransferError {
    folder: PathBuf,
    error: io::Error,
}

impl TransferError {
    /// What is said of it.
    pub fn message(&self) -> Message {
        say::file_not_written(self.folder.display(), of_system(&self.error))
    }
}

/// Writes files into the folder, making it if it is not there.
pub fn write(folder: &Path, files: &[SerialFile]) -> Result<(), TransferError> {
    let wrong = |error| TransferError {
        folder: folder.to_owned(),
        error,
    };
    platform::make_folder(folder).map_err(wrong)?;
    for file in files {
        atomic::write(&folder.join(&file.name), file.text.as_bytes()).map_err(wrong)?;
    }
    Ok(())
}

/// Names that end so are data for the control, and no programs.
const DATA: [&str; 3] = ["ofs", "wmp", "par"];

/// Whether a file holds offsets, pitch errors or parameters.
pub fn is_data(path: &Path) -> bool {
    let extension = path.extension().map(|name| name.to_string_lossy());
    extension.is_some_and(|name| DATA.iter().any(|data| name.eq_ignore_ascii_case(data)))
}

/// Reads a file for the control.
pub fn read(path: &Path) -> Result<SerialFile, FileError> {
    let name = path.file_name().unwrap_or_default();
    let file = program_file::read(path)?;
    Ok(SerialFile {
        name: name.to_string_lossy().into_owned(),
        text: file.text,
    })
}

/// What was sent, for a message.
pub fn names(files: &[SerialFile]) -> String {
    match files {
        [file] => file.name.clone(),
        [first, .., last] => format!("{} … {} ({})", first.name, last.name, files.len()),
        [] => String::new(),
    }
}

/// Writes them in a thread of their own: a slow disk never holds up the kernel. `done`
/// is told what was written, or why it was not.
pub fn write_aside(
    folder: PathBuf,
    files: Vec<SerialFile>,
    done: impl Fn(Result<String, Message>) + Clone + Send + 'static,
) {
    let written = done.clone();
    let begun = platform::beside("transfer", move || {
        let what = format!("{} → {}", names(&files), folder.display());
        let result = write(&folder, &files);
        written(result.map(|()| what).map_err(|error| error.message()));
    });
    if let Err(error) = begun {
        done(Err(say::as_written(error)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::test_folder;

    fn file(name: &str) -> SerialFile {
        SerialFile {
            name: name.to_owned(),
            text: "O0001;\n%\n".to_owned(),
        }
    }

    #[test]
    fn what_is_sent_stands_in_the_folder() {
        let data = test_folder("transfer");
        let folder = data.join(FOLDER);
        let files = [file("O0001.CNC"), file("ParaW.par")];
        write(&folder, &files).expect("written");
        for file in &files {
            let text = std::fs::read_to_string(folder.join(&file.name));
            assert_eq!(text.ok().as_ref(), Some(&file.text));
        }
        assert_eq!(names(&files[..1]), "O0001.CNC");
        assert_eq!(names(&files), "O0001.CNC … ParaW.par (2)");
    }

    #[test]
    fn a_folder_that_cannot_be_made_is_said() {
        let data = test_folder("transfer-refused");
        let file_in_the_way = data.join(FOLDER);
        std::fs::write(&file_in_the_way, b"").expect("written");
        let said = write(&file_in_the_way, &[file("O0001.CNC")])
            .expect_err("no folder")
            .to_string();
        assert!(said.contains("cannot be written"), "{said}");
    }
}
