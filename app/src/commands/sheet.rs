//! `sheet`: writes the setup sheet of a program.

use std::path::{Path, PathBuf};

use gsk_core::units::Diameter;
use gsk_host::files::overwrite_guard::{CommandInputs, check_overwrites};
use gsk_host::files::program_file;
use gsk_host::job::{self, JobArgs};
use gsk_host::loading::{self, LoadError};
use gsk_host::output::WriteError;
use gsk_host::platform::{self, PdfPrint};
use gsk_messages::{Language, Message, say};
use gsk_plot::setup_sheet::{SheetSource, make_setup_sheet};
use gsk_runner::report;
use gsk_workpiece::job::DiameterPoint;

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
    let file = program_file::read_bytes(main)?;
    let source = SheetSource {
        file_name: &picture_title(main),
        program_name: &main.display().to_string(),
        file: &file,
        setup: &setup,
        machining: job_choice.create_machining(),
        job_file: job_choice.file_name(),
        given_zero,
        report_language: language,
    };
    let mut watch = output::watch_preview(&setup.memory.programs, args.look.limits.start(), true);
    let words = language.unwrap_or(Language::En);
    let (page, report) = make_setup_sheet(source, words, &mut |progress| {
        watch.update_progress(progress)
    })?;
    drop(watch);
    write_sheet(&target, &page, language)?;
    Ok(report_exit_code(&report))
}

/// Returns the default path of the sheet: `shaft.sheet.html` for `shaft.CNC`.
fn default_path(program: &Path) -> PathBuf {
    program.with_extension("sheet.html")
}

/// Whether a sheet is written as PDF.
fn is_pdf(target: &Path) -> bool {
    let ending = target.extension();
    ending.is_some_and(|ending| ending.eq_ignore_ascii_case("pdf"))
}

/// Refuses a sheet that is neither HTML nor PDF, or that overwrites a file which the command reads.
fn check_target(args: &SheetArgs, target: &Path) -> Result<(), CommandError> {
    let ending = target
        .extension()
        .map(|it| it.to_string_lossy().to_ascii_lowercase());
    let is_html = matches!(ending.as_deref(), Some("html" | "htm"));
    if !is_html && !is_pdf(target) && !output::is_standard_output(Some(target)) {
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

fn write_sheet(target: &Path, text: &str, language: Option<Language>) -> Result<(), CommandError> {
    if output::is_standard_output(Some(target)) {
        output::print(text);
        return Ok(());
    }
    match is_pdf(target) {
        true => print_pdf(target, text)?,
        false => output::reserve_file(target)?.write(text.as_bytes())?,
    }
    let written = report::message_text(&say::sheet_written(target.display()), language);
    output::print(&format!("{written}\n"));
    Ok(())
}

/// Prints a sheet as PDF by an installed browser. Returns an error if there is none or the file
/// is not written.
fn print_pdf(target: &Path, text: &str) -> Result<(), Message> {
    let printed = platform::print_page_as_pdf(text.as_bytes(), target);
    match printed.map_err(|error| WriteError::new(target, error).message())? {
        PdfPrint::Written => Ok(()),
        PdfPrint::NoBrowser => Err(say::sheet_no_browser()),
        PdfPrint::Failed(browser) => Err(say::sheet_no_pdf(browser, target.display())),
    }
}
