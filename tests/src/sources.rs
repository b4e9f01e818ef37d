//! Reads the sources of the workspace, for tables that name tests and for tests of the
//! sources.

use std::fs;
use std::path::{Path, PathBuf};

use crate::repository;

/// The packages in which [`has_test`] searches for a test.
const TESTED_PACKAGES: [&str; 8] = [
    "core", "milling", "panel", "host", "window", "app", "twins", "tests",
];

/// Returns the folder names of the packages of the workspace, sorted.
pub fn packages() -> Vec<String> {
    let entries = fs::read_dir(repository()).into_iter().flatten().flatten();
    let packages = entries.filter(|entry| entry.path().join("Cargo.toml").is_file());
    let names = packages.map(|entry| entry.file_name().to_string_lossy().into_owned());
    let mut names: Vec<String> = names.collect();
    names.sort();
    names
}

/// Returns the Rust files in a folder and its subfolders, sorted.
pub fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            files.extend(rust_files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files.sort();
    files
}

/// Returns whether a Rust test function with this name exists in the workspace.
pub fn has_test(name: &str) -> bool {
    let wanted = format!("fn {name}()");
    TESTED_PACKAGES
        .iter()
        .any(|package| contains_text(&repository().join(package), &wanted))
}

fn contains_text(folder: &Path, wanted: &str) -> bool {
    let Ok(entries) = fs::read_dir(folder) else {
        return false;
    };
    entries.flatten().map(|entry| entry.path()).any(|path| {
        if path.is_dir() {
            return contains_text(&path, wanted);
        }
        let rust = path.extension().is_some_and(|extension| extension == "rs");
        rust && fs::read_to_string(&path).is_ok_and(|text| text.contains(wanted))
    })
}

/// A Rust source file without its tests.
pub struct SourceFile {
    /// Path of the file in the repository.
    pub path: PathBuf,
    /// Text of the file without its tests.
    pub text: String,
}

/// Returns the sources of control, link, mill, panel and program, without their tests.
pub fn control_sources() -> Vec<SourceFile> {
    package_sources(&["core", "link", "milling", "panel", "host", "window", "app"])
}

/// Returns the sources of packages without their tests. `packages` are their folders.
pub fn package_sources(packages: &[&str]) -> Vec<SourceFile> {
    let mut sources = Vec::new();
    for package in packages {
        collect(&repository().join(package).join("src"), &mut sources);
    }
    sources
}

fn collect(folder: &Path, sources: &mut Vec<SourceFile>) {
    let Ok(entries) = fs::read_dir(folder) else {
        return;
    };
    for path in entries.flatten().map(|entry| entry.path()) {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if path.is_dir() {
            if name != "tests" {
                collect(&path, sources);
            }
        } else if name.ends_with(".rs") && name != "tests.rs" && !name.ends_with("_tests.rs") {
            let text = fs::read_to_string(&path).unwrap_or_default();
            let own = text.split("#[cfg(test)]\nmod tests {").next();
            let text = own.unwrap_or_default().to_owned();
            sources.push(SourceFile { path, text });
        }
    }
}
