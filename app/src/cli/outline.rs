//! Options of `outline`.

use std::path::PathBuf;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueEnum};
use gsk_core::units::{Point, parse_finite};
use gsk_host::setup_args::OptionValueError;
use gsk_outline::{DrawingUnit, OutlineFormat, ProfileZero};

/// `outline`.
#[derive(Args, Debug)]
pub struct OutlineArgs {
    /// The drawing, DXF or SVG
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// A layer with the outline (may be repeated) [default: all visible ones]
    #[arg(long, value_name = "NAME")]
    pub layer: Vec<String>,
    /// The program zero: the right or left end, or the axis (X) and Z0 in the drawing, mm
    #[arg(long, value_name = "right|left|X,Z", default_value = "right", allow_hyphen_values = true, value_parser = parse_zero)]
    pub zero: ProfileZero,
    /// The unit of the drawing [default: as the drawing states]
    #[arg(long, value_name = "UNIT", value_parser = unit_parser())]
    pub unit: Option<DrawingUnit>,
    /// Join ends that are closer than this distance, mm
    #[arg(long, value_name = "MM", default_value_t = gsk_outline::DEFAULT_GAP_MM)]
    pub gap: f64,
    /// Diameter of the stock [default: the largest diameter and 2 mm, rounded up]
    #[arg(long, value_name = "MM")]
    pub stock: Option<f64>,
    /// Corner angle of the finishing insert: refuse what its end edge does not clear
    #[arg(long, value_name = "DEGREES")]
    pub insert: Option<f64>,
    /// Kind of output
    #[arg(long, value_name = "FORMAT", default_value = "g71")]
    pub format: OutlineTextFormat,
    /// Write the program into this file and check it
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Print outline, notes and program as JSON
    #[arg(long)]
    pub json: bool,
}

/// What `outline` writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum OutlineTextFormat {
    /// A whole program with G71 and G70
    G71,
    /// The blocks of the outline alone
    Contour,
}

impl From<OutlineTextFormat> for OutlineFormat {
    fn from(format: OutlineTextFormat) -> Self {
        match format {
            OutlineTextFormat::G71 => Self::G71,
            OutlineTextFormat::Contour => Self::Contour,
        }
    }
}

fn parse_zero(text: &str) -> Result<ProfileZero, OptionValueError> {
    let wrong = || OptionValueError::WrongForm("right|left|X,Z");
    match text {
        "right" => Ok(ProfileZero::Right),
        "left" => Ok(ProfileZero::Left),
        _ => {
            let (x, z) = text.split_once(',').ok_or_else(wrong)?;
            let [x, z] = [x, z].map(|word| parse_finite(word.trim()).ok_or_else(wrong));
            Ok(ProfileZero::At(Point::new(x?, z?)))
        }
    }
}

fn unit_parser() -> impl TypedValueParser<Value = DrawingUnit> {
    let names = ["mm", "cm", "m", "in"];
    PossibleValuesParser::new(names.map(PossibleValue::new)).map(|word| match word.as_str() {
        "cm" => DrawingUnit::Centimetre,
        "m" => DrawingUnit::Metre,
        "in" => DrawingUnit::Inch,
        _ => DrawingUnit::Millimetre,
    })
}
