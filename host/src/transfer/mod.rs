//! The partner at the control's serial port: a folder of the data directory takes the
//! files that the control sends; the user chooses the files to receive.

pub mod udisk;

use std::io;
use std::path::{Path, PathBuf};

use gsk_messages::{Message, say};
use gsk_panel::panel::SerialFile;

use crate::files::atomic;
use crate::files::program_file::{self, ProgramFileError};
use crate::message_format::describe_io_error;
use crate::platform;

/// Name of the folder in the data directory for the files that the control sends.
pub const FOLDER: &str = "transfer";

/// The reason why files that the control has sent cannot be stored.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub struct TransferError {
    folder: PathBuf,
    error: io::Error,
}

impl TransferError {
    /// Returns the message for the operator: the folder, and why the files cannot be stored.
    pub fn message(&self) -> Message {
        say::file_not_written(self.folder.display(), describe_io_error(&self.error))
    }
}

/// Writes files into a folder; creates it if it does not exist.
///
/// # Errors
/// The folder or a file cannot be written.
pub fn write_files(folder: &Path, files: &[SerialFile]) -> Result<(), TransferError> {
    let to_error = |error| TransferError {
        folder: folder.to_owned(),
        error,
    };
    platform::make_folder(folder).map_err(to_error)?;
    for file in files {
        atomic::write(&folder.join(&file.name), file.text.as_bytes()).map_err(to_error)?;
    }
    Ok(())
}

/// Extensions of files with offsets, pitch errors and parameters, as opposed to programs.
const DATA_EXTENSIONS: [&str; 3] = ["ofs", "wmp", "par"];

/// Whether a file contains tool offsets, pitch errors or parameters, by its extension.
pub fn is_data_file(path: &Path) -> bool {
    let extension = path.extension().map(|name| name.to_string_lossy());
    extension.is_some_and(|name| {
        DATA_EXTENSIONS
            .iter()
            .any(|data| name.eq_ignore_ascii_case(data))
    })
}

/// Reads a file that is to be sent to the control.
///
/// # Errors
/// The file cannot be read or decoded.
pub fn read_serial_file(path: &Path) -> Result<SerialFile, ProgramFileError> {
    let name = path.file_name().unwrap_or_default();
    let file = program_file::read(path)?;
    Ok(SerialFile {
        name: name.to_string_lossy().into_owned(),
        text: file.text,
    })
}

/// Lists the names of files in one message.
pub fn describe_files(files: &[SerialFile]) -> String {
    match files {
        [file] => file.name.clone(),
        [first, .., last] => format!("{} … {} ({})", first.name, last.name, files.len()),
        [] => String::new(),
    }
}

/// Writes files in a separate thread, because a slow disk must not hold up the kernel. `done`
/// gets the names and the folder, or why the files were not written.
pub fn write_in_background(
    folder: PathBuf,
    files: Vec<SerialFile>,
    done: impl Fn(Result<String, Message>) + Clone + Send + 'static,
) {
    let written = done.clone();
    let begun = platform::run_in_background("transfer", move || {
        let what = format!("{} → {}", describe_files(&files), folder.display());
        let result = write_files(&folder, &files);
        written(result.map(|()| what).map_err(|error| error.message()));
    });
    if let Err(error) = begun {
        done(Err(say::as_written(error)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_tests::test_folder;

    fn file(name: &str) -> SerialFile {
        SerialFile {
            name: name.to_owned(),
            text: "O0001;\n%\n".to_owned(),
        }
    }

    #[test]
    fn sent_files_are_in_the_folder() {
        let data = test_folder("transfer");
        let folder = data.join(FOLDER);
        let files = [file("O0001.CNC"), file("ParaW.par")];
        write_files(&folder, &files).expect("written");
        for file in &files {
            let text = std::fs::read_to_string(folder.join(&file.name));
            assert_eq!(text.ok().as_ref(), Some(&file.text));
        }
        assert_eq!(describe_files(&files[..1]), "O0001.CNC");
        assert_eq!(describe_files(&files), "O0001.CNC … ParaW.par (2)");
    }

    #[test]
    fn a_folder_that_cannot_be_made_is_reported() {
        let data = test_folder("transfer-refused");
        let file_in_the_way = data.join(FOLDER);
        std::fs::write(&file_in_the_way, b"").expect("written");
        let message = write_files(&file_in_the_way, &[file("O0001.CNC")])
            .expect_err("no folder")
            .to_string();
        assert!(message.contains("cannot be written"), "{message}");
    }
}
