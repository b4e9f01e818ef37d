//! What a window needs of the desktop, on Unix systems.

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
