//! Options of `run`.

use std::path::PathBuf;

use clap::Args;
use gsk_host::job::PartArgs;
use gsk_host::setup_args::{self, SetupArgs};

use super::{MqttArgs, MtconnectArgs, PictureArgs, RunDebugArgs, RunRestartArgs};

/// `run`.
#[derive(Args, Debug)]
#[command(
    mut_arg("size", |arg| arg.requires("plot")),
    mut_arg("whole", |arg| arg.requires("plot")),
    mut_arg("labels", |arg| arg.requires("plot")),
    mut_arg("dimensions", |arg| arg.requires("plot")),
    mut_arg("tools", |arg| arg.requires("plot"))
)]
pub struct RunArgs {
    /// The program, then files of subprograms
    #[arg(required_unless_present = "dnc", value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Execute the program from this source (DNC): a file, a serial port, or `-` for standard
    /// input; FILES are then subprograms
    #[arg(long, value_name = "SOURCE")]
    pub dnc: Option<PathBuf>,
    /// A pulse board at this port moves the slides: REAL MOTION. M00 and the next part wait for
    /// Enter at the terminal; without one M00 ends the run [default: the simulated lathe, also
    /// where the machine file names a port]
    #[arg(long, value_name = "PORT")]
    pub link: Option<String>,
    /// Both axes of the real machine make their machine zero return first, X then Z: they MOVE
    #[arg(long, requires = "link")]
    pub home: bool,
    /// Stop after this number of parts (M30, or M99 in the main program)
    #[arg(long, default_value_t = 1, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub parts: u32,
    /// Stop after this machine time, for instance 90s, 30m, 2h
    #[arg(long, default_value = "24h", value_name = "TIME", value_parser = setup_args::parse_duration_ms)]
    pub limit: u64,
    /// Explain the modal state after each block, each move, and the position of each pass of a
    /// cycle
    #[arg(long)]
    pub explain: bool,
    /// Write every move as one JSON object a line (`-`: standard output)
    #[arg(long, value_name = "FILE")]
    pub moves: Option<PathBuf>,
    /// Write time, X (diameter), Z and spindle angle of every millisecond as CSV
    #[arg(long, value_name = "FILE")]
    pub positions: Option<PathBuf>,
    #[command(flatten)]
    pub part: PartArgs,
    /// A cut above the limits breaks the insert of the simulated lathe, stalls its spindle or
    /// loosens its stock (exit code 3). A stall and loose stock end the run. The limits are those of
    /// `load` in the machine file
    #[arg(long, conflicts_with = "link")]
    pub overload: bool,
    #[command(flatten)]
    pub debug: RunDebugArgs,
    #[command(flatten)]
    pub restart: RunRestartArgs,
    #[command(flatten)]
    pub mtconnect: MtconnectArgs,
    #[command(flatten)]
    pub mqtt: MqttArgs,
    /// Draw the executed toolpath (name ends in .png or .svg)
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    #[command(flatten)]
    pub picture: PictureArgs,
    /// Print the result as one JSON object
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub setup: SetupArgs,
}
