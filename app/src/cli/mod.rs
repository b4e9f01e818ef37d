//! The command line: the options of all commands as clap parses them. The window and the
//! short commands are in this file; each longer command has a file.

pub mod chinese;
mod class;
mod command_call;
mod dap;
mod deferred;
mod dialect;
mod exercise;
mod form;
mod help;
mod ladder;
mod language;
mod lesson;
mod link;
mod load;
mod lsp;
mod mill;
mod mqtt;
mod mtconnect;
mod outline;
mod packages;
mod picture;
mod pitch;
mod preview;
mod project;
mod replay;
mod run;
mod run_debug;
mod run_restart;
mod sheet;
mod tools;
mod transfer;

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use gsk_core::model::ModelId;
use gsk_panel::script::FORMS;
pub use gsk_runner::Language;

pub use class::{ClassArgs, SeatArgs};
pub use command_call::GlobalArgs;
pub use dap::DapArgs;
pub use dialect::{DialectArgs, ProgramOrigin};
pub use exercise::{
    ExerciseCheckArgs, ExerciseCommand, ExerciseDrawingArgs, ExerciseListArgs, ExerciseMarkArgs,
    ExerciseNewArgs, ExercisePackArgs, ExerciseSolveArgs, MarkTableFormat,
};
pub use form::FormArgs;
pub use help::HelpArgs;
pub use ladder::{
    FindDirection, LadderArgs, LadderCommand, LadderFindArgs, LadderPrintArgs, LadderReadArgs,
    LadderRunArgs, LadderSendArgs,
};
pub use language::{find_language, first_window_language, is_chinese, system_language};
pub use lesson::{LessonCheckArgs, LessonCommand, LessonListArgs, LessonRunArgs};
pub use link::{
    LinkArgs, LinkBoardArgs, LinkCommand, LinkFlashArgs, LinkMonitorArgs, LinkTestArgs,
    LinkTwinArgs, TwinBoard,
};
pub use load::{LoadCommand, LoadValuesArgs};
pub use lsp::LspArgs;
pub use mill::{
    GearArgs, HomingArgs, MILL_AXES, MillCommand, MillKeysArgs, MillSearchArgs, PitchArgs,
};
pub use mqtt::MqttArgs;
pub use mtconnect::MtconnectArgs;
pub use outline::OutlineArgs;
pub use packages::{CompletionsArgs, ManArgs};
pub use picture::PictureArgs;
pub use pitch::{PitchCommand, PitchFormat, PitchImportArgs, PitchShowArgs};
pub use preview::{CheckArgs, CheckFormat, LimitArgs, LookArgs, PlotArgs};
pub use project::{
    DiffFormat, ProjectDiffArgs, ProjectExportArgs, ProjectImportArgs, ProjectNewArgs,
    ProjectSubcommand,
};
pub use replay::ReplayArgs;
pub use run::RunArgs;
pub use run_debug::RunDebugArgs;
pub use run_restart::RunRestartArgs;
pub use sheet::SheetArgs;
pub use tools::{
    ToolsAddArgs, ToolsCommand, ToolsCountArgs, ToolsDataArgs, ToolsFileArgs, ToolsLifeArgs,
    ToolsListArgs, ToolsShowArgs,
};
pub use transfer::{
    ExistingFile, SerialArgs, TextEnd, TransferArgs, TransferBackupArgs, TransferCommand,
    TransferControlArgs, TransferDeleteArgs, TransferListArgs, TransferPortArgs,
    TransferReceiveArgs, TransferReceiveTextArgs, TransferRenameArgs, TransferRestoreArgs,
    TransferSendArgs, TransferSendTextArgs, TransferWaitArgs,
};

use deferred::{CommandGroup, DeferredArgs};
use gsk_host::setup_args::{self, SetupArgs};

const EXAMPLES: &str = "\
Examples:
  gsk980td                                  open the panel in a window
  gsk980td --program shaft.CNC              open the panel with a program
  gsk980td check shaft.CNC                  check the program: alarms, tools, time
  gsk980td run shaft.CNC --spindle 800      execute it on the simulated lathe
  gsk980td plot shaft.CNC -o shaft.png      draw its toolpath
  gsk980td operate lesson.txt               press keys from a script

Exit codes: 0 success, 1 alarm of the control (also: a failed script, an unfinished run), 2 invalid \
arguments or file, 3 collision (--part), 130 ended by Ctrl-C or a signal on a real machine.";

/// The control of a GSK980TD lathe on a PC: panel, control and simulated lathe.
///
/// Without a command the operator panel opens in a window. The commands need neither a window nor a
/// display.
#[derive(Debug, Parser)]
#[command(name = "gsk980td", version, after_help = EXAMPLES, args_conflicts_with_subcommands = true, disable_help_subcommand = true)]
pub struct CommandLine {
    /// The command to execute; `None` opens the window.
    #[command(subcommand)]
    pub command: Option<CliCommand>,
    /// Options of every command.
    #[command(flatten)]
    pub global: GlobalArgs,
    /// Options with which the window is opened.
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
    /// Ask the three questions of the first start (language, purpose, lathe) again, or skip
    /// them [default: asked once, unless this start names a program, a lathe, a control model or
    /// a port]
    #[arg(long, value_name = "on|off", num_args = 0..=1, require_equals = true, default_missing_value = "on", value_parser = setup_args::parse_switch)]
    pub first_start: Option<bool>,
    /// Print the time to the first frame and frames a second on standard error
    #[arg(long)]
    pub figures: bool,
    /// The machine's ladder instead of the standard one (instruction list)
    #[arg(long, value_name = "FILE")]
    pub ladder: Option<PathBuf>,
    /// Source of the programs in DNC mode: a file, a serial port, or `-` for standard input
    /// [default: transfer/DNC.CNC in the data folder]
    ///
    /// Without --ladder the ladder with keys for DNC and teach-in runs: press 自动 twice for DNC.
    #[arg(long, value_name = "SOURCE")]
    pub dnc: Option<PathBuf>,
    #[command(flatten)]
    pub serial: SerialArgs,
    /// The simulated lathe (travel, turret, dogs …) from a RON file
    #[arg(long, value_name = "FILE")]
    pub machine: Option<PathBuf>,
    /// Macro B: formulas, IF, WHILE, GOTO and calls with arguments (G65 P) in programs; stored in
    /// the data folder [default: the stored setting, at first off]
    #[arg(long, value_name = "on|off", value_parser = setup_args::parse_switch)]
    pub macro_b: Option<bool>,
    /// Control model; each has a separate memory in the data folder, which stores the choice
    /// [default: the stored choice, at first gsk980td]
    #[arg(long, value_name = "MODEL", value_parser = setup_args::model_parser())]
    pub model: Option<ModelId>,
    /// A pulse board at this port moves the slides: REAL MOTION [default: the port in the machine
    /// file, if it names one]
    #[arg(long, value_name = "PORT")]
    pub link: Option<String>,
    /// Record the session into this file as well, for `replay`
    #[arg(long, value_name = "FILE")]
    pub record: Option<PathBuf>,
    #[command(flatten)]
    pub mtconnect: MtconnectArgs,
    #[command(flatten)]
    pub mqtt: MqttArgs,
    #[command(flatten)]
    pub seat: SeatArgs,
}

/// The commands; only the options of the one that is called are built.
#[derive(Debug, Subcommand)]
#[expect(
    clippy::large_enum_variant,
    reason = "one value in the life of the program"
)]
pub enum CliCommand {
    /// Execute a program on the simulated lathe, as fast as the PC can
    ///
    /// Executes the first file to its end in the complete control: ladder, acceleration, spindle,
    /// turret. Subprograms come from the other files and from the folder of the first one. After
    /// M00 the command presses cycle start. With --link a real machine executes the program, and
    /// M00 waits for the operator.
    Run(DeferredArgs<RunArgs>),
    /// Check programs without executing them: alarms, path, tools, time
    ///
    /// Interprets every block as the control does, without running the machine. After the
    /// alarm that stops the control, further ones are listed, as far as the program can be
    /// followed. Each file is checked for itself; subprograms are found in its folder.
    Check(DeferredArgs<CheckArgs>),
    /// Draw the toolpath of a program as a picture (PNG or SVG)
    ///
    /// Z to the right, X as a diameter upwards; a colour for each tool with its
    /// cutting time, rapids grey and dashed.
    Plot(DeferredArgs<PlotArgs>),
    /// Write the setup sheet of a program: a page to print (HTML, A4)
    ///
    /// Part with dimensions, stock and clamping, tools with offsets, zero, times, warnings, the
    /// program, and its hash as a QR code. A browser prints it, also as PDF.
    Sheet(DeferredArgs<SheetArgs>),
    /// List the words of a program that another control model reads differently
    ///
    /// Lists for each block the codes that the other model lacks, reads differently, or numbers
    /// differently. With -o it writes the program with the numbers of the other model where the
    /// meaning is the same; it lists all other differences and leaves those words unchanged.
    ///
    /// From the dialect of another control (`fanuc0t`, `fanuc-10t`, `haas`, `fusion`, `mach3`,
    /// `linuxcnc`) the program is ported: printed or, with -o, written, and checked. Lines
    /// without an equivalent are listed, and stop the ported program with alarm 500.
    Dialect(DeferredArgs<DialectArgs>),
    /// Write blocks from the dimensions of a drawing
    ///
    /// Forms for faces, turned and bored cylinders, outlines, grooves, parting off, threads,
    /// holes and centre holes. The values stay in comments in front of the blocks, so that
    /// `--read` and the window open the form again. docs/forms.md shows each form.
    Form(DeferredArgs<FormArgs>),
    /// Print materials with their cutting force, and cutting values to start with
    ///
    /// `check --load` computes the load of the cuts of a program. docs/load.md describes both.
    Load(DeferredArgs<CommandGroup<LoadCommand>>),
    /// The tool library: tools by their ISO codes, tables of other programs, life of the edges
    ///
    /// A job file names its tools, the forms take their tool from it, and the window shows it
    /// in *Tools and stock*. docs/tool-library.md describes it.
    Tools(DeferredArgs<CommandGroup<ToolsCommand>>),
    /// Write the program that turns the outline of a drawing (DXF or SVG)
    ///
    /// Reads the outline above the axis from its right end to its left end, joins its lines and
    /// arcs and checks them. The program contains G71 and G70, or only the blocks of the outline.
    Outline(DeferredArgs<OutlineArgs>),
    /// Operate the panel by a script of key presses and expectations
    #[command(after_help = script_help())]
    Operate(DeferredArgs<OperateArgs>),
    /// List, check or play guided lessons
    Lesson(DeferredArgs<CommandGroup<LessonCommand>>),
    /// List, check, solve or mark exercises
    ///
    /// An exercise marks itself: the recording of a solution is replayed bit for bit, and its
    /// criteria are checked on the machine and on the part. docs/exercises.md describes how to
    /// write one.
    Exercise(DeferredArgs<CommandGroup<ExerciseCommand>>),
    /// Show the seats of a class to the instructor, the most urgent first
    ///
    /// A seat joins in the window (Views, Network) or with --class CODE@BROKER. The instructor
    /// watches an LCD live, offers exercises, sets faults where the seat allows it, and collects
    /// results. The view cannot press keys. docs/network.md describes it.
    Class(DeferredArgs<ClassArgs>),
    /// Replay a recording of the window and compare the states in it
    ///
    /// The window records every session into `recordings` of the data folder, the last 50 MB.
    /// The replay simulates it from its first state and its inputs. Exit code 1: a state differs
    /// from the recorded one, or the file is damaged.
    Replay(DeferredArgs<ReplayArgs>),
    /// Print or draw one LCD page as it looks after power-on
    Screen(DeferredArgs<ScreenArgs>),
    /// Print the keys of the panel: script name, label, PC key, address
    Keys(DeferredArgs<ModelTableArgs>),
    /// Print the parameter table
    ///
    /// With `--model` the table of another control model; that of the GSK980MDi mill has a column
    /// with the effect in `check` and `plot`.
    Parameters(DeferredArgs<ModelTableArgs>),
    /// Print the alarm table: number, text, meaning, cause, remedy
    Alarms(DeferredArgs<TableArgs>),
    /// Print the PLC signal table
    Signals(DeferredArgs<TableArgs>),
    /// Print the faults of the simulated lathe: name for `fault NAME on`, and effect
    Faults(DeferredArgs<TableArgs>),
    /// Check, print, search or scan a ladder (instruction list), move it to and from a control
    Ladder(DeferredArgs<CommandGroup<LadderCommand>>),
    /// Import measured pitch errors, print and export the pitch error table
    Pitch(DeferredArgs<CommandGroup<PitchCommand>>),
    /// Export the memory of the control as a folder of text files, import it, compare two
    ///
    /// The folder holds programs, parameters, offsets, variables, pitch errors, ladder and
    /// settings, one value per line, for version control or another machine. Differences are listed
    /// by meaning. docs/project.md describes the folder.
    Project(DeferredArgs<CommandGroup<ProjectSubcommand>>),
    /// Compute the settings of a GSK980MDi mill: gears, pitch errors, backlash, keys, homing
    Mill(DeferredArgs<CommandGroup<MillCommand>>),
    /// Find, test, monitor or simulate a pulse board
    Link(DeferredArgs<LinkArgs>),
    /// Send files to a control and receive them, through its serial port
    Transfer(DeferredArgs<TransferArgs>),
    /// Explain a symbol of the control, or a command
    ///
    /// Explains alarms, parameters and their bits, G and M codes, keys, lamps, pages and their
    /// fields, PLC signals and diagnosis numbers: purpose, range, cause, remedy and an example.
    /// Other words are searched for in all topics.
    Help(DeferredArgs<HelpArgs>),
    /// Serve an editor (language server): alarms while typing, meanings of words, targets of calls
    ///
    /// Speaks the language server protocol on standard input and output; an editor starts it.
    Lsp(DeferredArgs<LspArgs>),
    /// Serve a debugger of an editor: breakpoints, steps forwards and backwards, values
    ///
    /// Speaks the Debug Adapter Protocol on standard input and output; an editor starts it. The
    /// options are those of the control and lathe on which the program runs.
    Dap(DeferredArgs<DapArgs>),
    /// Print the licences of this program and of the packages it contains
    Notices,
    /// Print the script by which a shell completes this command line
    ///
    /// For bash: `gsk980td completions bash > ~/.local/share/bash-completion/completions/gsk980td`;
    /// the packages for Linux bring it along.
    Completions(DeferredArgs<CompletionsArgs>),
    /// Print the manual page, for `man -l`
    Man(DeferredArgs<ManArgs>),
    /// Hold the port of a board for the program at standard input
    #[command(name = gsk_host::guard::HOLDER_COMMAND, hide = true)]
    HoldPort(DeferredArgs<HoldPortArgs>),
}

/// Options of `hold-port`, which the program starts as its guard process.
#[derive(Args, Debug)]
pub struct HoldPortArgs {
    /// The port
    pub port: String,
    /// Its speed, bits a second
    #[arg(long)]
    pub baud: u32,
}

/// Returns the forms of all script actions, for `operate --help`.
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

/// Arguments of the command `operate`.
#[derive(Args, Debug)]
pub struct OperateArgs {
    /// The script
    #[arg(value_name = "SCRIPT")]
    pub script: PathBuf,
    /// Program to open before the script starts
    #[arg(long, value_name = "FILE")]
    pub program: Option<PathBuf>,
    /// A pulse board at this port moves the slides: REAL MOTION. Press RESET and make the machine
    /// zero return in the script [default: the simulated lathe, also where the machine file names a
    /// port]
    #[arg(long, value_name = "PORT")]
    pub link: Option<String>,
    /// The program cuts the part of its job, as in the window: a cut above the limits of `load` in
    /// the machine file breaks the insert, stalls the spindle or loosens the stock, and a collision
    /// stops the lathe
    #[arg(long, requires = "program", conflicts_with = "link")]
    pub overload: bool,
    /// Write the session as a script with the time of every key
    #[arg(long, value_name = "FILE")]
    pub record: Option<PathBuf>,
    #[command(flatten)]
    pub mtconnect: MtconnectArgs,
    #[command(flatten)]
    pub mqtt: MqttArgs,
    #[command(flatten)]
    pub setup: SetupArgs,
}

/// Arguments of the command `screen`.
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
    /// The control model
    #[arg(long, value_name = "MODEL", value_parser = setup_args::lathe_model_parser(), default_value = "gsk980td")]
    pub model: ModelId,
}

/// Options of the commands that print a table.
#[derive(Args, Debug)]
pub struct TableArgs {
    /// Only lines that contain this text, in upper or lower case
    #[arg(value_name = "TEXT")]
    pub filter: Option<String>,
    /// Print as JSON
    #[arg(long)]
    pub json: bool,
}

/// Arguments of the commands `parameters` and `keys`.
#[derive(Args, Debug)]
pub struct ModelTableArgs {
    #[command(flatten)]
    pub table: TableArgs,
    /// The control model
    #[arg(long, value_name = "MODEL", value_parser = setup_args::model_parser(), default_value = "gsk980td")]
    pub model: ModelId,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        CommandLine::command().debug_assert();
    }

    #[test]
    fn the_window_is_the_default() {
        let cli = CommandLine::try_parse_from(["gsk980td", "--lang", "en"]).expect("window");
        assert!(cli.command.is_none());
        assert_eq!(cli.global.lang, Some(Language::En));
    }

    #[test]
    fn options_of_a_mill_alone_stand_under_its_heading() {
        let mut program = CommandLine::command();
        program.build();
        let arguments = program
            .get_subcommands()
            .flat_map(clap::Command::get_arguments);
        let mut of_mills = 0;
        for argument in arguments {
            let heading = argument.get_help_heading().unwrap_or_default();
            let of_a_mill = argument.get_id().as_str().starts_with("mill_");
            assert_eq!(heading.starts_with("Mill"), of_a_mill, "{argument}");
            of_mills += usize::from(of_a_mill);
        }
        assert!(of_mills > 9);
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
            CommandLine::try_parse_from(words.split_whitespace()).expect(command);
        }
    }
}
