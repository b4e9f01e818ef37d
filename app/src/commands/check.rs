//! `check`: previews programs without running the machine.

use std::io::{self, Write};
use std::path::Path;

use gsk_core::command::ExecutedMove;
use gsk_core::preview::{Lint, PreviewProgress};
use gsk_core::setup::Setup;
use gsk_host::files::tool_library;
use gsk_host::job::{self, write_section};
use gsk_host::loading;
use gsk_messages::Language;
use gsk_runner::curves::RapidRates;
use gsk_runner::machining::{LoadSummary, Machining};
use gsk_runner::move_output;
use gsk_runner::report::{self, PartReport, ProgramReport};
use gsk_workpiece::cutting::CuttingMaterial;
use gsk_workpiece::job::Job;

use super::results::{CheckOptions, check_programs};
use super::{CommandError, EXIT_OK, mill, output};
use crate::cli::CheckArgs;

/// Checks programs, prints the results and returns the highest exit code. Returns an error if a
/// file cannot be read or written.
pub fn check(args: &CheckArgs, language: Option<Language>) -> Result<u8, CommandError> {
    if args.lints {
        output::print(&list_lints(language));
        return Ok(EXIT_OK);
    }
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

/// The kinds of warnings, one in a line: code, name, sentence.
fn list_lints(language: Option<Language>) -> String {
    let lines = Lint::ALL.into_iter().map(|it| {
        let summary = report::message_text(&it.summary(), language);
        format!("{}  {:<22}{summary}\n", it.code(), it.id())
    });
    lines.collect()
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
    if !args.part.is_requested() && !args.is_load_requested() {
        let report = report::check_program(&name, &setup, language, on_move, &mut should_continue);
        return Ok(report);
    }
    let job_choice = job::choose(&args.part.job, Some(file), &setup)?;
    if let Some(message) = job_choice.set_work_zero(&mut setup) {
        complain!("gsk980td: {}", report::message_text(&message, language));
    }
    let mut machining = job_choice.create_machining();
    let rates = RapidRates::from_memory(&setup.memory);
    let mut loads = LoadOutput::new(args, &job_choice.job)?;
    let mut cut_move = |executed: &ExecutedMove| {
        loads.execute_move(&mut machining, executed, rates);
        on_move(executed);
    };
    let mut report =
        report::check_program(&name, &setup, language, &mut cut_move, &mut should_continue);
    if let Some(path) = &args.part.section {
        write_section(path, &machining)?;
    }
    loads.finish()?;
    if args.is_load_requested() {
        let (limits, job) = (&setup.lathe.load, &job_choice.job);
        let is_guessed = job_choice.file.is_none();
        report.add_load(&loads.summary, limits, job, is_guessed, language);
    }
    let lives = tool_library::life_limits(&job_choice.job);
    report.add_tool_lives(&machining, &lives, language);
    if args.part.is_requested() {
        report.part = Some(PartReport::new(
            &machining,
            job_choice.file_name(),
            args.part.measure,
            language,
        ));
    }
    Ok(report)
}

/// The loads of a program and the CSV file that receives them.
struct LoadOutput<'a> {
    /// Material of the job; `None` if no load was requested or the table has no constants.
    material: Option<CuttingMaterial>,
    summary: LoadSummary,
    csv: Option<(&'a Path, Box<dyn Write>)>,
    error: Option<io::Error>,
}

impl<'a> LoadOutput<'a> {
    fn new(args: &'a CheckArgs, job: &Job) -> Result<Self, CommandError> {
        let csv = match &args.load_csv {
            Some(path) => Some((path.as_path(), output::open(path)?)),
            None => None,
        };
        let mut loads = Self {
            material: job.cutting_material().filter(|_| args.is_load_requested()),
            summary: LoadSummary::default(),
            csv,
            error: None,
        };
        loads.write(|out| out.write_all(move_output::LOADS_HEADER.as_bytes()));
        Ok(loads)
    }

    fn write(&mut self, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) {
        if let (Some((_, out)), None) = (&mut self.csv, &self.error) {
            self.error = write(out).err();
        }
    }

    /// Cuts the part with a move and stores its load.
    fn execute_move(
        &mut self,
        machining: &mut Machining,
        executed: &ExecutedMove,
        rates: RapidRates,
    ) {
        let Some(material) = &self.material else {
            machining.execute_move(executed, rates);
            return;
        };
        let load = machining.execute_move_with_load(executed, rates, material);
        if let Some(load) = load {
            self.summary.add_move(&load);
            self.write(|out| move_output::write_loads(out, &load));
        }
    }

    /// Completes the CSV file. Returns the first error of a write.
    fn finish(&mut self) -> Result<(), CommandError> {
        self.write(|out| out.flush());
        match (&self.csv, self.error.take()) {
            (Some((path, _)), Some(error)) => Err(output::WriteError::new(path, error).into()),
            _ => Ok(()),
        }
    }
}
