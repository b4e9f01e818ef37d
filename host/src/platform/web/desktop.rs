//! What a window needs of the desktop, in a browser.

/// Returns true: a browser always has a file dialog.
pub const fn has_file_dialog() -> bool {
    true
}

/// Returns true: a page always has a display.
pub const fn has_display() -> bool {
    true
}

/// Does nothing: a page has no console.
pub const fn close_own_console() {}

/// Returns false: nothing can connect to a page.
pub const fn has_listeners() -> bool {
    false
}
