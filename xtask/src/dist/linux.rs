//! The program for the Linux that it is built on: a portable .tar.gz and a .deb. Neither
//! needs more than the tool chain of every other build and coreutils.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::archive::{self, Item};
use super::needs::{self, Needs};
use super::{BESIDE, VERSION, deb, folder, notes, on, same_places, target, told};
use crate::error::TaskError;
use crate::run;

/// Shells, with the names of their scripts in the portable archive and in the system.
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

/// What packages are made of.
pub struct Parts {
    /// The program.
    pub program: Vec<u8>,
    /// What it needs of a system.
    pub needs: Needs,
    /// Its manual pages by file name.
    pub pages: Vec<(String, Vec<u8>)>,
    /// Scripts of shells: name in the portable archive, path in the system, text.
    pub shells: Vec<(&'static str, &'static str, String)>,
    /// The time of all files, seconds since 1970: the day of the version.
    pub time: u64,
}

/// Makes the `.tar.gz` and the `.deb` in `target/dist`.
///
/// # Errors
/// This is no Linux, or what a tool says.
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
    let program = on(&built, fs::read(&built))?;
    let needs = needs::read(&program).map_err(|why| TaskError::Program {
        path: built.clone(),
        why,
    })?;
    let parts = Parts {
        program,
        needs,
        pages: pages(root, &built)?,
        shells: shells(&built)?,
        time: version.seconds(),
    };
    let folder = folder(root)?;
    for path in [
        portable(root, &folder, &parts)?,
        deb::make(root, &folder, &parts, &version)?,
    ] {
        println!("{}", path.display());
    }
    Ok(())
}

/// Builds the program and says where it is.
fn build(root: &Path) -> Result<PathBuf, TaskError> {
    let compiler = told(Command::new("rustc").arg("-vV"))?;
    let host = compiler
        .lines()
        .find_map(|line| line.strip_prefix("host: "));
    let host = host.unwrap_or_default();
    let target = target(root);
    let target_folder = target.to_string_lossy();
    // With a target the flags are the program's alone, and other builds stay as they are.
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
    let flags = same_places(root);
    run("cargo", &arguments, &[("CARGO_ENCODED_RUSTFLAGS", &flags)])?;
    Ok(target.join(host).join("release/gsk980td"))
}

/// The manual pages that the program writes.
fn pages(root: &Path, program: &Path) -> Result<Vec<(String, Vec<u8>)>, TaskError> {
    let folder = empty(target(root).join("dist-man"))?;
    told(Command::new(program).args(["man", "--folder"]).arg(&folder))?;
    let mut pages = Vec::new();
    for (name, path) in archive::entries(&folder, ".")? {
        let name = name.trim_start_matches("./").to_owned();
        pages.push((name, on(&path, fs::read(&path))?));
    }
    Ok(pages)
}

/// The scripts of shells that the program writes.
fn shells(program: &Path) -> Result<Vec<(&'static str, &'static str, String)>, TaskError> {
    let scripts = SHELLS.iter().map(|&(shell, portable, installed)| {
        let script = told(Command::new(program).args(["completions", shell]))?;
        Ok((portable, installed, script))
    });
    scripts.collect()
}

/// A folder with nothing in it.
pub fn empty(folder: PathBuf) -> Result<PathBuf, TaskError> {
    if folder.exists() {
        on(&folder, fs::remove_dir_all(&folder))?;
    }
    on(&folder, fs::create_dir_all(&folder))?;
    Ok(folder)
}

/// The archive that is unpacked anywhere.
fn portable(root: &Path, folder: &Path, parts: &Parts) -> Result<PathBuf, TaskError> {
    let name = format!("gsk980td-{VERSION}-linux-{}", parts.needs.processor.0);
    let mut items = vec![Item {
        name: "gsk980td".to_owned(),
        bytes: parts.program.clone(),
        program: true,
    }];
    for beside in BESIDE {
        for (name, path) in archive::entries(root, beside)? {
            items.push(Item::text(name, on(&path, fs::read(&path))?));
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
    on(&path, bytes.and_then(|bytes| fs::write(&path, bytes)))?;
    Ok(path)
}
