//! Options of the serial port, and of `transfer`.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};
use gsk_host::setup_args::{OptionValueError, SetupArgs};
use gsk_transfer::{FileName, Partition, TextLineEnd};

/// Options of the control's serial port.
#[derive(Args, Clone, Debug, Default)]
pub struct SerialArgs {
    /// The control's serial port is this port, at the speed of parameter 044: a device,
    /// `tcp:HOST:PORT`, `listen:HOST:PORT`, or `pty` for a new pseudo terminal, whose name is
    /// printed
    #[arg(long, value_name = "PORT")]
    pub serial: Option<String>,
    /// Send programs through this port as plain text between `%` with this line ending, as DNC
    /// software expects [default: frames for `gsk980td transfer`; plain text is received in both
    /// cases]
    #[arg(long, value_enum, value_name = "LINE-END", requires = "serial", num_args = 0..=1, default_missing_value = "crlf")]
    pub serial_text: Option<TextEnd>,
}

/// Line ends of a text on the serial line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum TextEnd {
    /// CR LF
    Crlf,
    /// LF
    Lf,
    /// CR
    Cr,
    /// LF CR CR, as on a punched tape
    Lfcrcr,
}

impl TextEnd {
    /// Converts the option to the type of the transfer package.
    pub const fn to_line_end(self) -> TextLineEnd {
        match self {
            Self::Crlf => TextLineEnd::CrLf,
            Self::Lf => TextLineEnd::Lf,
            Self::Cr => TextLineEnd::Cr,
            Self::Lfcrcr => TextLineEnd::LfCrCr,
        }
    }
}

/// Arguments of the command `transfer`.
#[derive(Args, Debug)]
pub struct TransferArgs {
    #[command(subcommand)]
    pub command: TransferCommand,
}

/// Commands of the PC's side of the serial port.
#[derive(Debug, Subcommand)]
pub enum TransferCommand {
    /// List the files of the control, with their lengths in bytes
    List(TransferListArgs),
    /// Send files into the control
    Send(TransferSendArgs),
    /// Receive files from the control
    Receive(TransferReceiveArgs),
    /// Delete programs of the control
    Delete(TransferDeleteArgs),
    /// Rename a program of the control
    Rename(TransferRenameArgs),
    /// Receive all files of the control into a folder
    Backup(TransferBackupArgs),
    /// Send all files of a folder into the control: programs first, parameters last
    Restore(TransferRestoreArgs),
    /// Receive the files that the control sends by its key OUT, until Ctrl-C
    Wait(TransferWaitArgs),
    /// Send programs as plain text between `%`, to a control that is set to receive
    SendText(TransferSendTextArgs),
    /// Receive one plain text between `%`: the programs that a control sends by its key OUT
    ReceiveText(TransferReceiveTextArgs),
    /// Simulate the control on the other end of the line until Ctrl-C; prints its port first
    Control(Box<TransferControlArgs>),
}

/// Options of the serial port of the PC.
#[derive(Args, Clone, Debug)]
pub struct TransferPortArgs {
    /// The port: a device, or `tcp:HOST:PORT` [default: that of the view *Transfer* of the window]
    #[arg(long, value_name = "PORT")]
    pub port: Option<String>,
    /// Baud rate of the port, equal to parameter 044 of the control [default: 115200; without
    /// --port that of the view]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(50..=115_200))]
    pub baud: Option<u32>,
}

/// Policy for a file whose name is already used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ExistingFile {
    /// Ask at the terminal whether to replace it
    Ask,
    /// Replace it
    Overwrite,
    /// Rename the file on the control to the next free program number
    Rename,
    /// Keep it, and do not send the new file
    Skip,
}

/// Parses the name of a partition of the control's memory: USER, USER1 or USER2. Returns an error
/// for another text.
fn parse_partition(word: &str) -> Result<Partition, OptionValueError> {
    let mut all = Partition::ALL.into_iter();
    let found = all.find(|partition| partition.name().eq_ignore_ascii_case(word));
    found.ok_or(OptionValueError::UnknownPartition)
}

/// Parses the name of a file at the control, such as `O0001.CNC`. Returns an error for an invalid
/// name.
fn parse_file_name(word: &str) -> Result<FileName, gsk_transfer::FileNameError> {
    FileName::new(word)
}

/// Arguments of the command `transfer list`.
#[derive(Args, Debug)]
pub struct TransferListArgs {
    #[command(flatten)]
    pub port: TransferPortArgs,
    /// USER, USER1 or USER2
    #[arg(long, default_value = "USER", value_parser = parse_partition)]
    pub partition: Partition,
}

/// Arguments of the command `transfer send`.
#[derive(Args, Debug)]
pub struct TransferSendArgs {
    #[command(flatten)]
    pub port: TransferPortArgs,
    /// A file, or FILE=NAME to give it another name on the control
    #[arg(required = true, value_name = "FILE[=NAME]")]
    pub files: Vec<String>,
    /// USER, USER1 or USER2
    #[arg(long, default_value = "USER", value_parser = parse_partition)]
    pub partition: Partition,
    /// What to do with a file whose name the control already has
    #[arg(long, value_enum, default_value_t = ExistingFile::Ask)]
    pub on_existing: ExistingFile,
}

/// Arguments of the command `transfer receive`.
#[derive(Args, Debug)]
pub struct TransferReceiveArgs {
    #[command(flatten)]
    pub port: TransferPortArgs,
    /// File on the control: O0001.CNC, ParaW.par, Tofs.ofs, Wcomp.wmp, Main.ldx
    #[arg(required = true, value_name = "NAME", value_parser = parse_file_name)]
    pub names: Vec<FileName>,
    /// Folder to receive into
    #[arg(long, default_value = ".", value_name = "FOLDER")]
    pub into: PathBuf,
    /// Replace files of the folder
    #[arg(long)]
    pub overwrite: bool,
    /// USER, USER1 or USER2
    #[arg(long, default_value = "USER", value_parser = parse_partition)]
    pub partition: Partition,
}

/// Arguments of the command `transfer delete`.
#[derive(Args, Debug)]
pub struct TransferDeleteArgs {
    #[command(flatten)]
    pub port: TransferPortArgs,
    /// Program on the control: O0001.CNC
    #[arg(required = true, value_name = "NAME", value_parser = parse_file_name)]
    pub names: Vec<FileName>,
    /// USER, USER1 or USER2
    #[arg(long, default_value = "USER", value_parser = parse_partition)]
    pub partition: Partition,
}

/// Arguments of the command `transfer rename`.
#[derive(Args, Debug)]
pub struct TransferRenameArgs {
    #[command(flatten)]
    pub port: TransferPortArgs,
    /// Program on the control: O0001.CNC
    #[arg(value_name = "NAME", value_parser = parse_file_name)]
    pub from: FileName,
    /// New name of the program
    #[arg(value_name = "NEW-NAME", value_parser = parse_file_name)]
    pub to: FileName,
    /// USER, USER1 or USER2
    #[arg(long, default_value = "USER", value_parser = parse_partition)]
    pub partition: Partition,
}

/// Arguments of the command `transfer backup`.
#[derive(Args, Debug)]
pub struct TransferBackupArgs {
    #[command(flatten)]
    pub port: TransferPortArgs,
    /// Folder to receive the files into
    #[arg(value_name = "FOLDER")]
    pub folder: PathBuf,
    /// Replace files of the folder
    #[arg(long)]
    pub overwrite: bool,
}

/// Arguments of the command `transfer restore`.
#[derive(Args, Debug)]
pub struct TransferRestoreArgs {
    #[command(flatten)]
    pub port: TransferPortArgs,
    /// The folder with the files
    #[arg(value_name = "FOLDER")]
    pub folder: PathBuf,
    /// What to do with a file whose name the control already has
    #[arg(long, value_enum, default_value_t = ExistingFile::Overwrite)]
    pub on_existing: ExistingFile,
}

/// Arguments of the command `transfer wait`.
#[derive(Args, Debug)]
pub struct TransferWaitArgs {
    #[command(flatten)]
    pub port: TransferPortArgs,
    /// Folder to receive the files into
    #[arg(value_name = "FOLDER")]
    pub folder: PathBuf,
    /// Replace files of the folder [default: the new file gets a number after its name]
    #[arg(long)]
    pub overwrite: bool,
    /// End after this number of files
    #[arg(long, value_name = "N")]
    pub files: Option<usize>,
}

/// Arguments of the command `transfer send-text`.
#[derive(Args, Debug)]
pub struct TransferSendTextArgs {
    #[command(flatten)]
    pub port: TransferPortArgs,
    /// The programs
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Line ending on the serial line
    #[arg(long, value_enum, default_value_t = TextEnd::Crlf)]
    pub line_end: TextEnd,
    /// Stop if the other end holds the line (DC3) for this number of seconds
    #[arg(long, default_value_t = 120, value_name = "S")]
    pub wait: u64,
}

/// Arguments of the command `transfer receive-text`.
#[derive(Args, Debug)]
pub struct TransferReceiveTextArgs {
    #[command(flatten)]
    pub port: TransferPortArgs,
    /// Folder to receive the programs into, each under its number
    #[arg(value_name = "FOLDER")]
    pub folder: PathBuf,
    /// Replace files of the folder
    #[arg(long)]
    pub overwrite: bool,
    /// Stop if nothing is received for this number of seconds
    #[arg(long, default_value_t = 120, value_name = "S")]
    pub wait: u64,
}

/// Arguments of the command `transfer control`.
#[derive(Args, Debug)]
pub struct TransferControlArgs {
    /// The control's port: a device, `tcp:HOST:PORT`, `listen:HOST:PORT`, or `pty` for a new pseudo
    /// terminal
    #[arg(long, default_value = "pty", value_name = "PORT")]
    pub port: String,
    /// Send programs as plain text between `%`, with this line ending
    #[arg(long, value_enum, value_name = "LINE-END", num_args = 0..=1, default_missing_value = "crlf")]
    pub text: Option<TextEnd>,
    /// Switch the parameter switch on, in edit mode: parameters, offsets, pitch errors and the
    /// ladder can be transferred as well
    #[arg(long)]
    pub parameter_switch: bool,
    /// Load this program and send it with the key OUT
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Delay after the port is open, s; the receiver of a text must be ready by then
    #[arg(long, default_value_t = 3, value_name = "S", requires = "out", value_parser = clap::value_parser!(u64).range(..=3600))]
    pub out_after: u64,
    #[command(flatten)]
    pub setup: SetupArgs,
}
