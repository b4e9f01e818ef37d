//! `check` and `plot` for programs of a mill.

use std::path::{Path, PathBuf};

use gsk_core::preview::{PreviewEnd, PreviewProgress};
use gsk_host::files::folders;
use gsk_host::files::overwrite_guard::{CommandInputs, check_overwrites, collect_outputs};
use gsk_host::loading::{self, LoadError};
use gsk_host::setup_args::ModelMismatch;
use gsk_messages::{Language, say};
use gsk_milling::{MillMove, preview_while};
use gsk_plot::PictureFormat;
use gsk_plot::mill::{MillDrawing, encode_mill};
use gsk_runner::mill::{self, MillSetup};
use gsk_runner::report::{self, AlarmReport, ProgramReport};
use gsk_runner::text_format::format_time;

use super::results::{check_files, check_into_file, print_results};
use super::run::picture_title;
use super::{CommandError, EXIT_ALARM, EXIT_OK, output};
use crate::cli::{CheckArgs, PlotArgs};
use crate::picture::check_name;

/// Creates the error for an option that applies to lathes only.
fn lathe_option_error(option: &'static str) -> CommandError {
    LoadError::OfMill(ModelMismatch::LatheOnly(option)).into()
}

pub fn check(args: &CheckArgs, language: Option<Language>) -> Result<u8, CommandError> {
    if args.part.is_requested() {
        return Err(lathe_option_error("--part"));
    }
    if args.look.work_zero.is_some() {
        return Err(lathe_option_error("--work-zero"));
    }
    let (setup, _) = loading::mill_setup(&args.setup)?;
    let (files, mut errors) = folders::find_programs(&args.files);
    if args.moves.is_some() && files.len() > 1 {
        return Err(say::command_one_program().into());
    }
    if args.moves.is_some()
        && let Some(error) = errors.pop()
    {
        return Err(error.into());
    }
    let inputs = CommandInputs {
        files: files.iter().map(PathBuf::as_path).collect(),
        main_program: files.first().map(PathBuf::as_path),
        data_dir: None,
    };
    check_overwrites(&inputs, &collect_outputs(&[&args.moves]))?;
    if let (Some(path), [file]) = (&args.moves, &files[..]) {
        let report = check_into_file(path, mill::write_move, |on_move| {
            check_file(&setup, file, (args, language), true, on_move)
        })?;
        let aside = output::is_standard_output(Some(path));
        return print_results(&[Ok(report)], args.format(), aside, language);
    }
    let mut results = check_files(&files, &|file, alone| {
        check_file(&setup, file, (args, language), alone, &mut |_| {})
    });
    results.extend(errors.into_iter().map(|error| Err(error.into())));
    print_results(&results, args.format(), false, language)
}

fn check_file(
    setup: &MillSetup,
    file: &Path,
    (args, language): (&CheckArgs, Option<Language>),
    is_only: bool,
    on_move: &mut dyn FnMut(&MillMove),
) -> Result<ProgramReport, CommandError> {
    let (_, mut programs) = loading::mill_setup(&args.setup)?;
    loading::open_program(&mut programs, &[file.to_owned()])?.print(language);
    let programs = &programs.memory.programs;
    let mut watch = output::watch_preview(programs, args.look.limits.start(), is_only);
    let name = file.display().to_string();
    let mut should_continue = |progress: &PreviewProgress| watch.update_progress(progress);
    Ok(mill::check_program(
        &name,
        setup,
        programs,
        language,
        on_move,
        &mut should_continue,
    ))
}

/// Draws a mill program in four views into a picture. The moves before an alarm are drawn as
/// well.
pub fn plot(args: &PlotArgs, language: Option<Language>) -> Result<u8, CommandError> {
    check_name(&args.output)?;
    let format = PictureFormat::from_file_name(&args.output)?;
    let refused_options = [
        (
            args.part.is_requested() || args.picture.needs_part(),
            "--part",
        ),
        (args.solid, "--solid"),
        (args.scene.scene, "--scene"),
        (args.picture.labels, "--labels"),
        (args.look.work_zero.is_some(), "--work-zero"),
    ];
    if let Some((_, option)) = refused_options.into_iter().find(|(given, _)| *given) {
        return Err(lathe_option_error(option));
    }
    let main = args.file.as_path();
    let inputs = CommandInputs {
        files: vec![main],
        main_program: Some(main),
        data_dir: None,
    };
    check_overwrites(&inputs, &[&args.output])?;
    let (setup, mut programs) = loading::mill_setup(&args.setup)?;
    loading::open_program(&mut programs, std::slice::from_ref(&args.file))?.print(language);
    let programs = &programs.memory.programs;
    let target = output::reserve_file(&args.output)?;
    let mut drawing = MillDrawing::new(picture_title(&args.file), args.picture.to_look());
    let mut watch = output::watch_preview(programs, args.look.limits.start(), true);
    let preview = preview_while(
        &setup,
        programs,
        &mut |made| drawing.add_move(made),
        &mut |progress| watch.update_progress(progress),
    );
    drop(watch);
    target.write(&encode_mill(
        format,
        &drawing,
        language.unwrap_or(Language::En),
    )?)?;
    let drawn = say::plot_written(args.output.display(), format_time(preview.time_s));
    output::print(&format!("{}\n", report::message_text(&drawn, language)));
    if drawing.omitted_moves() > 0 {
        let message = say::picture_not_complete(drawing.omitted_moves());
        complain!("gsk980td: {}", report::message_text(&message, language));
    }
    if let Some(alarm) = &preview.alarm {
        let alarm = AlarmReport::new(alarm, programs, language);
        complain!("gsk980td: {}", alarm.sentence(language));
    }
    if preview.end == PreviewEnd::Limit {
        let text = report::message_text(&say::report_limit(), language);
        complain!("gsk980td: {}: {text}", args.file.display());
    }
    Ok(match preview.end {
        PreviewEnd::Alarm | PreviewEnd::Limit => EXIT_ALARM,
        PreviewEnd::M30 | PreviewEnd::M02 | PreviewEnd::M99 | PreviewEnd::Text => EXIT_OK,
    })
}
