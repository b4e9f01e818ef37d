//! The set-up words of a case, in the form of the command line.

use std::path::Path;
use std::sync::Arc;

use gsk_core::command::ProgramId;
use gsk_core::machine::LatheConfig;
use gsk_core::memory::{DayTime, ToolOffset};
use gsk_core::model::{ControlModel, ModelId};
use gsk_core::plc::Ladder;
use gsk_core::program::{Program, ProgramMemory};
use gsk_core::setup::Setup;
use gsk_core::units::{Axis, Diameter, Point};
use gsk_milling::{MillSetup, MillWordError};
use serde::Deserialize;

/// Start of the program that fills the memory up to a number of characters.
const FILLER_HEAD: &str = "O9999;\n(";

/// The set-up of a test case: its differences from the set-up of a dry run.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SetupWords {
    /// Whether to start from the machine as delivered: factory parameters, axes not
    /// referenced.
    pub delivered: bool,
    /// Tool position at the start, mm: X as a diameter, Z; `None` leaves the default.
    pub start: Option<(f64, f64)>,
    /// Position of the work zero in machine coordinates, mm: X as a diameter, Z. `start` then
    /// counts from the work zero. `None` keeps the default zero.
    pub work_zero: Option<(f64, f64)>,
    /// Speed of a spindle that is already on at the start, r/min; `None` for a stopped
    /// spindle.
    pub spindle: Option<f64>,
    /// Whether to wire the lathe for the parameters before those of `params` are set.
    pub as_built: bool,
    /// Parameters that differ, by number: `"22=3800"`, `"001.4=0"`.
    pub params: Vec<String>,
    /// Tool offsets by number, with X, Z, nose radius and tip: `"01=2,1.5,0,0"`.
    pub offsets: Vec<String>,
    /// Number of characters of a program O9999 that fills the memory.
    pub filled: usize,
    /// Points of the pitch error table, by axis and point: `"Z 1=7"` (µm).
    pub pitch: Vec<String>,
    /// Machine inputs that are held at a value: `"X0.4=1"`.
    pub inputs: Vec<String>,
    /// Whether the axes are referenced at the start; `None` leaves the default.
    pub referenced: Option<bool>,
    /// Whether the setting for programs in inches is on.
    pub inch: bool,
    /// Whether the control has the option of macro B.
    pub macro_b: bool,
    /// The control model by its word on the command line: `"ncb08"`. `None` leaves the default
    /// model.
    pub model: Option<String>,
    /// Parameters that only this model has, by number: `"17=6000"`.
    pub model_params: Vec<String>,
    /// Start position, work zeros and tools of a mill.
    pub mill: MillWords,
    /// Date and time of day of the control's clock at the start: `"1993-03-28 15:34:56"`.
    /// `None` leaves the default.
    pub clock: Option<String>,
    /// Number of parts that the part counter shows at the start.
    pub parts: u32,
    /// Cutting time that the counter shows at the start: `"05:28:08"`. `None` leaves the
    /// default.
    pub cutting: Option<String>,
    /// The ladder, by its file in `assets/ladder/`: `"bar-feeder.il"`. `None` leaves the
    /// default.
    pub ladder: Option<String>,
    /// The machine file, by its name in `assets/machines/`: `"small-flat-bed.ron"`. `None`
    /// leaves the default lathe.
    pub machine: Option<String>,
}

/// The set-up words that only a mill has, in the form of the command line.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MillWords {
    /// Start position of the axes, machine coordinates, mm: `"0,0,100"`. `None` leaves the
    /// default.
    pub start: Option<String>,
    /// Work zeros by code, machine coordinates, mm: `"54=100,50,0"`.
    pub zeros: Vec<String>,
    /// Tool offsets by number, with length and radius, mm: `"1=50,5"`.
    pub offsets: Vec<String>,
}

impl SetupWords {
    /// Returns the set-up of a case with a mill; `None` if the model is a lathe.
    ///
    /// # Errors
    /// Returns a message if a word is invalid.
    pub fn mill_setup(&self, setup: &Setup) -> Result<Option<MillSetup>, String> {
        let model = &setup.memory.model;
        if !model.id().is_mill() {
            return Ok(None);
        }
        let mut mill = MillSetup::default().with(model);
        mill.day_time = setup.day_time;
        let word_error = |error: MillWordError| error.0.to_string();
        if let Some(start) = &self.mill.start {
            mill.take_start(start).map_err(word_error)?;
        }
        for zero in &self.mill.zeros {
            mill.memory.take_zero(zero).map_err(word_error)?;
        }
        for offset in &self.mill.offsets {
            mill.memory.take_offset(offset).map_err(word_error)?;
        }
        Ok(Some(mill))
    }

    /// Returns the set-up of a case with a part program.
    ///
    /// # Errors
    /// Returns a message if a word is invalid or refused by the control.
    pub fn program_setup(&self) -> Result<Setup, String> {
        self.apply_to(Setup::default())
    }

    /// Returns the set-up of a case with an operator script.
    ///
    /// # Errors
    /// Returns a message if a word is invalid or refused by the control.
    pub fn script_setup(&self) -> Result<Setup, String> {
        self.apply_to(Setup::for_operator_script())
    }

    fn apply_to(&self, setup: Setup) -> Result<Setup, String> {
        let mut setup = if self.delivered {
            Setup::delivered()
        } else {
            setup
        };
        if let Some((x, z)) = self.start {
            setup.start = Some(Point::from_diameter(Diameter(x), z));
        }
        if let Some(name) = &self.ladder {
            setup.ladder = read_ladder(name)?.into();
        }
        if let Some(name) = &self.machine {
            setup.lathe = read_machine(name)?;
            if setup.start == Setup::default().start {
                setup.start = Some(setup.lathe.start());
            }
        }
        if let (Some(start), Some((x, z))) = (&mut setup.start, self.work_zero) {
            setup.absolute = Some(*start);
            *start = *start + Point::from_diameter(Diameter(x), z);
        }
        setup.spindle_rpm = self.spindle;
        setup.referenced = self.referenced.unwrap_or(setup.referenced);
        setup.memory.settings.inch = self.inch;
        setup.memory.settings.macro_b = self.macro_b;
        if let Some(word) = &self.model {
            let id = ModelId::from_command_word(word).ok_or_else(|| format!("no model {word}"))?;
            setup.memory.set_model(ControlModel::new(id));
        }
        for word in &self.model_params {
            let (number, value) = split_assignment(word)?;
            let number = number.parse().map_err(|_| format!("{word}: number"))?;
            let value = value.parse().map_err(|_| format!("{word}: value"))?;
            let set = setup.memory.model.set_parameter(number, value);
            set.map_err(|error| error.to_string())?;
        }
        if self.as_built {
            setup.wired = Some(setup.memory.parameters.clone());
        }
        if let Some(text) = &self.clock {
            let moment = DayTime::from_text(text);
            setup.day_time = moment.ok_or_else(|| format!("clock {text}: no such moment"))?;
        }
        setup.memory.counters.parts = self.parts;
        if let Some(clock) = &self.cutting {
            setup.memory.counters.cutting_ms = parse_clock_ms(clock)?;
        }
        for word in &self.params {
            set_parameter(&mut setup, word)
                .map_err(|error| format!("parameter {word}: {error}"))?;
        }
        for word in &self.offsets {
            set_offset(&mut setup, word).map_err(|error| format!("offset {word}: {error}"))?;
        }
        if self.filled > 0 {
            let comment = "X".repeat(self.filled.saturating_sub(FILLER_HEAD.len() + 1));
            let text = format!("{FILLER_HEAD}{comment})");
            let stored = setup.memory.programs.store(text);
            stored.map_err(|alarm| alarm.line_text())?;
        }
        for word in &self.pitch {
            set_pitch_point(&mut setup, word).map_err(|error| format!("pitch {word}: {error}"))?;
        }
        for word in &self.inputs {
            let (address, state) = split_assignment(word)?;
            let address = address
                .parse()
                .map_err(|error| format!("input {word}: {error}"))?;
            setup.forced_inputs.push((address, state == "1"));
        }
        Ok(setup)
    }
}

/// Reads a file in a folder of `assets/`.
fn read_asset(folder: &str, name: &str) -> Result<String, String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets");
    crate::read_case_file(&root.join(folder), name)
}

fn read_ladder(name: &str) -> Result<Arc<Ladder>, String> {
    let text = read_asset("ladder", name)?;
    let ladder = Ladder::compile(&text).map_err(|errors| format!("{name}: {errors}"))?;
    Ok(Arc::new(ladder))
}

fn read_machine(name: &str) -> Result<LatheConfig, String> {
    let options =
        ron::Options::default().with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME);
    let config: LatheConfig = options
        .from_str(&read_asset("machines", name)?)
        .map_err(|error| format!("{name}: {error}"))?;
    match config.check() {
        Ok(()) => Ok(config),
        Err(errors) => Err(format!("{name}: {}", errors[0])),
    }
}

fn split_assignment(word: &str) -> Result<(&str, &str), String> {
    word.split_once('=')
        .ok_or_else(|| format!("{word}: write it as NAME=VALUE"))
}

/// Parses a time `hh:mm:ss` and returns it in milliseconds.
fn parse_clock_ms(clock: &str) -> Result<u64, String> {
    let parts: Vec<u64> = clock
        .split(':')
        .map(parse_number)
        .collect::<Result<_, _>>()?;
    match parts[..] {
        [hours, minutes, seconds] => Ok(((hours * 60 + minutes) * 60 + seconds) * 1000),
        _ => Err(format!("{clock}: write it as HH:MM:SS")),
    }
}

fn parse_number<T: core::str::FromStr>(text: &str) -> Result<T, String> {
    text.trim()
        .parse()
        .map_err(|_| format!("{text} is not a number of this kind"))
}

fn set_parameter(setup: &mut Setup, word: &str) -> Result<(), String> {
    let (name, value) = split_assignment(word)?;
    let refusal = |error| format!("{error:?}");
    match name.split_once('.') {
        Some((name, bit)) => setup
            .memory
            .parameters
            .set_bit(parse_number(name)?, parse_number(bit)?, value == "1")
            .map_err(refusal),
        None => setup
            .memory
            .parameters
            .set(parse_number(name)?, parse_number(value)?)
            .map_err(refusal),
    }
}

fn set_pitch_point(setup: &mut Setup, word: &str) -> Result<(), String> {
    let (place, value) = split_assignment(word)?;
    let (axis, point) = match place.split_once(' ') {
        Some(("X", point)) => (Axis::X, point),
        Some(("Z", point)) => (Axis::Z, point),
        _ => return Err("write the axis, a blank and the point".to_owned()),
    };
    let (point, value) = (parse_number(point)?, parse_number(value)?);
    let written = setup.memory.pitch.set(axis, point, value);
    written.map_err(|error| format!("{error:?}"))
}

fn set_offset(setup: &mut Setup, word: &str) -> Result<(), String> {
    let (name, values) = split_assignment(word)?;
    let values: Vec<f64> = values
        .split(',')
        .map(parse_number)
        .collect::<Result<_, _>>()?;
    let value = |index: usize| values.get(index).copied().unwrap_or_default();
    let row = ToolOffset {
        x: value(0),
        z: value(1),
        r: value(2),
        t: value(3) as u8,
    };
    let refusal = |alarm: gsk_core::alarm::Alarm| alarm.line_text();
    setup
        .memory
        .offsets
        .set(parse_number(name)?, row)
        .map_err(refusal)
}

/// Returns a program memory with these texts; the first one is selected. A text without an O
/// word is opened as an external program.
///
/// # Errors
/// Returns the alarm with which the memory refuses a text, as a line.
pub fn build_memory(texts: &[String]) -> Result<ProgramMemory, String> {
    let mut memory = ProgramMemory::default();
    let mut first = None;
    for text in texts {
        let program = Program::new(text.as_str());
        let id = match program.number() {
            Some(_) => memory
                .store(text.as_str())
                .map(ProgramId::Stored)
                .map_err(|alarm| alarm.line_text())?,
            None => {
                memory.open_external(program);
                ProgramId::External
            }
        };
        first.get_or_insert(id);
    }
    if let Some(first) = first {
        memory.select(first);
    }
    Ok(memory)
}
