//! The setup sheet of a program: checks the program, cuts its part, and draws both pictures.

use core::fmt::Write;

use gsk_core::command::ProgramId;
use gsk_core::preview::PreviewProgress;
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_messages::{Language, Message, say};
use gsk_runner::curves::RapidRates;
use gsk_runner::machining::Machining;
use gsk_runner::report::{self, PartReport, ProgramReport};
use gsk_runner::sheet::SetupSheet;
use gsk_workpiece::job::DiameterPoint;
use sha2::{Digest, Sha256};

use crate::{DrawingOptions, PathDrawing, PictureFormat, PictureSize, encode};

/// What a setup sheet is made from.
pub struct SheetSource<'a> {
    /// Name of the program file, as the sheet prints it.
    pub file_name: &'a str,
    /// Name of the program in the report.
    pub program_name: &'a str,
    /// Content of the program file, which the hash covers.
    pub file: &'a [u8],
    /// The control with the selected program.
    pub setup: &'a Setup,
    /// The uncut part with stock and tools.
    pub machining: Machining,
    /// Name of the job file; `None` if stock and tools are guessed.
    pub job_file: Option<String>,
    /// Work zero that the caller was given; `None` without one.
    pub given_zero: Option<DiameterPoint>,
    /// Language of the report; `None` for both.
    pub report_language: Option<Language>,
}

/// Makes a setup sheet as an HTML page, with the report of its check. `may_continue` returns false
/// to stop the check.
///
/// # Errors
/// No program is selected, or a picture does not fit into memory.
pub fn make_setup_sheet(
    source: SheetSource<'_>,
    language: Language,
    may_continue: &mut dyn FnMut(&PreviewProgress) -> bool,
) -> Result<(String, ProgramReport), Message> {
    let (setup, mut machining) = (source.setup, source.machining);
    let rates = RapidRates::from_memory(&setup.memory);
    let options = DrawingOptions {
        size: PictureSize::WIDE,
        labels: true,
        tools: true,
        ..DrawingOptions::default()
    };
    let mut path = PathDrawing::new("", options);
    let mut report = report::check_program(
        source.program_name,
        setup,
        source.report_language,
        &mut |executed| {
            path.add_move(executed, rates);
            machining.execute_move(executed, rates);
        },
        may_continue,
    );
    path.end(report.time_s);
    path.add_scenery(&machining);
    let job_file = source.job_file;
    report.part = Some(PartReport::new(
        &machining,
        job_file,
        true,
        source.report_language,
    ));
    let programs = &setup.memory.programs;
    let selected = programs.selected().and_then(|id| programs.get(id));
    let program = selected.ok_or_else(say::file_not_there)?;
    let part_picture = svg_text(&part_drawing(&machining), language)?;
    let path_picture = svg_text(&path, language)?;
    let job = machining.job();
    let sheet = SetupSheet {
        file_name: source.file_name,
        model: setup.memory.model.id(),
        program,
        subprograms: subprograms(&report, setup),
        hash: &hex(&Sha256::digest(source.file)),
        report: &report,
        job,
        offsets: &setup.memory.offsets,
        zero: job.zero.or(source.given_zero),
        part_picture: &part_picture,
        path_picture: &path_picture,
    };
    let page = sheet.render(language);
    Ok((page, report))
}

/// The programs of the memory that the checked one called, with their names.
fn subprograms<'a>(report: &ProgramReport, setup: &'a Setup) -> Vec<(String, &'a Program)> {
    let programs = &setup.memory.programs;
    let naming = setup.memory.model.record().program_naming();
    let called = report.path.as_ref();
    let called = called.map_or(&[][..], |path| path.programs.as_slice());
    let others = called.iter().filter(|id| programs.selected() != Some(**id));
    let named = others.filter_map(|id| match id {
        ProgramId::Stored(number) => Some((naming.name(*number), programs.get(*id)?)),
        _ => None,
    });
    named.collect()
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

fn svg_text(drawing: &PathDrawing, language: Language) -> Result<String, Message> {
    let bytes = encode(PictureFormat::Svg, drawing, language);
    let bytes = bytes.map_err(|error| error.message())?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}
