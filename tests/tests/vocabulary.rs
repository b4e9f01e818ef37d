//! Names and comments of the sources use the field's words: none of those in
//! `tests/vocabulary.tsv`, which lists a better one for each.

use std::fs;
use std::path::{Path, PathBuf};

use gsk_tests::repository;
use gsk_tests::rust_text::{Token, tokens, words_of};

/// The packages that are held to the list; the others still have to be rewritten.
const REWRITTEN: [&str; 3] = ["link", "workpiece", "xtask"];

/// A word or phrase that the sources avoid.
struct Entry {
    in_names: bool,
    words: Vec<String>,
    better: String,
}

fn vocabulary() -> Vec<Entry> {
    let path = repository().join("tests/vocabulary.tsv");
    let table = fs::read_to_string(path).expect("the vocabulary");
    let rows = table.lines().skip(1).map(|row| {
        let fields: Vec<&str> = row.split('\t').collect();
        let [kind, words, better, reason] = fields[..] else {
            panic!("four fields: {row}");
        };
        assert!(!reason.is_empty(), "a reason: {row}");
        assert!(matches!(kind, "name" | "prose"), "name or prose: {row}");
        Entry {
            in_names: kind == "name",
            words: words.split(' ').map(str::to_owned).collect(),
            better: better.to_owned(),
        }
    });
    rows.collect()
}

fn rust_files(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            rust_files(&path, files);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
}

/// The words of a comment in lower case, without quoted code and marks.
fn prose_words(text: &str) -> Vec<String> {
    let outside = text.split('`').step_by(2).collect::<Vec<_>>().join(" | ");
    let words = outside.split(|letter: char| !letter.is_alphanumeric() && letter != '|');
    let words = words.filter(|word| !word.is_empty());
    words.map(str::to_lowercase).collect()
}

/// Words that belong together, each with its line: a name, or a comment of several lines.
struct Passage {
    in_names: bool,
    words: Vec<(String, usize)>,
    last_line: usize,
}

fn passages(source: &str) -> Vec<Passage> {
    let mut passages: Vec<Passage> = Vec::new();
    for token in tokens(source) {
        let (line, in_names, words) = match token {
            Token::Identifier { name, line } => (line, true, words_of(&name)),
            Token::Comment { text, line } => (line, false, prose_words(&text)),
        };
        let words = words.into_iter().map(|word| (word, line));
        match passages.last_mut() {
            Some(last) if !in_names && !last.in_names && last.last_line + 1 == line => {
                last.words.extend(words);
                last.last_line = line;
            }
            _ => passages.push(Passage {
                in_names,
                words: words.collect(),
                last_line: line,
            }),
        }
    }
    passages
}

fn complaints(vocabulary: &[Entry], source: &str) -> Vec<(usize, String)> {
    let mut complaints = Vec::new();
    for passage in passages(source) {
        let entries = vocabulary.iter();
        for entry in entries.filter(|entry| entry.in_names == passage.in_names) {
            for window in passage.words.windows(entry.words.len()) {
                if window.iter().map(|(word, _)| word).eq(&entry.words) {
                    let text = format!("`{}`: write {}", entry.words.join(" "), entry.better);
                    complaints.push((window[0].1, text));
                }
            }
        }
    }
    complaints
}

#[test]
fn sources_use_the_words_of_the_field() {
    let vocabulary = vocabulary();
    let mut all = Vec::new();
    for package in REWRITTEN {
        let mut files = Vec::new();
        rust_files(&repository().join(package), &mut files);
        assert!(!files.is_empty(), "{package} has sources");
        files.sort();
        for path in files {
            let source = fs::read_to_string(&path).expect("a source");
            let name = path.strip_prefix(repository()).expect("in the repository");
            for (line, complaint) in complaints(&vocabulary, &source) {
                all.push(format!("{}:{line}: {complaint}", name.display()));
            }
        }
    }
    assert!(all.is_empty(), "{}\n{} places", all.join("\n"), all.len());
}

#[test]
fn words_are_found_in_names_and_comments_only() {
    let vocabulary = vocabulary();
    let lines = |source: &str| -> Vec<usize> {
        let complaints = complaints(&vocabulary, source);
        complaints.into_iter().map(|(line, _)| line).collect()
    };
    assert_eq!(lines("fn told() {}\n/// Nobody.\n"), [1, 2]);
    assert_eq!(lines("// One.\n// It is\n// told.\n"), [2]);
    assert_eq!(lines("struct GoesOn;\n// it is\n// said\n"), [1, 2]);
    assert_eq!(lines("let a = \"told\"; // `told`, retold\n"), [0; 0]);
}
