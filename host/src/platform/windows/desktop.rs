//! What a window needs of the desktop, on Windows.

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
