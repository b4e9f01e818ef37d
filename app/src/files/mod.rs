//! Everything that touches the disk: reading programs, the data directory.

pub mod atomic;
pub mod data_dir;
pub mod decode;
pub mod folders;
pub mod kept;
pub mod lessons;
mod manifest;
pub mod models;
pub mod program_file;
pub mod subprograms;
pub mod time;

/// An empty folder of its own for one test.
#[cfg(test)]
pub(crate) fn test_folder(name: &str) -> std::path::PathBuf {
    let folder = std::env::temp_dir().join(format!("gsk980td-{name}-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("folder for a test");
    folder
}
