//! Reads `task.ron`.

use gsk_core::units::{NonFinite, find_non_finite};
use gsk_lesson::{LessonStart, LessonStartFile, LessonText};
use gsk_messages::{Message, say};
use gsk_panel::panel::limits::{NameFault, PanelLimits, PermittedNames, unlisted_stop_keys};
use gsk_workpiece::job::Job;
use serde::Deserialize;

use crate::criterion_file::{CriterionFile, check_text, read_criterion, read_fault, read_time_ms};
use crate::outline::{OutlineFile, TaskOutline};
use crate::task::{ExerciseHint, ExerciseTask, TaskHash};

/// Greatest number of criteria in a task.
const MAX_CRITERIA: usize = 100;
/// Default time limit of a task, s.
const DEFAULT_TIME_LIMIT_S: f64 = 3600.0;
/// Default number of results that a learner may hand in for a task.
const DEFAULT_ATTEMPTS: u32 = 3;

/// An error in a task file, with its position and the broken rule.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub struct ExerciseTaskError {
    /// Name of the task file.
    pub file: String,
    /// Line of the error in the task file, from 1.
    pub line: usize,
    /// The field or criterion that breaks the rule; `None` for a syntax error.
    pub field: Option<String>,
    /// Message about the rule that is broken.
    pub rule: Message,
}

impl ExerciseTaskError {
    /// Returns the error as one message with file, line and rule.
    pub fn message(&self) -> Message {
        match &self.field {
            Some(field) => say::exercise_file_rule(&self.file, self.line, field, self.rule.clone()),
            None => say::lesson_file_line(&self.file, self.line, self.rule.clone()),
        }
    }
}

/// A task as written in its file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TaskFile {
    title: LessonText,
    text: LessonText,
    #[serde(default)]
    begins: LessonStartFile,
    #[serde(default)]
    job: Option<Job>,
    #[serde(default)]
    outline: Option<OutlineFile>,
    #[serde(default)]
    faults: Vec<String>,
    #[serde(default)]
    keys: Option<PermittedNames>,
    #[serde(default)]
    pages: Option<PermittedNames>,
    #[serde(default)]
    time_limit: Option<f64>,
    #[serde(default)]
    attempts: Option<u32>,
    #[serde(default)]
    hints: Vec<HintFile>,
    criteria: Vec<CriterionFile>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct HintFile {
    text: LessonText,
    cost: u32,
}

impl ExerciseTask {
    /// Reads a task file. `id` is the name of its folder; messages name the file `file`.
    ///
    /// # Errors
    ///
    /// The text breaks a rule; the error has the line and the rule.
    pub fn read(id: &str, file: &str, text: &str) -> Result<Self, ExerciseTaskError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let error = |line, field: Option<&str>, rule| ExerciseTaskError {
            file: file.to_owned(),
            line,
            field: field.map(str::to_owned),
            rule,
        };
        if let Some(NonFinite { line, token }) = find_non_finite(text) {
            return Err(error(line, None, say::number_not_finite(token)));
        }
        let options = ron::Options::default()
            .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME);
        let raw: TaskFile = options.from_str(text).map_err(|wrong| {
            let reason = say::as_written(wrong.code);
            error(wrong.span.start.line, None, reason)
        })?;
        let in_field = |field: &str, rule| error(line_of_field(text, field), Some(field), rule);
        check_text(&raw.title).map_err(|rule| in_field("title", rule))?;
        check_text(&raw.text).map_err(|rule| in_field("text", rule))?;
        let start = LessonStart::read(raw.begins).map_err(|rule| in_field("begins", rule))?;
        if let Some(job) = &raw.job {
            job.check().map_err(|rule| in_field("job", rule))?;
        }
        let outline = raw.outline.as_ref().map(TaskOutline::read).transpose();
        let outline = outline.map_err(|rule| in_field("outline", rule))?;
        let faults = raw.faults.iter().map(|name| read_fault(name));
        let faults = faults
            .collect::<Result<_, _>>()
            .map_err(|rule| in_field("faults", rule))?;
        let mut limits = PanelLimits::default();
        let at_name = |field: &str, fault: NameFault| {
            let line = line_of_name(text, field, &fault.name);
            error(line, Some(field), fault.rule)
        };
        if let Some(keys) = &raw.keys {
            limits.limit_keys(keys).map_err(|it| at_name("keys", it))?;
        }
        if let Some(pages) = &raw.pages {
            limits
                .limit_pages(pages)
                .map_err(|it| at_name("pages", it))?;
        }
        let time_limit_ms = read_time_ms(raw.time_limit.unwrap_or(DEFAULT_TIME_LIMIT_S))
            .map_err(|rule| in_field("time_limit", rule))?;
        let attempts = raw.attempts.unwrap_or(DEFAULT_ATTEMPTS);
        if attempts == 0 {
            return Err(in_field("attempts", say::exercise_no_attempt()));
        }
        for hint in &raw.hints {
            check_text(&hint.text).map_err(|rule| in_field("hints", rule))?;
        }
        if raw.criteria.is_empty() || raw.criteria.len() > MAX_CRITERIA {
            let rule = say::exercise_criterion_count(raw.criteria.len(), MAX_CRITERIA);
            return Err(in_field("criteria", rule));
        }
        let mut criteria = Vec::new();
        for criterion in raw.criteria {
            let id = criterion.id.clone();
            let in_criterion = |rule| error(line_of_criterion(text, &id), Some(&id), rule);
            let criterion = read_criterion(criterion).map_err(in_criterion)?;
            if criteria
                .iter()
                .any(|known: &crate::criterion::ExerciseCriterion| known.id == id)
            {
                return Err(in_criterion(say::exercise_id_twice(&id)));
            }
            criteria.push(criterion);
        }
        let hints = raw.hints.into_iter().map(|hint| ExerciseHint {
            text: hint.text,
            cost: hint.cost,
        });
        Ok(Self {
            id: id.to_owned(),
            title: raw.title,
            text: raw.text,
            time_limit_ms,
            attempts,
            hints: hints.collect(),
            faults,
            criteria,
            hash: TaskHash::from_text(text),
            start,
            limits,
            unlisted_stop_keys: raw.keys.as_ref().map_or_else(Vec::new, unlisted_stop_keys),
            job: raw.job,
            outline,
            drawing: None,
        })
    }
}

/// Returns the first line, from 1, that begins with the field; 1 if there is none.
fn line_of_field(text: &str, field: &str) -> usize {
    let is_field = |line: &str| {
        let rest = line.trim_start().strip_prefix(field);
        rest.is_some_and(|rest| rest.trim_start().starts_with(':'))
    };
    text.lines().position(is_field).map_or(1, |index| index + 1)
}

/// Returns the first line, from 1, with a quoted name in the list of a field; the line of the field
/// if there is none.
fn line_of_name(text: &str, field: &str, name: &str) -> usize {
    let first = line_of_field(text, field);
    let mut lines = text.lines().skip(first - 1);
    let quoted = format!("\"{name}\"").to_ascii_lowercase();
    let offset = lines.position(|line| line.to_ascii_lowercase().contains(&quoted));
    first + offset.unwrap_or(0)
}

/// Returns the last line, from 1, with the name of a criterion: an error about a repeated name is
/// reported at the second one.
fn line_of_criterion(text: &str, id: &str) -> usize {
    let name = format!("\"{id}\"");
    let lines: Vec<&str> = text.lines().collect();
    let is_name = |line: &&str| line.contains("id:") && line.contains(&name);
    lines.iter().rposition(is_name).map_or(1, |index| index + 1)
}
