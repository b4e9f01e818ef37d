//! The notices of a binary release name every package that the binary links.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Command;

use crate::process::executable;

const ADVICE: &str = "run tools/notices.py";

type Package = (String, String);

fn read_file(name: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    std::fs::read_to_string(root.join(name)).unwrap()
}

/// The rows of the table with their licences, and the packages that the binaries do not
/// contain.
fn read_notices() -> (BTreeMap<Package, String>, BTreeSet<Package>) {
    let text = read_file("THIRD-PARTY.md");
    let (in_binaries, not_in_binaries) = text.split_once("\n## Not in the binaries\n").unwrap();
    let rows = in_binaries.lines().filter_map(|line| {
        let cells: Vec<&str> = line.strip_prefix("| ")?.split(" | ").collect();
        let [name, version, licence, ..] = cells[..] else {
            return None;
        };
        Some(((name.to_owned(), version.to_owned()), licence.to_owned()))
    });
    let others = not_in_binaries.lines().filter_map(|line| {
        let (name, version) = line.strip_prefix("- ")?.split_once(' ')?;
        Some((name.to_owned(), version.to_owned()))
    });
    let head = ("Package".to_owned(), "Version".to_owned());
    (rows.filter(|row| row.0 != head).collect(), others.collect())
}

/// The packages of Cargo.lock that come from a registry.
fn locked_packages() -> BTreeSet<Package> {
    let lock = read_file("Cargo.lock");
    let field = |package: &str, name: &str| {
        let start = format!("{name} = \"");
        let line = package.lines().find_map(|line| line.strip_prefix(&start));
        line.map(|value| value.trim_end_matches('"').to_owned())
    };
    lock.split("[[package]]")
        .filter(|package| field(package, "source").is_some())
        .filter_map(|package| Some((field(package, "name")?, field(package, "version")?)))
        .collect()
}

/// The packages that cargo links into the binary on this platform, with their licences.
fn linked_packages() -> BTreeMap<Package, String> {
    let output = Command::new(env!("CARGO"))
        .args(["tree", "--locked", "--offline", "-p", "gsk980td"])
        .args(["-e", "normal,no-proc-macro", "--prefix", "none"])
        .args(["--format", "{p}\t{l}"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{output:?}");
    let text = String::from_utf8(output.stdout).unwrap();
    let packages = text.lines().filter_map(|line| {
        let (package, licence) = line.trim_end_matches(" (*)").split_once('\t')?;
        let (name, version) = package.split_once(" v")?;
        // A package of the workspace has its folder after the version.
        let package = (name.to_owned(), version.to_owned());
        (!version.contains(' ')).then(|| (package, licence.to_owned()))
    });
    packages.collect()
}

#[test]
fn every_linked_package_is_named_with_its_licence() {
    let (named, _) = read_notices();
    let linked = linked_packages();
    assert!(linked.len() > 100, "{linked:?}");
    for (package, licence) in &linked {
        assert_eq!(named.get(package), Some(licence), "{package:?}: {ADVICE}");
    }
}

#[test]
fn the_notices_name_exactly_the_locked_packages() {
    let (named, others) = read_notices();
    let named: BTreeSet<Package> = named.into_keys().collect();
    assert!(named.is_disjoint(&others));
    let all: BTreeSet<Package> = named.union(&others).cloned().collect();
    let locked = locked_packages();
    let differ: Vec<_> = all.symmetric_difference(&locked).collect();
    assert!(differ.is_empty(), "{differ:?}: {ADVICE}");
}

#[test]
fn every_applied_licence_has_its_text() {
    let text = read_file("THIRD-PARTY.md");
    let applied: BTreeSet<&str> = text
        .lines()
        .filter_map(|line| line.strip_prefix("| ")?.split(" | ").nth(3))
        .flat_map(|licences| licences.split(" and "))
        .filter(|licence| !licence.starts_with('-') && *licence != "Taken")
        .collect();
    let excerpt = |licence: &str| match licence {
        "MIT" => "Permission is hereby granted, free of charge",
        "Apache-2.0" => "END OF TERMS AND CONDITIONS",
        "BSD-2-Clause" | "BSD-3-Clause" => "Redistribution and use in source and binary forms",
        "ISC" => "Permission to use, copy, modify, and/or distribute",
        "MPL-2.0" => "Exhibit B - \"Incompatible With Secondary Licenses\" Notice",
        "Unicode-3.0" => "UNICODE LICENSE V3",
        "Zlib" => "This software is provided 'as-is'",
        _ => "no text for this licence",
    };
    assert!(applied.len() >= 8, "{applied:?}");
    for licence in applied {
        assert!(text.contains(excerpt(licence)), "{licence}: {ADVICE}");
    }
    // The fonts are not packages.
    for words in ["SIL OPEN FONT LICENSE", "Copyright 2015 Google LLC"] {
        assert!(text.contains(words), "{words}: {ADVICE}");
    }
}

#[test]
fn the_binary_prints_the_notices() {
    let output = executable().arg("notices").output().unwrap();
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains(read_file("LICENSE-MIT").trim()));
    assert!(text.contains(read_file("NOTICE").trim()));
    assert!(
        text.trim_end()
            .ends_with(read_file("THIRD-PARTY.md").trim())
    );
}
