//! A public type name is unique in the workspace: a search for it finds one definition.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use gsk_tests::repository;
use gsk_tests::rust_text::{RustToken, split_tokens};
use gsk_tests::sources::{packages, rust_files};

/// Names that each system defines for itself: the modules of `host/src/platform` have one
/// interface.
const SYSTEM_NAMES: [&str; 9] = [
    "BrokerStream",
    "DisplayServer",
    "HolderConnection",
    "Lock",
    "LogFile",
    "Player",
    "ProgramConnection",
    "Serial",
    "TaskHandle",
];

/// The names of types that are public in the package or beyond, each with its line.
fn public_types(source: &str) -> Vec<(String, usize)> {
    let names: Vec<(String, usize)> = split_tokens(source)
        .into_iter()
        .filter_map(|token| match token {
            RustToken::Identifier { name, line } => Some((name, line)),
            RustToken::Comment { .. } => None,
        })
        .collect();
    let is_definition = |word: &str| matches!(word, "struct" | "enum" | "trait" | "type" | "union");
    let definitions = (1..names.len().saturating_sub(1)).filter(|at| {
        let before = |back: usize| at.checked_sub(back).map(|at| names[at].0.as_str());
        is_definition(&names[*at].0)
            && (before(1) == Some("pub")
                || (before(1) == Some("crate") && before(2) == Some("pub")))
    });
    definitions.map(|at| names[at + 1].clone()).collect()
}

fn is_system_file(path: &Path) -> bool {
    path.starts_with(repository().join("host/src/platform"))
}

#[test]
fn public_type_names_are_unique() {
    let mut definitions: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for package in packages() {
        for path in rust_files(&repository().join(&package).join("src")) {
            let source = fs::read_to_string(&path).expect("a source");
            let file = path.strip_prefix(repository()).expect("in the repository");
            for (name, line) in public_types(&source) {
                if is_system_file(&path) && SYSTEM_NAMES.contains(&name.as_str()) {
                    continue;
                }
                let place = format!("{}:{line}", file.display());
                definitions.entry(name).or_default().push(place);
            }
        }
    }
    assert!(definitions.len() > 500, "the sources were read");
    let double = definitions.iter().filter(|(_, places)| places.len() > 1);
    let double: Vec<String> = double
        .map(|(name, places)| format!("{name}: {}", places.join(", ")))
        .collect();
    assert!(double.is_empty(), "{}", double.join("\n"));
}

#[test]
fn only_public_definitions_count() {
    let names = |source: &str| -> Vec<String> {
        let types = public_types(source);
        types.into_iter().map(|(name, _)| name).collect()
    };
    assert_eq!(names("pub struct A;\npub(crate) enum B {}\n"), ["A", "B"]);
    assert_eq!(names("struct A;\npub(super) struct B;\n"), [""; 0]);
    assert_eq!(
        names("// pub struct A;\npub fn a() -> &str { \"pub enum B\" }"),
        [""; 0]
    );
}
