//! The page for browsers: the standard library is built along by Debian's compiler, as
//! for Windows; the linker for it comes with the usual tool chain, `wasm-bindgen` in its
//! version from the registry.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::archive::{self, Entry};
use super::debian::{self, CARGO, PATH, RUSTC};
use super::{VERSION, folder, on, same_places, sum, target, told};
use crate::error::TaskError;
use crate::run;

const TRIPLE: &str = "wasm32-unknown-unknown";
const SYSTEM: &str = "browsers";
/// Linker of the usual tool chain, below its own folder.
const LINKER: &str = "lib/rustlib/x86_64-unknown-linux-gnu/bin/rust-lld";
const CURE: &str = "on Debian: apt-get install rustc-web cargo-web rust-web-src";
const LINKER_CURE: &str = "it is part of the Rust tool chain that rustup installs";
/// What the page is made of, besides the program.
const BESIDE: [(&str, &str); 2] = [
    ("index.html", "web/index.html"),
    ("gsk980td.png", "assets/icon/gsk980td.png"),
];
/// Compressed it must not be larger, bytes.
const LARGEST: u64 = 4_000_000;

/// Makes the folder `web` and its .zip with a checksum in `target/dist`.
///
/// # Errors
/// A tool is missing, or what it says; the page is too large.
pub fn make(root: &Path) -> Result<(), TaskError> {
    debian::is_there(SYSTEM, CURE, &[])?;
    let linker = debian::sysroot("rustc").map(|sysroot| sysroot.join(LINKER));
    let linker = linker.filter(|linker| linker.exists());
    let linker = linker.ok_or_else(|| TaskError::Tools {
        system: SYSTEM,
        missing: LINKER.to_owned(),
        cure: LINKER_CURE,
    })?;
    let bindgen = bindgen(root)?;
    let page = folder(root)?.join("web");
    // What an earlier one has left is none of this page.
    if page.exists() {
        on(&page, fs::remove_dir_all(&page))?;
    }
    on(&page, fs::create_dir_all(&page))?;
    build(root, &linker)?;
    bind(root, &bindgen, "gsk980td-web", "gsk980td", &page)?;
    for (name, from) in BESIDE {
        let to = page.join(name);
        on(&to, fs::copy(root.join(from), &to))?;
    }
    // What `tools/page_check.py` opens first is no part of what is given to users.
    let check = target(root).join("page-check");
    on(&check, fs::create_dir_all(&check))?;
    bind(root, &bindgen, "golden", "golden", &check)?;
    pack(root, &page)
}

/// Builds the program, and the session whose every tick is hashed.
fn build(root: &Path, linker: &Path) -> Result<(), TaskError> {
    let target = target(root);
    let (target, linker) = (target.to_string_lossy(), linker.to_string_lossy());
    let arguments = [
        "build",
        "--profile=web",
        "--locked",
        "-Zbuild-std=std,panic_abort",
        "--target",
        TRIPLE,
        "--target-dir",
        &target,
        "--package=gsk980td-web",
        "--bin=gsk980td-web",
        "--package=gsk980td-tests",
        "--bin=golden",
    ];
    let environment = [
        ("PATH", PATH),
        ("RUSTC", RUSTC),
        ("RUSTC_BOOTSTRAP", "1"),
        (
            "CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER",
            linker.as_ref(),
        ),
        ("CARGO_ENCODED_RUSTFLAGS", &same_places(root)),
    ];
    run(CARGO, &arguments, &environment)
}

/// Makes of a program what a page can load.
fn bind(
    root: &Path,
    bindgen: &Path,
    program: &str,
    name: &str,
    into: &Path,
) -> Result<(), TaskError> {
    let built = target(root).join(TRIPLE).join("web");
    let built = built.join(format!("{program}.wasm"));
    let (built, into) = (built.to_string_lossy(), into.to_string_lossy());
    let arguments = [
        "--target=web",
        "--no-typescript",
        "--remove-name-section",
        "--remove-producers-section",
        "--out-name",
        name,
        "--out-dir",
        &into,
        &built,
    ];
    run(&bindgen.to_string_lossy(), &arguments, &[])
}

/// `wasm-bindgen` of the version that the program is built with, installed below
/// `target` when it is not there.
fn bindgen(root: &Path) -> Result<PathBuf, TaskError> {
    let version = locked_version(root, "wasm-bindgen")?;
    let home = target(root).join("wasm-bindgen");
    let program = home.join("bin/wasm-bindgen");
    let is_it = told(Command::new(&program).arg("--version"))
        .is_ok_and(|said| said.split_whitespace().nth(1) == Some(&version));
    if !is_it {
        let home = home.to_string_lossy();
        let arguments = [
            "install",
            "wasm-bindgen-cli",
            "--version",
            &version,
            "--root",
            &home,
        ];
        run("cargo", &arguments, &[])?;
    }
    Ok(program)
}

/// The version of a package in `Cargo.lock`.
fn locked_version(root: &Path, package: &str) -> Result<String, TaskError> {
    let path = root.join("Cargo.lock");
    let text = on(&path, fs::read_to_string(&path))?;
    let named = format!("name = \"{package}\"\nversion = \"");
    let version = text
        .split(&named)
        .nth(1)
        .and_then(|rest| rest.split('"').next());
    version.map(str::to_owned).ok_or_else(|| TaskError::Tools {
        system: SYSTEM,
        missing: format!("{package} in Cargo.lock"),
        cure: CURE,
    })
}

/// The archive and its checksum; says how large the page is.
fn pack(root: &Path, page: &Path) -> Result<(), TaskError> {
    let name = format!("gsk980td-{VERSION}-web");
    let mut files: Vec<Entry> = Vec::new();
    for file in [
        "gsk980td.js",
        "gsk980td_bg.wasm",
        "gsk980td.png",
        "index.html",
    ] {
        files.push((file.to_owned(), page.join(file)));
    }
    for beside in ["LICENSE-APACHE", "LICENSE-MIT", "NOTICE", "THIRD-PARTY.md"] {
        files.extend(archive::entries(root, beside)?);
    }
    let folder = folder(root)?;
    let zip = folder.join(format!("{name}.zip"));
    archive::zip(&zip, &name, &files, archive::Effort::Small)?;
    let size = on(&zip, fs::metadata(&zip))?.len();
    println!("{}: {} kB", zip.display(), size / 1000);
    if size > LARGEST {
        return Err(TaskError::Large {
            path: zip,
            size,
            largest: LARGEST,
        });
    }
    print!(
        "{}",
        sum(&folder, &format!("{name}.sha256"), &[format!("{name}.zip")])?
    );
    Ok(())
}
