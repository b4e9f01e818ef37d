//! Prepares the session of a `launch` request.

use std::path::PathBuf;

use gsk_core::simulation::Simulation;
use gsk_debugger::debugged_run::DebuggedRun;
use gsk_debugger::history::SnapshotHistory;
use gsk_debugger::session::DebugSession;
use gsk_debugger::source_files::ProgramSources;
use gsk_host::job::{self, JobArgs};
use gsk_host::loading;
use gsk_host::setup_args::SetupArgs;
use gsk_messages::{Language, say};
use gsk_runner::machining::live_part::LivePart;

use super::protocol::LaunchArguments;
use crate::commands::CommandError;
use crate::commands::program_sources::find_sources;

/// Loads the program and connects control and lathe. With `needs_part` the run cuts the part.
///
/// # Errors
/// The options, the program or the job cannot be used.
pub fn launch(
    args: &LaunchArguments,
    setup_args: &SetupArgs,
    language: Language,
) -> Result<(DebugSession, ProgramSources), CommandError> {
    if args.program.is_empty() {
        return Err(say::dap_no_program().into());
    }
    let files: Vec<PathBuf> = core::iter::once(&args.program)
        .chain(&args.subprograms)
        .map(PathBuf::from)
        .collect();
    let mut setup = loading::command_setup(setup_args, None, Some(language))?;
    loading::open_program(&mut setup, &files)?;
    let sources = find_sources(&setup.memory.programs, &files);
    let part = match args.part {
        true => {
            let main = files.first().map(PathBuf::as_path);
            let chosen = job::choose(&JobArgs::default(), main, &setup)?;
            Some(LivePart::new(chosen.create_machining()))
        }
        false => None,
    };
    let run = DebuggedRun::new(Simulation::new(setup), part);
    let session = DebugSession::new(run, Box::<SnapshotHistory>::default());
    Ok((session, sources))
}
