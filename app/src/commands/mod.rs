//! The commands, one file each. Each returns its exit code.

mod check;
mod class;
mod dap;
mod dialect;
mod error;
mod exercise;
mod form;
mod help;
mod ladder;
mod lesson;
mod link;
mod load;
mod lsp;
mod manual;
mod mill;
mod mill_setup;
mod network;
mod operate;
mod operate_part;
mod outline;
mod pitch;
mod plot;
mod program_sources;
mod project;
mod replay;
mod results;
mod run;
mod screen;
mod sheet;
mod tables;
mod tools;
mod transfer;
pub mod window;

use std::process::ExitCode;

pub use error::CommandError;
use gsk_host::guard::holder;
use gsk_host::{log, output};
use gsk_messages::say;

use crate::cli::{CliCommand, CommandLine, system_language};

/// Exit code of a command that succeeded.
pub const EXIT_OK: u8 = 0;
/// Exit code if the control raised an alarm, or a script failed.
pub const EXIT_ALARM: u8 = 1;
/// Exit code for a wrong command line or an unusable file.
pub const EXIT_USAGE: u8 = 2;

/// Exit code if a tool collided.
pub const EXIT_COLLISION: u8 = 3;

/// The program's notice, its licence, and the licences of its packages.
const NOTICES: [&str; 3] = [
    include_str!("../../../NOTICE"),
    include_str!("../../../LICENSE-MIT"),
    include_str!("../../../THIRD-PARTY.md"),
];

fn print_notices() -> u8 {
    output::print(
        &NOTICES
            .map(|text| format!("{}\n\n", text.trim_end()))
            .concat(),
    );
    EXIT_OK
}

fn hold_port(port: &str, baud: u32) -> Result<u8, CommandError> {
    holder::hold_port(port, baud)?;
    Ok(EXIT_OK)
}

/// Carries out a command line and returns the exit code of the process.
pub fn run_command_line(cli: CommandLine) -> ExitCode {
    let (log_level, lang) = (cli.global.log, cli.global.lang);
    let _log = match (&cli.command, log_level) {
        (Some(_), Some(level)) => log::start_on_terminal(level),
        _ => None,
    };
    let message_language = lang.or_else(system_language);
    let language = match &cli.command {
        // The window has stored its language, and an editor sends its own.
        None | Some(CliCommand::Lsp(_) | CliCommand::Dap(_)) => lang,
        Some(_) => message_language,
    };
    if let Some(message_language) = message_language {
        output::set_language(message_language);
    }
    let result = match cli.command {
        None => window::open(cli.window, language, log_level),
        Some(CliCommand::Run(args)) => run::run(&args, language),
        Some(CliCommand::Check(args)) => check::check(&args, language),
        Some(CliCommand::Plot(args)) => plot::plot(&args, language),
        Some(CliCommand::Sheet(args)) => sheet::sheet(&args, language),
        Some(CliCommand::Dialect(args)) => dialect::dialect(&args, language),
        Some(CliCommand::Form(args)) => form::form(&args, language),
        Some(CliCommand::Load(group)) => load::load(&group.command, language),
        Some(CliCommand::Tools(group)) => tools::tools(&group.command, language),
        Some(CliCommand::Outline(args)) => outline::outline(&args, language),
        Some(CliCommand::Operate(args)) => operate::operate(&args, language),
        Some(CliCommand::Lesson(group)) => lesson::lesson(&group.command, language),
        Some(CliCommand::Exercise(group)) => exercise::exercise(&group.command, language),
        Some(CliCommand::Class(args)) => class::show_class(&args),
        Some(CliCommand::Replay(args)) => replay::replay(&args, language),
        Some(CliCommand::Screen(args)) => screen::screen(&args),
        Some(CliCommand::Keys(args)) => tables::keys(&args, language),
        Some(CliCommand::Parameters(args)) => tables::parameters(&args, language),
        Some(CliCommand::Alarms(args)) => tables::alarms(&args, language),
        Some(CliCommand::Signals(args)) => tables::signals(&args, language),
        Some(CliCommand::Faults(args)) => tables::faults(&args, language),
        Some(CliCommand::Ladder(group)) => ladder::ladder(&group.command),
        Some(CliCommand::Mill(group)) => mill_setup::run_mill_command(&group.command, language),
        Some(CliCommand::Link(args)) => link::link(&args.command),
        Some(CliCommand::Pitch(group)) => pitch::pitch(&group.command, language),
        Some(CliCommand::Project(group)) => project::project(&group.command, language),
        Some(CliCommand::Transfer(args)) => transfer::transfer(&args.command),
        Some(CliCommand::Help(args)) => help::help(&args, language),
        Some(CliCommand::Lsp(args)) => lsp::lsp(&args, language),
        Some(CliCommand::Dap(args)) => dap::dap(&args, language),
        Some(CliCommand::Notices) => Ok(print_notices()),
        Some(CliCommand::Completions(args)) => Ok(manual::completions(&args)),
        Some(CliCommand::Man(args)) => manual::man(&args),
        Some(CliCommand::HoldPort(args)) => hold_port(&args.port, args.baud),
    };
    let code = result.unwrap_or_else(|error| {
        tracing::error!("{error}");
        output::report_error(&error.message());
        EXIT_USAGE
    });
    match output::stdout_error() {
        Some(error) => {
            output::report_error(&say::command_standard_output_lost(error));
            ExitCode::from(code.max(EXIT_USAGE))
        }
        None => ExitCode::from(code),
    }
}
