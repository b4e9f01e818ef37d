//! What a window needs of the desktop, on Unix systems.

use std::path::{Path, PathBuf};
use std::process::Command;

#[cfg(not(target_os = "macos"))]
pub use super::portal::has_file_dialog;

/// Returns true: macOS always shows a file dialog.
#[cfg(target_os = "macos")]
pub const fn file_dialog_answers() -> bool {
    true
}

/// Whether a window can be opened; macOS always has a display.
pub fn has_display() -> bool {
    cfg!(target_os = "macos")
        || ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"]
            .iter()
            .any(|name| std::env::var_os(name).is_some_and(|value| !value.is_empty()))
}

/// Does nothing: the terminal belongs to the user.
pub const fn close_own_console() {}

/// Returns true: other programs can connect to this one.
pub const fn has_listeners() -> bool {
    true
}

/// The command that opens a file in the program that the user has chosen for it.
pub fn open_file_command(path: &Path) -> Command {
    let opener = match cfg!(target_os = "macos") {
        true => "open",
        false => "xdg-open",
    };
    let mut command = Command::new(opener);
    command.arg(path);
    command
}

/// The browsers that print without a window, the first found one is used.
pub fn browser_candidates() -> Vec<PathBuf> {
    [
        "chromium",
        "chromium-browser",
        "google-chrome",
        "google-chrome-stable",
        "microsoft-edge",
        "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
    ]
    .map(PathBuf::from)
    .into()
}
