//! Checks the register `docs/decisions.md`: every decision has a permanent id of its section,
//! and every citation names an existing decision.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use gsk_tests::repository;

/// The register.
const REGISTER: &str = "docs/decisions.md";
/// Where decisions are cited: the packages, the documents, the tables.
const CITING_PATHS: [&str; 12] = [
    "app",
    "assets",
    "commission",
    "core",
    "docs",
    "host",
    "panel",
    "plc",
    "project",
    "tests",
    "twins",
    "window",
];
/// Extensions of hand-written files.
const TEXT_EXTENSIONS: [&str; 7] = ["il", "md", "nc", "ron", "rs", "tsv", "txt"];

/// The key in a heading: `## Zero return (ZERO)`.
fn heading_key(heading: &str) -> Option<&str> {
    heading
        .strip_prefix("## ")?
        .strip_suffix(')')?
        .split_once(" (")
        .map(|(_, key)| key)
}

/// Whether a word is a capital key: `G71`, `ZERO`.
fn is_key(word: &str) -> bool {
    let capital = |letter: char| letter.is_ascii_uppercase() || letter.is_ascii_digit();
    !word.is_empty() && word.chars().all(capital)
}

/// The ids of the register in their order, and its faults.
fn register_ids(register: &str) -> (Vec<String>, Vec<String>) {
    let (mut ids, mut faults) = (Vec::new(), Vec::new());
    let mut chapters = BTreeSet::new();
    let (mut chapter, mut count) = ("", 0);
    for line in register.lines() {
        if line.starts_with("## ") {
            (chapter, count) = (heading_key(line).unwrap_or_default(), 0);
            if !is_key(chapter) || !chapters.insert(chapter) {
                faults.push(format!("{line}: needs a key that no other chapter has"));
            }
        }
        let Some(row) = line.strip_prefix("| ") else {
            continue;
        };
        let cells: Vec<&str> = row.trim_end_matches(" |").split(" | ").collect();
        let id = cells[0];
        if id == "Id" {
            continue;
        }
        count += 1;
        if id != format!("{chapter}-{count}") {
            faults.push(format!("{id}: {chapter}-{count} comes next"));
        }
        if cells.len() != 4 || cells.iter().any(|cell| cell.trim().is_empty()) {
            faults.push(format!(
                "{id}: open point, decision and reason, three cells"
            ));
        }
        ids.push(id.to_owned());
    }
    (ids, faults)
}

/// The ids that a text cites: the word `decision`, a space, the id.
fn cited_ids(text: &str) -> Vec<&str> {
    let after = text.split("ecision ").skip(1);
    after.filter_map(leading_id).collect()
}

/// The id at the beginning of a text.
fn leading_id(text: &str) -> Option<&str> {
    let (key, rest) = text.split_once('-')?;
    let end = rest
        .find(|letter: char| !letter.is_ascii_digit())
        .unwrap_or(rest.len());
    (is_key(key) && end > 0).then(|| &text[..=key.len() + end])
}

/// The texts of a folder, and with `deep` of its subfolders.
fn collect_texts(folder: &Path, deep: bool, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("folder") {
        let path = entry.expect("entry").path();
        let ending = path.extension().unwrap_or_default();
        if path.is_dir() && deep {
            collect_texts(&path, deep, found);
        } else if path.is_file() && TEXT_EXTENSIONS.iter().any(|text| ending == *text) {
            found.push(path);
        }
    }
}

#[test]
fn every_decision_has_an_id_and_every_citation_a_decision() {
    let register = fs::read_to_string(repository().join(REGISTER)).expect(REGISTER);
    let (ids, mut faults) = register_ids(&register);
    assert!(ids.len() > 300, "{} decisions", ids.len());
    let ids: BTreeSet<String> = ids.into_iter().collect();
    let mut files = Vec::new();
    collect_texts(&repository(), false, &mut files);
    for place in CITING_PATHS {
        collect_texts(&repository().join(place), true, &mut files);
    }
    for path in files {
        let bytes = fs::read(&path).expect("file");
        let text = String::from_utf8_lossy(&bytes);
        let strange = cited_ids(&text).into_iter().filter(|id| !ids.contains(*id));
        faults.extend(strange.map(|id| format!("{}: there is no {id}", path.display())));
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn a_gap_a_wrong_chapter_and_a_key_twice_are_seen() {
    let register = "## Arcs (ARC)\n| Id | a | b | c |\n|---|\n| ARC-1 | a | b | c |\n\
                    | ARC-3 | a | b | c |\n## Bows (ARC)\n| LINE-1 | a | b |\n";
    let (ids, faults) = register_ids(register);
    assert_eq!(ids, ["ARC-1", "ARC-3", "LINE-1"]);
    assert_eq!(
        faults,
        [
            "ARC-3: ARC-2 comes next",
            "## Bows (ARC): needs a key that no other chapter has",
            "LINE-1: ARC-1 comes next",
            "LINE-1: open point, decision and reason, three cells",
        ]
    );
}

#[test]
fn a_citation_is_the_word_and_an_id() {
    let word = "decision";
    let text = format!("by {word} ARC-12, {word} G71-3. no {word} yet-1; a {word} X- and");
    assert_eq!(cited_ids(&text), ["ARC-12", "G71-3"]);
}
