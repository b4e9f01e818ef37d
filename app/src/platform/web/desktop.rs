//! What a window needs of the desktop.

/// The browser always lets a file be chosen.
pub const fn file_dialog_answers() -> bool {
    true
}

/// A page is always seen.
pub const fn has_display() -> bool {
    true
}

/// There is none.
pub const fn leave_console() {}
