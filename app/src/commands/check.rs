//! `check`: programs interpreted without running the machine.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use gsk_core::command::ExecutedMove;
use gsk_core::preview::Progress;
use gsk_core::setup::Setup;
use gsk_messages::say;
use gsk_runner::curves::RapidRates;
use gsk_runner::moves;
use gsk_runner::report::annotations::{annotations, github, sarif};
use gsk_runner::report::{self, PartReport, Report};

use super::{ALARM, COLLISION, CommandError, FINE, USAGE, mill, output};
use crate::apart::{Read, keep_apart, results};
use crate::cli::{CheckArgs, Format, Language};
use crate::files::folders;
use crate::job::{self, write_section};
use crate::loading;

/// Checks programs.
pub fn check(args: &CheckArgs) -> Result<u8, CommandError> {
    if args.setup.model().is_mill() {
        return mill::check(args);
    }
    let (files, mut wrong) = folders::programs(&args.files);
    if args.moves.is_some() && files.len() > 1 {
        return Err(CommandError::OneProgram);
    }
    if args.part.section.is_some() && files.len() > 1 {
        return Err(CommandError::OneSection);
    }
    // What is written is of one program: nothing is done by halves then.
    if (args.moves.is_some() || args.part.section.is_some())
        && let Some(error) = wrong.pop()
    {
        return Err(error.into());
    }
    let setup = loading::setup(&args.setup, args.look.work_zero, args.look.lang)?;
    let read = Read {
        files: (files.iter().map(PathBuf::as_path))
            .chain(args.setup.read_files())
            .collect(),
        main: files.first().map(PathBuf::as_path),
        data: args.setup.data.as_deref(),
    };
    let written = results(&[&args.moves, &args.part.section]);
    keep_apart(&read, &written)?;
    if let (Some(path), [file]) = (&args.moves, &files[..]) {
        let mut out = output::open(path)?;
        let mut failed = None;
        let report = check_file(&setup, file, args, true, &mut |executed| {
            if failed.is_none() {
                failed = moves::write_move(&mut *out, executed).err();
            }
        })?;
        let flushed = out.flush().err();
        if let Some(error) = failed.or(flushed) {
            return Err(output::WriteError::new(path, error).into());
        }
        drop(out);
        let aside = output::is_standard(Some(path));
        return print(&[Ok(report)], args.format(), aside, args.look.lang);
    }
    let mut results = all(&files, &|file, alone| {
        check_file(&setup, file, args, alone, &mut |_| {})
    });
    results.extend(wrong.into_iter().map(|error| Err(error.into())));
    print(&results, args.format(), false, args.look.lang)
}

/// Looks a file through; whether it is the only one.
pub(super) type Look<'a> = dyn Fn(&Path, bool) -> Result<Report, CommandError> + Sync + 'a;

/// Checks files on all cores; the results keep the order of the files.
pub(super) fn all(files: &[PathBuf], look: &Look<'_>) -> Vec<Result<Report, CommandError>> {
    let next = AtomicUsize::new(0);
    let results: Vec<Mutex<Option<Result<Report, CommandError>>>> =
        files.iter().map(|_| Mutex::new(None)).collect();
    let alone = files.len() == 1;
    let cores = thread::available_parallelism().map_or(1, NonZeroUsize::get);
    thread::scope(|scope| {
        for _ in 0..cores.min(files.len()) {
            scope.spawn(|| {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some(file) = files.get(index) else { break };
                    let result = look(file, alone);
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

fn check_file(
    setup: &Setup,
    file: &Path,
    args: &CheckArgs,
    alone: bool,
    on_move: &mut dyn FnMut(&ExecutedMove),
) -> Result<Report, CommandError> {
    let look = args.look;
    let mut setup = setup.clone();
    loading::open(&mut setup, &[file.to_owned()])?.print(look.lang);
    let mut watch = output::watch(&setup.memory.programs, look.patience.begin(), alone);
    let name = file.display().to_string();
    let mut goes_on = |progress: &Progress| watch.goes_on(progress);
    if !args.part.wanted() {
        let report = report::check(&name, &setup, look.lang, on_move, &mut goes_on);
        return Ok(report);
    }
    let chosen = job::choose(&args.part.job, Some(file), &setup)?;
    let mut machining = chosen.machining();
    let rates = RapidRates::of(&setup.memory);
    let mut take = |executed: &ExecutedMove| {
        machining.moved(executed, rates);
        on_move(executed);
    };
    let mut report = report::check(&name, &setup, look.lang, &mut take, &mut goes_on);
    if let Some(path) = &args.part.section {
        write_section(path, &machining)?;
    }
    report.part = Some(PartReport::new(
        &machining,
        chosen.name(),
        args.part.measure,
        look.lang,
    ));
    Ok(report)
}

/// `aside`: on standard error, as the moves are on standard output.
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

/// The exit code of one program alone.
fn code(result: &Result<Report, CommandError>) -> u8 {
    match result {
        Ok(report) if report.collided() => COLLISION,
        Ok(report) if report.failed() => ALARM,
        Ok(_) => FINE,
        Err(_) => USAGE,
    }
}
