//! Options of the linker for a release of the program.

use std::env;
use std::process::Command;

/// The first minor version of the GNU C library 2 that reads packed relocations (`DT_RELR`).
const PACKED_RELOCATIONS_MINOR: u32 = 36;
/// Set while the program is built for computers other than this one.
const PORTABLE: &str = "GSK980TD_PORTABLE";

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let is = |name: &str, value: &str| env::var(name).is_ok_and(|found| found == value);
    let is_linux = is("CARGO_CFG_TARGET_OS", "linux");
    let is_gnu = is("CARGO_CFG_TARGET_ENV", "gnu");
    if !is("PROFILE", "release") {
        return;
    }
    // Cargo ignores `strip` of a profile for a package that the profile has further settings for.
    if is_linux || is_gnu {
        println!("cargo::rustc-link-arg-bins=-Wl,--strip-all");
    }
    // Packed relocations take 2.3 MB less of the file, and fewer instructions at each start; a
    // package also starts with an older C library (COMMAND-17).
    println!("cargo::rerun-if-env-changed={PORTABLE}");
    let is_portable = env::var_os(PORTABLE).is_some();
    let is_native = !is_portable && env::var("HOST") == env::var("TARGET");
    if is_linux && is_gnu && is_native && reads_packed_relocations() {
        println!("cargo::rustc-link-arg-bins=-Wl,-z,pack-relative-relocs");
    }
}

/// Whether the C library of this computer reads packed relocations.
fn reads_packed_relocations() -> bool {
    let Ok(output) = Command::new("getconf").arg("GNU_LIBC_VERSION").output() else {
        return false;
    };
    let version = String::from_utf8_lossy(&output.stdout);
    let minor = version.trim().strip_prefix("glibc 2.");
    minor
        .and_then(|minor| minor.parse().ok())
        .is_some_and(|minor: u32| minor >= PACKED_RELOCATIONS_MINOR)
}
