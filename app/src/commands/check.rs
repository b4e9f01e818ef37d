//! `check`: previews programs without running the machine.

use std::path::Path;

use gsk_core::command::ExecutedMove;
use gsk_core::preview::{Lint, PreviewProgress};
use gsk_core::setup::Setup;
use gsk_host::job::{self, write_section};
use gsk_host::loading;
use gsk_messages::Language;
use gsk_runner::curves::RapidRates;
use gsk_runner::move_output;
use gsk_runner::report::{self, PartReport, ProgramReport};

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
