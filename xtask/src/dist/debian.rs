//! Debian's compiler, which brings the sources of the standard library: those are built
//! along for systems that the usual tool chain does not know.

use std::path::{Path, PathBuf};
use std::process::Command;

use super::told;
use crate::error::TaskError;

/// Debian's tool chain, whatever else stands before it on the PATH.
pub const PATH: &str = "/usr/bin:/bin";
pub const CARGO: &str = "/usr/bin/cargo";
pub const RUSTC: &str = "/usr/bin/rustc";
/// The sources of the standard library, below the compiler's own folder.
const LIBRARY: &str = "lib/rustlib/src/rust/library/Cargo.lock";

/// Whether it is there, with more tools that a system needs.
///
/// # Errors
/// The first that is missing, and how it comes.
pub fn is_there(system: &'static str, cure: &'static str, tools: &[&str]) -> Result<(), TaskError> {
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

/// Where a compiler keeps its own things.
pub fn sysroot(compiler: &str) -> Option<PathBuf> {
    let said = told(Command::new(compiler).args(["--print", "sysroot"])).ok()?;
    Some(PathBuf::from(said.trim()))
}
