//! Reads the file of a lesson (RON) and checks its rules.

use gsk_core::units::{NonFinite, find_non_finite};
use gsk_messages::{Message, say};
use gsk_panel::keys::{KEYS, Key, KeyRole};
use gsk_panel::script::{Expectation, Script, ScriptAction, ScriptLine};
use gsk_workpiece::job::Job;
use serde::Deserialize;
use serde::de::DeserializeOwned;

use crate::practice_machine::{LessonStart, LessonStartFile};
use crate::{Lesson, LessonCondition, LessonMistake, LessonStep, LessonText};

/// Maximum number of steps of a lesson; no useful lesson has more.
const MAX_STEPS: usize = 100;

/// The reason for which a lesson file cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub enum LessonError {
    /// The file is not valid RON, or has unknown fields.
    Syntax {
        /// Name of the lesson file.
        file: String,
        /// Line of the error, from 1.
        line: usize,
        /// The error message of the parser.
        reason: Message,
    },
    /// The lesson breaks a rule.
    Rule {
        /// Name of the lesson file.
        file: String,
        /// Number of the step that breaks the rule, from 1; `None` for a rule outside the
        /// steps.
        step: Option<usize>,
        /// Name of the field that breaks the rule.
        field: &'static str,
        /// The text of the rule that is broken.
        rule: Message,
    },
}

impl LessonError {
    /// The message that explains why the lesson cannot be used, with file and line or step.
    pub fn message(&self) -> Message {
        match self {
            Self::Syntax { file, line, reason } => {
                say::lesson_file_line(file, line, reason.clone())
            }
            Self::Rule {
                file,
                step: Some(step),
                field,
                rule,
            } => say::lesson_in_step(file, step, field, rule.clone()),
            Self::Rule {
                file, field, rule, ..
            } => say::lesson_in_field(file, field, rule.clone()),
        }
    }
}

/// A lesson, as written in its file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LessonFile {
    title: LessonText,
    about: LessonText,
    #[serde(default)]
    begins: LessonStartFile,
    #[serde(default)]
    job: Option<Job>,
    steps: Vec<StepFile>,
}

/// A step, as written in the file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct StepFile {
    pub(super) text: LessonText,
    pub(super) hint: LessonText,
    #[serde(default)]
    pub(super) keys: Vec<String>,
    #[serde(default)]
    pub(super) needs: Vec<String>,
    pub(super) until: Vec<String>,
    #[serde(default)]
    pub(super) wrong: Vec<WrongFile>,
    pub(super) solution: Vec<String>,
}

/// A frequent mistake of the learner, as written in the file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct WrongFile {
    when: Vec<String>,
    say: LessonText,
}

/// File, step and field that a rule applies to.
pub(super) struct LessonLocation<'a> {
    pub(super) file: &'a str,
    pub(super) step: Option<usize>,
    pub(super) field: &'static str,
}

impl LessonLocation<'_> {
    pub(super) fn rule_error(&self, rule: Message) -> LessonError {
        LessonError::Rule {
            file: self.file.to_owned(),
            step: self.step,
            field: self.field,
            rule,
        }
    }
}

impl Lesson {
    /// Parses a lesson. Messages call it `file`; its name is `file` without folder and
    /// extension.
    ///
    /// # Errors
    /// The line with a syntax error, or the step, field and rule that is broken.
    pub fn read(file: &str, text: &str) -> Result<Self, LessonError> {
        let raw: LessonFile = parse_ron(file, text)?;
        let location = |step, field| LessonLocation { file, step, field };
        check_text(&raw.title, &location(None, "title"))?;
        check_text(&raw.about, &location(None, "about"))?;
        if raw.steps.is_empty() || raw.steps.len() > MAX_STEPS {
            let rule = say::lesson_steps(raw.steps.len(), MAX_STEPS);
            return Err(location(None, "steps").rule_error(rule));
        }
        if let Some(job) = &raw.job {
            job.check()
                .map_err(|rule| location(None, "job").rule_error(rule))?;
        }
        let begins = LessonStart::read(raw.begins)
            .map_err(|rule| location(None, "begins").rule_error(rule))?;
        let steps = (1..).zip(raw.steps);
        let steps = steps.map(|(number, step)| parse_step(file, number, step));
        Ok(Self {
            name: file_stem(file),
            title: raw.title,
            about: raw.about,
            start: begins,
            job: raw.job,
            steps: steps.collect::<Result<_, _>>()?,
        })
    }
}

/// Parses a RON text. `file` names the text in error messages.
pub(super) fn parse_ron<T: DeserializeOwned>(file: &str, text: &str) -> Result<T, LessonError> {
    let options =
        ron::Options::default().with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME);
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    if let Some(NonFinite { line, token }) = find_non_finite(text) {
        return Err(LessonError::Syntax {
            file: file.to_owned(),
            line,
            reason: say::number_not_finite(token),
        });
    }
    options.from_str(text).map_err(|error| LessonError::Syntax {
        file: file.to_owned(),
        line: error.span.start.line,
        reason: say::as_written(error.code),
    })
}

/// The name of a file without folder and extension.
fn file_stem(file: &str) -> String {
    let name = file.rsplit(['/', '\\']).next().unwrap_or(file);
    name.strip_suffix(".ron").unwrap_or(name).to_owned()
}

pub(super) fn parse_step(
    file: &str,
    number: usize,
    raw: StepFile,
) -> Result<LessonStep, LessonError> {
    let location = |field| LessonLocation {
        file,
        step: Some(number),
        field,
    };
    check_text(&raw.text, &location("text"))?;
    check_text(&raw.hint, &location("hint"))?;
    let keys = raw
        .keys
        .iter()
        .map(|name| parse_key(name, &location("keys")));
    let keys = keys.collect::<Result<_, _>>()?;
    if raw.until.is_empty() {
        return Err(location("until").rule_error(say::lesson_without_end()));
    }
    let wrong = raw.wrong.into_iter().map(|wrong| {
        check_text(&wrong.say, &location("wrong"))?;
        if wrong.when.is_empty() {
            return Err(location("wrong").rule_error(say::lesson_without_end()));
        }
        Ok(LessonMistake {
            conditions: parse_conditions(&wrong.when, &location("wrong"))?,
            text: wrong.say,
        })
    });
    Ok(LessonStep {
        keys,
        requirements: parse_conditions(&raw.needs, &location("needs"))?,
        goals: parse_conditions(&raw.until, &location("until"))?,
        mistakes: wrong.collect::<Result<_, _>>()?,
        solution: parse_solution(&raw.solution, &location("solution"))?,
        text: raw.text,
        hint: raw.hint,
    })
}

pub(super) fn check_text(
    text: &LessonText,
    location: &LessonLocation<'_>,
) -> Result<(), LessonError> {
    match text.zh.trim().is_empty() || text.en.trim().is_empty() {
        true => Err(location.rule_error(say::lesson_text_missing())),
        false => Ok(()),
    }
}

fn parse_key(name: &str, location: &LessonLocation<'_>) -> Result<Key, LessonError> {
    Key::from_id(name).ok_or_else(|| location.rule_error(say::script_key_unknown(name)))
}

fn parse_conditions(
    texts: &[String],
    location: &LessonLocation<'_>,
) -> Result<Vec<LessonCondition>, LessonError> {
    let parsed = texts.iter().map(|text| {
        let expect = Expectation::parse(text)
            .map_err(|error| location.rule_error(say::subject_reason(text, error.message())))?;
        Ok(LessonCondition {
            text: text.clone(),
            expectation: expect,
        })
    });
    parsed.collect()
}

/// Parses the lines of a solution. Each character of a `type` line becomes the presses of its keys.
/// Returns the first fault as error.
fn parse_solution(lines: &[String], location: &LessonLocation<'_>) -> Result<Script, LessonError> {
    let script = Script::parse(&lines.join("\n")).map_err(|errors| {
        let first = errors
            .first()
            .map(|error| (error.line, error.cause.message()));
        let (line, cause) = first.unwrap_or((1, say::lesson_text_missing()));
        location.rule_error(say::in_line(line, cause))
    })?;
    if script.lines.is_empty() {
        return Err(location.rule_error(say::lesson_text_missing()));
    }
    let mut pressed = Vec::new();
    for line in script.lines {
        if !line.action.is_by_hand() || line.at.is_some() {
            let rule = say::lesson_not_by_hand(&line.text);
            return Err(location.rule_error(say::in_line(line.number, rule)));
        }
        let ScriptAction::Type(text) = &line.action else {
            pressed.push(line);
            continue;
        };
        for character in text.chars() {
            let keys = keys_for_character(character).ok_or_else(|| {
                let rule = say::lesson_no_key(character);
                location.rule_error(say::in_line(line.number, rule))
            })?;
            pressed.extend(keys.into_iter().map(|key| ScriptLine {
                text: format!("press {}", key.id()),
                action: ScriptAction::Press(key),
                ..line.clone()
            }));
        }
    }
    Ok(Script { lines: pressed })
}

/// The key presses that enter a character: two presses of a compound key for its second
/// character, no press for a space. `None` if no key enters the character.
fn keys_for_character(character: char) -> Option<Vec<Key>> {
    match character {
        ' ' => return Some(Vec::new()),
        ';' => return Some(vec![Key::Eob]),
        _ => {}
    }
    KEYS.iter().find_map(|row| match row.role {
        KeyRole::Character(first, _) if first == character => Some(vec![row.key]),
        KeyRole::Character(_, Some(second)) if second == character => Some(vec![row.key, row.key]),
        _ => None,
    })
}
