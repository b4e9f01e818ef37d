//! Processes and the events of their console.

use std::io;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Who hears that the end is asked for.
static HEARERS: Mutex<Vec<Arc<AtomicBool>>> = Mutex::new(Vec::new());

/// From now on Ctrl-C and Ctrl-Break set this flag, and end the program with this exit
/// code when it is set already. When its console is closed or the session ends, Windows
/// ends the program at once: whoever holds its port stops the board then.
///
/// # Errors
/// The system does not let them be heard.
pub fn hear_ending(asked: &Arc<AtomicBool>, code: u8) -> io::Result<()> {
    let mut hearers = HEARERS.lock().unwrap_or_else(PoisonError::into_inner);
    hearers.push(Arc::clone(asked));
    if hearers.len() > 1 {
        return Ok(());
    }
    let tell = move || {
        let hearers = HEARERS.lock().unwrap_or_else(PoisonError::into_inner);
        // All of them are told, whether it is the first time or not.
        let told = hearers
            .iter()
            .filter(|asked| asked.swap(true, Ordering::Relaxed));
        if told.count() > 0 {
            std::process::exit(i32::from(code));
        }
    };
    ctrlc::set_handler(tell).map_err(io::Error::other)
}

/// From now on nothing of that ends this process.
pub fn outlive_ending() {
    let _ = ctrlc::set_handler(|| {});
}

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
