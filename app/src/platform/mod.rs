//! What the systems that the program runs on do each in its own way. Nothing outside
//! this room asks which of them it is.
//!
//! | File | What |
//! |---|---|
//! | `files` | one file under two names, files for their owner alone, names of ports |
//! | `process` | this program's own file and name, how its end is asked for |
//! | `clock` | a clock that counts the sleep of the computer |
//! | `display` | the display server: whether it answers, and what it shows held |
//! | `tie` | what ties the program to the process that holds its port |
//! | `serial` | serial ports, pseudo terminals |
//! | `sound` | what plays samples |
//! | `desktop` | whether there is a display, a file dialog; the console behind a window |
//!
//! Linux and Windows do these alike (`computer/`), a page in a browser does not:
//!
//! | File | What |
//! |---|---|
//! | `disk` | files: of the disk, or of the storage that a browser has for a page |
//! | `turns` | what goes on beside the window: threads, or turns between two frames |
//! | `view` | the window itself, dialogs for files, files dropped on it |
//! | `log_file` | the file of the log |
//! | `panic` | what is done before a panic of the window |
//!
//! `day_time` is the clock on the wall, which a library knows on all of them.

use std::io;
use std::path::Path;

use gsk_messages::say;

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
pub use day_time::day_time;
#[cfg(unix)]
pub use unix::*;
#[cfg(target_arch = "wasm32")]
pub use web::*;
#[cfg(windows)]
pub use windows::*;

/// A file name that the system takes for a device.
#[derive(Debug, thiserror::Error)]
#[error("{}", say::file_name_device(.0))]
pub struct DeviceName(pub String);

/// Refuses a path whose last name is that of a device: reading `CON` waits for the keyboard.
///
/// # Errors
/// [`DeviceName`].
pub fn refuse_device(path: &Path) -> io::Result<()> {
    if !is_device(path) {
        return Ok(());
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    Err(io::Error::other(DeviceName(name.into_owned())))
}

/// What stands at a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Facts {
    /// A plain file.
    pub is_file: bool,
    /// A folder.
    pub is_folder: bool,
    /// Of a file, bytes.
    pub length: u64,
}

/// What a file or folder is chosen for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FileDialog {
    /// To be read.
    Open {
        /// What files with these endings are called.
        kind: String,
        /// The endings, in small letters.
        endings: Vec<&'static str>,
        /// What all other files are called.
        all: String,
    },
    /// A folder.
    Folder,
    /// To be written.
    Save {
        /// The name that is proposed.
        name: String,
        /// The ending.
        ending: &'static str,
    },
}
