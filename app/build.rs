//! Leaves the symbols out of a release of the program: Cargo ignores `strip` of a profile for a
//! package that the profile has further settings for.

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
