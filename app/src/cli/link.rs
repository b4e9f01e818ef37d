//! Options of `link`.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};
use gsk_host::setup_args::{self, SetupArgs};

/// Arguments of the command `link`.
#[derive(Args, Debug)]
pub struct LinkArgs {
    #[command(subcommand)]
    pub command: LinkCommand,
}

/// What is done with a board.
#[derive(Debug, Subcommand)]
pub enum LinkCommand {
    /// List the serial ports
    List,
    /// Identify a board, check its settings, measure its response times
    ///
    /// Without --travel nothing moves. The settings come from the machine file (--machine, section
    /// `link`) and the parameters (--data, --param).
    Test(LinkTestArgs),
    /// Open a board and print all traffic, with the time in seconds
    Monitor(LinkMonitorArgs),
    /// Copy firmware to a Raspberry Pi Pico in boot mode
    ///
    /// Hold the button BOOTSEL while plugging the board in; it then appears as a drive. The command
    /// checks file and board before it copies.
    Flash(LinkFlashArgs),
    /// Simulate a board on a pseudo terminal or a network address; its name is printed first
    Twin(LinkTwinArgs),
}

/// Options that select a board.
#[derive(Args, Debug)]
pub struct LinkBoardArgs {
    /// The port [default: the one of the machine file]
    #[arg(value_name = "PORT")]
    pub port: Option<String>,
    #[command(flatten)]
    pub setup: SetupArgs,
}

/// Arguments of the command `link test`.
#[derive(Args, Debug)]
pub struct LinkTestArgs {
    /// Write the settings that differ to the board
    #[arg(long)]
    pub write_settings: bool,
    /// MOVES Z by this distance in mm and back, with ten feed holds; switch the drives off or clear
    /// the travel
    #[arg(long, value_name = "MM", allow_hyphen_values = true, value_parser = setup_args::parse_distance)]
    pub travel: Option<f64>,
    /// Feed of that move, mm/min
    #[arg(long, default_value = "600", value_name = "F", requires = "travel", allow_hyphen_values = true, value_parser = setup_args::parse_feed)]
    pub feed: f64,
    #[command(flatten)]
    pub board: LinkBoardArgs,
}

/// Arguments of the command `link monitor`.
#[derive(Args, Debug)]
pub struct LinkMonitorArgs {
    /// Stop after this number of seconds
    #[arg(long, value_name = "S")]
    pub seconds: Option<u64>,
    #[command(flatten)]
    pub board: LinkBoardArgs,
}

/// `link flash`.
#[derive(Args, Debug)]
pub struct LinkFlashArgs {
    /// Firmware, a UF2 file
    pub file: PathBuf,
    /// Drive of the board [default: the only Pico in boot mode]
    #[arg(long, value_name = "FOLDER")]
    pub to: Option<PathBuf>,
}

/// `link twin`.
#[derive(Args, Debug)]
pub struct LinkTwinArgs {
    /// Firmware that the board runs
    #[arg(long, value_enum, default_value_t = TwinBoard::Grbl)]
    pub firmware: TwinBoard,
    /// Listen at this address; the port is then `tcp:HOST:PORT`. Port 0 lets the system choose
    /// [default: a pseudo terminal; on Windows 127.0.0.1:0]
    #[arg(long, value_name = "HOST:PORT")]
    pub tcp: Option<String>,
    /// Print a machine file with the wiring of this board, and end
    #[arg(long)]
    pub print_machine: bool,
    /// Drop every Nth byte from the PC to the board
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub lose_every: Option<u64>,
    /// Delay all bytes to the board by this time, ms
    #[arg(long, default_value_t = 0, value_name = "MS")]
    pub delay_ms: u64,
    /// Speed of the simulated spindle at the full output voltage, r/min
    #[arg(long, default_value_t = 9999.0, value_name = "RPM", value_parser = setup_args::parse_number)]
    pub spindle_top: f64,
    /// Klipper, Pico: ripple of the spindle speed, percent
    #[arg(long, default_value_t = 0.0, value_name = "PERCENT", value_parser = setup_args::parse_number)]
    pub ripple: f64,
    /// Klipper: frequency of the ripple, Hz
    #[arg(long, default_value_t = 0.5, value_name = "HZ", value_parser = setup_args::parse_number)]
    pub ripple_hz: f64,
    /// Klipper, Pico: the spindle index fails after this number of seconds
    #[arg(long, value_name = "S")]
    pub lose_index: Option<u64>,
    /// Stop after this number of seconds
    #[arg(long, value_name = "S")]
    pub seconds: Option<u64>,
}

/// Firmware that `link twin` simulates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum TwinBoard {
    /// Grbl 1.1h
    Grbl,
    /// grblHAL
    Grblhal,
    /// FluidNC
    Fluidnc,
    /// Klipper, 250000 bits a second
    Klipper,
    /// This project's firmware on a Raspberry Pi Pico, with a spindle encoder
    Pico,
}
