//! Debian's Rust tool chain. It ships the sources of the standard library, which are built
//! together with the program for systems that the usual tool chain does not support.

use std::path::{Path, PathBuf};
use std::process::Command;

use super::stdout_of;
use crate::error::TaskError;

/// `PATH` for the build, which finds Debian's tool chain before any other.
pub const PATH: &str = "/usr/bin:/bin";
pub const CARGO: &str = "/usr/bin/cargo";
pub const RUSTC: &str = "/usr/bin/rustc";
/// Path of the lock file of the standard library's sources, relative to the sysroot.
const LIBRARY: &str = "lib/rustlib/src/rust/library/Cargo.lock";

/// Checks that Debian's tool chain and more tools are installed.
///
/// # Errors
/// [`TaskError::Tools`] with the first missing tool and `cure`, the way to install it.
pub fn require_tools(
    system: &'static str,
    cure: &'static str,
    tools: &[&str],
) -> Result<(), TaskError> {
    let missing = |missing: &str| TaskError::Tools {
        system,
        missing: missing.to_owned(),
        cure,
    };
    for tool in [CARGO, RUSTC].iter().chain(tools) {
        if !Path::new(tool).exists() {
            return Err(missing(tool));
        }
    }
    let library = sysroot(RUSTC)
        .map(|sysroot| sysroot.join(LIBRARY))
        .filter(|library| library.exists());
    library.map(drop).ok_or_else(|| missing(LIBRARY))
}

/// Returns the sysroot of a compiler; `None` if the compiler cannot be run.
pub fn sysroot(compiler: &str) -> Option<PathBuf> {
    let sysroot = stdout_of(Command::new(compiler).args(["--print", "sysroot"])).ok()?;
    Some(PathBuf::from(sysroot.trim()))
}
