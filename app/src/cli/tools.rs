//! Options of `tools`.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};
use gsk_host::files::tool_tables::ToolTableFormat;
use gsk_host::setup_args::{self, SetupArgs};

/// Commands about the tool library.
#[derive(Debug, Subcommand)]
pub enum ToolsCommand {
    /// List the tools: id, T number, description, name and life
    List(ToolsListArgs),
    /// Show what a description means: shape, angles, nose radius, edge, holder and tip
    Show(ToolsShowArgs),
    /// Add a tool by its ISO codes or dimensions
    Add(ToolsAddArgs),
    /// Remove a tool
    Remove(ToolsRemoveArgs),
    /// Add the tools of a table: CSV, LinuxCNC (tool.tbl), FreeCAD (.fctl, or one .fctb)
    Import(ToolsFileArgs),
    /// Write the tools as a table: CSV, LinuxCNC (tool.tbl), FreeCAD (.fctl with a .fctb each)
    Export(ToolsFileArgs),
    /// Show or set the life of a tool's edge; without an id the lives of all tools
    Life(ToolsLifeArgs),
    /// Compute the minutes in the cut that a part takes from each tool, and count parts
    Count(ToolsCountArgs),
}

/// The file of the library.
#[derive(Args, Debug)]
pub struct ToolsDataArgs {
    /// The data folder with the tool library (`tools.ron`) [default: the one of the window]
    #[arg(long, value_name = "DIR")]
    pub data: Option<PathBuf>,
}

/// Arguments of the command `tools list`.
#[derive(Args, Debug)]
pub struct ToolsListArgs {
    /// Only tools that have this text in id, name or description
    #[arg(value_name = "TEXT")]
    pub text: Option<String>,
    #[command(flatten)]
    pub data: ToolsDataArgs,
}

/// Arguments of the command `tools show`.
#[derive(Args, Debug)]
pub struct ToolsShowArgs {
    /// ISO codes of insert and holder (CNMG 120408 PCLNR 2020K12), dimensions (drill 8.5,
    /// groove 3, thread 60, turn V nose=0.2) or the id of a tool
    #[arg(value_name = "DESCRIPTION", required = true)]
    pub description: Vec<String>,
    #[command(flatten)]
    pub data: ToolsDataArgs,
}

/// Arguments of the command `tools add`.
#[derive(Args, Debug)]
pub struct ToolsAddArgs {
    /// ISO codes of insert and holder (CNMG 120408 PCLNR 2020K12) or dimensions (drill 8.5,
    /// groove 3, thread 60, turn V nose=0.2)
    #[arg(value_name = "DESCRIPTION", required = true)]
    pub description: Vec<String>,
    /// Id of the tool [default: made from the description]
    #[arg(long, value_name = "ID")]
    pub id: Option<String>,
    /// Name or purpose
    #[arg(long, value_name = "TEXT", default_value = "")]
    pub name: String,
    /// Usual T number
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=99))]
    pub station: Option<u8>,
    /// Life of an edge in the cut, minutes
    #[arg(long, value_name = "MIN", value_parser = setup_args::parse_number)]
    pub life: Option<f64>,
    /// Number of edges
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=12))]
    pub edges: u8,
    /// Replace a tool with this id
    #[arg(long)]
    pub replace: bool,
    #[command(flatten)]
    pub data: ToolsDataArgs,
}

/// Arguments of the command `tools remove`.
#[derive(Args, Debug)]
pub struct ToolsRemoveArgs {
    /// Id of the tool
    #[arg(value_name = "ID")]
    pub id: String,
    #[command(flatten)]
    pub data: ToolsDataArgs,
}

/// Arguments of the commands `tools import` and `tools export`.
#[derive(Args, Debug)]
pub struct ToolsFileArgs {
    /// The table; its ending means its format: .csv, .tbl, .fctl, .ron
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Format of the table [default: by its ending]
    #[arg(long, value_enum, value_name = "FORMAT")]
    pub format: Option<TableFormat>,
    /// Lengths of a LinuxCNC table that is read are inches
    #[arg(long)]
    pub inch: bool,
    /// Tools that are read replace those with the same id
    #[arg(long)]
    pub replace: bool,
    #[command(flatten)]
    pub data: ToolsDataArgs,
}

/// The format of a tool table.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum TableFormat {
    /// Comma-separated values with a line of column names
    Csv,
    /// LinuxCNC's tool table
    Linuxcnc,
    /// FreeCAD's list of tools with a file for each tool
    Freecad,
    /// The same with the shapes of FreeCAD's add-on for lathes (Iso_shape_C, D, S, T)
    FreecadLathe,
    /// The file of this library
    Ron,
}

impl From<TableFormat> for ToolTableFormat {
    fn from(format: TableFormat) -> Self {
        match format {
            TableFormat::Csv => Self::Csv,
            TableFormat::Linuxcnc => Self::LinuxCnc,
            TableFormat::Freecad => Self::FreeCad,
            TableFormat::FreecadLathe => Self::FreeCadLathe,
            TableFormat::Ron => Self::Ron,
        }
    }
}

/// Arguments of the command `tools life`.
#[derive(Args, Debug)]
pub struct ToolsLifeArgs {
    /// Id of the tool
    #[arg(value_name = "ID")]
    pub id: Option<String>,
    /// Life of an edge in the cut, minutes
    #[arg(long, value_name = "MIN", requires = "id", value_parser = setup_args::parse_number)]
    pub minutes: Option<f64>,
    /// Number of edges
    #[arg(long, value_name = "N", requires = "id", value_parser = clap::value_parser!(u8).range(1..=12))]
    pub edges: Option<u8>,
    /// Add minutes in the cut
    #[arg(long, value_name = "MIN", requires = "id", value_parser = setup_args::parse_number)]
    pub add: Option<f64>,
    /// The insert is turned to its next edge, or replaced after its last one
    #[arg(long, requires = "id", conflicts_with = "add")]
    pub next_edge: bool,
    #[command(flatten)]
    pub data: ToolsDataArgs,
}

/// Arguments of the command `tools count`.
#[derive(Args, Debug)]
pub struct ToolsCountArgs {
    /// The program; its job file names tools of the library
    #[arg(value_name = "PROGRAM")]
    pub file: PathBuf,
    /// The job file [default: the one beside the program]
    #[arg(long, value_name = "FILE")]
    pub job: Option<PathBuf>,
    /// Add the minutes of this number of parts to the lives of the tools
    #[arg(long, value_name = "N")]
    pub parts: Option<u32>,
    #[command(flatten)]
    pub setup: SetupArgs,
}
