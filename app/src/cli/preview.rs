//! Options of `check` and `plot`, which preview a program without a machine.

use std::path::PathBuf;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueEnum};
use gsk_core::preview::{Lint, WorkBudget};
use gsk_host::job::{JobArgs, PartArgs};
use gsk_host::preview::work_limit::WorkLimit;
use gsk_host::setup_args::{self, SetupArgs};
use gsk_runner::report::lint_levels::{LintLevel, LintLevels};
use gsk_scene::camera::CameraPreset;
use web_time::Duration;

use super::PictureArgs;

/// Limits at which `check` and `plot` cancel a preview.
#[derive(Args, Clone, Copy, Debug)]
pub struct LimitArgs {
    /// Stop checking a program after this number of moves
    #[arg(long, default_value_t = WorkBudget::FULL.moves, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub most_moves: u64,
    /// Stop checking a program after this number of blocks; blocks of loops and subprograms count
    /// each time
    #[arg(long, default_value_t = WorkBudget::FULL.work, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub most_blocks: u64,
    /// Stop checking a program after this time as well, for instance 90s, 10m [default: no limit]
    #[arg(long, value_name = "TIME", value_parser = setup_args::parse_duration_ms)]
    pub give_up: Option<u64>,
}

impl LimitArgs {
    /// Returns the work limit of a preview; its time limit counts from this call.
    pub fn start(self) -> WorkLimit {
        let budget = WorkBudget {
            moves: self.most_moves,
            work: self.most_blocks,
            ..WorkBudget::FULL
        };
        WorkLimit::new(budget).with_deadline(self.give_up.map(Duration::from_millis))
    }
}

impl Default for LimitArgs {
    fn default() -> Self {
        Self {
            most_moves: WorkBudget::FULL.moves,
            most_blocks: WorkBudget::FULL.work,
            give_up: None,
        }
    }
}

/// Options of the preview of `check` and `plot`.
#[derive(Args, Clone, Copy, Debug, Default)]
pub struct LookArgs {
    /// Work zero in machine coordinates: X (diameter), Z in mm; --start is then relative to it
    /// [default: at the machine zero]
    ///
    /// With this option, G28 and the rest of the program are drawn at their true position relative
    /// to the machine zero. A program that begins with G50 also needs --start, the position of its
    /// tool at the start.
    #[arg(long, value_name = "X,Z", allow_hyphen_values = true, value_parser = setup_args::parse_xz)]
    pub work_zero: Option<(f64, f64)>,
    #[command(flatten)]
    pub limits: LimitArgs,
}

/// Arguments of the command `check`. The default has no file and no option.
#[derive(Args, Debug, Default)]
pub struct CheckArgs {
    /// The programs; of a folder those in it and below it
    #[arg(required_unless_present = "lints", value_name = "FILE")]
    pub files: Vec<PathBuf>,
    #[command(flatten)]
    pub look: LookArgs,
    #[command(flatten)]
    pub part: PartArgs,
    /// Compute force, power, torque and roughness of every cut, and warn where lathe or insert
    /// allow less
    #[arg(long)]
    pub load: bool,
    /// Compute the load and write it along every move as CSV; one program only
    #[arg(long, value_name = "FILE")]
    pub load_csv: Option<PathBuf>,
    /// Write every move as one JSON object a line (`-`: standard output); one program only
    #[arg(long, value_name = "FILE")]
    pub moves: Option<PathBuf>,
    /// Print one JSON object for each file; `times` are its seconds by kind (rapid, feed, thread,
    /// dwell, other), `tool_times` the same for each tool
    #[arg(long)]
    pub json: bool,
    /// Do not report this kind of warning: a name or number of --lints, or `all`; commas separate
    /// several
    #[arg(long, value_name = "LINT", value_delimiter = ',', hide_possible_values = true, value_parser = lint_parser())]
    pub allow: Vec<LintChoice>,
    /// Make this kind of warning an error (exit code 1): a name or number of --lints, or `all`;
    /// commas separate several
    #[arg(long, value_name = "LINT", value_delimiter = ',', hide_possible_values = true, value_parser = lint_parser())]
    pub deny: Vec<LintChoice>,
    /// Print all kinds of warnings with number and name
    #[arg(long, conflicts_with_all = ["files", "json", "format"])]
    pub lints: bool,
    /// Format of the results
    #[arg(
        long,
        value_enum,
        default_value_t,
        conflicts_with = "json",
        value_name = "FORMAT"
    )]
    pub format: CheckFormat,
    #[command(flatten)]
    pub setup: SetupArgs,
}

/// What `--allow` and `--deny` choose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LintChoice {
    All,
    One(Lint),
}

fn lint_parser() -> impl TypedValueParser<Value = LintChoice> {
    let each = Lint::ALL
        .into_iter()
        .map(|it| PossibleValue::new(it.id()).alias(it.code()));
    PossibleValuesParser::new(each.chain([PossibleValue::new("all")]))
        .map(|word| Lint::from_name(&word).map_or(LintChoice::All, LintChoice::One))
}

impl CheckArgs {
    /// Whether an option of the load is given.
    pub const fn is_load_requested(&self) -> bool {
        self.load || self.load_csv.is_some()
    }

    /// The level of each kind of warning. The error is a kind that is both allowed and denied.
    pub fn lint_levels(&self) -> Result<LintLevels, &'static str> {
        let mut levels = LintLevels::default();
        if let Some(both) = self.allow.iter().find(|it| self.deny.contains(it)) {
            return Err(match both {
                LintChoice::All => "all",
                LintChoice::One(lint) => lint.id(),
            });
        }
        let allowed = self.allow.iter().map(|it| (it, LintLevel::Allow));
        let denied = self.deny.iter().map(|it| (it, LintLevel::Deny));
        for (choice, level) in allowed.chain(denied) {
            let lint = match choice {
                LintChoice::All => None,
                LintChoice::One(lint) => Some(*lint),
            };
            levels.set(lint, level);
        }
        Ok(levels)
    }

    /// Returns the output format: `--json` is short for `--format json`.
    pub const fn format(&self) -> CheckFormat {
        match self.json {
            true => CheckFormat::Json,
            false => self.format,
        }
    }
}

/// Output format of `check`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum CheckFormat {
    /// Text, with a summary after several programs
    #[default]
    Human,
    /// One JSON object for each file
    Json,
    /// One line for each alarm, collision and warning, which a GitHub workflow shows beside the
    /// block
    Github,
    /// One SARIF 2.1.0 log, for editors and code scanning
    Sarif,
}

/// Cameras for a picture of the lathe in 3D.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum SceneCamera {
    #[default]
    Operator,
    Tool,
    Chuck,
    Top,
    Section,
}

impl From<SceneCamera> for CameraPreset {
    fn from(camera: SceneCamera) -> Self {
        match camera {
            SceneCamera::Operator => Self::Operator,
            SceneCamera::Tool => Self::Tool,
            SceneCamera::Chuck => Self::Chuck,
            SceneCamera::Top => Self::Top,
            SceneCamera::Section => Self::Section,
        }
    }
}

/// Options of a picture of the lathe in space.
#[derive(Args, Clone, Copy, Debug)]
pub struct SceneArgs {
    /// Draw the lathe in space with the finished part, not the path (.png only)
    #[arg(long, conflicts_with_all = ["solid", "whole", "labels", "dimensions", "tools"])]
    pub scene: bool,
    /// Draw the program from beginning to end in N pictures, as an animation (APNG)
    #[arg(long, requires = "scene", value_name = "N", value_parser = clap::value_parser!(u32).range(2..=1000))]
    pub frames: Option<u32>,
    /// Camera of the lathe in space; `tool` follows the tool, `section` shows the plane of the
    /// machine view
    #[arg(
        long,
        requires = "scene",
        value_enum,
        default_value_t,
        value_name = "CAMERA"
    )]
    pub camera: SceneCamera,
}

/// Arguments of the command `plot`.
#[derive(Args, Debug)]
pub struct PlotArgs {
    /// The program
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    #[command(flatten)]
    pub look: LookArgs,
    /// The part, drawn under the path.
    #[command(flatten)]
    pub part: JobArgs,
    /// Draw the part as a lit solid with a quarter cut out, not the path (.png only)
    #[arg(long, conflicts_with_all = ["whole", "labels", "dimensions", "tools"])]
    pub solid: bool,
    #[command(flatten)]
    pub scene: SceneArgs,
    /// The picture (name ends in .png or .svg)
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    #[command(flatten)]
    pub picture: PictureArgs,
    #[command(flatten)]
    pub setup: SetupArgs,
}
