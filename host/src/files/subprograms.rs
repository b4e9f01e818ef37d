//! Finds the subprograms of a program in its folder: one rule for all models and all
//! commands.
//!
//! The text is searched for calls:
//! * `M98 P…`, `G65 P…` and `G66 P…`,
//! * `G20 N…` where that is a call (Huaxing),
//! * G, M and T codes that call by parameters or numbers of the model (macro B, 6044 to 6046
//!   and M9000 to M9999 of the mill),
//! * on lathes the codes that call when 006.5 is set: `M61` O9061, `S21` O9121, `T15` O9215.
//!
//! A call whose number is a variable may call each program of the folder. A number that no
//! loaded program has is searched in the folder, first by file name (`O1002.CNC`, `1002.nc`,
//! `P33.nc`), then by the O word or the `%P33` at the start of a file. The control itself
//! reports a missing program when the call is executed (alarm 078).

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use gsk_core::model::{ControlModel, GCode};
use gsk_core::program::find_call_candidate;

use super::program_file;
use crate::platform;

/// Extensions of the files that are searched for an O word; empty: no extension.
const PROGRAM_ENDINGS: [&str; 9] = ["", "cnc", "nc", "txt", "tap", "gcode", "ngc", "min", "prg"];
/// Maximum number of files of a folder that are searched for an O word.
const MAX_FILES: usize = 2000;
/// Number of bytes at the start of a file that are searched for an O word.
const HEAD_BYTES: u64 = 4096;

/// A subprogram file that was found in a folder, with its number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FoundSubprogram {
    pub number: u16,
    pub path: PathBuf,
    pub text: String,
    /// True if a call names the number of the program; false if only a variable may select it.
    pub called_by_number: bool,
}

/// The numbers of the programs that a text calls.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SubprogramCalls {
    /// Program numbers that the calls name, or that follow from a code such as M, S or T.
    pub numbers: BTreeSet<u16>,
    /// True if a variable gives the number of a called program, which may then be any.
    pub by_variable: bool,
}

impl SubprogramCalls {
    /// Adds the calls of another program text.
    pub fn extend(&mut self, other: Self) {
        self.numbers.extend(other.numbers);
        self.by_variable |= other.by_variable;
    }
}

/// Searches the folder of `main` for called programs that are not in `loaded`, and for those
/// that they call in turn.
pub fn find_called(
    main: &Path,
    calls: SubprogramCalls,
    loaded: &BTreeSet<u16>,
    model: &ControlModel,
) -> Vec<FoundSubprogram> {
    if !calls.by_variable && calls.numbers.is_subset(loaded) {
        return Vec::new();
    }
    let read = |path: &Path| program_file::read(path).ok().map(|file| file.text);
    find_in_index(&index_folder(main), calls, loaded, model, &read)
}

/// Like [`find_called`], in an index of programs by number; `read` returns the text of a file.
pub fn find_in_index(
    index: &BTreeMap<u16, PathBuf>,
    calls: SubprogramCalls,
    loaded: &BTreeSet<u16>,
    model: &ControlModel,
    read: &dyn Fn(&Path) -> Option<String>,
) -> Vec<FoundSubprogram> {
    let mut pending: Vec<(u16, bool)> = Vec::new();
    let push_calls = |pending: &mut Vec<(u16, bool)>, calls: SubprogramCalls| {
        // The stack returns the certain calls first.
        if calls.by_variable {
            pending.extend(index.keys().map(|number| (*number, false)));
        }
        pending.extend(calls.numbers.into_iter().map(|number| (number, true)));
    };
    push_calls(&mut pending, calls);
    let mut visited = loaded.clone();
    let mut found = Vec::new();
    while let Some((number, called_by_number)) = pending.pop() {
        if !visited.insert(number) {
            continue;
        }
        let Some(path) = index.get(&number) else {
            continue;
        };
        let Some(text) = read(path) else {
            continue;
        };
        push_calls(&mut pending, find_calls(&text, model));
        found.push(FoundSubprogram {
            number,
            path: path.clone(),
            text,
            called_by_number,
        });
    }
    found.sort_by_key(|found| found.number);
    found
}

/// The calls of a text outside comments. P of M98, G65 and G66 gives the number by its last
/// four digits, N of a Huaxing call the whole number; other codes follow the model.
pub fn find_calls(text: &str, model: &ControlModel) -> SubprogramCalls {
    let record = model.record();
    let call_by_n = record.g_number(GCode::SubprogramCall);
    let g_can_call = call_by_n.is_some() || model.has_g_calls();
    let mut calls = SubprogramCalls::default();
    for line in candidate_lines(text, g_can_call) {
        let upper = strip_line(line);
        let rules = CallRules {
            model,
            call_by_n,
            codes_can_call: !model.id().is_mill(),
        };
        rules.add_calls_in_block(&upper, &mut calls);
    }
    calls
}

/// Rules by which the blocks of a control model call programs.
struct CallRules<'a> {
    model: &'a ControlModel,
    /// The G code that calls the program named by N; `None` if the model has no such code.
    call_by_n: Option<u8>,
    /// Whether M, S and T codes without a machine function call a program (parameter 006.5).
    codes_can_call: bool,
}

impl CallRules<'_> {
    fn add_calls_in_block(&self, block: &str, calls: &mut SubprogramCalls) {
        if (block.contains("M98") || calls_macro(block))
            && let Some(at) = block.find('P')
        {
            let after = &block[at + 1..];
            calls
                .numbers
                .extend(parse_last_four_digits(leading_digits(after)));
            calls.by_variable |= after.starts_with(['#', '[']);
        }
        let mut by_n = false;
        let letters = block.match_indices(|letter: char| letter.is_ascii_uppercase());
        for (at, letter) in letters {
            let digits = leading_digits(&block[at + 1..]);
            let Ok(code) = digits.parse::<i64>() else {
                continue;
            };
            let letter = letter.as_bytes()[0];
            if letter == b'N' && by_n {
                calls.numbers.extend(u16::try_from(code).ok());
            }
            by_n |= letter == b'G' && Some(code) == self.call_by_n.map(i64::from);
            let by_model = self.model.called_program(letter, code);
            calls.numbers.extend(by_model);
            if self.codes_can_call && by_model.is_none() {
                calls
                    .numbers
                    .extend(self.find_special_program(letter, digits));
            }
        }
    }

    /// Number of the program that a code calls if parameter 006.5 permits it: an M code
    /// without a machine function, or an S or T code of two digits. `None` for other codes.
    fn find_special_program(&self, letter: u8, digits: &str) -> Option<u16> {
        let code = parse_last_four_digits(digits)?;
        let is_two_digits = digits.len() == 2 && code >= 10;
        match letter {
            b'M' if digits.len() <= 2 => {
                let function = self.model.record().m_function(code as u8);
                function.is_none().then_some(9000 + code)
            }
            b'S' if is_two_digits => Some(9100 + code),
            b'T' if is_two_digits => Some(9200 + code),
            _ => None,
        }
    }
}

/// Whether a block calls a macro: by G66, or by G65 without an H word (macro A).
fn calls_macro(block: &str) -> bool {
    block.contains("G66") || block.contains("G65") && !block.contains("G65H")
}

/// The lines of `text` that contain a letter of a call. Of the other lines, most of a long
/// program, only the bytes are scanned.
fn candidate_lines(text: &str, g_can_call: bool) -> impl Iterator<Item = &str> {
    let mut rest = text;
    core::iter::from_fn(move || {
        let letter = find_call_candidate(rest.as_bytes(), g_can_call)?;
        let start = rest[..letter].rfind('\n').map_or(0, |end| end + 1);
        let line = &rest[start..];
        let (line, after) = line.split_once('\n').unwrap_or((line, ""));
        rest = after;
        Some(line)
    })
}

fn leading_digits(text: &str) -> &str {
    let end = text.bytes().take_while(u8::is_ascii_digit).count();
    &text[..end]
}

/// The number in the last four of the digits; `None` if there is no digit.
fn parse_last_four_digits(digits: &str) -> Option<u16> {
    digits[digits.len().saturating_sub(4)..].parse().ok()
}

/// A line without comments and blanks; full-width letters and digits become ASCII.
fn strip_line(line: &str) -> String {
    let code = line.split('(').next().unwrap_or_default();
    let code = code.chars().filter_map(|character| match character {
        '\u{FF01}'..='\u{FF5E}' => char::from_u32(u32::from(character) - 0xFEE0),
        ' ' | '\t' | '\u{3000}' => None,
        other => Some(other),
    });
    code.collect::<String>().to_ascii_uppercase()
}

/// Lists the programs in the folder of `main`, except `main`, by number. If several files have
/// a number, one with the number in its name precedes one with an O word, then the first path
/// precedes.
pub fn index_folder(main: &Path) -> BTreeMap<u16, PathBuf> {
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
        if let Some(number) = parse_number_in_name(path)
            && is_file(path)
        {
            by_number.entry(number).or_insert_with(|| path.clone());
        }
    }
    for path in paths
        .iter()
        .filter(|path| has_program_ending(path))
        .take(MAX_FILES)
    {
        if let Some(number) = read_number_in_head(path) {
            by_number.entry(number).or_insert_with(|| path.clone());
        }
    }
    by_number
}

/// Parses the program number in a file name, such as 1002 in `O1002.CNC`; `None` without one.
pub fn parse_number_in_name(path: &Path) -> Option<u16> {
    if !has_program_ending(path) {
        return None;
    }
    let stem = path.file_stem()?.to_str()?;
    let stem = stem.strip_prefix('%').unwrap_or(stem);
    let digits = stem.strip_prefix(['O', 'o', 'P', 'p']).unwrap_or(stem);
    let is_number =
        (1..=4).contains(&digits.len()) && digits.bytes().all(|byte| byte.is_ascii_digit());
    is_number.then(|| digits.parse().ok())?
}

/// Reads the program number in the O word or `%P01` at the start of a file; `None` without
/// one.
pub fn read_number_in_head(path: &Path) -> Option<u16> {
    if !is_file(path) {
        return None;
    }
    let head = platform::read(path, HEAD_BYTES).ok()?;
    let head = String::from_utf8_lossy(&head);
    let line = head
        .lines()
        .map(strip_line)
        .find(|line| !line.is_empty() && line != "%")?;
    let name = line.strip_prefix('O').or_else(|| line.strip_prefix("%P"));
    let digits: String = name?.chars().take_while(char::is_ascii_digit).collect();
    digits.parse().ok().filter(|number| *number <= 9999)
}

fn is_file(path: &Path) -> bool {
    platform::path_facts(path).is_ok_and(|facts| facts.is_file)
}

fn has_program_ending(path: &Path) -> bool {
    find_program_ending(path).is_some()
}

/// The extension of a file in lower case; `None` if it is not an extension of programs.
pub fn find_program_ending(path: &Path) -> Option<&'static str> {
    let ending = path
        .extension()
        .map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    let ending = ending.unwrap_or_default();
    PROGRAM_ENDINGS.into_iter().find(|known| *known == ending)
}

#[cfg(test)]
mod tests {
    use std::fs;

    use gsk_core::model::ModelId;

    use super::*;

    #[test]
    fn calls_are_found_despite_comments_blanks_and_repeat_counts() {
        let text =
            "N10 M98 P51002;\nm 98 p 7 (M98 P9)\n(M98 P8)\nM98 P12345678\nＭ９８ Ｐ３\nM99 P20\n";
        assert_eq!(numbers(text), [3, 7, 1002, 5678]);
    }

    #[test]
    fn macros_are_called_by_g65_and_g66() {
        let text = "N10 G65 P9010 A1.0\nG65 A1 P9011\nG66 P9012 Z1\nG65 H80 P10\nG04 P500\n";
        assert_eq!(numbers(text), [9010, 9011, 9012]);
        let by_variable = |text| find_calls(text, &ControlModel::default()).by_variable;
        assert!(by_variable("M98 P#200\n") && by_variable("G65 P[#1+1] A1\n"));
        assert!(!by_variable("M98 P20\nG65 H01 P#200 Q1\nX#1\n"));
    }

    #[test]
    fn codes_without_a_function_call_programs() {
        let text = "M61\nN10 G01 X1 M03 S500 T0101\nm 62 (M63)\nS21 M8\nT15\nS9 T5 M100 M30\n";
        assert_eq!(numbers(text), [9061, 9062, 9121, 9215]);
    }

    fn numbers_for_model(id: ModelId, parameters: &[(u16, i32)], text: &str) -> Vec<u16> {
        let mut model = ControlModel::new(id);
        for (number, value) in parameters {
            assert_eq!(model.set_parameter(*number, *value), Ok(()));
        }
        find_calls(text, &model).numbers.into_iter().collect()
    }

    #[test]
    fn the_model_decides_which_codes_call() {
        let macros = [(220, 81), (230, 60), (240, 61), (243, 1)];
        let text = "G81 X1\nM60 A1\nM61\nT0101\nM8\n";
        let td = ModelId::Gsk980td;
        assert_eq!(
            numbers_for_model(td, &macros, text),
            [9000, 9001, 9010, 9020]
        );
        let range = [(6044, 2000), (6045, 300), (6046, 100)];
        let text = "M2000\nM9005 X1\nG01 X1 M2007\nM61 T15 S21\nM98 P7 L2\n";
        let mdi = ModelId::Gsk980mdi;
        assert_eq!(numbers_for_model(mdi, &range, text), [7, 300, 307, 9005]);
        let text = "N10 G20 N33 L2\nG20 N5.3\nN20 G22 N7\nN99 M20 K1\nM71\n";
        assert_eq!(numbers_for_model(ModelId::Hx31, &[], text), [5, 33]);
        // G20 is a unit of the mill.
        assert!(numbers_for_model(mdi, &[], "G20 N33\n").is_empty());
    }

    fn numbers(text: &str) -> Vec<u16> {
        numbers_for_model(ModelId::Gsk980td, &[], text)
    }

    #[test]
    fn the_folder_is_searched_by_name_then_by_o_word_recursively() {
        let folder = gsk_tests::test_folder("subprograms");
        let write_file = |name: &str, text: &str| {
            fs::write(folder.join(name), text).expect("write");
        };
        write_file("main.CNC", "O1\nM98 P2\nM98 P5\n");
        write_file("O0002.nc", "O0002\nM98 P3\nM99\n");
        write_file("groove.txt", "%\nO0003 (groove)\nM98 P1\nM98 P2\nM99\n");
        write_file("zz.txt", "O0003\nM99\n");
        write_file("picture.png", "O0005\n");
        write_file("O0033.CNC", "%P33\nM99\n");
        write_file("turned.nc", "%P34\nM99\n");
        let main = folder.join("main.CNC");
        let text = fs::read_to_string(&main).expect("read");
        let td = ControlModel::default();
        let find = |text: &str, model: &ControlModel| {
            find_called(&main, find_calls(text, model), &BTreeSet::from([1]), model)
        };
        let found = find(&text, &td);
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
        let numbers =
            |found: Vec<FoundSubprogram>| found.iter().map(|it| it.number).collect::<Vec<_>>();
        let hx31 = ControlModel::new(ModelId::Hx31);
        assert_eq!(numbers(find("G20 N33\nG20 N34\n", &hx31)), [33, 34]);
        let all = find("M98 P#200\nM98 P2\n", &td);
        assert!(
            all.iter()
                .all(|it| it.called_by_number == matches!(it.number, 2 | 3)),
            "{all:?}"
        );
        assert_eq!(numbers(all), [2, 3, 33, 34]);
    }
}
