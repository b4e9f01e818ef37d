//! Options of `dialect`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use gsk_core::model::ModelId;
use gsk_messages::Language;
use gsk_port::{ForeignDialect, PlainNumbers};

/// Arguments of the command `dialect`.
#[derive(Args, Debug)]
pub struct DialectArgs {
    /// The program
    #[arg(value_name = "FILE", required_unless_present = "codes")]
    pub file: Option<PathBuf>,
    /// Model for which the program was written, or the dialect of another control
    #[arg(long, value_name = "MODEL", value_parser = origin_parser(), required_unless_present = "codes")]
    pub from: Option<ProgramOrigin>,
    /// Model that will read the program [default: gsk980td, for a dialect]
    #[arg(long, value_name = "MODEL", value_parser = gsk_host::setup_args::model_parser())]
    pub to: Option<ModelId>,
    /// Write the program for the other model into this file
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Dialects: print the result with all findings and the check as JSON
    #[arg(long)]
    pub json: bool,
    /// Dialects: how a number without a decimal point is read [default: as the control does]
    #[arg(long, value_name = "WORD", value_parser = numbers_parser())]
    pub numbers: Option<PlainNumbers>,
    /// Dialects: lengths are inches before the first G20 or G21
    #[arg(long)]
    pub inch: bool,
    /// Print the table of foreign codes with their equivalents
    #[arg(long, conflicts_with_all = ["from", "to", "output", "json", "numbers", "inch", "file"])]
    pub codes: bool,
}

/// The control that a program was written for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProgramOrigin {
    /// A control model of this program.
    Model(ModelId),
    /// Another control.
    Foreign(ForeignDialect),
}

fn origin_parser() -> impl TypedValueParser<Value = ProgramOrigin> {
    let models = ModelId::ALL.into_iter();
    let models =
        models.map(|id| PossibleValue::new(id.command_word()).help(id.name().text(Language::En)));
    let dialects = ForeignDialect::ALL.into_iter();
    let dialects = dialects.map(|it| PossibleValue::new(it.command_word()).help(it.name()));
    PossibleValuesParser::new(models.chain(dialects)).map(|word| {
        ForeignDialect::from_command_word(&word).map_or_else(
            || ProgramOrigin::Model(ModelId::from_command_word(&word).unwrap_or_default()),
            ProgramOrigin::Foreign,
        )
    })
}

fn numbers_parser() -> impl TypedValueParser<Value = PlainNumbers> {
    let words = [
        PossibleValue::new("increments").help("X1500 is 1.5 mm"),
        PossibleValue::new("written").help("X1500 is 1500 mm"),
    ];
    PossibleValuesParser::new(words).map(|word| match word.as_str() {
        "written" => PlainNumbers::AsWritten,
        _ => PlainNumbers::Increments,
    })
}
