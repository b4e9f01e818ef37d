//! The folder as files with their texts: written, and read strictly.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::sync::Arc;

use gsk_messages::{Language, Message, say};

use crate::build::build;
use crate::key::{HEAD, Key, MACHINE, Set, Table};
use crate::label;
use crate::state::State;
use crate::value::{self, Value};

/// The files of a project: names with `/`, and what they hold.
pub type Files = BTreeMap<String, String>;

/// Problems that are listed; of more it is said how many they are.
pub const MOST_PROBLEMS: usize = 100;

/// Before a remark.
const REMARK: char = ';';

/// What is wrong with a folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// Name of the file.
    pub file: String,
    /// Line, from 1; none of a file as a whole, and of a line that is missing.
    pub line: Option<u32>,
    /// The rule that is broken.
    pub rule: Message,
}

impl Problem {
    /// `parameters.txt:12: …`.
    pub fn message(&self) -> Message {
        match self.line {
            Some(line) => {
                say::subject_reason(format_args!("{}:{line}", self.file), self.rule.clone())
            }
            None => say::subject_reason(&self.file, self.rule.clone()),
        }
    }
}

impl core::fmt::Display for Problem {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        self.message().fmt(f)
    }
}

/// Whether a file at this place of a folder is one of the project. What else lies at its
/// top is its owner's: a README, `.git`.
pub fn is_own(path: &str) -> bool {
    let below = ["programs/", "ladder/", "disks/"];
    path == MACHINE
        || Table::of(path).is_some()
        || below.iter().any(|folder| path.starts_with(folder))
}

/// The files of what a control holds, in the same order and form whoever writes them. Names
/// are given as remarks in a language; nobody reads them again.
pub fn export(state: &State, language: Language) -> Files {
    let mut files = Files::new();
    let mut widths: BTreeMap<Table, usize> = BTreeMap::new();
    let entries = state.entries();
    let lines: Vec<(Table, String, String)> = entries
        .iter()
        .filter_map(|(key, value)| {
            let table = key.table()?;
            let line = format!("{} = {value}", key.name());
            Some((table, line, label::remark(*key, state, language)))
        })
        .collect();
    for (table, line, _) in &lines {
        let width = widths.entry(*table).or_default();
        *width = (*width).max(line.len());
    }
    for (table, line, remark) in lines {
        let text = files
            .entry(table.path())
            .or_insert_with(|| label::heading(table, language));
        let width = widths.get(&table).copied().unwrap_or_default();
        // A string takes whatever is written to it.
        let _ = match remark.is_empty() {
            true => writeln!(text, "{line}"),
            false => writeln!(text, "{line:width$} {REMARK} {remark}"),
        };
    }
    for (key, value) in entries {
        if let (Some(file), Value::Text(text)) = (key.file(), value) {
            files.insert(file, text.to_string());
        }
    }
    files
}

/// Where a value was read.
type Places = BTreeMap<Key, u32>;

/// What a control holds by these files.
///
/// # Errors
/// Everything that is wrong with them, up to [`MOST_PROBLEMS`], by file and line. Nothing is
/// corrected or filled in.
pub fn import(files: &Files) -> Result<State, Vec<Problem>> {
    let mut problems = Vec::new();
    let mut entries = BTreeMap::new();
    let mut places = Places::new();
    for (file, text) in files {
        if let Some(table) = Table::of(file) {
            read_table(table, text, &mut entries, &mut places, &mut problems);
        } else if let Some(key) = Key::of_file(file) {
            entries.insert(key, Value::Text(Arc::from(text.as_str())));
        } else {
            problems.push(of_file(file, say::project_file_unknown()));
        }
    }
    problems.extend(missing(files));
    // What a file lacks is not said of one that is not there, or cannot be read.
    let spoilt: Vec<String> = problems.iter().map(|it| it.file.clone()).collect();
    let found = match build(&entries) {
        Ok(state) if problems.is_empty() => return Ok(state),
        Ok(_) => Vec::new(),
        Err(faults) => faults,
    };
    for fault in found {
        let file = fault.key.path();
        let line = fault.line.or_else(|| places.get(&fault.key).copied());
        let is_there = entries.contains_key(&fault.key);
        if is_there || !spoilt.contains(&file) {
            let rule = fault.rule;
            problems.push(Problem { file, line, rule });
        }
    }
    problems.sort_by(|one, other| (&one.file, one.line).cmp(&(&other.file, other.line)));
    let more = problems.len().saturating_sub(MOST_PROBLEMS);
    if more > 0 {
        problems.truncate(MOST_PROBLEMS);
        problems.push(of_file(HEAD, say::project_more(more)));
    }
    Err(problems)
}

fn of_file(file: &str, rule: Message) -> Problem {
    Problem {
        file: file.to_owned(),
        line: None,
        rule,
    }
}

/// Files that must be there: all but those of disks that nothing was saved on, of models
/// without parameters of their own, and of the panel.
fn missing(files: &Files) -> Vec<Problem> {
    let has_disk = |set: Set| {
        let tables = [
            Table::Parameters(set),
            Table::Offsets(set),
            Table::Pitch(set),
        ];
        set == Set::Control || tables.iter().any(|table| files.contains_key(&table.path()))
    };
    let needed = Table::all().into_iter().filter(|table| match table {
        Table::ModelParameters | Table::Panel => false,
        Table::Parameters(set) | Table::Offsets(set) | Table::Pitch(set) => has_disk(*set),
        Table::Head | Table::Variables | Table::Counters | Table::Data => true,
    });
    let paths = needed.map(Table::path);
    let paths = paths.chain(Key::Ladder.file());
    paths
        .filter(|path| !files.contains_key(path))
        .map(|path| of_file(&path, say::project_file_missing()))
        .collect()
}

fn read_table(
    table: Table,
    text: &str,
    entries: &mut BTreeMap<Key, Value>,
    places: &mut Places,
    problems: &mut Vec<Problem>,
) {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    for (number, line) in (1..).zip(text.lines()) {
        let line = line.split(REMARK).next().unwrap_or_default().trim();
        if line.is_empty() {
            continue;
        }
        let read = read_line(table, line).and_then(|(key, value)| match places.get(&key) {
            Some(before) => Err(say::project_twice(key.name(), before)),
            None => Ok((key, value)),
        });
        match read {
            Ok((key, value)) => {
                places.insert(key, number);
                entries.insert(key, value);
            }
            Err(rule) => problems.push(Problem {
                file: table.path(),
                line: Some(number),
                rule,
            }),
        }
    }
}

fn read_line(table: Table, line: &str) -> Result<(Key, Value), Message> {
    let (name, text) = line.split_once('=').ok_or_else(say::project_line_form)?;
    let name = name.trim();
    let key = table.key(name);
    let key = key.ok_or_else(|| say::project_unknown(name))?;
    Ok((key, value::read(key, text.trim())?))
}
