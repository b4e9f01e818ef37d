//! The options of control and lathe that `run`, `check`, `plot` and `operate` share, and
//! their parsers.

mod words;

use std::path::{Path, PathBuf};

use clap::Args;
use gsk_core::memory::DayTime;
use gsk_core::model::ModelId;
use gsk_messages::{Message, say};

use crate::files::models;

pub use words::{
    InputBit, OffsetWord, ParameterWord, WordError, any_model, duration_ms, feed, finite,
    input_bit, model, pair, switch, travel,
};
use words::{model_parameter, moment, offset, parameter, spindle_speed};

/// Options of control and lathe. A command lists them last: their help heading applies to
/// all later options, too.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Control and lathe")]
pub struct SetupArgs {
    /// Where the tool stands before the first block: X (diameter), Z in mm [default: 300,300;
    /// with --machine where its file says]
    #[arg(long, value_name = "X,Z", allow_hyphen_values = true, value_parser = pair)]
    pub start: Option<(f64, f64)>,
    /// The spindle already turns forward at this speed, r/min [default: it stands]
    #[arg(long, value_name = "RPM", value_parser = spindle_speed)]
    pub spindle: Option<f64>,
    /// A parameter: 22=3800, or one bit of it: 1.4=1 (may be repeated)
    #[arg(long = "param", value_name = "N=V|N.B=0|1", allow_hyphen_values = true, value_parser = parameter)]
    pub parameters: Vec<ParameterWord>,
    /// A tool offset: NN=X,Z,R,T; what is left out at the end is 0 (may be repeated)
    #[arg(long = "offset", value_name = "NN=X,Z,R,T", allow_hyphen_values = true, value_parser = offset)]
    pub offsets: Vec<OffsetWord>,
    /// Hold a machine input at a value, for instance X0.4=1 (may be repeated)
    #[arg(long = "input", value_name = "X0.4=1", value_parser = input_bit)]
    pub inputs: Vec<InputBit>,
    /// The lathe (travel, turret, dogs …) from a RON file
    #[arg(long, value_name = "FILE")]
    pub machine: Option<PathBuf>,
    /// The machine's ladder instead of the standard one (instruction list)
    #[arg(long, value_name = "FILE")]
    pub ladder: Option<PathBuf>,
    /// Macro B: formulas, IF, WHILE, GOTO and calls with arguments (G65 P) in programs
    /// [default: as the data directory says, else off]
    #[arg(long, value_name = "on|off", value_parser = switch)]
    pub macro_b: Option<bool>,
    /// The control model whose programs are read; each has a memory of its own in the data
    /// directory [default: as the data directory says, else gsk980td]
    #[arg(long, value_name = "MODEL", value_parser = any_model())]
    pub model: Option<ModelId>,
    /// A parameter that only this model has, for instance 17=6000 (may be repeated)
    #[arg(long = "model-param", value_name = "N=V", allow_hyphen_values = true, value_parser = model_parameter)]
    pub model_parameters: Vec<(u16, i32)>,
    /// Date and time of day with which the control's clock begins (#3011, #3012 of macro B),
    /// for instance 1993-03-28T15:34:56 [default: the computer's]
    #[arg(long, value_name = "DATETIME", value_parser = moment)]
    pub clock: Option<DayTime>,
    /// Take parameters, offsets and programs from this data directory, and write them back
    #[arg(long, value_name = "DIR")]
    pub data: Option<PathBuf>,
    /// Options of the mill.
    #[command(flatten)]
    pub mill: Box<MillArgs>,
}

impl SetupArgs {
    /// The selected control model: that of `--model`, else that of the data directory, else
    /// the GSK980TD.
    pub fn model(&self) -> ModelId {
        let chosen = || self.data.as_deref().map(models::chosen);
        self.model.or_else(chosen).unwrap_or_default()
    }

    /// The folder of the selected model in the data directory; `None` without `--data`.
    pub fn data_folder(&self) -> Option<PathBuf> {
        let data = self.data.as_deref()?;
        Some(models::folder(data, self.model()))
    }

    /// Refuses programs of a mill for commands that execute programs.
    ///
    /// # Errors
    /// The selected model is a mill, or an option of a mill is given.
    pub fn refuse_mill(&self) -> Result<(), OfMill> {
        self.mill_words()?;
        match self.model() {
            model if model.is_mill() => Err(OfMill::NotRun(model)),
            _ => Ok(()),
        }
    }

    /// Refuses options of a mill if the selected model is a lathe.
    ///
    /// # Errors
    /// Names the first such option.
    pub fn mill_words(&self) -> Result<(), OfMill> {
        let mill = &self.mill;
        let given = [
            (mill.mill_start.is_some(), "--mill-start"),
            (!mill.mill_zeros.is_empty(), "--mill-zero"),
            (!mill.mill_offsets.is_empty(), "--mill-offset"),
        ];
        match given.into_iter().find(|(given, _)| *given) {
            Some((_, option)) if !self.model().is_mill() => Err(OfMill::MillsAlone(option)),
            _ => Ok(()),
        }
    }

    /// Refuses options of a lathe; called if the selected model is a mill.
    ///
    /// # Errors
    /// Names the first such option.
    pub fn lathe_words(&self) -> Result<(), OfMill> {
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
            Some((_, option)) => Err(OfMill::LathesAlone(option)),
            None => Ok(()),
        }
    }

    pub fn read_files(&self) -> impl Iterator<Item = &Path> {
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
    pub const fn refuse_at_a_board(&self) -> Result<(), SetByTheMachine> {
        match (self.start, self.spindle) {
            (Some(_), _) => Err(SetByTheMachine::Slides),
            (_, Some(_)) => Err(SetByTheMachine::Spindle),
            (None, None) => Ok(()),
        }
    }
}

/// Options of a mill (`--model gsk980mdi`) for `check`, `plot` and `lsp`.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Mill (--model gsk980mdi; check, plot, lsp)")]
pub struct MillArgs {
    /// Where the slides stand before the first block, machine coordinates [default: 0,0,100]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub mill_start: Option<String>,
    /// A zero of the work, machine coordinates: 54=X,Y,Z to 59, 54.1P1 to 54.1P48, 0 for the
    /// external one (may be repeated)
    #[arg(
        long = "mill-zero",
        value_name = "54=X,Y,Z",
        allow_hyphen_values = true
    )]
    pub mill_zeros: Vec<String>,
    /// The length and the radius of a tool, with the wear of both behind: N=H,D or N=H,D,W,W
    /// (may be repeated)
    #[arg(long = "mill-offset", value_name = "N=H,D", allow_hyphen_values = true)]
    pub mill_offsets: Vec<String>,
}

/// An option that contradicts a connected machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub enum SetByTheMachine {
    /// `--start`: the position of the slides.
    Slides,
    /// `--spindle`: the speed of the spindle.
    Spindle,
}

impl SetByTheMachine {
    pub fn message(self) -> Message {
        match self {
            Self::Slides => say::option_slides_stand(),
            Self::Spindle => say::option_spindle_started(),
        }
    }
}

/// An option or command that does not suit the selected model, lathe or mill.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub enum OfMill {
    /// Programs of this mill cannot be executed.
    NotRun(ModelId),
    /// The option belongs to lathes.
    LathesAlone(&'static str),
    /// The option belongs to mills.
    MillsAlone(&'static str),
}

impl OfMill {
    pub fn message(self) -> Message {
        match self {
            Self::NotRun(model) => say::mill_not_run(model.name()),
            Self::LathesAlone(option) => say::mill_option_of_lathe(option),
            Self::MillsAlone(option) => say::mill_option_of_mill(option),
        }
    }
}
