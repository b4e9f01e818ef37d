//! Processes and termination signals.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM};
use signal_hook::flag;

/// Registers a flag: Ctrl-C, `kill` and the end of the session set it. If it is already
/// set, they end the program with this exit code.
///
/// # Errors
/// The system refuses the handler.
pub fn register_termination_flag(requested: &Arc<AtomicBool>, code: u8) -> io::Result<()> {
    for signal in [SIGINT, SIGTERM, SIGHUP] {
        flag::register_conditional_shutdown(signal, i32::from(code), Arc::clone(requested))?;
        flag::register(signal, Arc::clone(requested))?;
    }
    Ok(())
}

/// Ignores the termination signals and SIGQUIT from now on.
pub fn ignore_termination() {
    let ignored = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM, SIGHUP, SIGQUIT] {
        let _ = flag::register(signal, Arc::clone(&ignored));
    }
}

/// Returns a path that opens the running program itself, even if the file under its name was
/// replaced meanwhile.
pub fn own_executable() -> PathBuf {
    let own = Path::new("/proc/self/exe");
    if own.exists() {
        return own.to_owned();
    }
    std::env::current_exe().unwrap_or_else(|_| "gsk980td".into())
}

/// Sets the name of this process in the process list; a failure is ignored.
pub fn set_process_name(name: &str) {
    let _ = std::fs::write("/proc/self/comm", name);
}

/// Returns the processor time that a process has used, s; `None` where the system does not
/// report it.
pub fn processor_time(process: u32) -> Option<f64> {
    /// Clock ticks per second in the times that Linux reports.
    const TICKS: f64 = 100.0;
    let stat = std::fs::read_to_string(format!("/proc/{process}/stat")).ok()?;
    // The program name in brackets may contain blanks.
    let (_, fields) = stat.rsplit_once(')')?;
    let mut times = fields.split_whitespace().skip(11);
    let user: f64 = times.next()?.parse().ok()?;
    let system: f64 = times.next()?.parse().ok()?;
    Some((user + system) / TICKS)
}
