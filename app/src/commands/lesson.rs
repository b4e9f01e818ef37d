//! `lesson`: lists, checks and plays guided lessons without a window.

use std::path::Path;
use std::sync::Arc;

use gsk_messages::{Language, say};
use gsk_runner::lesson::Lesson;
use gsk_runner::lesson::play::{self, Outcome};
use gsk_runner::report;

use super::{ALARM, CommandError, FINE, output};
use crate::cli::LessonCommand;
use crate::files::lessons;
use crate::platform;

/// Lists, checks or plays lessons. Exit code 1 if a step does not reach its goal.
///
/// # Errors
/// The lesson is unknown, or its file breaks a rule.
pub fn lesson(command: &LessonCommand, language: Option<Language>) -> Result<u8, CommandError> {
    match command {
        LessonCommand::List(args) => Ok(list(args.data.as_deref(), language)),
        LessonCommand::Check(args) => {
            let lesson = lessons::read(&args.file).map_err(CommandError::Lesson)?;
            run(lesson, language)
        }
        LessonCommand::Run(args) => {
            let lesson = find(&args.lesson, args.data.as_deref())?;
            run(lesson, language)
        }
    }
}

fn list(data: Option<&Path>, language: Option<Language>) -> u8 {
    let found = lessons::all(data);
    for lesson in &found.lessons {
        let title = lesson.title.of(language.unwrap_or(Language::En));
        output::print(&format!(
            "{:<24} {:>3}  {title}\n",
            lesson.name,
            lesson.steps.len()
        ));
    }
    for said in &found.wrong {
        complain!("gsk980td: {}", report::said(said, language));
    }
    match found.wrong.is_empty() {
        true => FINE,
        false => ALARM,
    }
}

/// Finds a lesson by name, else reads it from a file.
fn find(name: &Path, data: Option<&Path>) -> Result<Lesson, CommandError> {
    let known = lessons::all(data).lessons;
    let names: Vec<String> = known.iter().map(|lesson| lesson.name.clone()).collect();
    let mut known = known.into_iter();
    if let Some(lesson) = known.find(|lesson| Path::new(&lesson.name) == name) {
        return Ok(lesson);
    }
    if platform::is_taken(name) {
        return lessons::read(name).map_err(CommandError::Lesson);
    }
    let said = say::lesson_unknown(name.display(), names.join(" "));
    Err(CommandError::Lesson(said))
}

/// Plays the solution and reports the outcome of every step.
fn run(lesson: Lesson, language: Option<Language>) -> Result<u8, CommandError> {
    let lesson = Arc::new(lesson);
    let shown = language.unwrap_or(Language::En);
    output::print(&format!("{}: {}\n", lesson.name, lesson.title.of(shown)));
    let outcomes = play::run(&lesson).map_err(CommandError::Lesson)?;
    let mut all_done = true;
    for (number, (step, outcome)) in (1..).zip(lesson.steps.iter().zip(&outcomes)) {
        let said = match outcome {
            Outcome::Done(ticks) => say::lesson_step_done(number, *ticks as f64 / 1000.0),
            Outcome::DoneBefore => say::lesson_step_done_before(number),
            Outcome::Failed(why) => say::lesson_step_failed(number, why.clone()),
        };
        all_done &= matches!(outcome, Outcome::Done(_));
        output::print(&format!("{}\n", said.text(shown)));
        if !matches!(outcome, Outcome::Done(_)) {
            output::print(&format!("    {}\n", step.text.of(shown)));
        }
    }
    let left = lesson.steps.len() - outcomes.len();
    if left > 0 {
        output::print(&format!("{}\n", say::lesson_steps_left(left).text(shown)));
    }
    Ok(if all_done { FINE } else { ALARM })
}
