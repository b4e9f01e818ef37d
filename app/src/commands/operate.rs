//! `operate`: plays a script of key presses and expectations.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_host::files::data_dir::DataDir;
use gsk_host::files::overwrite_guard::{CommandInputs, check_overwrites};
use gsk_host::files::program_file;
use gsk_host::job::{self, JobArgs};
use gsk_host::kernel::headless_board::HeadlessBoard;
use gsk_host::loading::LoadError;
use gsk_host::message_format::join_lines;
use gsk_host::ports::dnc::{self, DncSource};
use gsk_host::termination::TERMINATED_EXIT_CODE;
use gsk_host::transfer::udisk;
use gsk_host::{loading, retained, transfer};
use gsk_messages::{Language, Message, say};
use gsk_panel::emulator::Emulator;
use gsk_panel::panel::{SerialCable, SerialFile};
use gsk_panel::script::{Script, ScriptAction};
use gsk_panel::why::CauseChain;
use gsk_plot::{encode_lcd, encode_panel};
use gsk_runner::board::PulseBoard;
use gsk_runner::machining::live_part::LivePart;
use gsk_runner::partner::ProgramPartner;
use gsk_runner::script::{
    CutFollower, ScriptEnd, ScriptHost, ScriptPicture, ScriptRecord, ScriptSession, TickObserver,
};
use gsk_runner::text_format::format_time;

use super::network::CommandNetwork;
use super::operate_part::OperatedPart;
use super::{CommandError, EXIT_ALARM, EXIT_OK, output};
use crate::cli::OperateArgs;
use crate::picture::check_png;

/// Plays a script of key presses. Returns exit code 1 if an expectation is not met. Returns an
/// error if the script is wrong or a file cannot be read or written.
pub fn operate(args: &OperateArgs, language: Option<Language>) -> Result<u8, CommandError> {
    args.setup.refuse_mill().map_err(LoadError::from)?;
    let path = &args.script;
    if args.link.is_some() {
        args.setup.refuse_machine_state()?;
    }
    let file = program_file::read(path)?;
    let script = Script::parse(&file.text).map_err(|errors| {
        let lines = errors
            .iter()
            .map(|error| say::subject_reason(path.display(), error.message()));
        join_lines(lines)
    })?;

    let mut setup =
        loading::with_training_lathe(Setup::for_operator_script(), args.setup.machine.as_ref());
    let data = match &args.setup.data_folder() {
        Some(folder) => Some(DataDir::open(folder)?),
        None => None,
    };
    let restored = retained::load_and_report(data.as_ref(), &mut setup);
    loading::apply_options(&mut setup, &args.setup)?;
    if let Some(program) = &args.program {
        loading::open_program(&mut setup, core::slice::from_ref(program))?.print(language);
    }

    check_script_outputs(args, &script, &script_folder(path))?;
    let recorded = args
        .record
        .as_deref()
        .map(output::reserve_file)
        .transpose()?;
    let link = match &args.link {
        Some(port) => {
            super::window::board_connection(Some(port.clone()), &setup, args.setup.data.as_deref())?
        }
        None => None,
    };
    let is_published = args.mtconnect.mtconnect.is_some() || args.mqtt.mqtt.is_some();
    let job = match is_published {
        true => job::choose(&JobArgs::default(), args.program.as_deref(), &setup).ok(),
        false => None,
    };
    let mut part = OperatedPart::from_args(args, &setup)?;
    let mut emulator = Emulator::new(setup);
    let mut network = CommandNetwork::start(
        (&args.mtconnect, &args.mqtt),
        emulator.simulation(),
        job.map(|chosen| LivePart::new(chosen.create_machining())),
        link.is_some(),
    )?;
    let mut record = args.record.is_some().then(|| ScriptRecord::new(&script));
    if let Some(restored) = &restored {
        restored.restore_panel(&mut emulator);
        emulator.connect_cable(SerialCable::Simulated);
        if let Some(data) = &data {
            let folder = data.path().join(udisk::FOLDER);
            emulator.plug_udisk(udisk::read_folder(&folder));
        }
    }
    let live = match link {
        Some(link) => Some(HeadlessBoard::open(link, emulator.board_simulation())?),
        None => None,
    };
    let code = play_script(
        script,
        path,
        &mut emulator,
        live,
        ScriptFollowers {
            record: record.as_mut(),
            network: network.as_mut(),
            part: part.as_mut(),
        },
    );
    // Each result is written independently: one failure does not affect the others.
    let mut errors = Vec::new();
    if let (Some(data), Some(restored)) = (data, restored) {
        emulator.store_edited();
        let stored = emulator.take_udisk_files();
        let folder = data.path().join(udisk::FOLDER);
        let written = transfer::write_files(&folder, &udisk::to_serial_files(stored));
        errors.extend(written.map_err(Into::into).err());
        let sent = emulator.take_sent();
        let folder = data.path().join(transfer::FOLDER);
        errors.extend(
            transfer::write_files(&folder, &sent)
                .map_err(Into::into)
                .err(),
        );
        let saved = retained::save_emulator(data, &restored, &emulator);
        errors.extend(saved.map_err(CommandError::from).err());
    }
    if let (Some(target), Some(record)) = (recorded, &record) {
        let written = target.write(record.text().as_bytes());
        errors.extend(written.map_err(Into::into).err());
    }
    if !errors.is_empty() {
        return Err(CommandError::several(&errors));
    }
    Ok(code)
}

/// Refuses a recording or pictures that would overwrite a file that the script reads.
fn check_script_outputs(
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
            | ScriptAction::Udisk(Some(name))
            | ScriptAction::Dnc(Some(name)) => {
                loaded.push(resolve_path(folder, name));
            }
            ScriptAction::Shot { path, .. } => {
                pictures.insert(Path::new(path));
            }
            _ => {}
        }
    }
    let inputs = CommandInputs {
        files: core::iter::once(args.script.as_path())
            .chain(args.program.as_deref())
            .chain(loaded.iter().map(PathBuf::as_path))
            .chain(args.setup.input_files())
            .collect(),
        main_program: args.program.as_deref(),
        data_dir: args.setup.data.as_deref(),
    };
    let outputs: Vec<&Path> = args.record.as_deref().into_iter().chain(pictures).collect();
    Ok(check_overwrites(&inputs, &outputs)?)
}

/// Returns the path of a file named in a script: in the folder of the script if it exists
/// there, else in the current folder.
fn resolve_path(folder: &Path, name: &str) -> PathBuf {
    let beside = folder.join(name);
    if beside.exists() {
        beside
    } else {
        PathBuf::from(name)
    }
}

const fn simulation(emulator: &mut Emulator) -> &mut Simulation {
    emulator.board_simulation()
}

/// What follows a script, each `None` where no option requests it.
struct ScriptFollowers<'a> {
    record: Option<&'a mut ScriptRecord>,
    network: Option<&'a mut CommandNetwork>,
    part: Option<&'a mut OperatedPart>,
}

/// Plays the script once the board, if any, has reported its state. Returns the exit code.
fn play_script(
    script: Script,
    path: &Path,
    emulator: &mut Emulator,
    mut live: Option<HeadlessBoard>,
    followers: ScriptFollowers<'_>,
) -> u8 {
    if let Some(live) = &mut live {
        let known = live.wait_until_ready(emulator, simulation, Emulator::tick);
        if let Err(error) = known {
            output::report_error(&error.message());
            return if live.has_ended() {
                TERMINATED_EXIT_CODE
            } else {
                EXIT_ALARM
            };
        }
    }
    let mut files = ScriptFiles {
        folder: script_folder(path),
    };
    let lines = script.lines.len();
    let board = live.as_mut().map(|live| live as &mut dyn PulseBoard);
    let end = ScriptSession::new(emulator, &mut files)
        .with_board(board)
        .with_record(followers.record)
        .with_observer((followers.network).map(|it| it as &mut dyn TickObserver))
        .with_part(followers.part.map(|it| it as &mut dyn CutFollower))
        .run(script);
    let code = match end {
        ScriptEnd::Finished => {
            let took = format_time(emulator.cnc().ticks() as f64 * 0.001);
            // On standard error: standard output has the screens of the script.
            let message = say::script_done(path.display(), lines, took);
            complain!("{}", output::localize(&message));
            EXIT_OK
        }
        ScriptEnd::Failed(failure) => {
            complain!(
                "{}: {}",
                path.display(),
                output::localize(&failure.message())
            );
            EXIT_ALARM
        }
        ScriptEnd::Requested => TERMINATED_EXIT_CODE,
    };
    match live {
        Some(live) if live.has_ended() => {
            output::report_error(&say::run_ended_from_outside());
            TERMINATED_EXIT_CODE
        }
        Some(live) => {
            live.close(emulator, simulation, Emulator::tick);
            code
        }
        None => code,
    }
}

fn script_folder(script: &Path) -> PathBuf {
    script.parent().map(Path::to_path_buf).unwrap_or_default()
}

/// Resolves and opens the files named in a script, relative to the folder of the script.
struct ScriptFiles {
    folder: PathBuf,
}

impl ScriptFiles {
    fn resolve(&self, name: &str) -> PathBuf {
        resolve_path(&self.folder, name)
    }
}

impl ScriptHost for ScriptFiles {
    type Error = CommandError;

    fn show_chain(&mut self, chain: &CauseChain) {
        output::print(&chain.text(output::language()));
    }

    fn show_screen(&mut self, screen: &str) {
        output::print(&format!("{screen}\n"));
    }

    fn store_picture(
        &mut self,
        name: &str,
        picture: ScriptPicture,
        emulator: &Emulator,
    ) -> Result<(), CommandError> {
        let path = Path::new(name);
        check_png(path)?;
        let bytes = match picture {
            ScriptPicture::Panel => encode_panel(emulator)?,
            ScriptPicture::Lcd => {
                encode_lcd(&emulator.screen(), emulator.panel().view().brightness)?
            }
        };
        std::fs::write(path, bytes).map_err(|error| output::WriteError::new(path, error).into())
    }

    fn read_program(&mut self, name: &str) -> Result<SerialFile, CommandError> {
        let path = self.resolve(name);
        let file = program_file::read(&path)?;
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        Ok(SerialFile {
            name: name.into_owned(),
            text: file.text,
        })
    }

    fn read_transfer_file(&mut self, name: &str) -> Result<SerialFile, CommandError> {
        Ok(transfer::read_serial_file(&self.resolve(name))?)
    }

    fn show_refusal(&mut self, message: &Message) {
        output::report_error(message);
    }

    fn open_partner(&mut self, name: &str) -> Result<Box<dyn ProgramPartner>, CommandError> {
        let source = DncSource::from_name(&self.resolve(name));
        Ok(Box::new(dnc::DncPartner::new(source)))
    }
}
