//! Names and comments of the sources use the field's words: none of those in
//! `tests/vocabulary.tsv`, which lists a better one for each.

use std::fs;

use gsk_tests::repository;
use gsk_tests::rust_text::{RustToken, split_tokens, split_words};
use gsk_tests::sources::{packages, rust_files};

/// A word or phrase that the sources avoid.
struct VocabularyEntry {
    in_names: bool,
    words: Vec<String>,
    better: String,
}

fn read_vocabulary() -> Vec<VocabularyEntry> {
    let path = repository().join("tests/vocabulary.tsv");
    let table = fs::read_to_string(path).expect("the vocabulary");
    let rows = table.lines().skip(1).map(|row| {
        let fields: Vec<&str> = row.split('\t').collect();
        let [kind, words, better, reason] = fields[..] else {
            panic!("four fields: {row}");
        };
        assert!(!reason.is_empty(), "a reason: {row}");
        assert!(matches!(kind, "name" | "prose"), "name or prose: {row}");
        VocabularyEntry {
            in_names: kind == "name",
            words: words.split(' ').map(str::to_owned).collect(),
            better: better.to_owned(),
        }
    });
    rows.collect()
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

fn split_passages(source: &str) -> Vec<Passage> {
    let mut passages: Vec<Passage> = Vec::new();
    for token in split_tokens(source) {
        let (line, in_names, words) = match token {
            RustToken::Identifier { name, line } => (line, true, split_words(&name)),
            RustToken::Comment { text, line } => (line, false, prose_words(&text)),
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

fn find_forbidden_words(vocabulary: &[VocabularyEntry], source: &str) -> Vec<(usize, String)> {
    let mut complaints = Vec::new();
    for passage in split_passages(source) {
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
    let vocabulary = read_vocabulary();
    let mut all = Vec::new();
    for package in packages() {
        let files = rust_files(&repository().join(&package));
        assert!(!files.is_empty(), "{package} has sources");
        for path in files {
            let source = fs::read_to_string(&path).expect("a source");
            let name = path.strip_prefix(repository()).expect("in the repository");
            for (line, complaint) in find_forbidden_words(&vocabulary, &source) {
                all.push(format!("{}:{line}: {complaint}", name.display()));
            }
        }
    }
    assert!(all.is_empty(), "{}\n{} places", all.join("\n"), all.len());
}

#[test]
fn words_are_found_in_names_and_comments_only() {
    let vocabulary = read_vocabulary();
    let lines = |source: &str| -> Vec<usize> {
        let complaints = find_forbidden_words(&vocabulary, source);
        complaints.into_iter().map(|(line, _)| line).collect()
    };
    assert_eq!(lines("fn told() {}\n/// Nobody.\n"), [1, 2]);
    assert_eq!(lines("// One.\n// It is\n// told.\n"), [2]);
    assert_eq!(lines("struct GoesOn;\n// it is\n// said\n"), [1, 2]);
    assert_eq!(lines("let a = \"told\"; // `told`, retold\n"), [0; 0]);
}
