//! `check` and `plot` for programs of a mill.

use std::path::Path;

use gsk_host::files::overwrite_guard::{CommandInputs, check_overwrites};
use gsk_host::loading::{self, LoadError};
use gsk_host::setup_args::ModelMismatch;
use gsk_messages::{Language, say};
use gsk_milling::{MillMove, preview_while};
use gsk_plot::PictureFormat;
use gsk_plot::mill::{MillDrawing, encode_mill};
use gsk_runner::mill::{self, MillSetup};
use gsk_runner::report::ProgramReport;

use super::results::{CheckOptions, check_programs, report_end, report_picture};
use super::run::picture_title;
use super::{CommandError, output};
use crate::cli::{CheckArgs, PlotArgs};
use crate::picture::check_name;

/// Creates the error for an option that applies to lathes only.
fn lathe_option_error(option: &'static str) -> CommandError {
    LoadError::OfMill(ModelMismatch::LatheOnly(option)).into()
}

/// Checks programs of a mill, as `check` does for a lathe. Returns an error for an option
/// that applies to lathes only, and for a file that cannot be read or written.
pub fn check(args: &CheckArgs, language: Option<Language>) -> Result<u8, CommandError> {
    if args.is_load_requested() {
        return Err(lathe_option_error("--load"));
    }
    if args.part.is_requested() {
        return Err(lathe_option_error("--part"));
    }
    if args.look.work_zero.is_some() {
        return Err(lathe_option_error("--work-zero"));
    }
    let (setup, _) = loading::mill_setup(&args.setup)?;
    check_programs((args, language), || Ok(setup), mill::write_move, check_file)
}

fn check_file(
    setup: &MillSetup,
    file: &Path,
    (args, language): CheckOptions<'_>,
    is_only: bool,
    on_move: &mut dyn FnMut(&MillMove),
) -> Result<ProgramReport, CommandError> {
    let (_, mut programs) = loading::mill_setup(&args.setup)?;
    loading::open_program(&mut programs, &[file.to_owned()])?.print(language);
    let programs = &programs.memory.programs;
    let mut watch = output::watch_preview(programs, args.look.limits.start(), is_only);
    let name = file.display().to_string();
    Ok(mill::check_program(
        &name,
        setup,
        programs,
        language,
        on_move,
        &mut |progress| watch.update_progress(progress),
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
    let shortfall = match drawing.omitted_moves() {
        0 => None,
        omitted => Some(say::picture_not_complete(omitted)),
    };
    report_picture(args, preview.time_s, shortfall.as_ref(), language);
    let alarm = preview.alarm.as_ref();
    Ok(report_end(args, preview.end, alarm, programs, language))
}
