//! Processes and their console events.

use std::io;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// The termination flags that console events set.
static FLAGS: Mutex<Vec<Arc<AtomicBool>>> = Mutex::new(Vec::new());

/// Registers a flag: Ctrl-C and Ctrl-Break set it. If it is already set, they end the
/// program with this exit code. When the console is closed or the session ends, Windows
/// ends the program at once; the process that holds the port stops the board then.
///
/// # Errors
/// The system refuses the handler.
pub fn register_termination_flag(requested: &Arc<AtomicBool>, code: u8) -> io::Result<()> {
    let mut flags = FLAGS.lock().unwrap_or_else(PoisonError::into_inner);
    flags.push(Arc::clone(requested));
    if flags.len() > 1 {
        return Ok(());
    }
    let set_flags = move || {
        let flags = FLAGS.lock().unwrap_or_else(PoisonError::into_inner);
        // All flags are set, also after the first event.
        let already_set = flags
            .iter()
            .filter(|requested| requested.swap(true, Ordering::Relaxed));
        if already_set.count() > 0 {
            std::process::exit(i32::from(code));
        }
    };
    ctrlc::set_handler(set_flags).map_err(io::Error::other)
}

/// Ignores Ctrl-C and Ctrl-Break from now on.
pub fn ignore_termination() {
    let _ = ctrlc::set_handler(|| {});
}

/// Returns the path of this program; Windows prevents the replacement of a running program.
pub fn own_executable() -> PathBuf {
    std::env::current_exe().unwrap_or_else(|_| "gsk980td.exe".into())
}

/// Does nothing: Windows names a process after its file.
pub const fn set_process_name(_name: &str) {}

/// Returns `None`: the processor time of a process is not read on Windows.
pub const fn processor_time(_process: u32) -> Option<f64> {
    None
}
