//! Options of `form`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use gsk_forms::FormKind;

/// `form`.
#[derive(Args, Debug)]
pub struct FormArgs {
    /// The form
    #[arg(value_name = "NAME", value_parser = form_parser(), required_unless_present_any = ["list", "read", "threads"])]
    pub name: Option<FormKind>,
    /// A field of the form (may be repeated) [default: the default of each field]
    #[arg(long = "set", value_name = "FIELD=VALUE", requires = "name")]
    pub values: Vec<String>,
    /// Set speed, feed and depth to starting values for this material of `load materials`, before --set
    #[arg(long, value_name = "MATERIAL", requires = "name")]
    pub material: Option<String>,
    /// Take the tool from the tool library: T number, nose radius, width or diameter, before --set
    #[arg(long, value_name = "ID", requires = "name")]
    pub tool: Option<String>,
    /// The data folder with the tool library [default: the one of the window]
    #[arg(long, value_name = "DIR", requires = "tool")]
    pub data: Option<PathBuf>,
    /// Write a program into this file, and stock and tool beside it (shaft.CNC: shaft.job.ron) [default: print the program]
    #[arg(short, long, value_name = "FILE", requires = "name")]
    pub output: Option<PathBuf>,
    /// The program number
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(0..=9999))]
    pub number: u16,
    /// Print the blocks of the form alone, for another program
    #[arg(long, requires = "name", conflicts_with = "output")]
    pub blocks: bool,
    /// List the forms
    #[arg(long, conflicts_with_all = ["name", "read", "threads"])]
    pub list: bool,
    /// List the fields of the form with value, unit and range
    #[arg(long, requires = "name", conflicts_with_all = ["output", "blocks"])]
    pub fields: bool,
    /// List the forms in a program, and whether their blocks were changed by hand (exit code 1)
    #[arg(long, value_name = "FILE", conflicts_with_all = ["name", "threads"])]
    pub read: Option<PathBuf>,
    /// Print the thread table with diameters and sources
    #[arg(long, conflicts_with = "name")]
    pub threads: bool,
}

fn form_parser() -> impl TypedValueParser<Value = FormKind> {
    let forms = FormKind::ALL.into_iter();
    let words = PossibleValuesParser::new(forms.map(|form| PossibleValue::new(form.word())));
    words.map(|word| FormKind::from_word(&word).unwrap_or(FormKind::Turn))
}
