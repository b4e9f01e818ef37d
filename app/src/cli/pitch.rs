//! Options of `pitch`.

use std::path::PathBuf;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, Subcommand, ValueEnum};
use gsk_core::model::ModelId;
use gsk_core::units::Axis;

/// Commands about pitch error tables.
#[derive(Debug, Subcommand)]
pub enum PitchCommand {
    /// Write measured pitch errors into the table of the control, with the control's rights
    ///
    /// A CSV file has a heading with `target` (mm) and `deviation` (µm) or `measured` (mm), and
    /// if need be `run` and `direction`; runs in both directions give the backlash as well. The
    /// text of a calibration (REN) has values that are added to those of the table, or runs of
    /// readings; a linear measurement of Renishaw (RTL) has runs. docs/commissioning.md describes both. What the control held before is kept as a
    /// project in `backups` of the data folder.
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
    /// The control model whose memory is written [default: as the data folder says]
    #[arg(long, value_name = "MODEL", value_parser = gsk_host::setup_args::lathe_model_parser())]
    pub model: Option<ModelId>,
    /// Slide travel from point to point, mm [default: the coarsest that leaves 0.8 µm or less]
    #[arg(long, value_name = "MM", allow_negative_numbers = true, value_parser = gsk_host::setup_args::parse_number)]
    pub interval: Option<f64>,
    /// The table was empty when it was measured: what stands in it is dropped, not added to
    #[arg(long)]
    pub clear: bool,
    /// Targets are programmed diameters (X)
    #[arg(long)]
    pub diameter: bool,
    /// A password of the control: the rights of its operation level, for this once
    #[arg(long, value_name = "PASSWORD")]
    pub password: Option<String>,
    /// Only say what would be written, beside the corrections in force
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
    /// The control model whose memory is read [default: as the data folder says]
    #[arg(long, value_name = "MODEL", value_parser = gsk_host::setup_args::lathe_model_parser())]
    pub model: Option<ModelId>,
    /// How the table is written
    #[arg(long, value_enum, default_value_t = PitchFormat::Human)]
    pub format: PitchFormat,
}

/// Output format of a pitch error table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum PitchFormat {
    /// A line for each point with a value
    Human,
    /// Position in mm and correction in µm, as CSV
    Csv,
    /// The text of a calibration, which `pitch import` reads
    Ren,
    /// A JSON array
    Json,
}
