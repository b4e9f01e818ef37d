//! Checks several files on all cores and prints the results.

use std::io::{self, Write};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use gsk_messages::say;
use gsk_runner::report::annotations::{collect_annotations, to_github_commands, to_sarif_log};
use gsk_runner::report::{self, ProgramReport};

use super::{CommandError, EXIT_ALARM, EXIT_COLLISION, EXIT_OK, EXIT_USAGE, output};
use crate::cli::{CheckFormat, Language};

/// Function that checks the file at a path; the flag is true if it is the only file.
pub(super) type FileCheck<'a> =
    dyn Fn(&Path, bool) -> Result<ProgramReport, CommandError> + Sync + 'a;

/// Checks files on all cores, a single file in this thread. The results keep the order of
/// the files.
pub(super) fn check_files(
    files: &[PathBuf],
    check: &FileCheck<'_>,
) -> Vec<Result<ProgramReport, CommandError>> {
    if let [file] = files {
        return vec![check(file, true)];
    }
    let next = AtomicUsize::new(0);
    let results: Vec<Mutex<Option<Result<ProgramReport, CommandError>>>> =
        files.iter().map(|_| Mutex::new(None)).collect();
    let cores = thread::available_parallelism().map_or(1, NonZeroUsize::get);
    thread::scope(|scope| {
        for _ in 0..cores.min(files.len()) {
            scope.spawn(|| {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some(file) = files.get(index) else { break };
                    let result = check(file, false);
                    if let Ok(mut slot) = results[index].lock() {
                        *slot = Some(result);
                    }
                }
            });
        }
    });
    let not_checked = || Err(say::command_not_checked().into());
    results
        .into_iter()
        .map(|result| {
            result
                .into_inner()
                .ok()
                .flatten()
                .unwrap_or_else(not_checked)
        })
        .collect()
}

/// Prints results and returns the highest exit code. `to_stderr` selects standard error, for
/// use when the moves are on standard output.
pub(super) fn print_results(
    results: &[Result<ProgramReport, CommandError>],
    format: CheckFormat,
    to_stderr: bool,
    language: Option<Language>,
) -> Result<u8, CommandError> {
    let reports = results.iter().flatten();
    match format {
        CheckFormat::Human | CheckFormat::Json => {
            for report in reports {
                output::print_report(report, format == CheckFormat::Json, to_stderr, language)?;
            }
        }
        CheckFormat::Github | CheckFormat::Sarif => {
            let all: Vec<_> = reports
                .flat_map(|it| collect_annotations(it, language))
                .collect();
            let text = match format {
                CheckFormat::Github => to_github_commands(&all),
                _ => to_sarif_log(&all, env!("CARGO_PKG_VERSION")),
            };
            output::print_or_report(&text, to_stderr);
        }
    }
    for error in results.iter().filter_map(|result| result.as_ref().err()) {
        complain!(
            "gsk980td: {}",
            report::message_text(&error.message(), language)
        );
    }
    let codes: Vec<u8> = results.iter().map(exit_code).collect();
    if format == CheckFormat::Human && results.len() > 1 {
        let count_of = |code| codes.iter().filter(|it| **it == code).count();
        let summary = say::check_summary(
            codes.len(),
            count_of(EXIT_OK),
            count_of(EXIT_ALARM),
            count_of(EXIT_COLLISION),
            count_of(EXIT_USAGE),
        );
        output::print_or_report(
            &(report::message_text(&summary, language) + "\n"),
            to_stderr,
        );
    }
    Ok(codes.into_iter().max().unwrap_or(EXIT_OK))
}

/// The exit code of the result of one file.
fn exit_code(result: &Result<ProgramReport, CommandError>) -> u8 {
    match result {
        Ok(report) => report_exit_code(report),
        Err(_) => EXIT_USAGE,
    }
}

/// The exit code of a program with this report.
pub(super) fn report_exit_code(report: &ProgramReport) -> u8 {
    match report.has_failed() {
        _ if report.has_collision() => EXIT_COLLISION,
        true => EXIT_ALARM,
        false => EXIT_OK,
    }
}

/// Checks a program and writes each move with `write` into the file at `path`.
pub(super) fn check_into_file<M>(
    path: &Path,
    write: impl Fn(&mut dyn Write, &M) -> io::Result<()>,
    check_program: impl FnOnce(&mut dyn FnMut(&M)) -> Result<ProgramReport, CommandError>,
) -> Result<ProgramReport, CommandError> {
    let mut out = output::open(path)?;
    let mut error = None;
    let report = check_program(&mut |made| {
        if error.is_none() {
            error = write(&mut *out, made).err();
        }
    })?;
    match error.or(out.flush().err()) {
        Some(error) => Err(output::WriteError::new(path, error).into()),
        None => Ok(report),
    }
}
