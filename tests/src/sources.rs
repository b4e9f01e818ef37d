//! What the sources hold, for tables that name tests.

use std::fs;
use std::path::Path;

use crate::repository;

/// The packages whose tests a table may name.
const PACKAGES: [&str; 5] = ["core", "panel", "app", "twins", "tests"];

/// Whether a Rust test function of this name exists.
pub fn has_test(name: &str) -> bool {
    let wanted = format!("fn {name}()");
    PACKAGES
        .iter()
        .any(|package| contains(&repository().join(package), &wanted))
}

fn contains(folder: &Path, wanted: &str) -> bool {
    let Ok(entries) = fs::read_dir(folder) else {
        return false;
    };
    entries.flatten().map(|entry| entry.path()).any(|path| {
        if path.is_dir() {
            return contains(&path, wanted);
        }
        let rust = path.extension().is_some_and(|extension| extension == "rs");
        rust && fs::read_to_string(&path).is_ok_and(|text| text.contains(wanted))
    })
}
