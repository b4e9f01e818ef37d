//! Options of `project`.

use std::path::PathBuf;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, Subcommand, ValueEnum};
use gsk_core::model::ModelId;
use gsk_project::ProjectSection;

/// Commands about projects.
#[derive(Debug, Subcommand)]
pub enum ProjectSubcommand {
    /// Write the project of a control as it is delivered
    New(ProjectNewArgs),
    /// Write all that the control holds into a folder
    ///
    /// A folder that is a project already is brought up to date: files that are the same stay
    /// untouched, those of programs that are gone are removed, its machine file, jobs and
    /// whatever else its owner keeps at its top are left alone.
    Export(ProjectExportArgs),
    /// Take over what a project says, with the rights of the control
    ///
    /// Nothing is changed when one line of the folder is wrong, or one value is refused. What
    /// the control held before is kept as a project in `backups` of the data folder.
    Import(ProjectImportArgs),
    /// List what differs between two projects, data folders or the control
    ///
    /// Exit code 0: nothing differs, 1: something does.
    Diff(ProjectDiffArgs),
}

/// Arguments of the command `project new`.
#[derive(Args, Debug)]
pub struct ProjectNewArgs {
    /// The folder: a new one, or an empty one
    #[arg(value_name = "FOLDER")]
    pub folder: PathBuf,
    /// The control model [default: gsk980td]
    #[arg(long, value_name = "MODEL", value_parser = gsk_host::setup_args::lathe_model_parser())]
    pub model: Option<ModelId>,
    /// The lathe from a RON file, which becomes the machine file of the project
    #[arg(long, value_name = "FILE")]
    pub machine: Option<PathBuf>,
}

/// Arguments of the command `project export`.
#[derive(Args, Debug)]
pub struct ProjectExportArgs {
    /// The folder: a new one, an empty one, or a project
    #[arg(value_name = "FOLDER")]
    pub folder: PathBuf,
    /// The data folder of the control [default: the one of the window]
    #[arg(long, value_name = "DIR")]
    pub data: Option<PathBuf>,
    /// The control model whose memory is written [default: as the data folder says]
    #[arg(long, value_name = "MODEL", value_parser = gsk_host::setup_args::lathe_model_parser())]
    pub model: Option<ModelId>,
    /// The lathe from a RON file, which becomes the machine file of the project
    #[arg(long, value_name = "FILE")]
    pub machine: Option<PathBuf>,
}

/// Arguments of the command `project import`.
#[derive(Args, Debug)]
pub struct ProjectImportArgs {
    /// The project
    #[arg(value_name = "FOLDER")]
    pub folder: PathBuf,
    /// The data folder of the control [default: the one of the window]
    #[arg(long, value_name = "DIR")]
    pub data: Option<PathBuf>,
    /// Take over these parts alone, for instance parameters,offsets
    #[arg(long, value_name = "PART", value_delimiter = ',', value_parser = section_parser(ProjectSection::is_in_control))]
    pub only: Vec<ProjectSection>,
    /// A password of the control: the rights of its operation level, for this once
    #[arg(long, value_name = "PASSWORD")]
    pub password: Option<String>,
    /// Only say what would be taken over
    #[arg(long)]
    pub dry_run: bool,
}

/// Arguments of the command `project diff`.
#[derive(Args, Debug)]
pub struct ProjectDiffArgs {
    /// A project or a data folder: what there was
    #[arg(value_name = "OLD")]
    pub old: PathBuf,
    /// Another one: what there is [default: the control of the data folder]
    #[arg(value_name = "NEW")]
    pub new: Option<PathBuf>,
    /// The data folder of the control, without a second folder [default: the one of the window]
    #[arg(long, value_name = "DIR", conflicts_with = "new")]
    pub data: Option<PathBuf>,
    /// The control model whose memory is compared, of data folders [default: as they say]
    #[arg(long, value_name = "MODEL", value_parser = gsk_host::setup_args::lathe_model_parser())]
    pub model: Option<ModelId>,
    /// Compare these parts alone, for instance parameters,offsets
    #[arg(long, value_name = "PART", value_delimiter = ',', value_parser = section_parser(|_| true))]
    pub only: Vec<ProjectSection>,
    /// How the list is written
    #[arg(long, value_enum, default_value_t = DiffFormat::Human)]
    pub format: DiffFormat,
}

/// Output format of `project diff`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum DiffFormat {
    /// A line each
    Human,
    /// A JSON array
    Json,
}

/// Creates the parser for section names; it accepts the sections for which `is_accepted` returns
/// true.
fn section_parser(
    is_accepted: fn(ProjectSection) -> bool,
) -> impl TypedValueParser<Value = ProjectSection> {
    let rows = ProjectSection::ALL.into_iter();
    let words = rows.filter(|(section, _)| is_accepted(*section));
    let words: Vec<&'static str> = words.map(|(_, word)| word).collect();
    // The parser accepts no other word.
    PossibleValuesParser::new(words)
        .map(|word| ProjectSection::from_word(&word).unwrap_or(ProjectSection::Model))
}
