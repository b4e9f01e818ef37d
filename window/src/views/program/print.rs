//! Writes the setup sheet of the text in the editor, and opens it in a browser, which prints it.

use std::path::Path;

use gsk_core::command::ProgramId;
use gsk_core::preview::WorkBudget;
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_host::job::{self, JobArgs};
use gsk_host::message_format::describe_io_error;
use gsk_host::platform;
use gsk_host::preview::work_limit::WorkLimit;
use gsk_messages::{Language, Message, say};
use gsk_plot::setup_sheet::{SheetSource, make_setup_sheet};

/// Name of the sheet in the folder for temporary files.
const SHEET_FILE: &str = "gsk980td-sheet.html";
/// Limit of the work of the check.
const WORK_BUDGET: WorkBudget = WorkBudget::interactive(50_000_000);

/// Makes the setup sheet of a text, with the job of its file or a guessed one, and opens it.
/// Returns the message that names the sheet.
///
/// # Errors
/// There is nothing to guess stock and tools from, or the sheet cannot be written or opened.
pub fn print_sheet(
    name: &str,
    text: &str,
    file: Option<&Path>,
    mut setup: Setup,
    language: Language,
) -> Result<Message, Message> {
    let programs = &mut setup.memory.programs;
    programs.open_external(Program::new(text));
    programs.select(ProgramId::External);
    let job_args = JobArgs {
        part: true,
        job: None,
    };
    let job = job::choose(&job_args, file, &setup).map_err(|error| error.message())?;
    // The sheet names the zero of the job: no message.
    let _ = job.set_work_zero(&mut setup);
    let source = SheetSource {
        file_name: name,
        program_name: name,
        file: text.as_bytes(),
        setup: &setup,
        machining: job.create_machining(),
        job_file: job.file_name(),
        given_zero: None,
        report_language: Some(language),
    };
    let limit = WorkLimit::new(WORK_BUDGET);
    let sheet = make_setup_sheet(source, language, &mut |progress| limit.allows(progress));
    let (page, _) = sheet?;
    let opened = platform::open_page_file(SHEET_FILE, page.as_bytes());
    let path =
        opened.map_err(|error| say::sheet_not_opened(SHEET_FILE, describe_io_error(&error)))?;
    Ok(say::program_print_opened(path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_without_moves_has_no_sheet() {
        let printed = print_sheet("x", "M30;\n", None, Setup::default(), Language::En);
        assert!(printed.is_err(), "{printed:?}");
    }
}
