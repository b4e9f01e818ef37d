//! What differs between operating systems and the browser. No code outside this module
//! checks which of them it runs on.
//!
//! | File | What |
//! |---|---|
//! | `files` | identity of files, files that only their owner reads, names of ports |
//! | `process` | this program's own file and name, termination signals |
//! | `clock` | a clock that counts the sleep of the computer |
//! | `display` | the display server: whether it answers, which keys it reports as held |
//! | `tie` | the connection between the program and the process that holds its port |
//! | `serial` | serial ports, pseudo terminals |
//! | `sound` | output of samples |
//! | `volumes` | the drives that are mounted |
//! | `desktop` | whether there is a display and a file dialog; the console of a window |
//!
//! Linux and Windows share these (`computer/`), a page in a browser differs:
//!
//! | File | What |
//! |---|---|
//! | `disk` | files: on the disk, or in the storage that a browser has for a page |
//! | `turns` | background work: threads, or turns between two frames |
//! | `view` | the window itself, file dialogs, files dropped on it |
//! | `course` | the exercises of a learning platform that opened the page, and its store |
//! | `log_file` | the file of the log |
//! | `panic` | the action before a panic of the window |
//! | `browser` | opens a page in the browser of the user, prints a page as PDF |
//! | `broker_stream` | the connection to an MQTT broker: TCP and TLS, or a WebSocket |
//!
//! `day_time` is the local time of day; one library reads it on all systems.

use std::io;
use std::path::Path;

use gsk_messages::{Message, say};

#[cfg(any(unix, windows))]
mod computer;
mod day_time;
#[cfg(unix)]
mod unix;
#[cfg(target_arch = "wasm32")]
mod web;
#[cfg(windows)]
mod windows;

#[cfg(any(unix, windows))]
pub use computer::*;
pub use day_time::{clock_text, day_time};
#[cfg(unix)]
pub use unix::*;
#[cfg(target_arch = "wasm32")]
pub use web::*;
#[cfg(windows)]
pub use windows::*;

/// The error for a file name that the system would open as a device.
#[derive(Debug, thiserror::Error)]
#[error("{}", say::file_name_device(.0))]
pub struct DeviceName(pub String);

/// Refuses a path whose last name is a device: reading `CON` waits for the keyboard.
pub fn refuse_device(path: &Path) -> io::Result<()> {
    if !is_device(path) {
        return Ok(());
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    Err(io::Error::other(DeviceName(name.into_owned())))
}

/// Why a connection to a broker is not opened, or ends.
#[derive(Debug)]
pub enum BrokerFailure {
    /// The system reports this error.
    Io(io::Error),
    /// The connection is refused for this reason.
    Refused(Message),
}

impl From<io::Error> for BrokerFailure {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

impl From<Message> for BrokerFailure {
    fn from(reason: Message) -> Self {
        Self::Refused(reason)
    }
}

/// The outcome of printing a page as a PDF file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PdfPrint {
    /// The file is written.
    Written,
    /// No browser that prints without a window is installed.
    NoBrowser,
    /// The browser of this name has not written the file.
    Failed(String),
}

/// What a read from a broker has brought.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BrokerBytes {
    /// This number of bytes; none if nothing has arrived yet.
    Received(usize),
    /// The broker has closed the connection.
    Closed,
}

/// Type and length of the file or folder at a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PathFacts {
    /// Whether a plain file exists at the path.
    pub is_file: bool,
    /// Whether a folder exists at the path.
    pub is_folder: bool,
    /// Length of the file, bytes.
    pub length: u64,
}

/// The exercises that a learning platform has opened, with its data about the learner.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CoursePage {
    /// Content of the course file.
    pub file: Vec<u8>,
    /// The progress that the platform has stored, empty at the beginning.
    pub suspended: String,
    /// Name of the learner, empty if the platform gives none.
    pub learner: String,
}

/// A dialog in which the user chooses a file or folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FileDialog {
    /// The dialog in which a file to read is selected.
    Open {
        /// Label of the filter for files with these extensions.
        kind: String,
        /// Extensions, in lower case, without the dot.
        endings: Vec<&'static str>,
        /// Label of the filter for all files.
        all: String,
    },
    /// The dialog in which a folder is selected.
    Folder,
    /// The dialog in which the name of a file to write is selected.
    Save {
        /// Suggested name of the file.
        name: String,
        /// File extension that the name gets, without the dot.
        ending: &'static str,
    },
}
