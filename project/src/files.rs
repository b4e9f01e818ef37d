//! Writes a project as text files and parses them; any deviation is an error.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::sync::Arc;

use gsk_messages::{Language, Message, say};

use crate::builder::build_state;
use crate::key::{DataSet, HEAD_FILE, MACHINE_FILE, ProjectKey, ProjectTable};
use crate::label::{file_heading, line_comment};
use crate::project_state::ProjectState;
use crate::value::{ProjectValue, parse_value};

/// The files of a project: text by path. Paths are relative to the folder and use `/`.
pub type ProjectFiles = BTreeMap<String, String>;

/// Greatest number of problems that [`import`] lists. One more entry gives the number of the
/// rest.
pub const MAX_PROBLEMS: usize = 100;

const COMMENT_START: char = ';';

/// A fault in a file of a project folder: the rule that the file breaks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProjectProblem {
    /// Path of the faulty file in the project folder.
    pub file: String,
    /// Line of the fault, from 1; `None` if the fault is the whole file or a missing line.
    pub line: Option<u32>,
    /// The message about the rule that the file breaks.
    pub rule: Message,
}

impl ProjectProblem {
    /// Returns the message about the fault with file and line in front: `parameters.txt:12:
    /// …`.
    pub fn message(&self) -> Message {
        match self.line {
            Some(line) => {
                say::subject_reason(format_args!("{}:{line}", self.file), self.rule.clone())
            }
            None => say::subject_reason(&self.file, self.rule.clone()),
        }
    }
}

impl core::fmt::Display for ProjectProblem {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        self.message().fmt(f)
    }
}

/// Returns whether a path in the project folder is a project file. Export replaces or deletes
/// only these; other files at the top of the folder (a README, `.git`) belong to the user.
pub fn is_project_file(path: &str) -> bool {
    let below = ["programs/", "ladder/", "disks/"];
    path == MACHINE_FILE
        || ProjectTable::from_path(path).is_some()
        || below.iter().any(|folder| path.starts_with(folder))
}

/// Returns the files of a project as texts. The same state and language always give the same
/// bytes. The comments in the files are names in `language`; [`import`] ignores them.
pub fn export(state: &ProjectState, language: Language) -> ProjectFiles {
    let mut files = ProjectFiles::new();
    let mut widths: BTreeMap<ProjectTable, usize> = BTreeMap::new();
    let entries = state.entries();
    let lines: Vec<(ProjectTable, String, String)> = entries
        .iter()
        .filter_map(|(key, value)| {
            let table = key.table()?;
            let line = format!("{} = {value}", key.name());
            Some((table, line, line_comment(*key, state, language)))
        })
        .collect();
    for (table, line, _) in &lines {
        let width = widths.entry(*table).or_default();
        *width = (*width).max(line.len());
    }
    for (table, line, comment) in lines {
        let text = files
            .entry(table.path())
            .or_insert_with(|| file_heading(table, language));
        let width = widths.get(&table).copied().unwrap_or_default();
        // Writing to a string cannot fail.
        let _ = match comment.is_empty() {
            true => writeln!(text, "{line}"),
            false => writeln!(text, "{line:width$} {COMMENT_START} {comment}"),
        };
    }
    for (key, value) in entries {
        if let (Some(file), ProjectValue::Text(text)) = (key.own_file(), value) {
            files.insert(file, text.to_string());
        }
    }
    files
}

/// The line, from 1, in which each value is defined.
type LineNumbers = BTreeMap<ProjectKey, u32>;

/// Parses the files of a project to its state.
///
/// # Errors
/// All problems in the order of file and line, up to [`MAX_PROBLEMS`]. Nothing is corrected and
/// no default is filled in.
pub fn import(files: &ProjectFiles) -> Result<ProjectState, Vec<ProjectProblem>> {
    let mut problems = Vec::new();
    let mut entries = BTreeMap::new();
    let mut line_numbers = LineNumbers::new();
    for (file, text) in files {
        if let Some(table) = ProjectTable::from_path(file) {
            parse_table(table, text, &mut entries, &mut line_numbers, &mut problems);
        } else if let Some(key) = ProjectKey::from_path(file) {
            entries.insert(key, ProjectValue::Text(Arc::from(text.as_str())));
        } else {
            problems.push(file_problem(file, say::project_file_unknown()));
        }
    }
    problems.extend(find_missing_files(files));
    // The missing values of a missing or malformed file are not reported one by one.
    let faulty_files: Vec<String> = problems.iter().map(|it| it.file.clone()).collect();
    let invalid_values = match build_state(&entries) {
        Ok(state) if problems.is_empty() => return Ok(state),
        Ok(_) => Vec::new(),
        Err(invalid_values) => invalid_values,
    };
    for value in invalid_values {
        let file = value.key.path();
        let line = value.line.or_else(|| line_numbers.get(&value.key).copied());
        let is_present = entries.contains_key(&value.key);
        if is_present || !faulty_files.contains(&file) {
            let rule = value.rule;
            problems.push(ProjectProblem { file, line, rule });
        }
    }
    problems.sort_by(|one, other| (&one.file, one.line).cmp(&(&other.file, other.line)));
    let more = problems.len().saturating_sub(MAX_PROBLEMS);
    if more > 0 {
        problems.truncate(MAX_PROBLEMS);
        problems.push(file_problem(HEAD_FILE, say::project_more(more)));
    }
    Err(problems)
}

fn file_problem(file: &str, rule: Message) -> ProjectProblem {
    ProjectProblem {
        file: file.to_owned(),
        line: None,
        rule,
    }
}

/// Returns a problem for each required file that is missing. Optional are the files of empty
/// electronic disks, of the panel, and of models without separate parameters.
fn find_missing_files(files: &ProjectFiles) -> Vec<ProjectProblem> {
    let has_disk = |set: DataSet| {
        let tables = [
            ProjectTable::Parameters(set),
            ProjectTable::Offsets(set),
            ProjectTable::Pitch(set),
        ];
        set == DataSet::Control || tables.iter().any(|table| files.contains_key(&table.path()))
    };
    let needed = ProjectTable::all().into_iter().filter(|table| match table {
        ProjectTable::ModelParameters | ProjectTable::Panel => false,
        ProjectTable::Parameters(set) | ProjectTable::Offsets(set) | ProjectTable::Pitch(set) => {
            has_disk(*set)
        }
        ProjectTable::Head
        | ProjectTable::Variables
        | ProjectTable::Counters
        | ProjectTable::Data => true,
    });
    let paths = needed.map(ProjectTable::path);
    let paths = paths.chain(ProjectKey::Ladder.own_file());
    paths
        .filter(|path| !files.contains_key(path))
        .map(|path| file_problem(&path, say::project_file_missing()))
        .collect()
}

fn parse_table(
    table: ProjectTable,
    text: &str,
    entries: &mut BTreeMap<ProjectKey, ProjectValue>,
    line_numbers: &mut LineNumbers,
    problems: &mut Vec<ProjectProblem>,
) {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    for (number, line) in (1..).zip(text.lines()) {
        let line = line.split(COMMENT_START).next().unwrap_or_default().trim();
        if line.is_empty() {
            continue;
        }
        let parsed =
            parse_line(table, line).and_then(|(key, value)| match line_numbers.get(&key) {
                Some(before) => Err(say::project_twice(key.name(), before)),
                None => Ok((key, value)),
            });
        match parsed {
            Ok((key, value)) => {
                line_numbers.insert(key, number);
                entries.insert(key, value);
            }
            Err(rule) => problems.push(ProjectProblem {
                file: table.path(),
                line: Some(number),
                rule,
            }),
        }
    }
}

fn parse_line(table: ProjectTable, line: &str) -> Result<(ProjectKey, ProjectValue), Message> {
    let (name, text) = line.split_once('=').ok_or_else(say::project_line_form)?;
    let name = name.trim();
    let key = table.parse_key(name);
    let key = key.ok_or_else(|| say::project_unknown(name))?;
    Ok((key, parse_value(key, text.trim())?))
}
