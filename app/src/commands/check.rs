//! `check`: previews programs without running the machine.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use gsk_core::command::ExecutedMove;
use gsk_core::preview::PreviewProgress;
use gsk_core::setup::Setup;
use gsk_host::files::folders;
use gsk_host::files::overwrite_guard::{CommandInputs, check_overwrites, collect_outputs};
use gsk_host::job::{self, write_section};
use gsk_host::loading;
use gsk_messages::{Language, say};
use gsk_runner::curves::RapidRates;
use gsk_runner::move_output;
use gsk_runner::report::{self, PartReport, ProgramReport};

use super::results::{check_files, check_into_file, print_results};
use super::{CommandError, mill, output};
use crate::cli::CheckArgs;

/// Checks programs, prints the results and returns the highest exit code. Returns an error if a
/// file cannot be read or written.
pub fn check(args: &CheckArgs, language: Option<Language>) -> Result<u8, CommandError> {
    if args.setup.selected_model().is_mill() {
        return mill::check(args, language);
    }
    let create_setup = || {
        let work_zero = args.look.work_zero;
        loading::command_setup(&args.setup, work_zero, language).map_err(CommandError::from)
    };
    let options = (args, language);
    check_programs(options, create_setup, move_output::write_move, check_file)
}

/// Options of the command, and the language of its texts.
pub(super) type CheckOptions<'a> = (&'a CheckArgs, Option<Language>);

/// Checks programs of one kind of machine: with the set-up that `create_setup` makes after the
/// file names are checked, `check_file` checks a file and passes its moves on, and `write_move`
/// writes a move as a line of `--moves`. The flag of `check_file` is true for the only file.
pub(super) fn check_programs<S: Sync, M>(
    (args, language): CheckOptions<'_>,
    create_setup: impl FnOnce() -> Result<S, CommandError>,
    write_move: impl Fn(&mut dyn Write, &M) -> io::Result<()>,
    check_file: impl Fn(
        &S,
        &Path,
        CheckOptions<'_>,
        bool,
        &mut dyn FnMut(&M),
    ) -> Result<ProgramReport, CommandError>
    + Sync,
) -> Result<u8, CommandError> {
    let (files, mut errors) = folders::find_programs(&args.files);
    if args.moves.is_some() && files.len() > 1 {
        return Err(say::command_one_program().into());
    }
    if args.part.section.is_some() && files.len() > 1 {
        return Err(say::command_one_section().into());
    }
    // Moves and section belong to one program: an error here would leave them incomplete.
    if (args.moves.is_some() || args.part.section.is_some())
        && let Some(error) = errors.pop()
    {
        return Err(error.into());
    }
    let setup = create_setup()?;
    // A mill reads nothing from the data directory.
    let is_mill = args.setup.selected_model().is_mill();
    let data_dir = args.setup.data.as_ref().filter(|_| !is_mill);
    let inputs = CommandInputs {
        files: files
            .iter()
            .map(PathBuf::as_path)
            .chain(args.setup.input_files())
            .collect(),
        main_program: files.first().map(PathBuf::as_path),
        data_dir: data_dir.map(PathBuf::as_path),
    };
    let outputs = collect_outputs(&[&args.moves, &args.part.section]);
    check_overwrites(&inputs, &outputs)?;
    if let (Some(path), [file]) = (&args.moves, &files[..]) {
        let report = check_into_file(path, write_move, |on_move| {
            check_file(&setup, file, (args, language), true, on_move)
        })?;
        let aside = output::is_standard_output(Some(path));
        return print_results(&[Ok(report)], args.format(), aside, language);
    }
    let mut results = check_files(&files, &|file, is_only| {
        check_file(&setup, file, (args, language), is_only, &mut |_| {})
    });
    results.extend(errors.into_iter().map(|error| Err(error.into())));
    print_results(&results, args.format(), false, language)
}

fn check_file(
    setup: &Setup,
    file: &Path,
    (args, language): CheckOptions<'_>,
    is_only: bool,
    on_move: &mut dyn FnMut(&ExecutedMove),
) -> Result<ProgramReport, CommandError> {
    let mut setup = setup.clone();
    loading::open_program(&mut setup, &[file.to_owned()])?.print(language);
    let mut watch =
        output::watch_preview(&setup.memory.programs, args.look.limits.start(), is_only);
    let name = file.display().to_string();
    let mut should_continue = |progress: &PreviewProgress| watch.update_progress(progress);
    if !args.part.is_requested() {
        let report = report::check_program(&name, &setup, language, on_move, &mut should_continue);
        return Ok(report);
    }
    let job_choice = job::choose(&args.part.job, Some(file), &setup)?;
    if let Some(message) = job_choice.set_work_zero(&mut setup) {
        complain!("gsk980td: {}", report::message_text(&message, language));
    }
    let mut machining = job_choice.create_machining();
    let rates = RapidRates::from_memory(&setup.memory);
    let mut cut_move = |executed: &ExecutedMove| {
        machining.execute_move(executed, rates);
        on_move(executed);
    };
    let mut report =
        report::check_program(&name, &setup, language, &mut cut_move, &mut should_continue);
    if let Some(path) = &args.part.section {
        write_section(path, &machining)?;
    }
    report.part = Some(PartReport::new(
        &machining,
        job_choice.file_name(),
        args.part.measure,
        language,
    ));
    Ok(report)
}
