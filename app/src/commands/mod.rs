//! The commands, one file each; each returns the exit code.

mod check;
mod ladder;
mod link;
mod operate;
mod output;
mod plot;
mod run;
mod screen;
mod tables;
mod window;

use std::process::ExitCode;

use crate::cli::{Cli, Command};

/// Exit code: all right.
pub const FINE: u8 = 0;
/// Exit code: the control raised an alarm, or a script failed.
pub const ALARM: u8 = 1;
/// Exit code: wrong call, or a file that cannot be used.
pub const USAGE: u8 = 2;

/// Carries out a command line.
pub fn carry_out(cli: Cli) -> ExitCode {
    let result = match cli.command {
        None => window::open(cli.window),
        Some(Command::Run(args)) => run::run(&args),
        Some(Command::Check(args)) => check::check(&args),
        Some(Command::Plot(args)) => plot::plot(&args),
        Some(Command::Operate(args)) => operate::operate(&args),
        Some(Command::Screen(args)) => screen::screen(&args),
        Some(Command::Keys(args)) => tables::keys(&args),
        Some(Command::Parameters(args)) => tables::parameters(&args),
        Some(Command::Alarms(args)) => tables::alarms(&args),
        Some(Command::Signals(args)) => tables::signals(&args),
        Some(Command::Faults(args)) => tables::faults(&args),
        Some(Command::Ladder(command)) => ladder::ladder(&command),
        Some(Command::Link(command)) => link::link(&command),
    };
    match result {
        Ok(code) => ExitCode::from(code),
        Err(said) => {
            eprintln!("gsk980td: {said}");
            ExitCode::from(USAGE)
        }
    }
}
