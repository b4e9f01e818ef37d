//! Finding the subprograms of a program in the folder it lies in.
//!
//! `M98 P…`, `G65 P…` and `G66 P…` are looked for in the text, and the codes that call by themselves when
//! 006.5 is set: `M61` O9061, `S21` O9121, `T15` O9215. A number that no loaded
//! program has is searched beside the file, by name first (`O1002.CNC`, `1002.nc`),
//! then by the O word that a small file starts with. What stays missing is reported by
//! the control itself when the call is reached (alarm 078).

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::program_file;
use crate::platform;

/// Endings of files that are opened only to look for their O word.
const PROGRAM_ENDINGS: [&str; 9] = ["", "cnc", "nc", "txt", "tap", "gcode", "ngc", "min", "prg"];
/// The most files of a folder that are looked into.
const MOST_FILES: usize = 2000;
/// How much of a file is read to find its O word.
const HEAD_BYTES: u64 = 4096;

/// A subprogram found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Found {
    /// Its number.
    pub number: u16,
    /// Where.
    pub path: PathBuf,
    /// Its text.
    pub text: String,
}

/// Searches the folder of `main` for the programs that it `calls` and that are not in
/// `loaded`, and for those that they call.
pub fn find(main: &Path, calls: BTreeSet<u16>, loaded: &BTreeSet<u16>) -> Vec<Found> {
    if calls.is_subset(loaded) {
        return Vec::new();
    }
    let read = |path: &Path| program_file::read(path).ok().map(|file| file.text);
    find_among(&beside(main), calls, loaded, &read)
}

/// As [`find`], among programs that are known by number; `read` gives their texts.
pub fn find_among(
    index: &BTreeMap<u16, PathBuf>,
    calls: BTreeSet<u16>,
    loaded: &BTreeSet<u16>,
    read: &dyn Fn(&Path) -> Option<String>,
) -> Vec<Found> {
    let mut wanted: Vec<u16> = calls.into_iter().collect();
    let mut known = loaded.clone();
    let mut found = Vec::new();
    while let Some(number) = wanted.pop() {
        if !known.insert(number) {
            continue;
        }
        let Some(path) = index.get(&number) else {
            continue;
        };
        let Some(text) = read(path) else {
            continue;
        };
        wanted.extend(self::calls(&text));
        found.push(Found {
            number,
            path: path.clone(),
            text,
        });
    }
    found.sort_by_key(|found| found.number);
    found
}

/// The M codes of every machine: they call nothing.
const MACHINE_CODES: [u16; 20] = [
    0, 2, 3, 4, 5, 8, 9, 10, 11, 12, 13, 30, 32, 33, 41, 42, 43, 44, 98, 99,
];

/// The program numbers that a text calls outside comments: by `M98 P…`, `G65 P…` and
/// `G66 P…` the last four digits of P, by an M, S or T code its own.
pub fn calls(text: &str) -> BTreeSet<u16> {
    let mut numbers = BTreeSet::new();
    for line in lines_that_may_call(text) {
        let upper = code_of(line);
        if (upper.contains("M98") || calls_macro(&upper))
            && let Some(at) = upper.find('P')
            && let Some(number) = last_four(leading_digits(&upper[at + 1..]))
        {
            numbers.insert(number);
        }
        numbers.extend(special_calls(&upper));
    }
    numbers
}

/// Whether a block calls a macro: G66, or G65 that is no operation of macro A.
fn calls_macro(block: &str) -> bool {
    block.contains("G66") || block.contains("G65") && !block.contains("G65H")
}

/// The lines that have a letter of a call. Most lines of a long program have none: no
/// more is done with them than to look at their bytes.
fn lines_that_may_call(text: &str) -> impl Iterator<Item = &str> {
    let mut rest = text;
    core::iter::from_fn(move || {
        let letter = first_that_may_call(rest.as_bytes())?;
        let start = rest[..letter].rfind('\n').map_or(0, |end| end + 1);
        let line = &rest[start..];
        let (line, behind) = line.split_once('\n').unwrap_or((line, ""));
        rest = behind;
        Some(line)
    })
}

/// The first byte that may be one of M, P, S and T, or of their full-width forms.
fn first_that_may_call(bytes: &[u8]) -> Option<usize> {
    let may_call = |byte: &u8| {
        let small = byte | 0x20;
        small == b'm' || small == b'p' || small == b's' || small == b't' || *byte >= 0x80
    };
    // Many at once first: this is what the processor does best.
    let mut from = 0;
    for many in bytes.chunks(MANY) {
        if many.iter().fold(false, |any, byte| any | may_call(byte)) {
            break;
        }
        from += many.len();
    }
    let rest = bytes.get(from..)?;
    Some(from + rest.iter().position(may_call)?)
}

/// Bytes that are looked at together.
const MANY: usize = 64;

/// The programs of the codes in a block that may call one (006.5): an M that is no
/// machine function, S and T of two digits.
fn special_calls(block: &str) -> impl Iterator<Item = u16> {
    block
        .match_indices(['M', 'S', 'T'])
        .filter_map(|(at, word)| {
            let digits = leading_digits(&block[at + 1..]);
            let code = last_four(digits)?;
            let two = digits.len() == 2 && code >= 10;
            match word {
                "M" if digits.len() <= 2 && !MACHINE_CODES.contains(&code) => Some(9000 + code),
                "S" if two => Some(9100 + code),
                "T" if two => Some(9200 + code),
                _ => None,
            }
        })
}

fn leading_digits(text: &str) -> &str {
    let end = text.bytes().take_while(u8::is_ascii_digit).count();
    &text[..end]
}

/// The number of the last four digits; `None` without a digit.
fn last_four(digits: &str) -> Option<u16> {
    digits[digits.len().saturating_sub(4)..].parse().ok()
}

/// A line without comment and blanks, full-width letters and digits as ASCII.
fn code_of(line: &str) -> String {
    let code = line.split('(').next().unwrap_or_default();
    let code = code.chars().filter_map(|character| match character {
        '\u{FF01}'..='\u{FF5E}' => char::from_u32(u32::from(character) - 0xFEE0),
        ' ' | '\t' | '\u{3000}' => None,
        other => Some(other),
    });
    code.collect::<String>().to_ascii_uppercase()
}

/// The programs beside a file, by number; a name counts more than an O word,
/// and of two equals the first in alphabetical order.
pub fn beside(main: &Path) -> BTreeMap<u16, PathBuf> {
    let folder = main
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    let Ok(mut paths) = platform::list(folder.unwrap_or(Path::new("."))) else {
        return BTreeMap::new();
    };
    paths.retain(|path| path != main);
    paths.sort();
    let mut by_number = BTreeMap::new();
    for path in &paths {
        if let Some(number) = number_in_name(path)
            && is_file(path)
        {
            by_number.entry(number).or_insert_with(|| path.clone());
        }
    }
    for path in paths
        .iter()
        .filter(|path| has_program_ending(path))
        .take(MOST_FILES)
    {
        if let Some(number) = number_in_head(path) {
            by_number.entry(number).or_insert_with(|| path.clone());
        }
    }
    by_number
}

/// The number that a file of this name would be found by.
pub fn number_in_name(path: &Path) -> Option<u16> {
    if !has_program_ending(path) {
        return None;
    }
    let stem = path.file_stem()?.to_str()?;
    let digits = stem.strip_prefix(['O', 'o']).unwrap_or(stem);
    let plain = (1..=4).contains(&digits.len()) && digits.bytes().all(|byte| byte.is_ascii_digit());
    plain.then(|| digits.parse().ok())?
}

/// The number of the O word that a file begins with.
pub fn number_in_head(path: &Path) -> Option<u16> {
    if !is_file(path) {
        return None;
    }
    let head = platform::read(path, HEAD_BYTES).ok()?;
    let head = String::from_utf8_lossy(&head);
    let line = head
        .lines()
        .map(code_of)
        .find(|line| !line.is_empty() && line != "%")?;
    let digits: String = line
        .strip_prefix('O')?
        .chars()
        .take_while(char::is_ascii_digit)
        .collect();
    digits.parse().ok().filter(|number| *number <= 9999)
}

fn is_file(path: &Path) -> bool {
    platform::facts(path).is_ok_and(|facts| facts.is_file)
}

fn has_program_ending(path: &Path) -> bool {
    program_ending(path).is_some()
}

/// The ending of a file in small letters, if programs have such.
pub fn program_ending(path: &Path) -> Option<&'static str> {
    let ending = path
        .extension()
        .map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    let ending = ending.unwrap_or_default();
    PROGRAM_ENDINGS.into_iter().find(|known| *known == ending)
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn calls_are_found_through_comments_blanks_and_counts() {
        let text =
            "N10 M98 P51002;\nm 98 p 7 (M98 P9)\n(M98 P8)\nM98 P12345678\nＭ９８ Ｐ３\nM99 P20\n";
        assert_eq!(
            calls(text).into_iter().collect::<Vec<_>>(),
            [3, 7, 1002, 5678]
        );
    }

    #[test]
    fn macros_are_called_by_g65_and_g66() {
        let text = "N10 G65 P9010 A1.0\nG65 A1 P9011\nG66 P9012 Z1\nG65 H80 P10\nG04 P500\n";
        assert_eq!(
            calls(text).into_iter().collect::<Vec<_>>(),
            [9010, 9011, 9012]
        );
    }

    #[test]
    fn codes_without_a_function_call_programs_of_their_own() {
        let text = "M61\nN10 G01 X1 M03 S500 T0101\nm 62 (M63)\nS21 M8\nT15\nS9 T5 M100 M30\n";
        assert_eq!(
            calls(text).into_iter().collect::<Vec<_>>(),
            [9061, 9062, 9121, 9215]
        );
    }

    #[test]
    fn the_folder_is_searched_by_name_then_by_o_word_and_on_from_there() {
        let folder = crate::files::test_folder("subprograms");
        let put = |name: &str, text: &str| {
            fs::write(folder.join(name), text).expect("write");
        };
        put("main.CNC", "O1\nM98 P2\nM98 P5\n");
        put("O0002.nc", "O0002\nM98 P3\nM99\n");
        put("groove.txt", "%\nO0003 (groove)\nM98 P1\nM98 P2\nM99\n");
        put("zz.txt", "O0003\nM99\n");
        put("picture.png", "O0005\n");
        let main = folder.join("main.CNC");
        let text = fs::read_to_string(&main).expect("read");
        let found = find(&main, calls(&text), &BTreeSet::from([1]));
        let names: Vec<_> = found
            .iter()
            .map(|found| (found.number, found.path.file_name()))
            .collect();
        assert_eq!(
            names,
            [
                (2, Some("O0002.nc".as_ref())),
                (3, Some("groove.txt".as_ref()))
            ]
        );
    }
}
