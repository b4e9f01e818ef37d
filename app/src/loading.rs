//! From files and options to a [`Setup`] with its program: what `run`, `check`,
//! `plot`, `operate` and the window start from.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use gsk_core::command::ProgramId;
use gsk_core::machine::LatheConfig;
use gsk_core::plc::Ladder;
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::program::{self, Program, ProgramMemory};
use gsk_core::setup::Setup;
use gsk_core::units::Point;

use crate::files::data_dir::DataDir;
use crate::files::{program_file, subprograms};
use crate::retained;
use crate::setup_args::{OffsetWord, ParameterWord, SetupArgs};

/// A program in the control's memory, and what the user should know about it.
#[derive(Clone, Debug, Default)]
pub struct Notices(pub Vec<String>);

impl Notices {
    /// Prints them on standard error.
    pub fn print(&self) {
        for notice in &self.0 {
            eprintln!("gsk980td: {notice}");
        }
    }
}

/// What a command starts from that writes nothing back: the data directory, if one
/// is named, under the options.
pub fn setup(args: &SetupArgs) -> Result<Setup, String> {
    let mut setup = Setup::default();
    if let Some(path) = &args.data {
        let data = DataDir::existing(path).map_err(|error| error.to_string())?;
        for complaint in retained::load(&data, &mut setup).complaints {
            eprintln!("gsk980td: {complaint}");
        }
    }
    apply(&mut setup, args)?;
    Ok(setup)
}

/// Applies the options of control and lathe.
pub fn apply(setup: &mut Setup, args: &SetupArgs) -> Result<(), String> {
    if let Some(path) = &args.ladder {
        setup.ladder = ladder(path)?;
    }
    if let Some(path) = &args.machine {
        setup.lathe = machine(path)?;
    }
    if let Some((x, z)) = args.start {
        setup.start = Some(Point::new(x / 2.0, z));
    }
    if let Some(rpm) = args.spindle {
        setup.spindle_rpm = Some(rpm);
    }
    for word in &args.parameters {
        parameter(setup, *word)?;
    }
    for word in &args.offsets {
        offset(setup, word)?;
    }
    for input in &args.inputs {
        let address = address(&input.address)?;
        if address.area != Area::X {
            return Err(format!(
                "--input {}: only inputs X0.0 to X29.7 can be held",
                input.address
            ));
        }
        setup.forced_inputs.push((address, input.state));
    }
    Ok(())
}

fn parameter(setup: &mut Setup, word: ParameterWord) -> Result<(), String> {
    let result = match word {
        ParameterWord::Value { number, value } => setup.parameters.set(number, value),
        ParameterWord::Bit { number, bit, state } => setup.parameters.set_bit(number, bit, state),
    };
    result.map_err(|error| format!("--param: {error}"))
}

fn offset(setup: &mut Setup, word: &OffsetWord) -> Result<(), String> {
    let number = word.number;
    let entry = gsk_core::memory::ToolOffset {
        x: word.x,
        z: word.z,
        r: word.radius,
        t: word.nose,
    };
    setup.offsets.set(number, entry).map_err(|alarm| {
        format!(
            "--offset: {}",
            alarm.detail.as_deref().unwrap_or(alarm.text())
        )
    })
}

/// Reads an address like `X0.4`.
pub fn address(text: &str) -> Result<BitAddress, String> {
    text.parse()
        .map_err(|error| format!("`{text}` is no address of the PLC: {error}"))
}

/// Compiles a ladder file; its first errors are named by line, and the way back
/// to the standard ladder is told.
pub fn ladder(path: &Path) -> Result<Arc<Ladder>, String> {
    let file = program_file::read(path).map_err(|error| error.to_string())?;
    match Ladder::compile(&file.text) {
        Ok(ladder) => Ok(Arc::new(ladder)),
        Err(errors) => Err(format!(
            "the ladder {} has an error and is not started:\n{errors}\n\
             Correct it, or leave --ladder out to start with the standard ladder.",
            path.display()
        )),
    }
}

/// Reads a machine file (`docs/machine-file.md`) and checks its rules.
pub fn machine(path: &Path) -> Result<LatheConfig, String> {
    let file = program_file::read(path).map_err(|error| error.to_string())?;
    let options =
        ron::Options::default().with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME);
    let config: LatheConfig = options.from_str(&file.text).map_err(|error| {
        format!(
            "the machine file {}, line {}: {}",
            path.display(),
            error.span.start.line,
            error.code
        )
    })?;
    config.check().map_err(|errors| {
        let rules: Vec<String> = errors.iter().map(|error| format!("  {error}")).collect();
        format!(
            "the machine file {} describes no lathe:\n{}",
            path.display(),
            rules.join("\n")
        )
    })?;
    Ok(config)
}

/// Opens a program file as the external program, stores the programs it calls
/// and those of further files, and selects it.
pub fn open(setup: &mut Setup, files: &[PathBuf]) -> Result<Notices, String> {
    let (main, others) = files.split_first().ok_or("no program was given")?;
    let (program, notices) = open_into(&mut setup.programs, main, others)?;
    setup.programs.open_external(program);
    setup.programs.select(ProgramId::External);
    Ok(notices)
}

/// Reads a program file; what it needs besides is stored in the memory.
pub fn open_into(
    programs: &mut ProgramMemory,
    main: &Path,
    others: &[PathBuf],
) -> Result<(Program, Notices), String> {
    let file = program_file::read(main).map_err(|error| error.to_string())?;
    let mut notices = file.notices.clone();
    let mut parts = program::split(&file.text).into_iter();
    let program = parts
        .next()
        .unwrap_or_else(|| Program::new(file.text.as_str()));
    for part in parts {
        store(programs, part.text(), None, main)?;
    }
    for path in others {
        let other = program_file::read(path).map_err(|error| error.to_string())?;
        notices.extend(other.notices);
        for part in program::split(&other.text) {
            store(programs, part.text(), None, path)?;
        }
    }
    let mut loaded: BTreeSet<u16> = programs.iter().map(|(number, _)| number).collect();
    loaded.extend(program.number());
    for found in subprograms::find(main, &file.text, &loaded) {
        store(programs, &found.text, Some(found.number), &found.path)?;
    }
    Ok((program, Notices(notices)))
}

/// Stores a subprogram; a file without an O word gets the number of its name.
fn store(
    programs: &mut ProgramMemory,
    text: &str,
    number: Option<u16>,
    path: &Path,
) -> Result<(), String> {
    let program = Program::new(text);
    let text = match (program.number(), number) {
        (None, Some(number)) => program.renumbered(number).text().to_owned(),
        (None, None) => {
            return Err(format!(
                "{}: a subprogram begins with its number, for instance O1002",
                path.display()
            ));
        }
        _ => text.to_owned(),
    };
    match programs.store(text) {
        Ok(_) => Ok(()),
        Err(alarm) => Err(format!("{}: {}", path.display(), alarm.line_text())),
    }
}

/// What `run` and its kin start from.
pub fn dry_run_setup(args: &SetupArgs) -> Result<Setup, String> {
    let mut setup = Setup::default();
    apply(&mut setup, args)?;
    Ok(setup)
}
