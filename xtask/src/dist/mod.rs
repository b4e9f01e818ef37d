//! Builds the release files: programs for other systems, archives, checksums. Builds are
//! reproducible.

mod archive;
mod deb;
mod debian;
pub mod linux;
mod needs;
pub mod notes;
pub mod pico;
pub mod web;
pub mod windows;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

use crate::error::TaskError;

/// The version of the program.
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Files and folders of the repository with texts and samples for every package.
const BUNDLED: [&str; 9] = [
    "CHANGELOG.md",
    "LICENSE-APACHE",
    "LICENSE-MIT",
    "NOTICE",
    "README.md",
    "README.zh-CN.md",
    "THIRD-PARTY.md",
    "assets/programs",
    "posts",
];

/// Separates two compiler flags in `CARGO_ENCODED_RUSTFLAGS`.
const FLAG_SEPARATOR: &str = "\u{1f}";

/// The build folder of cargo: `CARGO_TARGET_DIR`, or `target` in the repository.
pub fn target(root: &Path) -> PathBuf {
    env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from)
}

/// Creates `target/dist`, the folder of all release files, and returns its path.
fn dist_folder(root: &Path) -> Result<PathBuf, TaskError> {
    let folder = target(root).join("dist");
    match fs::create_dir_all(&folder) {
        Ok(()) => Ok(folder),
        Err(error) => Err(TaskError::Write {
            path: folder,
            error,
        }),
    }
}

/// Adds `path` to the error of a file operation.
fn with_path<T>(path: &Path, result: std::io::Result<T>) -> Result<T, TaskError> {
    result.map_err(|error| TaskError::Write {
        path: path.to_owned(),
        error,
    })
}

/// Returns compiler flags that keep the paths of this computer out of the program.
fn remap_flags(root: &Path) -> String {
    let home = env::var_os("CARGO_HOME").map(PathBuf::from);
    let home = home.or_else(|| env::home_dir().map(|home| home.join(".cargo")));
    let remap = |path: &Path, name| format!("--remap-path-prefix={}={name}", path.display());
    let mut flags = vec![remap(root, "gsk980td"), remap(&target(root), "target")];
    flags.extend(home.map(|home| remap(&home, "cargo")));
    flags.join(FLAG_SEPARATOR)
}

/// A function that builds one kind of release file.
type Make = fn(&Path) -> Result<(), TaskError>;

/// All kinds of release files by name. The release notes come first, because they fail
/// fastest.
const ALL: [(&str, Make); 5] = [
    ("notes", notes::make),
    ("linux", linux::make),
    ("windows", windows::make),
    ("web", web::make),
    ("pico", pico::make),
];

/// Builds everything whose tools are installed, prints what is skipped, and writes the
/// checksums of all files in `target/dist` into `SHA256SUMS`.
///
/// # Errors
/// A build fails for another reason than a missing tool.
pub fn all(root: &Path) -> Result<(), TaskError> {
    let mut left_out = Vec::new();
    for (name, make) in ALL {
        match make(root) {
            Ok(()) => {}
            Err(error @ TaskError::Tools { .. }) => {
                println!("{name} is left out: {error}");
                left_out.push(name);
            }
            Err(error) => return Err(error),
        }
    }
    let folder = dist_folder(root)?;
    write_all_checksums(&folder)?;
    println!("in {}, with SHA256SUMS", folder.display());
    if !left_out.is_empty() {
        println!("left out: {}", left_out.join(", "));
    }
    Ok(())
}

/// Writes the file `SHA256SUMS` of a folder, in the order of the file names, and leaves out
/// the checksum files of single archives.
fn write_all_checksums(folder: &Path) -> Result<(), TaskError> {
    let mut names = Vec::new();
    for entry in with_path(folder, fs::read_dir(folder))? {
        let entry = with_path(folder, entry)?;
        let name = entry.file_name().to_string_lossy().into_owned();
        if entry.path().is_file() && name != "SHA256SUMS" && !name.ends_with(".sha256") {
            names.push(name);
        }
    }
    names.sort();
    write_checksums(folder, "SHA256SUMS", &names).map(drop)
}

/// Writes the checksums of `files` into the file `name` in the same folder, and returns its
/// text.
fn write_checksums(folder: &Path, name: &str, files: &[String]) -> Result<String, TaskError> {
    let mut command = Command::new("sha256sum");
    let text = stdout_of(command.arg("--").args(files).current_dir(folder))?;
    let path = folder.join(name);
    with_path(&path, fs::write(&path, &text))?;
    Ok(text)
}

/// Writes the program's help as one page for each language, beside the documentation.
///
/// # Errors
/// The program cannot be built, or a page cannot be written.
pub fn write_manuals(root: &Path) -> Result<(), TaskError> {
    for language in ["en", "zh"] {
        let arguments = [
            "run",
            "--locked",
            "--",
            "help",
            "--document",
            "--lang",
            language,
        ];
        let page = stdout_of(Command::new("cargo").args(arguments).current_dir(root))?;
        let path = target(root).join(format!("doc/help-{language}.html"));
        with_path(&path, fs::write(&path, page))?;
        println!("{}", path.display());
    }
    Ok(())
}

/// Runs a command and returns its standard output.
fn stdout_of(command: &mut Command) -> Result<String, TaskError> {
    let line = format!("{command:?}");
    match command.output() {
        Err(error) => Err(TaskError::Start { line, error }),
        Ok(output) if output.status.success() => {
            Ok(String::from_utf8_lossy(&output.stdout).into_owned())
        }
        Ok(output) => Err(TaskError::Failed {
            line,
            status: output.status,
        }),
    }
}
