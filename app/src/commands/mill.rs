//! `check` and `plot` for programs of a mill.

use std::path::{Path, PathBuf};

use gsk_core::preview::{End, Progress};
use gsk_messages::{Language, say};
use gsk_milling::{MillMove, preview_while};
use gsk_runner::mill::{self, MillSetup};
use gsk_runner::picture::Format;
use gsk_runner::picture::mill::{MillDrawing, encode};
use gsk_runner::report::{self, AlarmReport, Report};
use gsk_runner::words::clock;

use super::results::{all, into_file, print};
use super::run::title;
use super::{ALARM, CommandError, FINE, output};
use crate::apart::{Read, keep_apart, results};
use crate::cli::{CheckArgs, PlotArgs};
use crate::files::folders;
use crate::loading::{self, LoadError};
use crate::picture::check_name;
use crate::setup_args::OfMill;

/// The error for an option that mills do not have.
fn refuse(option: &'static str) -> CommandError {
    LoadError::OfMill(OfMill::LathesAlone(option)).into()
}

pub fn check(args: &CheckArgs, language: Option<Language>) -> Result<u8, CommandError> {
    if args.part.wanted() {
        return Err(refuse("--part"));
    }
    if args.look.work_zero.is_some() {
        return Err(refuse("--work-zero"));
    }
    let (setup, _) = loading::mill(&args.setup)?;
    let (files, mut wrong) = folders::programs(&args.files);
    if args.moves.is_some() && files.len() > 1 {
        return Err(CommandError::OneProgram);
    }
    if args.moves.is_some()
        && let Some(error) = wrong.pop()
    {
        return Err(error.into());
    }
    let read = Read {
        files: files.iter().map(PathBuf::as_path).collect(),
        main: files.first().map(PathBuf::as_path),
        data: None,
    };
    keep_apart(&read, &results(&[&args.moves]))?;
    if let (Some(path), [file]) = (&args.moves, &files[..]) {
        let report = into_file(path, mill::write_move, |on_move| {
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
    setup: &MillSetup,
    file: &Path,
    (args, language): (&CheckArgs, Option<Language>),
    alone: bool,
    on_move: &mut dyn FnMut(&MillMove),
) -> Result<Report, CommandError> {
    let (_, mut programs) = loading::mill(&args.setup)?;
    loading::open(&mut programs, &[file.to_owned()])?.print(language);
    let programs = &programs.memory.programs;
    let mut watch = output::watch(programs, args.look.limits.begin(), alone);
    let name = file.display().to_string();
    let mut goes_on = |progress: &Progress| watch.goes_on(progress);
    Ok(mill::check(
        &name,
        setup,
        programs,
        language,
        on_move,
        &mut goes_on,
    ))
}

/// Draws a program in four views. The moves before an alarm are drawn as well.
pub fn plot(args: &PlotArgs, language: Option<Language>) -> Result<u8, CommandError> {
    check_name(&args.output)?;
    let format = Format::of(&args.output)?;
    let refused = [
        (args.part.wanted() || args.picture.needs_part(), "--part"),
        (args.solid, "--solid"),
        (args.picture.labels, "--labels"),
        (args.look.work_zero.is_some(), "--work-zero"),
    ];
    if let Some((_, option)) = refused.into_iter().find(|(given, _)| *given) {
        return Err(refuse(option));
    }
    let main = args.file.as_path();
    let read = Read {
        files: vec![main],
        main: Some(main),
        data: None,
    };
    keep_apart(&read, &[&args.output])?;
    let (setup, mut programs) = loading::mill(&args.setup)?;
    loading::open(&mut programs, std::slice::from_ref(&args.file))?.print(language);
    let programs = &programs.memory.programs;
    let target = output::reserve(&args.output)?;
    let mut drawing = MillDrawing::new(title(&args.file), args.picture.look());
    let mut watch = output::watch(programs, args.look.limits.begin(), true);
    let preview = preview_while(
        &setup,
        programs,
        &mut |made| drawing.push(made),
        &mut |progress| watch.goes_on(progress),
    );
    drop(watch);
    target.write(&encode(format, &drawing, language.unwrap_or(Language::En))?)?;
    let drawn = say::plot_written(args.output.display(), clock(preview.time_s));
    output::print(&format!("{}\n", report::said(&drawn, language)));
    if drawing.left_out() > 0 {
        let said = say::picture_not_complete(drawing.left_out());
        complain!("gsk980td: {}", report::said(&said, language));
    }
    if let Some(alarm) = &preview.alarm {
        let alarm = AlarmReport::new(alarm, programs, language);
        complain!("gsk980td: {}", alarm.sentence(language));
    }
    if preview.end == End::Limit {
        let said = report::said(&say::report_limit(), language);
        complain!("gsk980td: {}: {said}", args.file.display());
    }
    Ok(match preview.end {
        End::Alarm | End::Limit => ALARM,
        End::M30 | End::M02 | End::M99 | End::Text => FINE,
    })
}
