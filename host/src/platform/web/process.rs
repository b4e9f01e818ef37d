//! Processes: a page has none.

use std::io;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Does nothing: a page gets no termination signals.
///
/// # Errors
/// Never.
pub const fn register_termination_flag(_requested: &Arc<AtomicBool>, _code: u8) -> io::Result<()> {
    Ok(())
}

/// Does nothing: a page gets no termination signals.
pub const fn ignore_termination() {}

/// Returns an empty path: a page has no program file.
pub const fn own_executable() -> PathBuf {
    PathBuf::new()
}

/// Does nothing: a page is in no list of processes.
pub const fn set_process_name(_name: &str) {}

/// Returns `None`: the browser does not report the processor time.
pub const fn processor_time(_process: u32) -> Option<f64> {
    None
}

/// Does nothing: the page itself shows a panic.
pub fn before_panic(_then: impl Fn() + 'static) {}
