//! Checks that the window has no text in its sources. Its texts are in the table of messages,
//! so that each exists in both languages.

use std::fs;
use std::path::{Path, PathBuf};

use gsk_tests::repository;

/// The folder of the window's sources.
const WINDOW_FOLDER: &str = "window/src";
/// Literals with this number of words count as a sentence.
const SENTENCE_WORDS: usize = 3;

/// Literals that are not shown as a sentence, and the reason.
const NOT_SHOWN: [(&str, &str); 2] = [
    ("parameters and offsets", "the name of a help topic"),
    ("tools and stock", "the name of a help topic"),
];

/// A string literal of a source and its line.
#[derive(Debug, PartialEq, Eq)]
struct StringLiteral {
    line: usize,
    text: String,
}

/// The string literals of a source without its tests and comments.
fn find_literals(source: &str) -> Vec<StringLiteral> {
    let code = source.split("#[cfg(test)]").next().unwrap_or(source);
    let mut found = Vec::new();
    let mut rest = code;
    while let Some(at) = rest.find(['"', '\'', '/']) {
        let (before, here) = rest.split_at(at);
        let passed = match here.as_bytes() {
            [b'/', b'/', ..] => here.find('\n').unwrap_or(here.len()),
            [b'"', ..] => {
                let raw = before.ends_with('r') || before.ends_with('#');
                assert!(!raw, "a raw string: {}", &here[..here.len().min(40)]);
                let length = string_length(here);
                found.push(StringLiteral {
                    line: line_number(code, here),
                    text: here[1..length - 1].replace("\\\n", " "),
                });
                length
            }
            [b'\'', ..] => character_length(here),
            _ => 1,
        };
        rest = &here[passed..];
    }
    found
}

/// Length in bytes of the string at the beginning of a text, with its quotation marks.
fn string_length(text: &str) -> usize {
    let mut escaped = false;
    for (at, character) in text.char_indices().skip(1) {
        match character {
            '"' if !escaped => return at + 1,
            '\\' => escaped = !escaped,
            _ => escaped = false,
        }
    }
    panic!("a string without end: {}", &text[..text.len().min(40)]);
}

/// Length in bytes of the character literal at the beginning of a text; 1 for a lifetime.
fn character_length(text: &str) -> usize {
    let mut characters = text.char_indices().skip(1);
    match (characters.next(), characters.next(), characters.next()) {
        // '\u{4e00}', '\'', '\n'
        (Some((_, '\\')), Some(_), Some((at, _))) => {
            text[at..].find('\'').map_or(1, |end| at + end + 1)
        }
        (Some(_), Some((at, '\'')), _) => at + 1,
        _ => 1,
    }
}

fn line_number(code: &str, rest: &str) -> usize {
    code[..code.len() - rest.len()].matches('\n').count() + 1
}

fn is_chinese(text: &str) -> bool {
    text.chars()
        .any(|letter| ('\u{3000}'..='\u{9fff}').contains(&letter))
}

/// Number of words of a literal: letters between spaces, without placeholders.
fn word_count(text: &str) -> usize {
    let mut outside = String::new();
    let mut depth = 0_u32;
    for character in text.chars() {
        match character {
            '{' => depth += 1,
            '}' => depth = depth.saturating_sub(1),
            _ if depth == 0 => outside.push(character),
            _ => {}
        }
    }
    let is_word = |word: &&str| {
        let word = word.trim_matches(|letter: char| !letter.is_alphanumeric());
        word.len() > 1 && word.chars().all(|letter| letter.is_ascii_alphabetic())
    };
    outside.split_whitespace().filter(is_word).count()
}

/// Whether a file is a source whose texts a user may see, and not one of tests.
fn is_shown_source(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    name.ends_with(".rs") && !name.ends_with("tests.rs")
}

fn collect(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("sources of the window") {
        let path = entry.expect("entry").path();
        if path.is_dir() {
            collect(&path, found);
        } else if is_shown_source(&path) {
            found.push(path);
        }
    }
}

#[test]
fn every_text_of_the_window_is_in_the_table_of_messages() {
    let mut files = Vec::new();
    collect(&repository().join(WINDOW_FOLDER), &mut files);
    files.sort();
    assert!(files.len() > 30, "the window is elsewhere now");
    let mut own = Vec::new();
    for path in &files {
        let source = fs::read_to_string(path).expect("a source");
        let name = path.strip_prefix(repository()).unwrap_or(path).display();
        for StringLiteral { line, text } in find_literals(&source) {
            let known = NOT_SHOWN.iter().any(|(literal, _)| *literal == text);
            if !known && (is_chinese(&text) || word_count(&text) >= SENTENCE_WORDS) {
                own.push(format!("{name}:{line}: {text}"));
            }
        }
    }
    assert!(
        own.is_empty(),
        "give each a row in assets/tables/messages.tsv:\n{}",
        own.join("\n")
    );
}

#[test]
fn every_exception_is_still_needed() {
    let mut files = Vec::new();
    collect(&repository().join(WINDOW_FOLDER), &mut files);
    let sources: Vec<String> = files
        .iter()
        .map(|path| fs::read_to_string(path).expect("a source"))
        .collect();
    for (literal, reason) in NOT_SHOWN {
        let quoted = format!("\"{literal}\"");
        let used = sources.iter().any(|source| source.contains(&quoted));
        assert!(used, "nobody says {quoted} any more ({reason})");
    }
}

#[test]
fn literals_are_found_and_comments_characters_and_lifetimes_are_none() {
    let source = "// \"no\"\nfn a<'a>(x: &'a str) { say('\"', \"two \\\" quotes\"); }\n\
                  const B: char = '\\''; /* */ \"运行\"\n#[cfg(test)]\n\"never\"";
    let expected = [(2, "two \\\" quotes"), (3, "运行")].map(|(line, text)| StringLiteral {
        line,
        text: text.to_owned(),
    });
    assert_eq!(find_literals(source), expected);
    assert!(is_chinese("运行") && !is_chinese("S: µm …"));
    assert_eq!(word_count("{name} came to no end in {seconds} s"), 5);
    assert_eq!(word_count("{:.1} r/min, X {x}"), 0);
}

/// Messages that the LCD shows as the control writes them.
const LCD_MESSAGES: [&str; 6] = [
    "lcd_",
    "page_",
    "panel_",
    "label_",
    "ladder_compiled",
    "ladder_not_compiled",
];

/// The first half-width sign after a Chinese character; `None` without one.
fn half_width_sign(text: &str) -> Option<char> {
    let signs: Vec<char> = text.chars().collect();
    signs.windows(2).find_map(|pair| {
        let is_chinese = ('\u{4e00}'..='\u{9fff}').contains(&pair[0]);
        (is_chinese && matches!(pair[1], ',' | ':' | ';' | '?' | '!')).then_some(pair[1])
    })
}

#[test]
fn chinese_messages_have_full_width_punctuation() {
    assert_eq!(half_width_sign("按 [自动], 再按 [运行]：N10"), None);
    assert_eq!(half_width_sign("程序: O0001"), Some(':'));
    let table = repository().join("assets/tables/messages.tsv");
    let table = fs::read_to_string(table).expect("the table of messages");
    let faults: Vec<String> = table
        .lines()
        .skip(1)
        .filter(|row| !LCD_MESSAGES.iter().any(|prefix| row.starts_with(prefix)))
        .filter_map(|row| {
            let chinese = row.split('\t').nth(2).unwrap_or_default();
            let sign = half_width_sign(chinese)?;
            Some(format!("{sign} in {row}"))
        })
        .collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
