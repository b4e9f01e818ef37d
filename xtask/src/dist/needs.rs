//! Reads the packages that a Linux program requires out of its ELF file.

use std::collections::BTreeSet;

use object::elf::{EM_AARCH64, EM_X86_64, FileHeader64};
use object::read::elf::{Dyn, FileHeader};
use object::{Endianness, elf};

/// Libraries that the program may link: name, Debian package, and the prefix of those symbol
/// versions that are also versions of the package.
const LINKED: [(&str, &str, &str); 5] = [
    ("libc.so.6", "libc6", "GLIBC_"),
    ("libm.so.6", "libc6", "GLIBC_"),
    ("libgcc_s.so.1", "libgcc-s1", "GCC_"),
    ("ld-linux-x86-64.so.2", "libc6", "GLIBC_"),
    ("ld-linux-aarch64.so.1", "libc6", "GLIBC_"),
];

/// A version name that stands for a feature of the C library, and the first version with it.
const PACKED_RELOCATIONS: (&str, &str) = ("GLIBC_ABI_DT_RELR", "GLIBC_2.36");

/// Libraries that the window loads at run time, with their Debian packages. Commands work
/// without them.
const LOADED: [(&str, &str); 10] = [
    ("libEGL.so.1", "libegl1"),
    ("libGL.so.1", "libgl1"),
    ("libX11.so.6", "libx11-6"),
    ("libX11-xcb.so.1", "libx11-xcb1"),
    ("libXcursor.so.1", "libxcursor1"),
    ("libXi.so.6", "libxi6"),
    ("libwayland-client.so.0", "libwayland-client0"),
    ("libwayland-egl.so.1", "libwayland-egl1"),
    ("libxkbcommon.so.0", "libxkbcommon0"),
    ("libxkbcommon-x11.so.0", "libxkbcommon-x11-0"),
];

/// The processor and the system packages that an executable program requires.
#[derive(Debug, Default)]
pub struct Requirements {
    /// The name of the processor in Rust and in Debian.
    pub processor: (&'static str, &'static str),
    /// Packages that the program needs to start, each with its lowest version.
    pub depends: Vec<String>,
    /// Packages of the libraries that the window loads at run time.
    pub loads: Vec<String>,
}

/// Reads the requirements of a program from its executable file, whose bytes are `program`.
///
/// # Errors
/// The file is not a Linux program, its processor is unknown, or it links a library whose
/// package is unknown.
pub fn read(program: &[u8]) -> Result<Requirements, String> {
    let processor = processor(program).map_err(|error| error.to_string())?;
    let (libraries, versions) = linked(program).map_err(|error| error.to_string())?;
    let processor = processor.ok_or("unknown processor")?;
    let packages = libraries
        .iter()
        .map(|library| {
            let known = LINKED.iter().find(|(name, ..)| name == library);
            known
                .map(|&(_, package, word)| (package, word))
                .ok_or_else(|| format!("{library}: no package is known for this library"))
        })
        .collect::<Result<BTreeSet<_>, _>>()?;
    let depends = packages
        .iter()
        .map(|&(package, word)| match newest(&versions, word) {
            Some(version) => format!("{package} (>= {version})"),
            None => package.to_owned(),
        })
        .collect();
    let named = |library: &str| {
        program
            .windows(library.len())
            .any(|at| at == library.as_bytes())
    };
    let loads = LOADED
        .iter()
        .filter(|(library, _)| named(library))
        .map(|&(_, package)| package.to_owned())
        .collect();
    Ok(Requirements {
        processor,
        depends,
        loads,
    })
}

fn processor(program: &[u8]) -> object::Result<Option<(&'static str, &'static str)>> {
    let header = FileHeader64::<Endianness>::parse(program)?;
    Ok(match header.e_machine(header.endian()?) {
        EM_X86_64 => Some(("x86_64", "amd64")),
        EM_AARCH64 => Some(("aarch64", "arm64")),
        _ => None,
    })
}

/// Lists the libraries that a program links, and the symbol versions that it requires.
fn linked(program: &[u8]) -> object::Result<(BTreeSet<String>, BTreeSet<String>)> {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let header = FileHeader64::<Endianness>::parse(program)?;
    let endian = header.endian()?;
    let sections = header.sections(endian, program)?;
    let mut libraries = BTreeSet::new();
    if let Some((entries, index)) = sections.dynamic(endian, program)? {
        let strings = sections.strings(endian, program, index)?;
        for entry in entries {
            if entry.tag(endian) == elf::DT_NEEDED {
                libraries.insert(text(entry.string(endian, strings)?));
            }
        }
    }
    let mut versions = BTreeSet::new();
    if let Some((mut files, index)) = sections.gnu_verneed(endian, program)? {
        let strings = sections.strings(endian, program, index)?;
        while let Some((_, mut names)) = files.next()? {
            while let Some(name) = names.next()? {
                let name = text(name.name(endian, strings)?);
                versions.insert(numbered_version(name));
            }
        }
    }
    Ok((libraries, versions))
}

/// The version with the feature that `name` requires, if it names a feature instead of a version.
fn numbered_version(name: String) -> String {
    let (feature, version) = PACKED_RELOCATIONS;
    if name == feature {
        return version.to_owned();
    }
    name
}

/// Finds the newest of the versions that begin with `word` and returns it without that prefix;
/// `None` if there is none.
fn newest(versions: &BTreeSet<String>, word: &str) -> Option<String> {
    let numbers = |version: &&str| {
        let parts = version.split('.').map(|part| part.parse().ok());
        parts.collect::<Option<Vec<u32>>>()
    };
    let named = versions.iter().filter_map(|name| name.strip_prefix(word));
    let newest = named
        .filter_map(|version| Some((numbers(&version)?, version)))
        .max()?;
    Some(newest.1.to_owned())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

    use super::*;

    #[test]
    fn newest_version_is_found_by_number() {
        let names = [
            "GLIBC_2.4",
            "GLIBC_2.34",
            "GLIBC_2.9",
            "GLIBC_PRIVATE",
            "GCC_4.2.0",
        ];
        let versions = names.map(str::to_owned).into();
        assert_eq!(newest(&versions, "GLIBC_").as_deref(), Some("2.34"));
        assert_eq!(newest(&versions, "GCC_").as_deref(), Some("4.2.0"));
        assert_eq!(newest(&versions, "QT_"), None);
    }

    #[test]
    fn packed_relocations_require_the_first_c_library_that_reads_them() {
        let names = ["GLIBC_2.34", "GLIBC_ABI_DT_RELR"].map(str::to_owned);
        let versions = names.map(numbered_version).into();
        assert_eq!(newest(&versions, "GLIBC_").as_deref(), Some("2.36"));
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn this_test_requires_libc() {
        let program = std::fs::read(std::env::current_exe().unwrap()).unwrap();
        let needs = read(&program).unwrap();
        assert_eq!(needs.processor.0, std::env::consts::ARCH);
        let libc = needs
            .depends
            .iter()
            .find(|need| need.starts_with("libc6 (>= 2."));
        assert!(libc.is_some(), "{needs:?}");
    }

    #[test]
    fn other_files_are_refused() {
        assert!(read(b"#!/bin/sh\n").is_err());
    }
}
