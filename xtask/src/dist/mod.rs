//! What is given to users: programs for other systems, archives, checksums.
//! The same sources give the same bytes.

mod archive;
mod debian;
pub mod web;
pub mod windows;

use std::path::{Path, PathBuf};
use std::{env, fs};

use crate::error::TaskError;

/// The version of the program.
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Texts and samples that go with every program: files and folders of the repository.
const BESIDE: [&str; 8] = [
    "CHANGELOG.md",
    "LICENSE-APACHE",
    "LICENSE-MIT",
    "NOTICE",
    "README.md",
    "README.zh-CN.md",
    "THIRD-PARTY.md",
    "assets/programs",
];

/// The `\x1f` between two flags of the compiler.
const NEXT: &str = "\u{1f}";

/// Where cargo builds.
fn target(root: &Path) -> PathBuf {
    env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from)
}

/// Makes the folder for what is given to users.
fn folder(root: &Path) -> Result<PathBuf, TaskError> {
    let folder = target(root).join("dist");
    match fs::create_dir_all(&folder) {
        Ok(()) => Ok(folder),
        Err(error) => Err(TaskError::Write {
            path: folder,
            error,
        }),
    }
}

/// The file operation on a path, its error with the path.
fn on<T>(path: &Path, done: std::io::Result<T>) -> Result<T, TaskError> {
    done.map_err(|error| TaskError::Write {
        path: path.to_owned(),
        error,
    })
}

/// Flags after which the program does not know where it was built.
fn same_places(root: &Path) -> String {
    let home = env::var_os("CARGO_HOME").map(PathBuf::from);
    let home = home.or_else(|| env::home_dir().map(|home| home.join(".cargo")));
    let called = |path: &Path, name| format!("--remap-path-prefix={}={name}", path.display());
    let mut flags = vec![called(root, "gsk980td"), called(&target(root), "target")];
    flags.extend(home.map(|home| called(&home, "cargo")));
    flags.join(NEXT)
}
