//! Processes and the signals they are sent.

use std::ffi::c_int;
use std::path::{Path, PathBuf};

use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM};

/// Signals that ask the program for its end: Ctrl-C, `kill`, the end of the session.
pub const ENDING_SIGNALS: [c_int; 3] = [SIGINT, SIGTERM, SIGHUP];
/// Signals that do not end the holder of a port before its work is done.
pub const HOLDER_SIGNALS: [c_int; 4] = [SIGINT, SIGTERM, SIGHUP, SIGQUIT];

/// The file of this program, of the same version: one that stands under its name may
/// have been replaced.
pub fn own_program() -> PathBuf {
    let own = Path::new("/proc/self/exe");
    if own.exists() {
        return own.to_owned();
    }
    std::env::current_exe().unwrap_or_else(|_| "gsk980td".into())
}

/// Gives this process a name in the list of processes; it goes without.
pub fn name_process(name: &str) {
    let _ = std::fs::write("/proc/self/comm", name);
}

/// Processor time of a process so far, s, where the system tells.
pub fn processor_time(process: u32) -> Option<f64> {
    /// Ticks a second in which Linux counts for programs.
    const TICKS: f64 = 100.0;
    let stat = std::fs::read_to_string(format!("/proc/{process}/stat")).ok()?;
    // The name of the program, in brackets, may hold blanks.
    let (_, fields) = stat.rsplit_once(')')?;
    let mut times = fields.split_whitespace().skip(11);
    let user: f64 = times.next()?.parse().ok()?;
    let system: f64 = times.next()?.parse().ok()?;
    Some((user + system) / TICKS)
}
