//! Processes: a page is none.

use std::io;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// A page is not asked to end; it is gone.
///
/// # Errors
/// None here.
pub const fn hear_ending(_asked: &Arc<AtomicBool>, _code: u8) -> io::Result<()> {
    Ok(())
}

/// There is nothing to outlive.
pub const fn outlive_ending() {}

/// There is no such file.
pub const fn own_program() -> PathBuf {
    PathBuf::new()
}

/// There is no list of processes.
pub const fn name_process(_name: &str) {}

/// The browser does not tell.
pub const fn processor_time(_process: u32) -> Option<f64> {
    None
}

/// A page shows its panic by itself.
pub fn before_panic(_then: impl Fn() + 'static) {}
