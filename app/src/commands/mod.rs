//! The commands, one file each. Each returns its exit code.

mod check;
mod dialect;
mod error;
mod help;
mod ladder;
mod lesson;
mod link;
mod lsp;
mod manual;
mod mill;
mod mill_setup;
mod operate;
mod pitch;
mod plot;
mod project;
mod results;
mod run;
mod screen;
mod tables;
mod transfer;
pub mod window;

use std::process::ExitCode;

pub use error::CommandError;
use gsk_messages::say;

use crate::cli::{Cli, Command, of_the_system};
use crate::guard::holder;
use crate::{log, output};

/// Exit code: success.
pub const FINE: u8 = 0;
/// Exit code: the control raised an alarm, or a script failed.
pub const ALARM: u8 = 1;
/// Exit code: wrong call, or an unusable file.
pub const USAGE: u8 = 2;

/// Exit code: a tool collided.
pub const COLLISION: u8 = 3;

/// The program's notice, its licence, and the licences of its packages.
const NOTICES: [&str; 3] = [
    include_str!("../../../NOTICE"),
    include_str!("../../../LICENSE-MIT"),
    include_str!("../../../THIRD-PARTY.md"),
];

fn notices() -> u8 {
    output::print(
        &NOTICES
            .map(|text| format!("{}\n\n", text.trim_end()))
            .concat(),
    );
    FINE
}

fn hold(port: &str, baud: u32) -> Result<u8, CommandError> {
    holder::hold(port, baud)?;
    Ok(FINE)
}

/// Carries out a command line and returns the exit code of the process.
pub fn carry_out(cli: Cli) -> ExitCode {
    let _log = match (&cli.command, cli.log) {
        (Some(_), Some(level)) => log::on_terminal(level),
        _ => None,
    };
    let told = cli.lang.or_else(of_the_system);
    let language = match &cli.command {
        // The window has stored its language, and an editor sends its own.
        None | Some(Command::Lsp(_)) => cli.lang,
        Some(_) => told,
    };
    if let Some(told) = told {
        output::speak(told);
    }
    let result = match cli.command {
        None => window::open(cli.window, language, cli.log),
        Some(Command::Run(args)) => run::run(&args, language),
        Some(Command::Check(args)) => check::check(&args, language),
        Some(Command::Plot(args)) => plot::plot(&args, language),
        Some(Command::Dialect(args)) => dialect::dialect(&args, language),
        Some(Command::Operate(args)) => operate::operate(&args, language),
        Some(Command::Lesson(command)) => lesson::lesson(&command, language),
        Some(Command::Screen(args)) => screen::screen(&args),
        Some(Command::Keys(args)) => tables::keys(&args, language),
        Some(Command::Parameters(args)) => tables::parameters(&args, language),
        Some(Command::Alarms(args)) => tables::alarms(&args, language),
        Some(Command::Signals(args)) => tables::signals(&args, language),
        Some(Command::Faults(args)) => tables::faults(&args, language),
        Some(Command::Ladder(command)) => ladder::ladder(&command),
        Some(Command::Mill(command)) => mill_setup::work_out(&command, language),
        Some(Command::Link(args)) => link::link(&args.command),
        Some(Command::Pitch(command)) => pitch::pitch(&command, language),
        Some(Command::Project(command)) => project::project(&command, language),
        Some(Command::Transfer(args)) => transfer::transfer(&args.command),
        Some(Command::Help(args)) => help::help(&args, language),
        Some(Command::Lsp(args)) => lsp::lsp(&args, language),
        Some(Command::Notices) => Ok(notices()),
        Some(Command::Completions(args)) => Ok(manual::completions(&args)),
        Some(Command::Man(args)) => manual::man(&args),
        Some(Command::HoldPort(args)) => hold(&args.port, args.baud),
    };
    let code = result.unwrap_or_else(|said| {
        tracing::error!("{said}");
        output::complain_of(&said.message());
        USAGE
    });
    match output::lost() {
        Some(error) => {
            output::complain_of(&say::command_standard_output_lost(error));
            ExitCode::from(code.max(USAGE))
        }
        None => ExitCode::from(code),
    }
}
