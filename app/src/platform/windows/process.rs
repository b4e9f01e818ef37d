//! Processes and the events of their console.

use std::ffi::c_int;
use std::path::PathBuf;

use signal_hook::consts::{SIGBREAK, SIGINT, SIGTERM};

/// What asks the program for its end: Ctrl-C, Ctrl-Break. Windows reports the closing of
/// the console and the end of the session by the second one, and ends the program at
/// once behind it.
pub const ENDING_SIGNALS: [c_int; 3] = [SIGINT, SIGTERM, SIGBREAK];
/// What does not end the holder of a port before its work is done.
pub const HOLDER_SIGNALS: [c_int; 3] = [SIGINT, SIGTERM, SIGBREAK];

/// The file of this program; Windows lets nobody replace it while it runs.
pub fn own_program() -> PathBuf {
    std::env::current_exe().unwrap_or_else(|_| "gsk980td.exe".into())
}

/// A process is called as its file is.
pub const fn name_process(_name: &str) {}

/// Processor time of a process so far, s: not asked here.
pub const fn processor_time(_process: u32) -> Option<f64> {
    None
}
