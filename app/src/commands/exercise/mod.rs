//! `exercise`: lists, checks, solves and marks exercises without a window.

mod drafting;
mod drawing;
mod marking;
mod packing;

use std::path::Path;

use gsk_exercise::check::check_task;
use gsk_exercise::judge::judge;
use gsk_exercise::mark_table::{describe_evidence, verdict_sentence};
use gsk_exercise::report::{CriterionVerdict, ExerciseReport};
use gsk_exercise::result_file::{ResultAuthor, write_result};
use gsk_exercise::solve::{SolutionScript, record_solution};
use gsk_exercise::task::ExerciseTask;
use gsk_host::files::data_dir::default_data_path;
use gsk_host::files::{exercise_key, exercises, program_file};
use gsk_messages::{Language, say};
use gsk_plot::decode_png;
use gsk_runner::report;

use super::{CommandError, EXIT_ALARM, EXIT_OK, output};
use crate::cli::{ExerciseCommand, ExerciseSolveArgs};

/// Lists, checks, solves or marks exercises. Exit code 1 if a check fails, or if a result is not
/// what it claims.
///
/// # Errors
/// The exercise is unknown, or a file cannot be read or written.
pub fn exercise(command: &ExerciseCommand, language: Option<Language>) -> Result<u8, CommandError> {
    match command {
        ExerciseCommand::List(args) => Ok(list(args.data.as_deref(), language)),
        ExerciseCommand::Check(args) => check(&args.task, language.unwrap_or(Language::En)),
        ExerciseCommand::Solve(args) => solve(args, language),
        ExerciseCommand::Mark(args) => marking::mark(args, language),
        ExerciseCommand::New(args) => drafting::draft(args, language),
        ExerciseCommand::Drawing(args) => drawing::draw(args, language.unwrap_or(Language::En)),
        ExerciseCommand::Outline(args) => drawing::print_outline(&args.task),
        ExerciseCommand::Pack(args) => packing::pack(args, language.unwrap_or(Language::En)),
    }
}

fn list(data: Option<&Path>, language: Option<Language>) -> u8 {
    let found = exercises::load_exercises(data);
    for task in &found.tasks {
        let title = task.title.in_language(language.unwrap_or(Language::En));
        let minutes = task.time_limit_ms.div_ceil(60_000);
        let length = say::exercise_length(task.criteria.len(), task.max_points(), minutes);
        let length = output::localize(&length);
        output::print(&format!("{:<24} {length:<36} {title}\n", task.id));
    }
    for error in &found.errors {
        complain!("gsk980td: {}", report::message_text(error, language));
    }
    match found.errors.is_empty() {
        true => EXIT_OK,
        false => EXIT_ALARM,
    }
}

pub(super) fn check(path: &Path, language: Language) -> Result<u8, CommandError> {
    let task = exercises::read(path)?;
    let solutions = exercises::read_solutions(path)?;
    let check = check_task(&task, &solutions);
    for (name, report) in &check.reports {
        let seconds = report.duration_ms as f64 / 1000.0;
        let unmet = match report.unmet() {
            unmet if unmet.is_empty() => "-".to_owned(),
            unmet => unmet.join(" "),
        };
        let (points, most) = (report.points, report.max_points);
        let line = say::exercise_check_solution(name, points, most, seconds, unmet);
        output::print_message(&line);
        print_verdicts(&task, report, language, |verdict| !verdict.is_met);
    }
    for note in &check.notes {
        output::print_message(note);
    }
    for fault in &check.faults {
        output::report_error(fault);
    }
    let is_drawing_damaged = task
        .drawing
        .as_deref()
        .is_some_and(|it| decode_png(it).is_none());
    if is_drawing_damaged {
        output::report_error(&say::exercise_drawing_damaged(&task.id));
    }
    if !check.faults.is_empty() || is_drawing_damaged {
        return Ok(EXIT_ALARM);
    }
    output::print_message(&say::exercise_check_ok(&task.id, solutions.len()));
    Ok(EXIT_OK)
}

fn solve(args: &ExerciseSolveArgs, language: Option<Language>) -> Result<u8, CommandError> {
    let task = exercises::find(&args.task, args.data.as_deref())?;
    task.hint_cost(&args.hint)?;
    let text = program_file::read(&args.script)?.text;
    let in_script = |message| say::subject_reason(args.script.display(), message);
    let script = SolutionScript::read(&text).map_err(in_script)?;
    let target = output::reserve_file(&args.output)?;
    let version = env!("CARGO_PKG_VERSION");
    let recording = record_solution(&task, &script, version).map_err(in_script)?;
    let report = judge(&task, &recording).map_err(|error| error.message())?;
    let data = match &args.data {
        Some(data) => data.clone(),
        None => default_data_path()?,
    };
    let (key, made) = exercise_key::load_or_make(&data)?;
    if let Some(made) = made {
        complain!("{}", output::localize(&made));
    }
    let script_name = args.script.file_stem().unwrap_or_default();
    let author = ResultAuthor {
        program: version.to_owned(),
        learner: match &args.learner {
            Some(learner) => learner.clone(),
            None => script_name.to_string_lossy().into_owned(),
        },
        hints: args.hint.clone(),
        exam: None,
    };
    let bytes = write_result(author, report.clone(), &recording, &key)?;
    target.write(&bytes)?;
    print_verdicts(&task, &report, language.unwrap_or(Language::En), |_| true);
    if let Some(refused) = &report.refused {
        output::print_message(&refused.message());
    }
    let (file, most) = (args.output.display(), report.max_points);
    output::print_message(&say::exercise_solved(file, report.points, most));
    Ok(EXIT_OK)
}

/// Prints the sentence and the evidence of each criterion for which `is_shown` returns true.
fn print_verdicts(
    task: &ExerciseTask,
    report: &ExerciseReport,
    language: Language,
    is_shown: impl Fn(&CriterionVerdict) -> bool,
) {
    let verdicts = task.criteria.iter().zip(&report.verdicts);
    for (criterion, verdict) in verdicts.filter(|(_, verdict)| is_shown(verdict)) {
        output::print(&format!(
            "{:>3}/{:<3} {} {}\n",
            verdict.points,
            verdict.max_points,
            verdict_sentence(criterion, verdict, language),
            describe_evidence(&verdict.evidence, language)
        ));
    }
}
