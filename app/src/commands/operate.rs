//! `operate`: plays a script of key presses and expectations.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_messages::{Language, Message, say};
use gsk_panel::emulator::Emulator;
use gsk_panel::panel::SerialFile;
use gsk_panel::script::{Script, ScriptAction};
use gsk_runner::board::PulseBoard;
use gsk_runner::partner::Partner;
use gsk_runner::picture::PictureError;
use gsk_runner::script::{Record, ScriptEnd, Session, Surroundings};
use gsk_runner::words::clock;

use super::{ALARM, CommandError, FINE, output};
use crate::apart::{Read, keep_apart};
use crate::cli::OperateArgs;
use crate::dnc::{self, Source};
use crate::ending::ENDED;
use crate::files::data_dir::DataDir;
use crate::files::program_file;
use crate::kernel::live::Live;
use crate::loading::LoadError;
use crate::picture::check_png;
use crate::{loading, retained, transfer};

/// Runs a script. Exit code 1 if an expectation is not met.
pub fn operate(args: &OperateArgs, language: Option<Language>) -> Result<u8, CommandError> {
    args.setup.refuse_mill().map_err(LoadError::from)?;
    let path = &args.script;
    if args.link.is_some() {
        args.setup.refuse_at_a_board()?;
    }
    let file = program_file::read(path)?;
    let script = Script::parse(&file.text).map_err(|errors| CommandError::Script {
        path: path.clone(),
        errors,
    })?;

    let mut setup = loading::fitted(Setup::at_the_panel(), args.setup.machine.as_ref());
    let data = match &args.setup.data_folder() {
        Some(folder) => Some(DataDir::open(folder)?),
        None => None,
    };
    let restored = retained::bring_back(data.as_ref(), &mut setup);
    loading::apply(&mut setup, &args.setup)?;
    if let Some(program) = &args.program {
        loading::open(&mut setup, core::slice::from_ref(program))?.print(language);
    }

    keep_script_apart(args, &script, &folder_of(path))?;
    let recorded = args.record.as_deref().map(output::reserve).transpose()?;
    let link = match &args.link {
        Some(port) => {
            super::window::connection(Some(port.clone()), &setup, args.setup.data.as_deref())?
        }
        None => None,
    };
    let mut emulator = Emulator::new(setup);
    let mut record = args.record.is_some().then(|| Record::new(&script));
    if let Some(restored) = &restored {
        restored.restore_panel(&mut emulator);
        emulator.panel.connect(true);
    }
    let live = match link {
        Some(link) => Some(Live::open(link, &mut emulator.simulation)?),
        None => None,
    };
    let code = play(script, path, &mut emulator, live, record.as_mut());
    // Each result is written independently: one failure does not affect the others.
    let mut failures = Vec::new();
    if let (Some(data), Some(restored)) = (data, restored) {
        emulator.store_edited();
        let sent = emulator.panel.take_sent();
        let folder = data.path().join(transfer::FOLDER);
        failures.extend(transfer::write(&folder, &sent).map_err(Into::into).err());
        let saved = retained::save_emulator(data, &restored, &emulator);
        failures.extend(saved.map_err(CommandError::from).err());
    }
    if let (Some(target), Some(record)) = (recorded, &record) {
        let written = target.write(record.text().as_bytes());
        failures.extend(written.map_err(Into::into).err());
    }
    if !failures.is_empty() {
        return Err(CommandError::Several(failures));
    }
    Ok(code)
}

/// Refuses a recording or pictures that would overwrite files that the script reads.
fn keep_script_apart(
    args: &OperateArgs,
    script: &Script,
    folder: &Path,
) -> Result<(), CommandError> {
    let mut loaded = Vec::new();
    let mut pictures = BTreeSet::new();
    for line in &script.lines {
        match &line.action {
            ScriptAction::Load(name)
            | ScriptAction::Receive(name)
            | ScriptAction::Dnc(Some(name)) => {
                loaded.push(found(folder, name));
            }
            ScriptAction::Shot { path, .. } => {
                pictures.insert(Path::new(path));
            }
            _ => {}
        }
    }
    let read = Read {
        files: core::iter::once(args.script.as_path())
            .chain(args.program.as_deref())
            .chain(loaded.iter().map(PathBuf::as_path))
            .chain(args.setup.read_files())
            .collect(),
        main: args.program.as_deref(),
        data: args.setup.data.as_deref(),
    };
    let written: Vec<&Path> = args.record.as_deref().into_iter().chain(pictures).collect();
    Ok(keep_apart(&read, &written)?)
}

/// The path of a file named in a script: in the folder of the script, else in the current
/// folder.
fn found(folder: &Path, name: &str) -> PathBuf {
    let beside = folder.join(name);
    if beside.exists() {
        beside
    } else {
        PathBuf::from(name)
    }
}

const fn simulation(emulator: &mut Emulator) -> &mut Simulation {
    &mut emulator.simulation
}

/// Runs the script, after a board has reported its state. Returns the exit code.
fn play(
    script: Script,
    path: &Path,
    emulator: &mut Emulator,
    mut live: Option<Live>,
    record: Option<&mut Record>,
) -> u8 {
    if let Some(live) = &mut live {
        let known = live.get_known(emulator, simulation, Emulator::tick);
        if let Err(said) = known {
            output::complain_of(&said.message());
            return if live.is_over() { ENDED } else { ALARM };
        }
    }
    let mut files = Files {
        folder: folder_of(path),
    };
    let lines = script.lines.len();
    let board = live.as_mut().map(|live| live as &mut dyn PulseBoard);
    let end = Session::new(emulator, &mut files)
        .at_board(board)
        .recorded(record)
        .run(script);
    let code = match end {
        ScriptEnd::Finished => {
            let took = clock(emulator.simulation.cnc.ticks() as f64 * 0.001);
            // On standard error: standard output has the screens of the script.
            let said = say::script_done(path.display(), lines, took);
            complain!("{}", output::worded(&said));
            FINE
        }
        ScriptEnd::Failed(failure) => {
            complain!("{}: {}", path.display(), output::worded(&failure.message()));
            ALARM
        }
        ScriptEnd::Asked => ENDED,
    };
    match live {
        Some(live) if live.is_over() => {
            output::complain_of(&say::run_ended_from_outside());
            ENDED
        }
        Some(live) => {
            live.close(emulator, simulation, Emulator::tick);
            code
        }
        None => code,
    }
}

fn folder_of(script: &Path) -> PathBuf {
    script.parent().map(Path::to_path_buf).unwrap_or_default()
}

/// Opens the files named in a script.
struct Files {
    folder: PathBuf,
}

impl Files {
    fn file(&self, name: &str) -> PathBuf {
        found(&self.folder, name)
    }
}

impl Surroundings for Files {
    type Error = CommandError;

    fn show(&mut self, screen: &str) {
        output::print(&format!("{screen}\n"));
    }

    fn shot(
        &mut self,
        name: &str,
        bytes: &dyn Fn() -> Result<Vec<u8>, PictureError>,
    ) -> Result<(), CommandError> {
        let path = Path::new(name);
        check_png(path)?;
        let bytes = bytes()?;
        std::fs::write(path, bytes).map_err(|error| output::WriteError::new(path, error).into())
    }

    fn program(&mut self, name: &str) -> Result<SerialFile, CommandError> {
        let path = self.file(name);
        let file = program_file::read(&path)?;
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        Ok(SerialFile {
            name: name.into_owned(),
            text: file.text,
        })
    }

    fn transfer(&mut self, name: &str) -> Result<SerialFile, CommandError> {
        Ok(transfer::read(&self.file(name))?)
    }

    fn told(&mut self, said: &Message) {
        output::complain_of(said);
    }

    fn partner(&mut self, name: &str) -> Result<Box<dyn Partner>, CommandError> {
        let source = Source::of(&self.file(name));
        Ok(Box::new(dnc::Partner::new(source)))
    }
}
