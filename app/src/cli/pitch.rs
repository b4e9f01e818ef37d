//! Options of `pitch`.

use std::path::PathBuf;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, Subcommand, ValueEnum};
use gsk_core::model::ModelId;
use gsk_core::units::Axis;

/// Commands about pitch error tables.
#[derive(Debug, Subcommand)]
pub enum PitchCommand {
    /// Import measured pitch errors into the table of the control, with the rights of its operation
    /// level
    ///
    /// A CSV file has a heading with `target` (mm) and `deviation` (µm) or `measured` (mm), and
    /// optionally `run` and `direction`; runs in both directions also give the backlash. A
    /// calibration text (REN) contains values that are added to those of the table, or runs of
    /// readings; a linear measurement of Renishaw (RTL) contains runs. docs/commissioning.md
    /// describes both. The previous memory of the control is kept as a project in `backups` of the
    /// data folder.
    Import(PitchImportArgs),
    /// Print the table of the control with its corrections
    Show(PitchShowArgs),
}

/// Creates the parser for the letter of a lathe axis.
fn axis_parser() -> impl TypedValueParser<Value = Axis> {
    PossibleValuesParser::new(["x", "z"]).map(|word| match word.as_str() {
        "x" => Axis::X,
        _ => Axis::Z,
    })
}

/// Arguments of the command `pitch import`.
#[derive(Args, Debug)]
pub struct PitchImportArgs {
    /// The measurement: CSV, RTL, or the text of a calibration (REN)
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// The axis
    #[arg(long, value_parser = axis_parser(), value_name = "AXIS")]
    pub axis: Axis,
    /// The data folder of the control [default: the one of the window]
    #[arg(long, value_name = "DIR", alias = "data")]
    pub into: Option<PathBuf>,
    /// Control model whose memory is written [default: the model stored in the data folder]
    #[arg(long, value_name = "MODEL", value_parser = gsk_host::setup_args::lathe_model_parser())]
    pub model: Option<ModelId>,
    /// Slide travel from point to point, mm [default: the coarsest that leaves 0.8 µm or less]
    #[arg(long, value_name = "MM", allow_negative_numbers = true, value_parser = gsk_host::setup_args::parse_number)]
    pub interval: Option<f64>,
    /// The table was empty during the measurement: replace its values instead of adding to them
    #[arg(long)]
    pub clear: bool,
    /// The targets are diameters (X)
    #[arg(long)]
    pub diameter: bool,
    /// Password of the control: use the rights of its operation level for this command
    #[arg(long, value_name = "PASSWORD")]
    pub password: Option<String>,
    /// Print the new values beside the current ones, and write nothing
    #[arg(long)]
    pub dry_run: bool,
    /// Print as JSON
    #[arg(long)]
    pub json: bool,
}

/// Arguments of the command `pitch show`.
#[derive(Args, Debug)]
pub struct PitchShowArgs {
    /// The axis [default: both]
    #[arg(long, value_parser = axis_parser(), value_name = "AXIS")]
    pub axis: Option<Axis>,
    /// The data folder of the control [default: the one of the window]
    #[arg(long, value_name = "DIR", alias = "into")]
    pub data: Option<PathBuf>,
    /// Control model whose memory is read [default: the model stored in the data folder]
    #[arg(long, value_name = "MODEL", value_parser = gsk_host::setup_args::lathe_model_parser())]
    pub model: Option<ModelId>,
    /// Format of the table
    #[arg(long, value_enum, default_value_t = PitchFormat::Human)]
    pub format: PitchFormat,
}

/// Output format of a pitch error table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum PitchFormat {
    /// One line for each point with a value
    Human,
    /// Position in mm and correction in µm, as CSV
    Csv,
    /// The text of a calibration, which `pitch import` reads
    Ren,
    /// JSON array
    Json,
}
