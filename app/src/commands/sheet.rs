//! `sheet`: writes the setup sheet of a program.

use std::path::{Path, PathBuf};

use gsk_core::setup::Setup;
use gsk_core::units::Diameter;
use gsk_host::files::overwrite_guard::{CommandInputs, check_overwrites};
use gsk_host::files::program_file;
use gsk_host::job::{self, JobArgs};
use gsk_host::loading::{self, LoadError};
use gsk_messages::{Language, say};
use gsk_plot::{DrawingOptions, PathDrawing, PictureFormat, PictureSize};
use gsk_runner::curves::RapidRates;
use gsk_runner::machining::Machining;
use gsk_runner::report::{self, PartReport, ProgramReport};
use gsk_runner::sheet::SetupSheet;
use gsk_workpiece::job::DiameterPoint;
use sha2::{Digest, Sha256};

use super::results::report_exit_code;
use super::run::picture_title;
use super::{CommandError, output};
use crate::cli::SheetArgs;

/// Writes the setup sheet of a program and returns the exit code of its check. Returns an error if
/// a file cannot be read or written.
pub fn sheet(args: &SheetArgs, language: Option<Language>) -> Result<u8, CommandError> {
    args.setup.refuse_mill().map_err(LoadError::from)?;
    let main = args.file.as_path();
    let target = args.out.clone().unwrap_or_else(|| default_path(main));
    check_target(args, &target)?;
    let mut setup = loading::command_setup(&args.setup, args.look.work_zero, language)?;
    loading::open_program(&mut setup, core::slice::from_ref(&args.file))?.print(language);
    let job_args = JobArgs {
        part: true,
        job: args.job.clone(),
    };
    let job_choice = job::choose(&job_args, Some(main), &setup)?;
    // The sheet names the zero of the job: no message.
    let _ = job_choice.set_work_zero(&mut setup);
    let given_zero = args
        .look
        .work_zero
        .map(|(x, z)| DiameterPoint { x: Diameter(x), z });
    let mut machining = job_choice.create_machining();
    let (mut report, path) = check_and_draw(args, &setup, &mut machining, language);
    let name = job_choice.file_name();
    report.part = Some(PartReport::new(&machining, name, true, language));
    let words = language.unwrap_or(Language::En);
    let programs = &setup.memory.programs;
    let selected = programs.selected().and_then(|id| programs.get(id));
    let Some(program) = selected else {
        return Err(say::file_not_there().into());
    };
    let file_name = picture_title(main);
    let hash = hex(&Sha256::digest(program_file::read_bytes(main)?));
    let part_picture = svg_text(&part_drawing(&machining), words)?;
    let path_picture = svg_text(&path, words)?;
    let sheet = SetupSheet {
        file_name: &file_name,
        program,
        hash: &hash,
        report: &report,
        job: &job_choice.job,
        offsets: &setup.memory.offsets,
        zero: job_choice.job.zero.or(given_zero),
        part_picture: &part_picture,
        path_picture: &path_picture,
    };
    write_sheet(&target, &sheet.render(words), language)?;
    Ok(report_exit_code(&report))
}

/// Returns the default path of the sheet: `shaft.sheet.html` for `shaft.CNC`.
fn default_path(program: &Path) -> PathBuf {
    program.with_extension("sheet.html")
}

/// Refuses a sheet that is no HTML file, or that overwrites a file which the command reads.
fn check_target(args: &SheetArgs, target: &Path) -> Result<(), CommandError> {
    let ending = target
        .extension()
        .map(|it| it.to_string_lossy().to_ascii_lowercase());
    let is_html = matches!(ending.as_deref(), Some("html" | "htm"));
    if !is_html && !output::is_standard_output(Some(target)) {
        return Err(say::sheet_ending(target.display()).into());
    }
    let inputs = CommandInputs {
        files: core::iter::once(args.file.as_path())
            .chain(args.job.as_deref())
            .chain(args.setup.input_files())
            .collect(),
        main_program: Some(&args.file),
        data_dir: args.setup.data.as_deref(),
    };
    Ok(check_overwrites(&inputs, &[target])?)
}

/// Checks the program, cuts the part, and draws the path with the numbers of its blocks.
fn check_and_draw(
    args: &SheetArgs,
    setup: &Setup,
    machining: &mut Machining,
    language: Option<Language>,
) -> (ProgramReport, PathDrawing) {
    let rates = RapidRates::from_memory(&setup.memory);
    let options = DrawingOptions {
        size: PictureSize::WIDE,
        labels: true,
        tools: true,
        ..DrawingOptions::default()
    };
    let mut path = PathDrawing::new("", options);
    let mut watch = output::watch_preview(&setup.memory.programs, args.look.limits.start(), true);
    let name = args.file.display().to_string();
    let report = report::check_program(
        &name,
        setup,
        language,
        &mut |executed| {
            path.add_move(executed, rates);
            machining.execute_move(executed, rates);
        },
        &mut |progress| watch.update_progress(progress),
    );
    path.end(report.time_s);
    path.add_scenery(machining);
    (report, path)
}

/// Returns a drawing of the finished part with its dimensions, without a path.
fn part_drawing(machining: &Machining) -> PathDrawing {
    let options = DrawingOptions {
        size: PictureSize::WIDE,
        dimensions: true,
        ..DrawingOptions::default()
    };
    let mut drawing = PathDrawing::new("", options);
    drawing.fit_to_part(machining);
    drawing.add_scenery(machining);
    drawing
}

fn svg_text(drawing: &PathDrawing, language: Language) -> Result<String, CommandError> {
    let bytes = gsk_plot::encode(PictureFormat::Svg, drawing, language)?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

fn write_sheet(target: &Path, text: &str, language: Option<Language>) -> Result<(), CommandError> {
    if output::is_standard_output(Some(target)) {
        output::print(text);
        return Ok(());
    }
    output::reserve_file(target)?.write(text.as_bytes())?;
    let written = report::message_text(&say::sheet_written(target.display()), language);
    output::print(&format!("{written}\n"));
    Ok(())
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
