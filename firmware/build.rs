//! Passes the memory map and the linker scripts to the linker.

use std::path::Path;

fn main() {
    let folder = std::env::var("OUT_DIR").expect("set by cargo");
    std::fs::copy("memory.x", Path::new(&folder).join("memory.x")).expect("a writable folder");
    println!("cargo:rustc-link-search={folder}");
    println!("cargo:rerun-if-changed=memory.x");
    for argument in ["--nmagic", "-Tlink.x", "-Tlink-rp.x"] {
        println!("cargo:rustc-link-arg-bins={argument}");
    }
}
