//! Processes and the signals they are sent.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM};
use signal_hook::flag;

/// From now on Ctrl-C, `kill` and the end of the session set this flag, and end the
/// program with this exit code when it is set already.
///
/// # Errors
/// The system does not let them be heard.
pub fn hear_ending(asked: &Arc<AtomicBool>, code: u8) -> io::Result<()> {
    for signal in [SIGINT, SIGTERM, SIGHUP] {
        flag::register_conditional_shutdown(signal, i32::from(code), Arc::clone(asked))?;
        flag::register(signal, Arc::clone(asked))?;
    }
    Ok(())
}

/// From now on nothing of that ends this process.
pub fn outlive_ending() {
    let told = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM, SIGHUP, SIGQUIT] {
        let _ = flag::register(signal, Arc::clone(&told));
    }
}

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
