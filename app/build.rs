//! Leaves the symbols out of a release of the program. Cargo does not apply `strip` of a profile
//! to a package that has other settings of its own in it.

use std::env;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let is = |name: &str, value: &str| env::var(name).is_ok_and(|found| found == value);
    if is("PROFILE", "release")
        && (is("CARGO_CFG_TARGET_OS", "linux") || is("CARGO_CFG_TARGET_ENV", "gnu"))
    {
        println!("cargo::rustc-link-arg-bins=-Wl,--strip-all");
    }
}
