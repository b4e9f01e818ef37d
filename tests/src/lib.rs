//! End-to-end cases as folders of data, run through the public API.
//!
//! A case is a folder `tests/cases/<subject>/<code>/<case>/`; `ARCHITECTURE.md` explains its
//! files. [`run_case`] runs one and returns the differences.

pub mod case;
pub mod compare;
pub mod determinism;
pub mod execute;
pub mod folder;
pub mod fuzz;
pub mod marks;
pub mod rust_text;
pub mod saved_state;
pub mod setup;
pub mod sources;
pub mod tree;

mod operate;
mod picture;
mod program;

use std::path::{Path, PathBuf};

use gsk_messages::MessageTable;

pub use case::{ProgramPath, TestCase};
pub use folder::{TestFolder, test_folder};
pub use tree::case_dir;

static TEXTS: MessageTable = MessageTable::new(include_str!("../../assets/tables/messages.tsv"));

/// Gives the messages their texts. A release build, as for Windows, does not read the table of
/// the sources.
pub fn install_texts() {
    gsk_messages::install_texts(&TEXTS);
}

/// Returns the root folder of the repository.
pub fn repository() -> PathBuf {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR"));
    manifest.parent().unwrap_or(manifest).to_path_buf()
}

/// Runs the test case in a folder. With `update` the values of its expectation files are
/// rewritten where they differ.
///
/// # Errors
/// Returns the differences, a line each; or that the case cannot be read; or that a case
/// marked as a known failure passes.
pub fn run_case(folder: &Path, update: bool) -> Result<(), String> {
    let case = TestCase::read(folder)?;
    let outcome = run_loaded_case(&case, folder, update);
    match (&case.known_failure, outcome) {
        (None, outcome) => outcome,
        (Some(_), Err(_)) => Ok(()),
        (Some(reason), Ok(())) => Err(format!(
            "passes now, although it is marked as a known failure ({reason}): remove the mark"
        )),
    }
}

/// Runs a test case that was read before, and may have been changed since.
///
/// # Errors
/// Returns the differences from the expectation, a line each.
pub fn run_loaded_case(case: &TestCase, folder: &Path, update: bool) -> Result<(), String> {
    match &case.script {
        Some(script) => operate::run_script_case(case, folder, script, update),
        None => program::run_program_case(case, folder, update),
    }
}

/// Reads a file of a test case.
fn read_case_file(folder: &Path, name: &str) -> Result<String, String> {
    std::fs::read_to_string(folder.join(name)).map_err(|error| format!("{name}: {error}"))
}

/// Reads an optional file of a test case; `None` if it does not exist.
fn read_optional_file(folder: &Path, name: &str) -> Result<Option<String>, String> {
    if folder.join(name).exists() {
        read_case_file(folder, name).map(Some)
    } else {
        Ok(None)
    }
}

/// Rewrites an expectation file of a test case.
fn write_expectation(folder: &Path, name: &str, text: &str) -> Result<(), String> {
    std::fs::write(folder.join(name), text).map_err(|error| format!("{name}: {error}"))
}
