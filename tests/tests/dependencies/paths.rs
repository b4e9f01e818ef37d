//! Finds the paths that a source file names: those that begin with `crate`, `super` or `self`,
//! and those of the workspace's libraries.

use std::fs;
use std::path::Path;

use gsk_tests::repository;

/// A path in a source, without its tests: `["crate", "alarm", "Alarm"]`.
#[derive(Debug, PartialEq, Eq)]
pub struct UsedPath {
    pub line: usize,
    pub segments: Vec<String>,
}

/// A source file and its module: `operation/board.rs` is `["operation", "board"]`.
pub struct ModuleSource {
    pub file: String,
    pub module: Vec<String>,
    pub names: Vec<UsedPath>,
}

/// All sources below a folder except tests, sorted by name.
pub fn sources(src: &Path) -> Vec<ModuleSource> {
    let mut found = Vec::new();
    walk(src, &mut Vec::new(), &mut found);
    found
}

fn walk(folder: &Path, above: &mut Vec<String>, found: &mut Vec<ModuleSource>) {
    let entries = fs::read_dir(folder).expect("a folder of sources");
    let mut paths: Vec<_> = entries.map(|entry| entry.expect("entry").path()).collect();
    paths.sort();
    for path in paths {
        let stem = path.file_stem().expect("name").to_string_lossy();
        if stem == "tests" || stem.ends_with("_tests") {
            continue;
        }
        let mut module = above.clone();
        if path.is_dir() {
            above.push(stem.into_owned());
            walk(&path, above, found);
            above.pop();
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            if !matches!(&*stem, "mod" | "lib" | "main") {
                module.push(stem.into_owned());
            }
            let text = fs::read_to_string(&path).expect("a source");
            let file = path.strip_prefix(repository()).unwrap_or(&path);
            found.push(ModuleSource {
                file: file.display().to_string(),
                module,
                names: used_paths(&text),
            });
        }
    }
}

/// The paths in a text.
fn used_paths(text: &str) -> Vec<UsedPath> {
    let tokens = tokens(text);
    let mut named = Vec::new();
    for (at, (line, token)) in tokens.iter().enumerate() {
        let begins = matches!(&**token, "crate" | "super" | "self") || token.starts_with("gsk_");
        let continues_path = at > 0 && tokens[at - 1].1 == "::";
        if begins && !continues_path {
            let mut paths = Vec::new();
            read_use_tree(&tokens, at, &mut Vec::new(), &mut paths);
            let library = token.starts_with("gsk_");
            let paths = paths
                .into_iter()
                .filter(|segments| library || segments.len() > 1);
            named.extend(paths.map(|segments| UsedPath {
                line: *line,
                segments,
            }));
        }
    }
    named
}

/// Reads one path with the content of its braces. Returns the position after it.
fn read_use_tree(
    tokens: &[(usize, String)],
    mut at: usize,
    before: &mut Vec<String>,
    paths: &mut Vec<Vec<String>>,
) -> usize {
    let token = |at: usize| tokens.get(at).map_or("", |(_, token)| token);
    let depth = before.len();
    if token(at) == "{" {
        while !matches!(token(at), "}" | "") {
            at = read_use_tree(tokens, at + 1, before, paths);
            while !matches!(token(at), "," | "}" | "") {
                at += 1;
            }
        }
        return at + 1;
    }
    if is_word(token(at)) {
        before.push(token(at).to_owned());
        at += 1;
        if token(at) == "::" {
            at = read_use_tree(tokens, at + 1, before, paths);
        } else {
            paths.push(before.clone());
        }
    } else {
        paths.push(before.clone());
    }
    before.truncate(depth);
    at
}

fn is_word(token: &str) -> bool {
    token.starts_with(|letter: char| letter.is_alphabetic() || letter == '_')
}

/// Words, `::` and single signs with their lines, without comments and tests.
fn tokens(text: &str) -> Vec<(usize, String)> {
    let mut tokens: Vec<(usize, String)> = Vec::new();
    for (line, text) in without_tests(text) {
        let code = text.split("//").next().unwrap_or_default();
        let mut word = String::new();
        for letter in code.chars().chain([' ']) {
            if letter.is_alphanumeric() || letter == '_' {
                word.push(letter);
                continue;
            }
            if !word.is_empty() {
                tokens.push((line, std::mem::take(&mut word)));
            }
            match tokens.last_mut() {
                Some((_, last)) if letter == ':' && last == ":" => last.push(':'),
                _ if letter != ' ' => tokens.push((line, letter.to_string())),
                _ => (),
            }
        }
    }
    tokens
}

/// The lines of a text, numbered from 1, without the items under `#[cfg(test)]`. These end
/// as formatted by rustfmt: with a semicolon, or with a brace at their own indentation.
fn without_tests(text: &str) -> Vec<(usize, &str)> {
    let mut lines = (1..).zip(text.lines());
    let mut kept = Vec::new();
    while let Some((number, line)) = lines.next() {
        if line.trim() != "#[cfg(test)]" {
            kept.push((number, line));
            continue;
        }
        let inset = &line[..line.len() - line.trim_start().len()];
        let end = format!("{inset}}}");
        let mut begun = false;
        for (_, line) in lines.by_ref() {
            let whole = !begun && line.ends_with(';');
            begun |= !line.trim_start().starts_with("#[");
            if whole || line == end {
                break;
            }
        }
    }
    kept
}

#[test]
fn paths_are_found_in_uses_and_in_code() {
    let text = "\
use crate::alarm::Alarm;
use super::{
    board::{self, Drives},
    manual,
};
pub(crate) fn at(self) -> crate::units::Point {
    self.take() // crate::comment
}
#[cfg(test)]
#[path = \"edit_tests.rs\"]
mod tests;
use gsk_link::Pin;
#[cfg(test)]
mod tests {
    use crate::unseen;
}
";
    let found: Vec<(usize, String)> = used_paths(text)
        .into_iter()
        .map(|named| (named.line, named.segments.join("::")))
        .collect();
    let expected = [
        (1, "crate::alarm::Alarm"),
        (2, "super::board::self"),
        (2, "super::board::Drives"),
        (2, "super::manual"),
        (6, "crate::units::Point"),
        (12, "gsk_link::Pin"),
    ];
    assert_eq!(found, expected.map(|(line, path)| (line, path.to_owned())));
}
