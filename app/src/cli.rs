//! The command line: what `gsk980td --help` says, and nothing else.

use std::path::PathBuf;
use std::time::Duration;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;
use gsk_core::model::ModelId;
use gsk_panel::script::FORMS;
pub use gsk_runner::Language;
use gsk_runner::picture::{Look, Size};
use tracing::level_filters::LevelFilter;

use crate::job::{JobArgs, PartArgs};
use crate::patience::Patience;
use crate::setup_args::SetupArgs;

const EXAMPLES: &str = "\
Examples:
  gsk980td                                  the panel in a window
  gsk980td --program shaft.CNC              the panel with a program opened
  gsk980td check shaft.CNC                  is the program right? how long does it take?
  gsk980td run shaft.CNC --spindle 800      execute it on the simulated lathe, headless
  gsk980td plot shaft.CNC -o shaft.png      its toolpath as a picture
  gsk980td operate lesson.txt               press keys from a script

Exit codes: 0 all right, 1 the control raised an alarm (or a script failed, or a run did not come \
to its end), 2 wrong call or file, 3 a tool hit something (--part), 130 ended by Ctrl-C or a signal at a real machine.";

/// The control of a GSK980TD lathe on a PC: panel, control and simulated lathe.
///
/// Without a command the operator panel opens in a window. Every command does
/// its job without a window and without a display.
#[derive(Debug, Parser)]
#[command(name = "gsk980td", version, after_help = EXAMPLES, args_conflicts_with_subcommands = true)]
pub struct Cli {
    /// What to do instead of opening the window.
    #[command(subcommand)]
    pub command: Option<Command>,
    /// How much is written into the log: off, error, warn, info, debug or trace [default: info
    /// in the window, into `log` of the data folder; off for commands, else on standard error]
    #[arg(long, global = true, value_name = "LEVEL", value_parser = crate::log::level)]
    pub log: Option<LevelFilter>,
    /// Options of the window.
    #[command(flatten)]
    pub window: WindowArgs,
}

/// Options of the window.
#[derive(Args, Clone, Debug, Default)]
pub struct WindowArgs {
    /// Folder of the control's memory (programs, parameters, offsets, counters)
    #[arg(long, value_name = "DIR")]
    pub data: Option<PathBuf>,
    /// Program to open at the start
    #[arg(long, value_name = "FILE")]
    pub program: Option<PathBuf>,
    /// Print the time to the first frame and frames a second on standard error
    #[arg(long)]
    pub figures: bool,
    /// Language of menus and messages; the panel itself is always as printed
    #[arg(long, value_parser = language(), value_name = "LANG")]
    pub lang: Option<Language>,
    /// The machine's ladder instead of the standard one (instruction list)
    #[arg(long, value_name = "FILE")]
    pub ladder: Option<PathBuf>,
    /// What sends programs in DNC mode: a file, a serial port, or `-` for standard input [default: transfer/DNC.CNC in the data folder]
    ///
    /// Unless there is a ladder of its own, the one with keys for DNC and teach-in
    /// runs: 自动 pressed twice is DNC.
    #[arg(long, value_name = "SOURCE")]
    pub dnc: Option<PathBuf>,
    /// The simulated lathe (travel, turret, dogs …) from a RON file
    #[arg(long, value_name = "FILE")]
    pub machine: Option<PathBuf>,
    /// Macro B: formulas, IF, WHILE, GOTO and calls with arguments (G65 P) in programs; the data
    /// folder keeps it [default: as it was, off at first]
    #[arg(long, value_name = "on|off", value_parser = crate::setup_args::switch)]
    pub macro_b: Option<bool>,
    /// The control model; each has a memory of its own in the data folder, which keeps the choice
    /// [default: as it was, gsk980td at first]
    #[arg(long, value_name = "MODEL", value_parser = crate::setup_args::model())]
    pub model: Option<ModelId>,
    /// A pulse board at this port moves the slides: REAL MOTION [default: the port in the machine file, if it names one]
    #[arg(long, value_name = "PORT")]
    pub link: Option<String>,
}

/// The word of a language.
fn language() -> impl TypedValueParser<Value = Language> {
    let words = [("zh", "Chinese"), ("en", "English")];
    PossibleValuesParser::new(words.map(|(word, help)| PossibleValue::new(word).help(help))).map(
        |word| match word.as_str() {
            "en" => Language::En,
            _ => Language::Zh,
        },
    )
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Execute a program on the simulated lathe, as fast as the PC can
    ///
    /// The first file is executed to its end in the complete control: ladder,
    /// acceleration, spindle, turret. Subprograms come from the other files and
    /// from the folder of the first one. M00 is answered with cycle start. With
    /// --link a real machine executes it, and nothing is answered by itself.
    Run(RunArgs),
    /// Check programs without executing them: alarms, path, tools, time
    ///
    /// Interprets every block as the control does, without running the machine. Behind
    /// the alarm that the control would stop with further ones are listed, as far as
    /// the program can be followed. Each file is checked for itself; subprograms are found in its folder.
    Check(CheckArgs),
    /// Draw the toolpath of a program as a picture (PNG or SVG)
    ///
    /// Z to the right, X as a diameter upwards; a colour for each tool with its
    /// cutting time, rapids grey and dashed.
    Plot(PlotArgs),
    /// List what means something else when another control model reads a program
    ///
    /// Block by block: codes that the other model does not have, that mean something else
    /// there, or that have another number. With -o the program is written with the numbers of
    /// the other model where they say the same; all else stands as it is, and is listed.
    Dialect(DialectArgs),
    /// Operate the panel by a script of key presses and expectations
    #[command(after_help = script_help())]
    Operate(OperateArgs),
    /// Print or draw one LCD page as it looks after power-on
    Screen(ScreenArgs),
    /// Print the keys of the panel: script name, label, PC key, address
    Keys(TableArgs),
    /// Print the parameter table
    Parameters(TableArgs),
    /// Print the alarm table: number, text, meaning, cause, cure
    Alarms(TableArgs),
    /// Print the PLC signal table
    Signals(TableArgs),
    /// Print the faults of the simulated lathe: name for `fault NAME on`, what it does
    Faults(TableArgs),
    /// Check, print or scan a ladder (instruction list)
    #[command(subcommand)]
    Ladder(LadderCommand),
    /// Find, try, watch or play a pulse board
    #[command(subcommand)]
    Link(LinkCommand),
    /// Print the licences of this program and of the packages it contains
    Notices,
    /// Print what a shell needs to complete this command line
    ///
    /// For bash: `gsk980td completions bash > ~/.local/share/bash-completion/completions/gsk980td`;
    /// the packages for Linux bring it along.
    Completions(CompletionsArgs),
    /// Print the manual page, for `man -l`
    Man(ManArgs),
    /// Hold the port of a board for the program at standard input
    #[command(name = crate::guard::COMMAND, hide = true)]
    HoldPort(HoldPortArgs),
}

/// `completions`.
#[derive(Args, Debug)]
pub struct CompletionsArgs {
    /// The shell
    #[arg(value_enum, value_name = "SHELL")]
    pub shell: Shell,
}

/// `man`.
#[derive(Args, Debug)]
pub struct ManArgs {
    /// Write a page for the program and one for each command into this folder instead
    #[arg(long, value_name = "DIR")]
    pub folder: Option<PathBuf>,
}

/// `hold-port`, which the program starts by itself.
#[derive(Args, Debug)]
pub struct HoldPortArgs {
    /// The port
    pub port: String,
    /// Its speed, bits a second
    #[arg(long)]
    pub baud: u32,
}

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
    /// Execute what comes in through the serial line instead (DNC): a file, a serial port, or `-` for standard input; files are then subprograms
    #[arg(long, value_name = "SOURCE")]
    pub dnc: Option<PathBuf>,
    /// Options of control and lathe.
    #[command(flatten)]
    pub setup: SetupArgs,
    /// A pulse board at this port moves the slides: REAL MOTION. M00 and the next part wait for Enter at the terminal; without one M00 ends the run [default: the simulated lathe, also where the machine file names a port]
    #[arg(long, value_name = "PORT")]
    pub link: Option<String>,
    /// Both axes of the real machine make their machine zero return first, X then Z: they MOVE
    #[arg(long, requires = "link")]
    pub home: bool,
    /// Stop after so many parts (M30, or M99 in the main program)
    #[arg(long, default_value_t = 1, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub parts: u32,
    /// Stop after so much machine time, for instance 90s, 30m, 2h
    #[arg(long, default_value = "24h", value_name = "TIME", value_parser = crate::setup_args::duration_ms)]
    pub limit: u64,
    /// Say what each block leaves in force, what each move does, and why each pass of a cycle is where it is
    #[arg(long)]
    pub explain: bool,
    /// Write every move as one JSON object a line (`-`: standard output)
    #[arg(long, value_name = "FILE")]
    pub moves: Option<PathBuf>,
    /// Write time, X (diameter), Z and spindle angle of every millisecond as CSV
    #[arg(long, value_name = "FILE")]
    pub positions: Option<PathBuf>,
    /// The part.
    #[command(flatten)]
    pub part: PartArgs,
    /// Stop at the first collision of the simulated lathe (exit code 3)
    #[arg(long, conflicts_with = "link")]
    pub stop_on_collision: bool,
    /// Draw the executed toolpath (name ends in .png or .svg)
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// How it is drawn.
    #[command(flatten)]
    pub picture: PictureArgs,
    /// Print the result as one JSON object
    #[arg(long)]
    pub json: bool,
}

/// When `check` and `plot` give a program up.
#[derive(Args, Clone, Copy, Debug)]
pub struct PatienceArgs {
    /// Give a program up after so much time of this computer, for instance 90s, 10m
    #[arg(long, default_value = "60s", value_name = "TIME", value_parser = crate::setup_args::duration_ms)]
    pub give_up: u64,
    /// Give a program up after so many moves
    #[arg(long, default_value_t = 200_000_000, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub most_moves: u64,
}

impl PatienceArgs {
    /// Begins now.
    pub fn begin(self) -> Patience {
        Patience::new(Duration::from_millis(self.give_up), self.most_moves)
    }
}

/// How `check` and `plot` look at a program.
#[derive(Args, Clone, Copy, Debug)]
pub struct LookArgs {
    /// Where the work zero lies in machine coordinates: X (diameter), Z in mm; --start is then counted from it [default: at the machine zero]
    ///
    /// G28 goes to the machine zero: with this option it is drawn, and the program
    /// goes on, where it truly lies. A program that begins with G50 needs --start as
    /// well: where its tool stands there.
    #[arg(long, value_name = "X,Z", allow_hyphen_values = true, value_parser = crate::setup_args::pair)]
    pub work_zero: Option<(f64, f64)>,
    /// Language of alarms, warnings and report [default: English, with the Chinese texts of the screen]
    #[arg(long, value_parser = language(), value_name = "LANG")]
    pub lang: Option<Language>,
    /// When to give up.
    #[command(flatten)]
    pub patience: PatienceArgs,
}

/// `check`.
#[derive(Args, Debug)]
pub struct CheckArgs {
    /// The programs; of a folder those in it and below it
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Options of control and lathe.
    #[command(flatten)]
    pub setup: SetupArgs,
    /// How to look at them.
    #[command(flatten)]
    pub look: LookArgs,
    /// The part.
    #[command(flatten)]
    pub part: PartArgs,
    /// Write every move as one JSON object a line (`-`: standard output); one program only
    #[arg(long, value_name = "FILE")]
    pub moves: Option<PathBuf>,
    /// Print one JSON object for each file; `times` are its seconds by kind (rapid, feed, thread, dwell, other), `tool_times` the same for each tool
    #[arg(long)]
    pub json: bool,
}

/// `plot`.
#[derive(Args, Debug)]
pub struct PlotArgs {
    /// The program
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Options of control and lathe.
    #[command(flatten)]
    pub setup: SetupArgs,
    /// How to look at it.
    #[command(flatten)]
    pub look: LookArgs,
    /// The part behind the path.
    #[command(flatten)]
    pub part: JobArgs,
    /// Draw the part as a lit solid with a quarter cut out, not the path (.png only)
    #[arg(long, conflicts_with_all = ["whole", "labels", "dimensions", "tools"])]
    pub solid: bool,
    /// The picture (name ends in .png or .svg)
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// How it is drawn.
    #[command(flatten)]
    pub picture: PictureArgs,
}

/// `dialect`.
#[derive(Args, Debug)]
pub struct DialectArgs {
    /// The program
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// The model that it was written for
    #[arg(long, value_name = "MODEL", value_parser = crate::setup_args::any_model())]
    pub from: ModelId,
    /// The model that is to read it
    #[arg(long, value_name = "MODEL", value_parser = crate::setup_args::any_model())]
    pub to: ModelId,
    /// Write the program for the other model into this file
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Language of what is listed [default: English]
    #[arg(long, value_parser = language(), value_name = "LANG")]
    pub lang: Option<Language>,
}

/// How a toolpath is drawn.
#[derive(Args, Clone, Copy, Debug)]
pub struct PictureArgs {
    /// Size of the picture, pixels [default: 1280x800]
    #[arg(long, value_name = "WIDTHxHEIGHT")]
    pub size: Option<Size>,
    /// Fit the picture to the whole path; without it the cuts fill it and rapids end at its frame
    #[arg(long)]
    pub whole: bool,
    /// Write the number of each block where it ends: its N word, or its line where it has none; numbers that would cover others are left out
    #[arg(long)]
    pub labels: bool,
    /// Write the dimensions of the part: diameters, radii, angles, pitches, and where its shoulders lie; with the part behind the path
    #[arg(long)]
    pub dimensions: bool,
    /// Draw each tool where it cut last; with the part behind the path
    #[arg(long)]
    pub tools: bool,
}

impl PictureArgs {
    /// As the drawing takes it.
    pub fn look(self) -> Look {
        Look {
            size: self.size.unwrap_or_default(),
            whole: self.whole,
            labels: self.labels,
            dimensions: self.dimensions,
            tools: self.tools,
        }
    }

    /// Whether the part is drawn, too.
    pub const fn needs_part(self) -> bool {
        self.dimensions || self.tools
    }
}

/// The actions of scripts, for `operate --help`.
fn script_help() -> String {
    let forms: Vec<String> = FORMS.iter().map(|(_, form)| format!("  {form}")).collect();
    format!(
        "A script has one action a line; # begins a comment, @12345 before an action is the \
         millisecond at which it happens. `gsk980td keys` lists the keys.\n\nActions:\n{}\n\n\
         Example:\n  load part.CNC        # beside the script, or in the current folder\n  \
         press AUTO\n  press CS\n  wait idle 10m\n  expect alarm none\n  show",
        forms.join("\n")
    )
}

/// `operate`.
#[derive(Args, Debug)]
pub struct OperateArgs {
    /// The script
    #[arg(value_name = "SCRIPT")]
    pub script: PathBuf,
    /// Options of control and lathe.
    #[command(flatten)]
    pub setup: SetupArgs,
    /// Program to open before the script starts
    #[arg(long, value_name = "FILE")]
    pub program: Option<PathBuf>,
    /// A pulse board at this port moves the slides: REAL MOTION. Press RESET and make the machine zero return in the script [default: the simulated lathe, also where the machine file names a port]
    #[arg(long, value_name = "PORT")]
    pub link: Option<String>,
    /// Write what happened as a script with the time of every key
    #[arg(long, value_name = "FILE")]
    pub record: Option<PathBuf>,
}

/// `screen`.
#[derive(Args, Debug)]
pub struct ScreenArgs {
    /// Page id, see --list
    #[arg(required_unless_present = "list", value_name = "PAGE")]
    pub page: Option<String>,
    /// List the pages
    #[arg(long, conflicts_with_all = ["page", "output"])]
    pub list: bool,
    /// Draw the page into a PNG instead of printing it
    #[arg(short, long, value_name = "FILE.png")]
    pub output: Option<PathBuf>,
}

/// A table.
#[derive(Args, Debug)]
pub struct TableArgs {
    /// Only lines that contain this text (capital or small letters alike)
    #[arg(value_name = "TEXT")]
    pub filter: Option<String>,
    /// Print as JSON
    #[arg(long)]
    pub json: bool,
}

/// `ladder`.
#[derive(Debug, Subcommand)]
pub enum LadderCommand {
    /// Compile a ladder and say whether it is right
    Check(LadderArgs),
    /// Print a ladder as it was compiled
    List(LadderArgs),
    /// Compile a ladder and scan it with all inputs off
    Run(LadderRunArgs),
}

/// A ladder file.
#[derive(Args, Debug)]
pub struct LadderArgs {
    /// The ladder; without it the standard ladder
    #[arg(value_name = "FILE")]
    pub file: Option<PathBuf>,
}

/// `ladder run`.
#[derive(Args, Debug)]
pub struct LadderRunArgs {
    /// The ladder; without it the standard ladder
    #[arg(value_name = "FILE")]
    pub file: Option<PathBuf>,
    /// Number of 8 ms slots to scan
    #[arg(long, default_value_t = 1000, value_name = "N")]
    pub slots: u32,
    /// Hold a bit, for instance X20.1=1
    #[arg(long = "set", value_name = "ADDRESS=0|1", value_parser = crate::setup_args::input_bit)]
    pub bits: Vec<crate::setup_args::InputBit>,
}

/// `link`.
#[derive(Debug, Subcommand)]
pub enum LinkCommand {
    /// List the serial ports
    List,
    /// Identify a board, check its settings, measure its answers
    ///
    /// Nothing moves unless --travel is given. The settings come from the machine
    /// file (--machine, section `link`) and the parameters (--data, --param).
    Test(LinkTestArgs),
    /// Open a board and print everything said, with the time in seconds
    Monitor(LinkMonitorArgs),
    /// Play a board behind a pseudo terminal or a network address; its name is printed first
    Twin(LinkTwinArgs),
}

/// Which board.
#[derive(Args, Debug)]
pub struct LinkBoardArgs {
    /// The port [default: the one of the machine file]
    #[arg(value_name = "PORT")]
    pub port: Option<String>,
    /// Options of control and lathe.
    #[command(flatten)]
    pub setup: SetupArgs,
}

/// `link test`.
#[derive(Args, Debug)]
pub struct LinkTestArgs {
    /// Which board.
    #[command(flatten)]
    pub board: LinkBoardArgs,
    /// Write settings that differ into the board
    #[arg(long)]
    pub write_settings: bool,
    /// MOVES Z there and back by so many mm, with ten holds; drives unpowered, or the way clear
    #[arg(long, value_name = "MM", allow_hyphen_values = true, value_parser = crate::setup_args::travel)]
    pub travel: Option<f64>,
    /// Feed of that move, mm/min
    #[arg(long, default_value = "600", value_name = "F", requires = "travel", allow_hyphen_values = true, value_parser = crate::setup_args::feed)]
    pub feed: f64,
}

/// `link monitor`.
#[derive(Args, Debug)]
pub struct LinkMonitorArgs {
    /// Which board.
    #[command(flatten)]
    pub board: LinkBoardArgs,
    /// Stop after so many seconds
    #[arg(long, value_name = "S")]
    pub seconds: Option<u64>,
}

/// `link twin`.
#[derive(Args, Debug)]
pub struct LinkTwinArgs {
    /// Firmware of the board
    #[arg(long, value_enum, default_value_t = TwinBoard::Grbl)]
    pub firmware: TwinBoard,
    /// Offer it at this address as the port `tcp:HOST:PORT`; port 0 lets the system choose [default: a pseudo terminal; on Windows 127.0.0.1:0]
    #[arg(long, value_name = "HOST:PORT")]
    pub tcp: Option<String>,
    /// Print a machine file with the wiring of this board, and end
    #[arg(long)]
    pub print_machine: bool,
    /// Lose every Nth byte from the PC to the board
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub lose_every: Option<u64>,
    /// Hold all bytes to the board up by so many ms
    #[arg(long, default_value_t = 0, value_name = "MS")]
    pub delay_ms: u64,
    /// Speed of its spindle at full output, turns a minute
    #[arg(long, default_value_t = 9999.0, value_name = "RPM")]
    pub spindle_top: f64,
    /// Klipper: the speed of its spindle goes up and down by so many per cent
    #[arg(long, default_value_t = 0.0, value_name = "PERCENT")]
    pub ripple: f64,
    /// Klipper: so often a second
    #[arg(long, default_value_t = 0.5, value_name = "HZ")]
    pub ripple_hz: f64,
    /// Klipper: the index of its spindle stays away after so many seconds
    #[arg(long, value_name = "S")]
    pub lose_index: Option<u64>,
    /// Stop after so many seconds
    #[arg(long, value_name = "S")]
    pub seconds: Option<u64>,
}

/// Firmware of a twin.
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn the_window_is_the_default() {
        let cli = Cli::try_parse_from(["gsk980td", "--lang", "en"]).expect("window");
        assert!(cli.command.is_none());
        assert_eq!(cli.window.lang, Some(Language::En));
    }

    #[test]
    fn options_of_control_and_lathe_are_shared() {
        for command in [
            "run a.nc",
            "check a.nc",
            "plot a.nc -o a.png",
            "operate a.txt",
        ] {
            let words = format!(
                "gsk980td {command} --start 100,50 --spindle 800 --param 22=3800 --param 1.4=0 \
                 --offset 1=0,0,0.4,3 --input X0.4=1"
            );
            Cli::try_parse_from(words.split_whitespace()).expect(command);
        }
    }
}
