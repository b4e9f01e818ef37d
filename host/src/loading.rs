//! Makes a [`Setup`] with its program from files and options, for `run`, `check`, `plot`,
//! `operate` and the window.

mod machine_file;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use gsk_core::alarm::Alarm;
use gsk_core::command::ProgramId;
use gsk_core::memory::ParameterError;
use gsk_core::model::ControlModel;
use gsk_core::plc::address::{AddressError, Area, BitAddress};
use gsk_core::plc::{CompileErrors, Ladder};
use gsk_core::program::{self, Program, ProgramMemory};
use gsk_core::setup::{Setup, dnc_teach_ladder};
use gsk_core::units::Point;
use gsk_messages::{Language, Message, say};
use gsk_milling::{MillSetup, MillWordError};
use gsk_runner::report;

use crate::files::data_dir::DataDir;
use crate::files::data_dir::DataDirError;
use crate::files::program_file::{self, ProgramFile, ProgramFileError};
use crate::files::subprograms::{self, FoundSubprogram, SubprogramCalls};
use crate::files::tool_library;
use crate::message_format::{describe_ladder_errors, join_lines};
use crate::platform;
use crate::retained;
use crate::setup_args::{ModelMismatch, OffsetOption, ParameterOption, SetupArgs};
pub use machine_file::{SHIPPED_LATHES, load_machine, missing_machine_parameters, parse_machine};

/// The reason why a setup cannot be loaded.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub enum LoadError {
    /// The data directory cannot be used.
    Data(#[from] DataDirError),
    /// A program or machine file cannot be read.
    File(#[from] ProgramFileError),
    /// `--input` has an address outside X; the payload is the address.
    NotAnInput(String),
    /// `--start` is outside the travel of a slide.
    StartBeyondTravel {
        /// Name of the axis.
        name: String,
        /// Name of the axis's section in a machine file.
        section: String,
        /// Minus end of the axis travel, mm.
        minus: f64,
        /// Plus end of the axis travel, mm.
        plus: f64,
    },
    /// The machine file lists an invalid parameter.
    MachineParameter {
        /// The text in the file.
        word: String,
        /// The rule that it breaks.
        reason: Message,
    },
    /// `--param` has an invalid number or value.
    Parameter(#[from] ParameterError),
    /// `--model-param` has an invalid number or value, for this reason.
    ModelParameter(Message),
    /// An option does not apply to the selected kind of machine, lathe or mill.
    OfMill(#[from] ModelMismatch),
    /// `--mill-start`, `--mill-zero` or `--mill-offset` is invalid, for this reason.
    MillWord(Message),
    /// `--offset` is refused by the control with this alarm.
    Offset(Box<Alarm>),
    /// An address of the PLC is invalid.
    Address {
        /// The text of the invalid address.
        text: String,
        /// The reason why the address is invalid.
        error: AddressError,
    },
    /// A ladder file has errors.
    Ladder {
        /// Path of the ladder file.
        path: PathBuf,
        /// The errors of the ladder.
        errors: CompileErrors,
    },
    /// A machine file is malformed.
    Machine {
        /// Path of the machine file.
        path: PathBuf,
        /// Line of the error in the file, from 1.
        line: usize,
        /// The error in this line.
        error: Box<ron::Error>,
    },
    /// A number in a machine file is not finite.
    MachineNumber {
        /// Path of the machine file.
        path: PathBuf,
        /// Line of the number in the file, from 1.
        line: usize,
        /// The number as written in the file.
        token: String,
    },
    /// A machine file breaks the rules for lathes.
    InvalidLathe {
        /// Path of the machine file.
        path: PathBuf,
        /// One message for each broken rule.
        rules: Vec<Message>,
    },
    /// The command line names no program to run.
    NoProgram,
    /// A subprogram file has no program number, so that no program could call it.
    NoNumber(PathBuf),
    /// The program memory refuses a program file.
    NotStored {
        /// Path of the program file.
        path: PathBuf,
        /// The alarm with which the memory refuses the program.
        alarm: Box<Alarm>,
    },
}

impl LoadError {
    /// Returns the message for the operator: what cannot be loaded, and why.
    pub fn message(&self) -> Message {
        match self {
            Self::Data(error) => error.message(),
            Self::File(error) => error.message(),
            Self::NotAnInput(input) => say::input_not_x(input),
            Self::StartBeyondTravel {
                name,
                section,
                minus,
                plus,
            } => say::start_beyond_ends(name, minus, plus, section),
            Self::MachineParameter { word, reason } => {
                say::subject_reason(format!("parameters: \"{word}\""), reason.clone())
            }
            Self::Parameter(error) => say::subject_reason("--param", error.message()),
            Self::OfMill(error) => error.message(),
            Self::MillWord(message) => message.clone(),
            Self::ModelParameter(message) => say::subject_reason("--model-param", message.clone()),
            Self::Offset(alarm) => say::subject_reason("--offset", alarm.reason()),
            Self::Address { text, error } => say::ladder_address_of_plc(text, error.message()),
            Self::Ladder { path, errors } => {
                say::ladder_not_started(path.display(), describe_ladder_errors(errors))
            }
            Self::Machine { path, line, error } => {
                say::machine_file_line(path.display(), line, say::as_written(error))
            }
            Self::MachineNumber { path, line, token } => {
                say::machine_file_line(path.display(), line, say::number_not_finite(token))
            }
            Self::InvalidLathe { path, rules } => {
                let rules = rules.iter().cloned().map(say::indented);
                say::machine_file_no_lathe(path.display(), join_lines(rules))
            }
            Self::NoProgram => say::program_none_given(),
            Self::NoNumber(path) => say::program_without_number(path.display()),
            Self::NotStored { path, alarm } => say::subject_reason(path.display(), alarm.reason()),
        }
    }
}

/// Messages for the operator about programs that were loaded into the memory.
#[derive(Clone, Debug, Default)]
pub struct Notices(pub Vec<Message>);

impl Notices {
    /// Prints the messages on standard error.
    pub fn print(&self, language: Option<Language>) {
        for notice in &self.0 {
            complain!("gsk980td: {}", report::message_text(notice, language));
        }
    }
}

/// Equips `bare` with the training lathe, which has a chuck, unless a machine file is named.
pub fn with_training_lathe(bare: Setup, machine: Option<&PathBuf>) -> Setup {
    match machine {
        Some(_) => bare,
        None => bare.with_chuck(),
    }
}

/// Makes the setup of a command that saves nothing: the data directory, if one is named,
/// and the options on top. With a work zero (X as a diameter, machine coordinates, mm) the
/// start position, of `--start` or of a dry run, counts from it.
pub fn command_setup(
    args: &SetupArgs,
    work_zero: Option<(f64, f64)>,
    language: Option<Language>,
) -> Result<Setup, LoadError> {
    args.refuse_mill()?;
    let mut setup = with_training_lathe(Setup::default(), args.machine.as_ref());
    if let Some(path) = &args.data {
        tool_library::set_data_folder(path);
    }
    if let Some(path) = &args.data_folder() {
        let data = DataDir::open_read_only(path)?;
        Notices(retained::load(&data, &mut setup).complaints).print(language);
    }
    let zero = work_zero.map(|(x, z)| Point::new(x / 2.0, z));
    apply_options_from(&mut setup, args, zero)?;
    Ok(setup)
}

/// Makes the setup of a mill for `check` and `plot`, and the setup of the control that reads its
/// programs. Returns an error for a wrong option or a file that cannot be read.
pub fn mill_setup(args: &SetupArgs) -> Result<(MillSetup, Setup), LoadError> {
    args.check_lathe_options()?;
    let mut setup = Setup::default();
    let mut model = ControlModel::new(args.selected_model());
    for (number, value) in &args.model_parameters {
        let set = model.set_parameter(*number, *value);
        set.map_err(LoadError::ModelParameter)?;
    }
    let mut mill = MillSetup::default().with(&model);
    mill.day_time = args.clock.unwrap_or_else(platform::day_time);
    let words = &args.mill;
    let wrong = |error: MillWordError| LoadError::MillWord(error.0);
    if let Some(start) = &words.mill_start {
        mill.take_start(start).map_err(wrong)?;
    }
    if let Some(memory) = words.mill_memory {
        mill.memory.offset_memory = memory.to_memory();
    }
    for zero in &words.mill_zeros {
        mill.memory.take_zero(zero).map_err(wrong)?;
    }
    for offset in &words.mill_offsets {
        mill.memory.take_offset(offset).map_err(wrong)?;
    }
    setup.memory.model = model;
    Ok((mill, setup))
}

/// Applies the options of control and lathe to `setup`. Returns an error for a wrong option or a
/// file that cannot be read.
pub fn apply_options(setup: &mut Setup, args: &SetupArgs) -> Result<(), LoadError> {
    args.refuse_mill()?;
    apply_options_from(setup, args, None)
}

/// Applies the options. `zero` is the work zero that the options set, in machine coordinates,
/// mm (X as a radius); the start position counts from it.
fn apply_options_from(
    setup: &mut Setup,
    args: &SetupArgs,
    zero: Option<Point>,
) -> Result<(), LoadError> {
    if let Some(path) = &args.ladder {
        setup.ladder = load_ladder(path)?.into();
    }
    if let Some(path) = &args.machine {
        setup.lathe = load_machine(path)?;
        if setup.start == Setup::default().start {
            // The start position of a dry run belongs to no machine.
            setup.start = Some(setup.lathe.start());
        }
    } else if let (Some(start), Some(zero)) = (&mut setup.start, zero) {
        *start = *start + zero;
    }
    if let Some((x, z)) = args.start {
        setup.start = Some(Point::new(x / 2.0, z) + zero.unwrap_or_default());
        setup.slides = None;
        check_start(setup)?;
    }
    if let (Some(start), Some(zero)) = (setup.start, zero) {
        setup.absolute = Some(start - zero);
    }
    if setup.memory.model.id() != args.selected_model() {
        setup
            .memory
            .set_model(ControlModel::new(args.selected_model()));
    }
    let model = &mut setup.memory.model;
    for (number, value) in &args.model_parameters {
        let set = model.set_parameter(*number, *value);
        set.map_err(LoadError::ModelParameter)?;
    }
    setup.day_time = args.clock.unwrap_or_else(platform::day_time);
    if let Some(on) = args.macro_b {
        setup.memory.settings.macro_b = on;
    }
    if let Some(rpm) = args.spindle {
        setup.spindle_rpm = Some(rpm);
    }
    if args.machine.is_some() {
        machine_file::apply_machine_parameters(setup)?;
    }
    for word in &args.parameters {
        apply_parameter(setup, *word)?;
    }
    for word in &args.offsets {
        apply_offset(setup, word)?;
    }
    for input in &args.inputs {
        let address = parse_address(&input.address)?;
        if address.area != Area::X {
            return Err(LoadError::NotAnInput(input.address.clone()));
        }
        setup.forced_inputs.push((address, input.state));
    }
    Ok(())
}

/// Checks that the start position is within the travel of the slides. Returns an error if not.
fn check_start(setup: &Setup) -> Result<(), LoadError> {
    let beyond = setup.axes_beyond_ends();
    let Some((axis, ends)) = beyond.first() else {
        return Ok(());
    };
    let name = format!("{axis:?}");
    Err(LoadError::StartBeyondTravel {
        section: name.to_lowercase(),
        name,
        minus: ends.minus,
        plus: ends.plus,
    })
}

fn apply_parameter(setup: &mut Setup, word: ParameterOption) -> Result<(), LoadError> {
    let result = match word {
        ParameterOption::Value { number, value } => {
            let record = setup.memory.model.record();
            setup.memory.parameters.set_for_model(record, number, value)
        }
        ParameterOption::Bit { number, bit, state } => {
            setup.memory.parameters.set_bit(number, bit, state)
        }
    };
    Ok(result?)
}

fn apply_offset(setup: &mut Setup, word: &OffsetOption) -> Result<(), LoadError> {
    let number = word.number;
    let entry = gsk_core::memory::ToolOffset {
        x: word.x,
        z: word.z,
        r: word.nose_radius_mm,
        t: word.nose_type,
    };
    setup
        .memory
        .offsets
        .set(number, entry)
        .map_err(|alarm| LoadError::Offset(Box::new(alarm)))
}

/// Parses a PLC address such as `X0.4`. Returns an error for another text.
pub fn parse_address(text: &str) -> Result<BitAddress, LoadError> {
    text.parse().map_err(|error| LoadError::Address {
        text: text.to_owned(),
        error,
    })
}

/// Compiles a ladder file. The message of an error names the first bad lines and the
/// option that returns to the standard ladder.
pub fn load_ladder(path: &Path) -> Result<Arc<Ladder>, LoadError> {
    let file = program_file::read(path)?;
    match Ladder::compile(&file.text) {
        Ok(ladder) => Ok(Arc::new(ladder)),
        Err(errors) => Err(LoadError::Ladder {
            path: path.to_owned(),
            errors,
        }),
    }
}

/// Opens a program file as the external program, stores the programs it calls and those of
/// further files, and selects it.
pub fn open_program(setup: &mut Setup, files: &[PathBuf]) -> Result<Notices, LoadError> {
    let (main, others) = files.split_first().ok_or(LoadError::NoProgram)?;
    let memory = &mut setup.memory;
    let (program, notices) = open_into(&mut memory.programs, &memory.model, main, others)?;
    setup.memory.programs.open_external(program);
    setup.memory.programs.select(ProgramId::External);
    Ok(notices)
}

/// Reads the program file `main` and returns its program; stores the other programs that it
/// needs in `programs`.
pub fn open_into(
    programs: &mut ProgramMemory,
    model: &ControlModel,
    main: &Path,
    others: &[PathBuf],
) -> Result<(Program, Notices), LoadError> {
    let ProgramFile { text, notices, .. } = program_file::read(main)?;
    let mut notices = Notices(notices);
    let find = |calls, loaded: &_| subprograms::find_called(main, calls, loaded, model);
    let into = (programs, model);
    let program = load_text(into, (main, text), others, &mut notices, find)?;
    Ok((program, notices))
}

/// Opens a program text as the external program, stores the programs it calls, and selects
/// it. `path` is its name; `find` returns the called programs that are not in the text,
/// and those that they call.
pub fn open_text(
    setup: &mut Setup,
    path: &Path,
    text: String,
    find: impl FnOnce(SubprogramCalls, &BTreeSet<u16>) -> Vec<FoundSubprogram>,
) -> Result<Notices, LoadError> {
    let mut notices = Notices::default();
    let memory = &mut setup.memory;
    let into = (&mut memory.programs, &memory.model);
    let program = load_text(into, (path, text), &[], &mut notices, find)?;
    let programs = &mut memory.programs;
    programs.open_external(program);
    programs.select(ProgramId::External);
    Ok(notices)
}

/// Returns the program of a text that is to run; stores the other programs that it needs in
/// the memory.
fn load_text(
    (programs, model): (&mut ProgramMemory, &ControlModel),
    (main, text): (&Path, String),
    others: &[PathBuf],
    notices: &mut Notices,
    find: impl FnOnce(SubprogramCalls, &BTreeSet<u16>) -> Vec<FoundSubprogram>,
) -> Result<Program, LoadError> {
    let calls = subprograms::find_calls(&text, model);
    let mut parts = program::split_programs(text);
    let begin = main_program_index(&parts, model);
    let program = parts.remove(begin);
    if begin > 0 {
        let number = program.number().unwrap_or_default();
        let notice = say::file_begins_before(main.display(), number);
        notices.0.push(notice);
    }
    for part in parts {
        store_subprogram(programs, part.text(), None, main)?;
    }
    notices.0.extend(store_files(programs, others)?.0);
    let mut loaded: BTreeSet<u16> = programs.iter().map(|(number, _)| number).collect();
    loaded.extend(program.number());
    for found in find(calls, &loaded) {
        let stored = store_subprogram(programs, &found.text, Some(found.number), &found.path);
        if found.called_by_number {
            stored?;
        }
    }
    Ok(program)
}

/// Stores all programs of the files in `programs`. Returns an error for a file that cannot be read
/// or a program that cannot be stored.
pub fn store_files(programs: &mut ProgramMemory, files: &[PathBuf]) -> Result<Notices, LoadError> {
    let mut notices = Vec::new();
    for path in files {
        let file = program_file::read(path)?;
        notices.extend(file.notices);
        for part in program::split_programs(file.text) {
            store_subprogram(programs, part.text(), None, path)?;
        }
    }
    Ok(Notices(notices))
}

/// Replaces the standard ladder by the one with keys for DNC; other ladders stay.
pub fn use_dnc_ladder(setup: &mut Setup) {
    if setup.ladder.is_standard() {
        setup.ladder = dnc_teach_ladder().into();
    }
}

/// Returns the index of the program in `parts` that is to run: the first one if no other
/// program calls it, else the first one that no program calls.
fn main_program_index(parts: &[Program], model: &ControlModel) -> usize {
    let [first, others @ ..] = parts else {
        return 0;
    };
    let called =
        |number: Option<u16>, by: &BTreeSet<u16>| number.is_some_and(|number| by.contains(&number));
    let calls = |part: &Program| subprograms::find_calls(part.text(), model).numbers;
    let by_others: BTreeSet<u16> = others.iter().flat_map(calls).collect();
    if !called(first.number(), &by_others) {
        return 0;
    }
    let mut all = by_others;
    all.extend(calls(first));
    let free = parts.iter().position(|part| !called(part.number(), &all));
    free.unwrap_or(0)
}

/// Stores a subprogram; a text without an O word gets `number`. Returns an error if the memory
/// refuses it.
fn store_subprogram(
    programs: &mut ProgramMemory,
    text: &str,
    number: Option<u16>,
    path: &Path,
) -> Result<(), LoadError> {
    let program = Program::new(text);
    let text = match (program.number(), number) {
        (None, Some(number)) => program.renumbered(number).text().to_owned(),
        (None, None) => {
            return Err(LoadError::NoNumber(path.to_owned()));
        }
        _ => text.to_owned(),
    };
    match programs.store(text) {
        Ok(_) => Ok(()),
        Err(alarm) => Err(LoadError::NotStored {
            path: path.to_owned(),
            alarm: Box::new(alarm),
        }),
    }
}

/// Makes the setup of a command that starts with a new control: the data directory is not read, the
/// options are applied. Returns an error for a wrong option or a file that cannot be read.
pub fn dry_run_setup(args: &SetupArgs) -> Result<Setup, LoadError> {
    let mut setup = with_training_lathe(Setup::default(), args.machine.as_ref());
    apply_options(&mut setup, args)?;
    Ok(setup)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn apply_to_panel_setup(words: &SetupArgs) -> Result<Setup, LoadError> {
        let mut setup = Setup::for_operator_script();
        apply_options(&mut setup, words).map(|()| setup)
    }

    #[test]
    fn no_number_of_a_machine_file_is_infinite() {
        for (text, line) in [
            ("(\n  x: (motor_turn: NaN),\n)", 2),
            ("(z: (start: -1e999))", 1),
        ] {
            let refused = parse_machine(Path::new("lathe.ron"), text)
                .expect_err(text)
                .to_string();
            assert!(refused.contains(&format!("line {line}")), "{refused}");
            assert!(refused.contains("is not a finite number"), "{refused}");
        }
    }

    #[test]
    fn the_tool_starts_where_the_slides_can_go() {
        let machine = Path::new(env!("CARGO_MANIFEST_DIR"));
        let machine = Some(machine.join("../assets/machines/small-flat-bed.ron"));
        let file = SetupArgs {
            machine,
            ..SetupArgs::default()
        };
        let start = |words: &SetupArgs| apply_to_panel_setup(words).map(|setup| setup.start);
        assert_eq!(
            start(&file).expect("machine"),
            Some(Point::new(-20.0, -80.0))
        );
        let at = |x, z| SetupArgs {
            start: Some((x, z)),
            ..file.clone()
        };
        assert_eq!(
            start(&at(-100.0, -20.0)).expect("start"),
            Some(Point::new(-50.0, -20.0))
        );
        let refused = start(&at(300.0, 300.0)).expect_err("beyond").to_string();
        assert!(refused.starts_with("--start: X is beyond"), "{refused}");
        assert!(refused.contains("-220 to 26 mm"), "{refused}");
        assert!(
            apply_to_panel_setup(&SetupArgs::default())
                .is_ok_and(|setup| setup.axes_beyond_ends().is_empty())
        );
    }
}
