//! A folder on the disk that lives as long as one test.

use std::fs;
use std::ops::Deref;
use std::path::{Path, PathBuf};

/// A folder that is removed at the end of its test, even if the test panics.
#[derive(Debug)]
pub struct TestFolder(PathBuf);

/// Creates an empty folder for one test.
///
/// # Panics
/// The folder cannot be created.
#[expect(clippy::expect_used, reason = "a test without its folder has failed")]
pub fn test_folder(name: &str) -> TestFolder {
    let folder = std::env::temp_dir().join(format!("gsk980td-{name}-{}", std::process::id()));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("folder for a test");
    TestFolder(folder)
}

impl Deref for TestFolder {
    type Target = Path;

    fn deref(&self) -> &Path {
        &self.0
    }
}

impl AsRef<Path> for TestFolder {
    fn as_ref(&self) -> &Path {
        self
    }
}

impl Drop for TestFolder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}
