//! What a window needs of the desktop, on Windows.

use std::path::{Path, PathBuf};
use std::process::Command;

use win32console::console::WinConsole;

/// Returns true: Windows always has a file dialog.
pub const fn has_file_dialog() -> bool {
    true
}

/// Returns true: Windows always has a display.
pub const fn has_display() -> bool {
    true
}

/// Closes the console that Windows opens when the program is started with a double click.
/// A console that other processes share belongs to the user and stays open.
pub fn close_own_console() {
    // Windows pads the list with zeros.
    let processes = WinConsole::get_process_list().unwrap_or_default();
    if processes.iter().filter(|process| **process != 0).count() == 1 {
        // A console that stays open does no harm.
        let _ = WinConsole::free_console();
    }
}

/// Returns true: other programs can connect to this one.
pub const fn has_listeners() -> bool {
    true
}

/// The command that opens a file in the program that the user has chosen for it.
pub fn open_file_command(path: &Path) -> Command {
    let mut command = Command::new("explorer");
    command.arg(path);
    command
}

/// The browsers that print without a window, the first found one is used.
pub fn browser_candidates() -> Vec<PathBuf> {
    let folders = ["ProgramFiles(x86)", "ProgramFiles", "LocalAppData"];
    let folders = folders.iter().filter_map(std::env::var_os);
    folders
        .map(PathBuf::from)
        .flat_map(|folder| {
            [
                folder.join("Microsoft/Edge/Application/msedge.exe"),
                folder.join("Google/Chrome/Application/chrome.exe"),
            ]
        })
        .collect()
}
