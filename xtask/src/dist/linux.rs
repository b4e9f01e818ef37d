//! Packages for the Linux system they are built on: a portable .tar.gz and a .deb. Both
//! need only the usual Rust tool chain and coreutils.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::archive::{self, Item};
use super::needs::{self, Requirements};
use super::{
    BUNDLED, FLAG_SEPARATOR, VERSION, deb, dist_folder, notes, remap_flags, stdout_of, target,
    with_path,
};
use crate::error::TaskError;
use crate::run;

/// Shells: name, path of the completion script in the archive, and in the system.
const SHELLS: [(&str, &str, &str); 3] = [
    (
        "bash",
        "gsk980td.bash",
        "usr/share/bash-completion/completions/gsk980td",
    ),
    (
        "fish",
        "gsk980td.fish",
        "usr/share/fish/vendor_completions.d/gsk980td.fish",
    ),
    (
        "zsh",
        "_gsk980td",
        "usr/share/zsh/vendor-completions/_gsk980td",
    ),
];

/// The contents that the portable archive and the .deb have in common.
pub struct PackageContents {
    /// The executable file of the program.
    pub program: Vec<u8>,
    /// Processor and packages that the program needs.
    pub needs: Requirements,
    /// Manual pages: file name and contents.
    pub pages: Vec<(String, Vec<u8>)>,
    /// Completion scripts: name in the portable archive, path in the system, text.
    pub shells: Vec<(&'static str, &'static str, String)>,
    /// The time of all files, seconds since 1970: the day of the version.
    pub time: u64,
}

/// Makes the `.tar.gz` and the `.deb` in `target/dist`.
///
/// # Errors
/// The system is not Linux, a tool fails, or a file cannot be read or written.
pub fn make(root: &Path) -> Result<(), TaskError> {
    if !cfg!(target_os = "linux") {
        return Err(TaskError::Tools {
            system: "Linux",
            missing: "a Linux".to_owned(),
            cure: "it is built on the system that it is for",
        });
    }
    let changelog = notes::read(root)?;
    let version = notes::section(&changelog, VERSION)?;
    let built = build(root)?;
    let program = with_path(&built, fs::read(&built))?;
    let needs = needs::read(&program).map_err(|why| TaskError::Program {
        path: built.clone(),
        why,
    })?;
    let parts = PackageContents {
        program,
        needs,
        pages: pages(root, &built)?,
        shells: shells(&built)?,
        time: version.seconds(),
    };
    let folder = dist_folder(root)?;
    for path in [
        portable(root, &folder, &parts)?,
        deb::make(root, &folder, &parts, &version)?,
    ] {
        println!("{}", path.display());
    }
    Ok(())
}

/// Flags of direct calls between packages (COMMAND-18). Those of `.cargo/config.toml` do not hold
/// for a build that gets flags from the environment.
const DIRECT_CALLS: [&str; 2] = ["-Crelro-level=partial", "-Clink-arg=-Wl,-z,now"];

/// Builds the program for release and returns its path.
fn build(root: &Path) -> Result<PathBuf, TaskError> {
    let compiler = stdout_of(Command::new("rustc").arg("-vV"))?;
    let host = compiler
        .lines()
        .find_map(|line| line.strip_prefix("host: "));
    let host = host.unwrap_or_default();
    let target = target(root);
    let target_folder = target.to_string_lossy();
    // `--target` limits the flags to the program, so other builds are not invalidated.
    let arguments = [
        "build",
        "--release",
        "--locked",
        "--package=gsk980td",
        "--bin=gsk980td",
        "--target",
        host,
        "--target-dir",
        &target_folder,
    ];
    let remap = remap_flags(root);
    let flags = [&[remap.as_str()], &DIRECT_CALLS[..]].concat();
    let flags = flags.join(FLAG_SEPARATOR);
    let environment = [
        ("CARGO_ENCODED_RUSTFLAGS", flags.as_str()),
        // Computers with an older C library than this one start it, too.
        ("GSK980TD_PORTABLE", "1"),
    ];
    run("cargo", &arguments, &environment)?;
    Ok(target.join(host).join("release/gsk980td"))
}

/// Lets the program write its manual pages and returns their names and contents.
fn pages(root: &Path, program: &Path) -> Result<Vec<(String, Vec<u8>)>, TaskError> {
    let folder = empty_folder(target(root).join("dist-man"))?;
    stdout_of(Command::new(program).args(["man", "--folder"]).arg(&folder))?;
    let mut pages = Vec::new();
    for (name, path) in archive::entries(&folder, ".")? {
        let name = name.trim_start_matches("./").to_owned();
        pages.push((name, with_path(&path, fs::read(&path))?));
    }
    Ok(pages)
}

/// Lets the program print its completion scripts and returns them with their paths.
fn shells(program: &Path) -> Result<Vec<(&'static str, &'static str, String)>, TaskError> {
    let scripts = SHELLS.iter().map(|&(shell, portable, installed)| {
        let script = stdout_of(Command::new(program).args(["completions", shell]))?;
        Ok((portable, installed, script))
    });
    scripts.collect()
}

/// Creates an empty folder, or empties an existing one.
pub fn empty_folder(folder: PathBuf) -> Result<PathBuf, TaskError> {
    if folder.exists() {
        with_path(&folder, fs::remove_dir_all(&folder))?;
    }
    with_path(&folder, fs::create_dir_all(&folder))?;
    Ok(folder)
}

/// Makes the portable archive and returns its path.
fn portable(root: &Path, folder: &Path, parts: &PackageContents) -> Result<PathBuf, TaskError> {
    let name = format!("gsk980td-{VERSION}-linux-{}", parts.needs.processor.0);
    let mut items = vec![Item {
        name: "gsk980td".to_owned(),
        bytes: parts.program.clone(),
        program: true,
    }];
    for bundled in BUNDLED {
        for (name, path) in archive::entries(root, bundled)? {
            items.push(Item::text(name, with_path(&path, fs::read(&path))?));
        }
    }
    for (name, page) in &parts.pages {
        items.push(Item::text(format!("man/man1/{name}"), page.as_slice()));
    }
    for (name, _, script) in &parts.shells {
        items.push(Item::text(format!("completions/{name}"), script.as_str()));
    }
    let path = folder.join(format!("{name}.tar.gz"));
    let bytes = archive::tar_gz(&format!("{name}/"), &items, parts.time);
    with_path(&path, bytes.and_then(|bytes| fs::write(&path, bytes)))?;
    Ok(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packages_get_the_flags_of_every_other_build() {
        let configuration = include_str!("../../../.cargo/config.toml");
        for flag in DIRECT_CALLS {
            assert!(configuration.contains(&format!("\"{flag}\"")), "{flag}");
        }
    }
}
