//! Builds the page for browsers. Debian's compiler builds the standard library with it, as
//! for Windows. The linker comes with the usual tool chain; `wasm-bindgen` is installed in
//! the version of Cargo.lock. The page gets the program packed, and a small one that unpacks it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::archive::{self, ArchiveEntry};
use super::debian::{self, CARGO, PATH, RUSTC};
use super::{VERSION, dist_folder, remap_flags, stdout_of, target, with_path, write_checksums};
use crate::error::TaskError;
use crate::run;

const TRIPLE: &str = "wasm32-unknown-unknown";
const SYSTEM: &str = "browsers";
/// Path of the linker in the usual tool chain, relative to its sysroot.
const LINKER: &str = "lib/rustlib/x86_64-unknown-linux-gnu/bin/rust-lld";
const CURE: &str = "on Debian: apt-get install rustc-web cargo-web rust-web-src";
const LINKER_CURE: &str = "it is part of the Rust tool chain that rustup installs";
/// Files of the page besides the program: name in the page and path in the repository.
const PAGE_FILES: [(&str, &str); 2] = [
    ("index.html", "web/index.html"),
    ("gsk980td.png", "assets/icon/gsk980td.png"),
];
/// Limit of the compressed page, bytes.
const MAX_BYTES: u64 = 4_600_000;

/// Makes the folder `web` and its .zip with a checksum in `target/dist`.
///
/// # Errors
/// A tool is missing or fails, or the page is too large.
pub fn make(root: &Path) -> Result<(), TaskError> {
    debian::require_tools(SYSTEM, CURE, &[])?;
    let linker = debian::sysroot("rustc").map(|sysroot| sysroot.join(LINKER));
    let linker = linker.filter(|linker| linker.exists());
    let linker = linker.ok_or_else(|| TaskError::Tools {
        system: SYSTEM,
        missing: LINKER.to_owned(),
        cure: LINKER_CURE,
    })?;
    let bindgen = bindgen_path(root)?;
    let page = dist_folder(root)?.join("web");
    // Files of an earlier build do not belong to this page.
    if page.exists() {
        with_path(&page, fs::remove_dir_all(&page))?;
    }
    with_path(&page, fs::create_dir_all(&page))?;
    build(root, &linker)?;
    run_bindgen(root, &bindgen, "unpack", "unpack", &page)?;
    run_bindgen(root, &bindgen, "gsk980td-web", "gsk980td", &page)?;
    pack_program(&page.join("gsk980td_bg.wasm"))?;
    for (name, from) in PAGE_FILES {
        let to = page.join(name);
        with_path(&to, fs::copy(root.join(from), &to))?;
    }
    // `tools/page_check.py` opens this one first; users do not get it.
    let check = target(root).join("page-check");
    with_path(&check, fs::create_dir_all(&check))?;
    run_bindgen(root, &bindgen, "golden", "golden", &check)?;
    pack(root, &page)
}

/// Builds the program for browsers, and the test session that hashes every tick.
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
        "--bin=unpack",
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
        ("CARGO_ENCODED_RUSTFLAGS", &remap_flags(root)),
    ];
    run(CARGO, &arguments, &environment)
}

/// Runs `wasm-bindgen` on `program` and writes the files that a page loads, as `name`, into
/// the folder `into`.
fn run_bindgen(
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

/// Replaces `program` with its packed form, `program` with `.lz` at its end.
fn pack_program(program: &Path) -> Result<(), TaskError> {
    let bytes = with_path(program, fs::read(program))?;
    let packed_path = PathBuf::from(format!("{}.lz", program.display()));
    let packed = with_path(&packed_path, archive::lz(&bytes))?;
    println!(
        "{}: {} kB, packed {} kB",
        program.display(),
        bytes.len() / 1000,
        packed.len() / 1000
    );
    with_path(&packed_path, fs::write(&packed_path, packed))?;
    with_path(program, fs::remove_file(program))
}

/// Returns the path of `wasm-bindgen` in the version of Cargo.lock; installs it below `target`
/// if it is missing.
fn bindgen_path(root: &Path) -> Result<PathBuf, TaskError> {
    let version = locked_version(root, "wasm-bindgen")?;
    let home = target(root).join("wasm-bindgen");
    let program = home.join("bin/wasm-bindgen");
    let is_installed = stdout_of(Command::new(&program).arg("--version"))
        .is_ok_and(|output| output.split_whitespace().nth(1) == Some(&version));
    if !is_installed {
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

/// Returns the version of a package in `Cargo.lock`.
fn locked_version(root: &Path, package: &str) -> Result<String, TaskError> {
    let path = root.join("Cargo.lock");
    let text = with_path(&path, fs::read_to_string(&path))?;
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

/// Writes the archive of the page and its checksum, and prints the size of the page.
fn pack(root: &Path, page: &Path) -> Result<(), TaskError> {
    let name = format!("gsk980td-{VERSION}-web");
    let mut files: Vec<ArchiveEntry> = Vec::new();
    for file in [
        "gsk980td.js",
        "gsk980td_bg.wasm.lz",
        "gsk980td.png",
        "index.html",
        "unpack.js",
        "unpack_bg.wasm",
    ] {
        files.push((file.to_owned(), page.join(file)));
    }
    for bundled in ["LICENSE-APACHE", "LICENSE-MIT", "NOTICE", "THIRD-PARTY.md"] {
        files.extend(archive::entries(root, bundled)?);
    }
    let folder = dist_folder(root)?;
    let zip = folder.join(format!("{name}.zip"));
    archive::zip(&zip, &name, &files, archive::Effort::Small)?;
    let size = with_path(&zip, fs::metadata(&zip))?.len();
    println!("{}: {} kB", zip.display(), size / 1000);
    if size > MAX_BYTES {
        return Err(TaskError::Large {
            path: zip,
            size,
            largest: MAX_BYTES,
        });
    }
    print!(
        "{}",
        write_checksums(&folder, &format!("{name}.sha256"), &[format!("{name}.zip")])?
    );
    Ok(())
}
