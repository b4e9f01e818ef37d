//! Checks several files on all cores and prints the results.

use std::io::{self, Write};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use gsk_messages::say;
use gsk_runner::report::annotations::{annotations, github, sarif};
use gsk_runner::report::{self, Report};

use super::{ALARM, COLLISION, CommandError, FINE, USAGE, output};
use crate::cli::{Format, Language};

/// Checks one file; true if it is the only one.
pub(super) type Look<'a> = dyn Fn(&Path, bool) -> Result<Report, CommandError> + Sync + 'a;

/// Checks files on all cores, a single file in this thread. The results keep the order of
/// the files.
pub(super) fn all(files: &[PathBuf], look: &Look<'_>) -> Vec<Result<Report, CommandError>> {
    if let [file] = files {
        return vec![look(file, true)];
    }
    let next = AtomicUsize::new(0);
    let results: Vec<Mutex<Option<Result<Report, CommandError>>>> =
        files.iter().map(|_| Mutex::new(None)).collect();
    let cores = thread::available_parallelism().map_or(1, NonZeroUsize::get);
    thread::scope(|scope| {
        for _ in 0..cores.min(files.len()) {
            scope.spawn(|| {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some(file) = files.get(index) else { break };
                    let result = look(file, false);
                    if let Ok(mut place) = results[index].lock() {
                        *place = Some(result);
                    }
                }
            });
        }
    });
    let missing = || Err(CommandError::NotChecked);
    results
        .into_iter()
        .map(|result| result.into_inner().ok().flatten().unwrap_or_else(missing))
        .collect()
}

/// Prints results and returns the highest exit code. `aside` selects standard error, because
/// the moves are on standard output.
pub(super) fn print(
    results: &[Result<Report, CommandError>],
    format: Format,
    aside: bool,
    language: Option<Language>,
) -> Result<u8, CommandError> {
    let reports = results.iter().flatten();
    match format {
        Format::Human | Format::Json => {
            for report in reports {
                output::report(report, format == Format::Json, aside, language)?;
            }
        }
        Format::Github | Format::Sarif => {
            let all: Vec<_> = reports.flat_map(|it| annotations(it, language)).collect();
            let text = match format {
                Format::Github => github(&all),
                _ => sarif(&all, env!("CARGO_PKG_VERSION")),
            };
            output::print_or_aside(&text, aside);
        }
    }
    for error in results.iter().filter_map(|result| result.as_ref().err()) {
        complain!("gsk980td: {}", report::said(&error.message(), language));
    }
    let codes: Vec<u8> = results.iter().map(code).collect();
    if format == Format::Human && results.len() > 1 {
        let of = |code| codes.iter().filter(|it| **it == code).count();
        let summary =
            say::check_summary(codes.len(), of(FINE), of(ALARM), of(COLLISION), of(USAGE));
        output::print_or_aside(&(report::said(&summary, language) + "\n"), aside);
    }
    Ok(codes.into_iter().max().unwrap_or(FINE))
}

/// The exit code of one result.
fn code(result: &Result<Report, CommandError>) -> u8 {
    match result {
        Ok(report) if report.collided() => COLLISION,
        Ok(report) if report.failed() => ALARM,
        Ok(_) => FINE,
        Err(_) => USAGE,
    }
}

/// Checks a program and writes each of its moves into a file.
pub(super) fn into_file<M>(
    path: &Path,
    write: impl Fn(&mut dyn Write, &M) -> io::Result<()>,
    checked: impl FnOnce(&mut dyn FnMut(&M)) -> Result<Report, CommandError>,
) -> Result<Report, CommandError> {
    let mut out = output::open(path)?;
    let mut failed = None;
    let report = checked(&mut |made| {
        if failed.is_none() {
            failed = write(&mut *out, made).err();
        }
    })?;
    match failed.or(out.flush().err()) {
        Some(error) => Err(output::WriteError::new(path, error).into()),
        None => Ok(report),
    }
}
