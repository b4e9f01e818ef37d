//! `lesson`: lists, checks and plays guided lessons without a window.

use std::path::Path;
use std::sync::Arc;

use gsk_host::files::lessons;
use gsk_host::platform;
use gsk_lesson::Lesson;
use gsk_lesson::solution_player::{self, StepResult};
use gsk_messages::{Language, say};
use gsk_runner::report;

use super::{CommandError, EXIT_ALARM, EXIT_OK, output};
use crate::cli::LessonCommand;

/// Lists, checks or plays lessons. Exit code 1 if a step does not reach its goal.
///
/// # Errors
/// The lesson is unknown, or its file breaks a rule.
pub fn lesson(command: &LessonCommand, language: Option<Language>) -> Result<u8, CommandError> {
    match command {
        LessonCommand::List(args) => Ok(list(args.data.as_deref(), language)),
        LessonCommand::Check(args) => {
            let lesson = lessons::read(&args.file)?;
            run(lesson, language)
        }
        LessonCommand::Run(args) => {
            let lesson = find(&args.lesson, args.data.as_deref())?;
            run(lesson, language)
        }
    }
}

fn list(data: Option<&Path>, language: Option<Language>) -> u8 {
    let found = lessons::load_lessons(data);
    for lesson in &found.lessons {
        let title = lesson.title.in_language(language.unwrap_or(Language::En));
        output::print(&format!(
            "{:<24} {:>3}  {title}\n",
            lesson.name,
            lesson.steps.len()
        ));
    }
    for error in &found.errors {
        complain!("gsk980td: {}", report::message_text(error, language));
    }
    match found.errors.is_empty() {
        true => EXIT_OK,
        false => EXIT_ALARM,
    }
}

/// Finds a lesson by its name; a name that is unknown is read as a file. Returns an error if
/// neither exists or the file is wrong.
fn find(name: &Path, data: Option<&Path>) -> Result<Lesson, CommandError> {
    let all_lessons = lessons::load_lessons(data).lessons;
    let names: Vec<String> = all_lessons
        .iter()
        .map(|lesson| lesson.name.clone())
        .collect();
    let mut all_lessons = all_lessons.into_iter();
    if let Some(lesson) = all_lessons.find(|lesson| Path::new(&lesson.name) == name) {
        return Ok(lesson);
    }
    if platform::is_taken(name) {
        return Ok(lessons::read(name)?);
    }
    let message = say::lesson_unknown(name.display(), names.join(" "));
    Err(message.into())
}

/// Plays the solution of a lesson and prints the outcome of every step; returns the exit code.
/// Returns an error if the lesson cannot be started.
fn run(lesson: Lesson, language: Option<Language>) -> Result<u8, CommandError> {
    let lesson = Arc::new(lesson);
    let text_language = language.unwrap_or(Language::En);
    output::print(&format!(
        "{}: {}\n",
        lesson.name,
        lesson.title.in_language(text_language)
    ));
    let outcomes = solution_player::play_lesson(&lesson)?;
    let mut all_done = true;
    for (number, (step, outcome)) in (1..).zip(lesson.steps.iter().zip(&outcomes)) {
        let result = match outcome {
            StepResult::Done(ticks) => say::lesson_step_done(number, *ticks as f64 / 1000.0),
            StepResult::DoneBefore => say::lesson_step_done_before(number),
            StepResult::Failed(why) => say::lesson_step_failed(number, why.clone()),
        };
        all_done &= matches!(outcome, StepResult::Done(_));
        output::print(&format!("{}\n", result.text(text_language)));
        if !matches!(outcome, StepResult::Done(_)) {
            output::print(&format!("    {}\n", step.text.in_language(text_language)));
        }
    }
    let left = lesson.steps.len() - outcomes.len();
    if left > 0 {
        output::print(&format!(
            "{}\n",
            say::lesson_steps_left(left).text(text_language)
        ));
    }
    Ok(if all_done { EXIT_OK } else { EXIT_ALARM })
}
