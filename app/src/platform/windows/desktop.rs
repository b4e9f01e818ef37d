//! What a window needs of the desktop.

use win32console::console::WinConsole;

/// Windows always has a file dialog.
pub const fn file_dialog_answers() -> bool {
    true
}

/// Windows always has a display.
pub const fn has_display() -> bool {
    true
}

/// Closes a console that Windows has opened for this program alone, when it was started
/// with a double click. One that it was started from belongs to its user and stays.
pub fn leave_console() {
    // The list is filled up with zeros.
    let processes = WinConsole::get_process_list().unwrap_or_default();
    if processes.iter().filter(|process| **process != 0).count() == 1 {
        // A console that stays is a nuisance and no more.
        let _ = WinConsole::free_console();
    }
}
