//! What is given to users: programs for other systems, archives, checksums.
//! The same sources give the same bytes.

mod archive;
mod deb;
mod debian;
pub mod linux;
mod needs;
pub mod notes;
pub mod web;
pub mod windows;

use std::path::{Path, PathBuf};
use std::process::Command;
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
pub fn target(root: &Path) -> PathBuf {
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

/// Makes what is given to users.
type Make = fn(&Path) -> Result<(), TaskError>;

/// All there is, by name: the notes first, they are the cheapest to fail.
const ALL: [(&str, Make); 4] = [
    ("notes", notes::make),
    ("linux", linux::make),
    ("windows", windows::make),
    ("web", web::make),
];

/// Makes everything that can be made here; what lacks its tools is left out, and said so.
/// `SHA256SUMS` then holds the checksums of all files in the folder.
///
/// # Errors
/// What fails for another reason than a missing tool.
pub fn all(root: &Path) -> Result<(), TaskError> {
    let mut left_out = Vec::new();
    for (name, make) in ALL {
        match make(root) {
            Ok(()) => {}
            Err(said @ TaskError::Tools { .. }) => {
                println!("{name} is left out: {said}");
                left_out.push(name);
            }
            Err(error) => return Err(error),
        }
    }
    let folder = folder(root)?;
    sums(&folder)?;
    println!("in {}, with SHA256SUMS", folder.display());
    if !left_out.is_empty() {
        println!("left out: {}", left_out.join(", "));
    }
    Ok(())
}

/// Writes `SHA256SUMS` of the files in a folder, by name; checksums of a single archive
/// are none of them.
fn sums(folder: &Path) -> Result<(), TaskError> {
    let mut names = Vec::new();
    for entry in on(folder, fs::read_dir(folder))? {
        let entry = on(folder, entry)?;
        let name = entry.file_name().to_string_lossy().into_owned();
        if entry.path().is_file() && name != "SHA256SUMS" && !name.ends_with(".sha256") {
            names.push(name);
        }
    }
    names.sort();
    sum(folder, "SHA256SUMS", &names).map(drop)
}

/// Writes the checksums of files into one beside them, and returns its text.
fn sum(folder: &Path, name: &str, files: &[String]) -> Result<String, TaskError> {
    let mut command = Command::new("sha256sum");
    let text = told(command.arg("--").args(files).current_dir(folder))?;
    let path = folder.join(name);
    on(&path, fs::write(&path, &text))?;
    Ok(text)
}

/// The help of the program as one page a language, beside the documentation.
///
/// # Errors
/// The program cannot be built, or a page not written.
pub fn manuals(root: &Path) -> Result<(), TaskError> {
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
        let page = told(Command::new("cargo").args(arguments).current_dir(root))?;
        let path = target(root).join(format!("doc/help-{language}.html"));
        on(&path, fs::write(&path, page))?;
        println!("{}", path.display());
    }
    Ok(())
}

/// What a command writes to standard output.
fn told(command: &mut Command) -> Result<String, TaskError> {
    let line = format!("{command:?}");
    match command.output() {
        Err(error) => Err(TaskError::Start { line, error }),
        Ok(done) if done.status.success() => Ok(String::from_utf8_lossy(&done.stdout).into_owned()),
        Ok(done) => Err(TaskError::Failed {
            line,
            status: done.status,
        }),
    }
}
