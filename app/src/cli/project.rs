//! Options of `project`.

use std::path::PathBuf;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, Subcommand, ValueEnum};
use gsk_core::model::ModelId;
use gsk_project::ProjectSection;

/// Commands about projects.
#[derive(Debug, Subcommand)]
pub enum ProjectSubcommand {
    /// Write the project of a control with its delivered settings
    New(ProjectNewArgs),
    /// Export the memory of the control into a folder
    ///
    /// An existing project is updated: equal files stay untouched, and the files of deleted
    /// programs are removed. The machine file, the jobs and other files at the top of the folder
    /// are kept.
    Export(ProjectExportArgs),
    /// Import a project into the control, with the rights of its operation level
    ///
    /// If a line of the folder is invalid or a value is refused, nothing changes. The previous
    /// memory of the control is kept as a project in `backups` of the data folder.
    Import(ProjectImportArgs),
    /// List the differences between two projects, data folders or the control
    ///
    /// Exit code 0: no difference; 1: at least one.
    Diff(ProjectDiffArgs),
}

/// Arguments of the command `project new`.
#[derive(Args, Debug)]
pub struct ProjectNewArgs {
    /// Folder: new or empty
    #[arg(value_name = "FOLDER")]
    pub folder: PathBuf,
    /// The control model [default: gsk980td]
    #[arg(long, value_name = "MODEL", value_parser = gsk_host::setup_args::lathe_model_parser())]
    pub model: Option<ModelId>,
    /// Lathe from a RON file; it is copied into the project as its machine file
    #[arg(long, value_name = "FILE")]
    pub machine: Option<PathBuf>,
}

/// Arguments of the command `project export`.
#[derive(Args, Debug)]
pub struct ProjectExportArgs {
    /// Folder: new, empty, or a project
    #[arg(value_name = "FOLDER")]
    pub folder: PathBuf,
    /// The data folder of the control [default: the one of the window]
    #[arg(long, value_name = "DIR")]
    pub data: Option<PathBuf>,
    /// Control model whose memory is written [default: the model stored in the data folder]
    #[arg(long, value_name = "MODEL", value_parser = gsk_host::setup_args::lathe_model_parser())]
    pub model: Option<ModelId>,
    /// Lathe from a RON file; it is copied into the project as its machine file
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
    /// Import only these sections, for instance parameters,offsets
    #[arg(long, value_name = "PART", value_delimiter = ',', value_parser = section_parser(ProjectSection::is_in_control))]
    pub only: Vec<ProjectSection>,
    /// Password of the control: use the rights of its operation level for this command
    #[arg(long, value_name = "PASSWORD")]
    pub password: Option<String>,
    /// Print what would be imported, and change nothing
    #[arg(long)]
    pub dry_run: bool,
}

/// Arguments of the command `project diff`.
#[derive(Args, Debug)]
pub struct ProjectDiffArgs {
    /// The old state: a project or a data folder
    #[arg(value_name = "OLD")]
    pub old: PathBuf,
    /// The new state: a project or a data folder [default: the control of the data folder]
    #[arg(value_name = "NEW")]
    pub new: Option<PathBuf>,
    /// The data folder of the control, without a second folder [default: the one of the window]
    #[arg(long, value_name = "DIR", conflicts_with = "new")]
    pub data: Option<PathBuf>,
    /// Control model whose memory is compared, in data folders [default: the model stored in them]
    #[arg(long, value_name = "MODEL", value_parser = gsk_host::setup_args::lathe_model_parser())]
    pub model: Option<ModelId>,
    /// Compare only these sections, for instance parameters,offsets
    #[arg(long, value_name = "PART", value_delimiter = ',', value_parser = section_parser(|_| true))]
    pub only: Vec<ProjectSection>,
    /// Format of the list
    #[arg(long, value_enum, default_value_t = DiffFormat::Human)]
    pub format: DiffFormat,
}

/// Output format of `project diff`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum DiffFormat {
    /// One line for each difference
    Human,
    /// JSON array
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
