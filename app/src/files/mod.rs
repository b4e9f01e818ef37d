//! Files on the disk: programs, jobs, lessons and the data directory.

pub mod atomic;
pub mod data_dir;
pub mod decode;
pub mod folders;
pub mod lessons;
mod manifest;
pub mod mirrored_files;
pub mod models;
pub mod program_file;
pub mod subprograms;
pub mod time;

#[cfg(test)]
pub(crate) use testing::{TestFolder, test_folder};

#[cfg(test)]
mod testing {
    use std::fs;
    use std::ops::Deref;
    use std::path::{Path, PathBuf};

    /// A folder that is removed at the end of its test, even if the test panics.
    pub struct TestFolder(PathBuf);

    /// Creates an empty folder for one test.
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
}
