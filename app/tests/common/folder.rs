//! A temporary folder for a test, and calls of the program in it.

use std::fs;
use std::ops::Deref;
use std::path::{Path, PathBuf};

use crate::process::executable;

/// A temporary folder. It is removed when it is dropped.
pub struct TempFolder(pub PathBuf);

impl TempFolder {
    /// Creates an empty folder. `name` is unique among the tests.
    pub fn new(name: &str) -> Self {
        let name = format!("gsk980td-{}-{name}", std::process::id());
        let folder = std::env::temp_dir().join(name);
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).unwrap();
        Self(folder)
    }

    /// Writes a file and the folders that contain it.
    pub fn write(&self, file: &str, content: impl AsRef<[u8]>) {
        let path = self.0.join(file);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, content).unwrap();
    }

    /// Runs a command in this folder. Returns exit code, standard output and standard error.
    pub fn run(&self, command: &str) -> (i32, String, String) {
        let output = executable()
            .args(command.split_whitespace())
            .current_dir(&self.0)
            .output()
            .unwrap();
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        let code = output.status.code().unwrap_or(-1);
        (code, text(&output.stdout), text(&output.stderr))
    }
}

impl Drop for TempFolder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

impl Deref for TempFolder {
    type Target = Path;

    fn deref(&self) -> &Path {
        &self.0
    }
}

impl AsRef<Path> for TempFolder {
    fn as_ref(&self) -> &Path {
        self
    }
}
