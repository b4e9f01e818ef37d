//! `check`: previews programs without running the machine.

use std::path::{Path, PathBuf};

use gsk_core::command::ExecutedMove;
use gsk_core::preview::Progress;
use gsk_core::setup::Setup;
use gsk_messages::Language;
use gsk_runner::curves::RapidRates;
use gsk_runner::moves;
use gsk_runner::report::{self, PartReport, Report};

use super::results::{all, into_file, print};
use super::{CommandError, mill, output};
use crate::apart::{Read, keep_apart, results};
use crate::cli::CheckArgs;
use crate::files::folders;
use crate::job::{self, write_section};
use crate::loading;

/// Checks programs and returns the exit code.
pub fn check(args: &CheckArgs, language: Option<Language>) -> Result<u8, CommandError> {
    if args.setup.model().is_mill() {
        return mill::check(args, language);
    }
    let (files, mut wrong) = folders::programs(&args.files);
    if args.moves.is_some() && files.len() > 1 {
        return Err(CommandError::OneProgram);
    }
    if args.part.section.is_some() && files.len() > 1 {
        return Err(CommandError::OneSection);
    }
    // Moves and section belong to one program: an error here would leave them incomplete.
    if (args.moves.is_some() || args.part.section.is_some())
        && let Some(error) = wrong.pop()
    {
        return Err(error.into());
    }
    let setup = loading::setup(&args.setup, args.look.work_zero, language)?;
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
        let report = into_file(path, moves::write_move, |on_move| {
            check_file(&setup, file, (args, language), true, on_move)
        })?;
        let aside = output::is_standard(Some(path));
        return print(&[Ok(report)], args.format(), aside, language);
    }
    let mut results = all(&files, &|file, alone| {
        check_file(&setup, file, (args, language), alone, &mut |_| {})
    });
    results.extend(wrong.into_iter().map(|error| Err(error.into())));
    print(&results, args.format(), false, language)
}

fn check_file(
    setup: &Setup,
    file: &Path,
    (args, language): (&CheckArgs, Option<Language>),
    alone: bool,
    on_move: &mut dyn FnMut(&ExecutedMove),
) -> Result<Report, CommandError> {
    let mut setup = setup.clone();
    loading::open(&mut setup, &[file.to_owned()])?.print(language);
    let mut watch = output::watch(&setup.memory.programs, args.look.limits.begin(), alone);
    let name = file.display().to_string();
    let mut goes_on = |progress: &Progress| watch.goes_on(progress);
    if !args.part.wanted() {
        let report = report::check(&name, &setup, language, on_move, &mut goes_on);
        return Ok(report);
    }
    let chosen = job::choose(&args.part.job, Some(file), &setup)?;
    if let Some(said) = chosen.set_work_zero(&mut setup) {
        complain!("gsk980td: {}", report::said(&said, language));
    }
    let mut machining = chosen.machining();
    let rates = RapidRates::of(&setup.memory);
    let mut take = |executed: &ExecutedMove| {
        machining.moved(executed, rates);
        on_move(executed);
    };
    let mut report = report::check(&name, &setup, language, &mut take, &mut goes_on);
    if let Some(path) = &args.part.section {
        write_section(path, &machining)?;
    }
    report.part = Some(PartReport::new(
        &machining,
        chosen.name(),
        args.part.measure,
        language,
    ));
    Ok(report)
}
