//! What a window needs of the desktop, in a browser.

/// Returns true: a browser always has a file dialog.
pub const fn file_dialog_answers() -> bool {
    true
}

/// Returns true: a page always has a display.
pub const fn has_display() -> bool {
    true
}

/// Does nothing: a page has no console.
pub const fn leave_console() {}
