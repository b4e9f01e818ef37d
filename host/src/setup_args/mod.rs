//! The options of control and lathe that `run`, `check`, `plot` and `operate` share, and
//! their parsers.

mod words;

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use gsk_core::memory::DayTime;
use gsk_core::model::ModelId;
use gsk_messages::{Message, say};
use gsk_milling::MillOffsetMemory;

use crate::files::models;

pub use words::{
    InputBit, OffsetOption, OptionValueError, ParameterOption, lathe_model_parser, model_parser,
    parse_distance, parse_duration_ms, parse_feed, parse_input_bit, parse_number, parse_parameter,
    parse_switch, parse_xz,
};
use words::{parse_model_parameter, parse_moment, parse_offset, parse_spindle_speed};

/// Options of control and lathe. A command lists them last: their help heading applies to
/// all later options, too.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Control and lathe")]
pub struct SetupArgs {
    /// Position of the tool before the first block: X (diameter), Z in mm [default: 300,300; with
    /// --machine the position in its file]
    #[arg(long, value_name = "X,Z", allow_hyphen_values = true, value_parser = parse_xz)]
    pub start: Option<(f64, f64)>,
    /// The spindle already turns forward at this speed, r/min [default: it is stopped]
    #[arg(long, value_name = "RPM", value_parser = parse_spindle_speed)]
    pub spindle: Option<f64>,
    /// A parameter: 22=3800, or one bit of it: 1.4=1 (may be repeated)
    #[arg(long = "param", value_name = "N=V|N.B=0|1", allow_hyphen_values = true, value_parser = parse_parameter)]
    pub parameters: Vec<ParameterOption>,
    /// Tool offset: NN=X,Z,R,T; omitted values at the end are 0 (may be repeated)
    #[arg(long = "offset", value_name = "NN=X,Z,R,T", allow_hyphen_values = true, value_parser = parse_offset)]
    pub offsets: Vec<OffsetOption>,
    /// Hold a machine input at a value, for instance X0.4=1 (may be repeated)
    #[arg(long = "input", value_name = "X0.4=1", value_parser = parse_input_bit)]
    pub inputs: Vec<InputBit>,
    /// The lathe (travel, turret, dogs …) from a RON file
    #[arg(long, value_name = "FILE")]
    pub machine: Option<PathBuf>,
    /// The machine's ladder instead of the standard one (instruction list)
    #[arg(long, value_name = "FILE")]
    pub ladder: Option<PathBuf>,
    /// Macro B: formulas, IF, WHILE, GOTO and calls with arguments (G65 P) in programs [default:
    /// the setting in the data folder, else off]
    #[arg(long, value_name = "on|off", value_parser = parse_switch)]
    pub macro_b: Option<bool>,
    /// Control model that reads the programs; each has a separate memory in the data folder
    /// [default: the model stored in the data folder, else gsk980td]
    #[arg(long, value_name = "MODEL", value_parser = model_parser())]
    pub model: Option<ModelId>,
    /// A parameter that only this model has, for instance 17=6000 (may be repeated)
    #[arg(long = "model-param", value_name = "N=V", allow_hyphen_values = true, value_parser = parse_model_parameter)]
    pub model_parameters: Vec<(u16, i32)>,
    /// Date and time at which the clock of the control starts (#3011, #3012 of macro B), for
    /// instance 1993-03-28T15:34:56 [default: the computer's]
    #[arg(long, value_name = "DATETIME", value_parser = parse_moment)]
    pub clock: Option<DayTime>,
    /// Use the memory of this data folder (parameters, offsets, programs), and store changes in it
    #[arg(long, value_name = "DIR")]
    pub data: Option<PathBuf>,
    /// Options of the mill.
    #[command(flatten)]
    pub mill: Box<MillArgs>,
}

impl SetupArgs {
    /// The selected control model: that of `--model`, else that of the data directory, else
    /// the GSK980TD.
    pub fn selected_model(&self) -> ModelId {
        let stored_model = || self.data.as_deref().map(models::read_selected_model);
        self.model.or_else(stored_model).unwrap_or_default()
    }

    /// The folder of the selected model in the data directory; `None` without `--data`.
    pub fn data_folder(&self) -> Option<PathBuf> {
        let data = self.data.as_deref()?;
        Some(models::memory_folder(data, self.selected_model()))
    }

    /// Refuses programs of a mill for commands that execute programs.
    ///
    /// # Errors
    /// The selected model is a mill, or an option of a mill is given.
    pub fn refuse_mill(&self) -> Result<(), ModelMismatch> {
        self.check_mill_options()?;
        match self.selected_model() {
            model if model.is_mill() => Err(ModelMismatch::NotExecutable(model)),
            _ => Ok(()),
        }
    }

    /// Refuses options of a mill if the selected model is a lathe.
    ///
    /// # Errors
    /// Names the first such option.
    pub fn check_mill_options(&self) -> Result<(), ModelMismatch> {
        let mill = &self.mill;
        let given = [
            (mill.mill_start.is_some(), "--mill-start"),
            (!mill.mill_zeros.is_empty(), "--mill-zero"),
            (!mill.mill_offsets.is_empty(), "--mill-offset"),
            (mill.mill_memory.is_some(), "--mill-memory"),
        ];
        match given.into_iter().find(|(given, _)| *given) {
            Some((_, option)) if !self.selected_model().is_mill() => {
                Err(ModelMismatch::MillOnly(option))
            }
            _ => Ok(()),
        }
    }

    /// Refuses options of a lathe; called if the selected model is a mill.
    ///
    /// # Errors
    /// Names the first such option.
    pub fn check_lathe_options(&self) -> Result<(), ModelMismatch> {
        let given = [
            (self.start.is_some(), "--start"),
            (self.spindle.is_some(), "--spindle"),
            (!self.parameters.is_empty(), "--param"),
            (!self.offsets.is_empty(), "--offset"),
            (!self.inputs.is_empty(), "--input"),
            (self.machine.is_some(), "--machine"),
            (self.ladder.is_some(), "--ladder"),
        ];
        match given.into_iter().find(|(given, _)| *given) {
            Some((_, option)) => Err(ModelMismatch::LatheOnly(option)),
            None => Ok(()),
        }
    }

    pub fn input_files(&self) -> impl Iterator<Item = &Path> {
        [&self.machine, &self.ladder]
            .into_iter()
            .flatten()
            .map(PathBuf::as_path)
    }

    /// Refuses options that set what a real machine already determines: the position of its
    /// slides and the speed of its spindle.
    ///
    /// # Errors
    /// Names the first such option.
    pub const fn refuse_machine_state(&self) -> Result<(), MachineStateOption> {
        match (self.start, self.spindle) {
            (Some(_), _) => Err(MachineStateOption::Slides),
            (_, Some(_)) => Err(MachineStateOption::Spindle),
            (None, None) => Ok(()),
        }
    }
}

/// Options of a mill (`--model gsk980mdi`) for `check`, `plot` and `lsp`.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Mill (--model gsk980mdi; check, plot, lsp)")]
pub struct MillArgs {
    /// Position of the slides before the first block, machine coordinates [default: 0,0,100]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub mill_start: Option<String>,
    /// Work zero in machine coordinates: 54=X,Y,Z to 59, 54.1P1 to 54.1P48, 0 for the external one
    /// (may be repeated)
    #[arg(
        long = "mill-zero",
        value_name = "54=X,Y,Z",
        allow_hyphen_values = true
    )]
    pub mill_zeros: Vec<String>,
    /// The length and the radius of a tool, followed by the wear of both: N=H,D or N=H,D,W,W
    /// (may be repeated)
    #[arg(long = "mill-offset", value_name = "N=H,D", allow_hyphen_values = true)]
    pub mill_offsets: Vec<String>,
    /// How the machine stores tool offsets [default: c]
    #[arg(long, value_enum, value_name = "TYPE")]
    pub mill_memory: Option<OffsetMemoryType>,
}

/// The types of offset memory that `--mill-memory` selects.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum OffsetMemoryType {
    /// One value for each number, for H and D: N=V, G10 P R
    A,
    /// One value and its wear for each number, for H and D: N=V,W, G10 L10 and L11
    B,
    /// Length and radius with their wear: N=H,D,W,W, G10 L10 to L13
    C,
}

impl OffsetMemoryType {
    /// Converts the choice to the memory of the mill.
    pub(crate) const fn to_memory(self) -> MillOffsetMemory {
        match self {
            Self::A => MillOffsetMemory::A,
            Self::B => MillOffsetMemory::B,
            Self::C => MillOffsetMemory::C,
        }
    }
}

/// An option that contradicts the state of a connected machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub enum MachineStateOption {
    /// `--start` was given, which sets the position of the slides.
    Slides,
    /// `--spindle` was given, which sets the speed of the spindle.
    Spindle,
}

impl MachineStateOption {
    pub fn message(self) -> Message {
        match self {
            Self::Slides => say::option_slides_stand(),
            Self::Spindle => say::option_spindle_started(),
        }
    }
}

/// An option or command that does not apply to the selected model, a lathe or a mill.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub enum ModelMismatch {
    /// Programs of this mill cannot be executed.
    NotExecutable(ModelId),
    /// This option applies to lathes only.
    LatheOnly(&'static str),
    /// This option applies to mills only.
    MillOnly(&'static str),
}

impl ModelMismatch {
    pub fn message(self) -> Message {
        match self {
            Self::NotExecutable(model) => say::mill_not_run(model.name()),
            Self::LatheOnly(option) => say::mill_option_of_lathe(option),
            Self::MillOnly(option) => say::mill_option_of_mill(option),
        }
    }
}
