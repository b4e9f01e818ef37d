//! Builds the program for Windows on Debian. Debian's compiler builds the standard library
//! with it, and mingw links. The usual tool chain is not affected.

use std::fs;
use std::path::{Path, PathBuf};

use super::archive::{self, ArchiveEntry};
use super::debian::{self, CARGO, PATH, RUSTC};
use super::{BUNDLED, VERSION, dist_folder, remap_flags, target, with_path, write_checksums};
use crate::error::TaskError;
use crate::run;

const TRIPLE: &str = "x86_64-pc-windows-gnu";
const LINKER: &str = "/usr/bin/x86_64-w64-mingw32-gcc";
const RESOURCES: &str = "/usr/bin/x86_64-w64-mingw32-windres";
const CURE: &str = "on Debian: apt-get install rustc-web cargo-web rust-web-src \
                    gcc-mingw-w64-x86-64-posix";

/// Makes the `.exe` and the `.zip` with its checksum in `target/dist`.
///
/// # Errors
/// A tool is missing or fails.
pub fn make(root: &Path) -> Result<(), TaskError> {
    debian::require_tools("Windows", CURE, &[LINKER, RESOURCES])?;
    let folder = dist_folder(root)?;
    let built = build(root, &resources(root)?)?;
    let program = folder.join("gsk980td.exe");
    with_path(&program, fs::copy(&built, &program))?;
    pack(root, &folder, &program)
}

/// Compiles icon, manifest and version into an object file for the linker and returns its
/// path.
fn resources(root: &Path) -> Result<PathBuf, TaskError> {
    let numbers = VERSION.replace('.', ",");
    let text = format!(
        "1 ICON \"gsk980td.ico\"\n\
         1 24 \"gsk980td.manifest\"\n\
         1 VERSIONINFO\nFILEVERSION {numbers},0\nPRODUCTVERSION {numbers},0\nBEGIN\n\
         BLOCK \"StringFileInfo\"\nBEGIN\nBLOCK \"040904b0\"\nBEGIN\n\
         VALUE \"FileDescription\", \"GSK980TD lathe control\"\n\
         VALUE \"ProductName\", \"gsk980td\"\n\
         VALUE \"OriginalFilename\", \"gsk980td.exe\"\n\
         VALUE \"LegalCopyright\", \"MIT OR Apache-2.0\"\n\
         VALUE \"FileVersion\", \"{VERSION}\"\n\
         VALUE \"ProductVersion\", \"{VERSION}\"\nEND\nEND\n\
         BLOCK \"VarFileInfo\"\nBEGIN\nVALUE \"Translation\", 0x0409, 1200\nEND\nEND\n"
    );
    let folder = target(root).join(TRIPLE);
    with_path(&folder, fs::create_dir_all(&folder))?;
    let (script, object) = (folder.join("gsk980td.rc"), folder.join("gsk980td.rc.o"));
    with_path(&script, fs::write(&script, text))?;
    let include = root.join("app/windows");
    let paths = [&include, &script, &object].map(|path| path.to_string_lossy());
    let arguments = ["-O", "coff", "-I", &paths[0], &paths[1], &paths[2]];
    run(RESOURCES, &arguments, &[])?;
    Ok(object)
}

/// Builds the program for release, links `resources` into it and returns its path.
fn build(root: &Path, resources: &Path) -> Result<PathBuf, TaskError> {
    let target = target(root);
    let resources = format!("link-arg={}", resources.display());
    let target_folder = target.to_string_lossy();
    let arguments = [
        "rustc",
        "--release",
        "--locked",
        "--package=gsk980td",
        "--bin=gsk980td",
        "-Zbuild-std=std,panic_unwind",
        "--target",
        TRIPLE,
        "--target-dir",
        &target_folder,
        "--",
        "-C",
        &resources,
        // Without this flag the linker writes the time of the build into the program.
        "-C",
        "link-arg=-Wl,--no-insert-timestamp",
    ];
    let environment = [
        ("PATH", PATH),
        ("RUSTC", RUSTC),
        ("RUSTC_BOOTSTRAP", "1"),
        ("CARGO_TARGET_X86_64_PC_WINDOWS_GNU_LINKER", LINKER),
        ("CARGO_ENCODED_RUSTFLAGS", &remap_flags(root)),
    ];
    run(CARGO, &arguments, &environment)?;
    Ok(target.join(TRIPLE).join("release/gsk980td.exe"))
}

/// Writes the archive of the program and its checksum.
fn pack(root: &Path, folder: &Path, program: &Path) -> Result<(), TaskError> {
    let name = format!("gsk980td-{VERSION}-windows-x86_64");
    let mut files: Vec<ArchiveEntry> = vec![("gsk980td.exe".to_owned(), program.to_owned())];
    for bundled in BUNDLED {
        files.extend(archive::entries(root, bundled)?);
    }
    let zip = folder.join(format!("{name}.zip"));
    archive::zip(&zip, &name, &files, archive::Effort::Quick)?;
    let both = ["gsk980td.exe".to_owned(), format!("{name}.zip")];
    print!(
        "{}",
        write_checksums(folder, &format!("{name}.sha256"), &both)?
    );
    Ok(())
}
