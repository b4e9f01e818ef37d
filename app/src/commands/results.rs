//! What the commands for lathe and mill share: checks files on all cores and prints the results.

use std::io::{self, Write};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use gsk_core::alarm::Alarm;
use gsk_core::json_line::JsonLine;
use gsk_core::preview::PreviewEnd;
use gsk_core::program::ProgramMemory;
use gsk_host::files::folders;
use gsk_host::files::overwrite_guard::{CommandInputs, check_overwrites, collect_outputs};
use gsk_messages::{Message, say};
use gsk_runner::report::annotations::{collect_annotations, to_github_commands, to_sarif_log};
use gsk_runner::report::{self, AlarmReport, ProgramReport};
use gsk_runner::text_format::format_time;

use super::{CommandError, EXIT_ALARM, EXIT_COLLISION, EXIT_OK, EXIT_USAGE, output};
use crate::cli::{CheckArgs, CheckFormat, Language, PlotArgs};

/// Function that checks the file at a path; the flag is true if it is the only file.
type FileCheck<'a> = dyn Fn(&Path, bool) -> Result<ProgramReport, CommandError> + Sync + 'a;

/// Checks files on all cores, a single file in this thread. The results keep the order of
/// the files.
fn check_files(
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
fn print_results(
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

/// Returns the exit code for the result of one file.
fn exit_code(result: &Result<ProgramReport, CommandError>) -> u8 {
    match result {
        Ok(report) => report_exit_code(report),
        Err(_) => EXIT_USAGE,
    }
}

/// Returns the exit code for a program with this report.
pub(super) fn report_exit_code(report: &ProgramReport) -> u8 {
    match report.has_failed() || report.has_denied_warning() {
        _ if report.has_collision() => EXIT_COLLISION,
        true => EXIT_ALARM,
        false => EXIT_OK,
    }
}

/// Checks a program and writes each move with `write` into the file at `path`.
fn check_into_file<M>(
    path: &Path,
    write: impl Fn(&mut dyn Write, &mut JsonLine, &M) -> io::Result<()>,
    check_program: impl FnOnce(&mut dyn FnMut(&M)) -> Result<ProgramReport, CommandError>,
) -> Result<ProgramReport, CommandError> {
    let mut out = output::open(path)?;
    let mut line = JsonLine::default();
    let mut error = None;
    let report = check_program(&mut |made| {
        if error.is_none() {
            error = write(&mut *out, &mut line, made).err();
        }
    })?;
    match error.or(out.flush().err()) {
        Some(error) => Err(output::WriteError::new(path, error).into()),
        None => Ok(report),
    }
}

/// Options of the command, and the language of its texts.
pub(super) type CheckOptions<'a> = (&'a CheckArgs, Option<Language>);

/// Checks programs of one kind of machine: with the set-up that `create_setup` makes after the
/// file names are checked, `check_file` checks a file and passes its moves on, and `write_move`
/// writes a move as a line of `--moves`. The flag of `check_file` is true for the only file.
pub(super) fn check_programs<S: Sync, M>(
    (args, language): CheckOptions<'_>,
    create_setup: impl FnOnce() -> Result<S, CommandError>,
    write_move: impl Fn(&mut dyn Write, &mut JsonLine, &M) -> io::Result<()>,
    check_file: impl Fn(
        &S,
        &Path,
        CheckOptions<'_>,
        bool,
        &mut dyn FnMut(&M),
    ) -> Result<ProgramReport, CommandError>
    + Sync,
) -> Result<u8, CommandError> {
    let levels = args.lint_levels().map_err(say::command_lint_both)?;
    let (files, mut errors) = folders::find_programs(&args.files);
    if args.moves.is_some() && files.len() > 1 {
        return Err(say::command_one_program().into());
    }
    if args.part.section.is_some() && files.len() > 1 {
        return Err(say::command_one_section().into());
    }
    if args.load_csv.is_some() && files.len() > 1 {
        return Err(say::command_one_load().into());
    }
    // Moves and section belong to one program: an error here would leave them incomplete.
    if (args.moves.is_some() || args.part.section.is_some() || args.load_csv.is_some())
        && let Some(error) = errors.pop()
    {
        return Err(error.into());
    }
    let setup = create_setup()?;
    // A mill reads nothing from the data directory.
    let is_lathe = !args.setup.selected_model().is_mill();
    let inputs = CommandInputs {
        files: (files.iter().map(PathBuf::as_path))
            .chain(args.setup.input_files())
            .collect(),
        main_program: files.first().map(PathBuf::as_path),
        data_dir: args.setup.data.as_deref().filter(|_| is_lathe),
    };
    let outputs = collect_outputs(&[&args.moves, &args.part.section, &args.load_csv]);
    check_overwrites(&inputs, &outputs)?;
    if let (Some(path), [file]) = (&args.moves, &files[..]) {
        let mut report = check_into_file(path, write_move, |on_move| {
            check_file(&setup, file, (args, language), true, on_move)
        })?;
        report.apply_levels(&levels);
        let aside = output::is_standard_output(Some(path));
        return print_results(&[Ok(report)], args.format(), aside, language);
    }
    let mut results = check_files(&files, &|file, is_only| {
        check_file(&setup, file, (args, language), is_only, &mut |_| {})
    });
    for report in results.iter_mut().flatten() {
        report.apply_levels(&levels);
    }
    results.extend(errors.into_iter().map(|error| Err(error.into())));
    print_results(&results, args.format(), false, language)
}

/// Prints that the picture is written, with the machine time, s, and the message that moves are
/// missing in it.
pub(super) fn report_picture(
    args: &PlotArgs,
    time_s: f64,
    shortfall: Option<&Message>,
    language: Option<Language>,
) {
    let drawn = say::plot_written(args.output.display(), format_time(time_s));
    output::print(&format!("{}\n", report::message_text(&drawn, language)));
    if let Some(message) = shortfall {
        complain!("gsk980td: {}", report::message_text(message, language));
    }
}

/// Prints the alarm or the limit that ended the program of a picture; returns the exit code.
pub(super) fn report_end(
    args: &PlotArgs,
    end: PreviewEnd,
    alarm: Option<&Alarm>,
    programs: &ProgramMemory,
    language: Option<Language>,
) -> u8 {
    if let Some(alarm) = alarm {
        let alarm = AlarmReport::new(alarm, programs, language);
        complain!("gsk980td: {}", alarm.sentence(language));
    }
    if end == PreviewEnd::Limit {
        let text = report::message_text(&say::report_limit(), language);
        complain!("gsk980td: {}: {text}", args.file.display());
    }
    match end {
        PreviewEnd::Alarm | PreviewEnd::Limit => EXIT_ALARM,
        PreviewEnd::M30 | PreviewEnd::M02 | PreviewEnd::M99 | PreviewEnd::Text => EXIT_OK,
    }
}
