//! `operate`: a script of key presses and expectations.

use std::path::{Path, PathBuf};

use gsk_core::setup::Setup;
use gsk_panel::emulator::Emulator;
use gsk_panel::pages::POWER_ON_TICKS;
use gsk_panel::raster;
use gsk_panel::script::{Action, Effect, Line, Progress, Runner, Script};

use super::{ALARM, FINE, output};
use crate::cli::OperateArgs;
use crate::files::data_dir::DataDir;
use crate::files::program_file;
use crate::{loading, picture, retained, transfer};

/// Ticks between two looks at a script.
const SLICE: u64 = 100_000;
/// Pixels of an LCD dot in a picture of the LCD.
const LCD_SCALE: u32 = 2;
/// Pixels of a panel unit in a picture of the whole panel.
const PANEL_SCALE: f32 = 1.5;

/// Runs a script. Exit code 1 if an expectation is not met.
pub fn operate(args: &OperateArgs) -> Result<u8, String> {
    let path = &args.script;
    let file = program_file::read(path).map_err(|error| error.to_string())?;
    let script = Script::parse(&file.text).map_err(|errors| {
        let lines: Vec<String> = errors
            .iter()
            .map(|error| format!("{}: {error}", path.display()))
            .collect();
        lines.join("\n")
    })?;

    let mut setup = Setup::default();
    let data = match &args.setup.data {
        Some(folder) => Some(DataDir::open(folder).map_err(|error| error.to_string())?),
        None => None,
    };
    let restored = data.as_ref().map(|data| retained::load(data, &mut setup));
    for complaint in restored.iter().flat_map(|restored| &restored.complaints) {
        eprintln!("gsk980td: {complaint}");
    }
    if let Some(restored) = &restored {
        restored.place(&mut setup);
    }
    loading::apply(&mut setup, &args.setup)?;
    if let Some(program) = &args.program {
        loading::open(&mut setup, core::slice::from_ref(program))?.print();
    }

    let mut session = Session {
        emulator: Emulator::new(setup),
        folder: path.parent().map(Path::to_path_buf).unwrap_or_default(),
        record: args.record.is_some().then(|| Record::new(&script)),
    };
    if let Some(restored) = &restored {
        restored.restore_panel(&mut session.emulator);
        session.emulator.panel.connect(true);
    }
    let code = session.run(script, path);
    if let (Some(target), Some(record)) = (&args.record, &session.record) {
        std::fs::write(target, &record.text)
            .map_err(|error| format!("{} cannot be written: {error}", target.display()))?;
    }
    if let (Some(data), Some(restored)) = (data, restored) {
        session.emulator.store_edited();
        let sent = session.emulator.panel.take_sent();
        transfer::write(&data.path().join(transfer::FOLDER), &sent)?;
        retained::save_emulator(data, &restored, &session.emulator)?;
    }
    Ok(code)
}

struct Session {
    emulator: Emulator,
    /// Files named in the script stand beside it, or in the current folder.
    folder: PathBuf,
    record: Option<Record>,
}

impl Session {
    /// Runs the script; the exit code.
    fn run(&mut self, script: Script, path: &Path) -> u8 {
        let mut runner = Runner::new(script);
        let slice = if self.record.is_some() { 1 } else { SLICE };
        loop {
            let tick = self.emulator.ticks();
            let progress = runner.advance(&mut self.emulator, slice);
            if let (Some(record), Some(line)) = (&mut self.record, runner.line()) {
                record.reached(line.number, tick);
            }
            let failure = match progress {
                Progress::Running => continue,
                Progress::Effect(effect) => match self.carry_out(effect) {
                    Ok(()) => continue,
                    Err(seen) => runner.failure(seen),
                },
                Progress::Failed(failure) => failure,
                Progress::Finished => return FINE,
            };
            eprintln!("{}: {failure}", path.display());
            return ALARM;
        }
    }

    fn carry_out(&mut self, effect: Effect) -> Result<(), String> {
        match effect {
            Effect::Show(text) => output::print(&format!("{text}\n")),
            Effect::Shot { path, panel } => self.shot(Path::new(&path), panel),
            Effect::Load(name) => self.load(&name),
            Effect::Receive(name) => self.receive(&name),
        }
    }

    fn shot(&self, path: &Path, panel: bool) -> Result<(), String> {
        let pixels = if panel {
            self.emulator.panel_picture(PANEL_SCALE)
        } else {
            let brightness = self.emulator.panel.view().brightness;
            raster::render(&self.emulator.screen(), LCD_SCALE, brightness)
        };
        let pixels = pixels.ok_or("no memory for the picture")?;
        std::fs::write(path, picture::encode_png(&pixels)?)
            .map_err(|error| format!("{} cannot be written: {error}", path.display()))
    }

    /// A file named in the script stands beside it, or in the current folder.
    fn file(&self, name: &str) -> PathBuf {
        let beside = self.folder.join(name);
        if beside.exists() {
            beside
        } else {
            PathBuf::from(name)
        }
    }

    fn receive(&mut self, name: &str) -> Result<(), String> {
        let file = transfer::read(&self.file(name))?;
        if let Err(said) = self.emulator.receive(file) {
            eprintln!("gsk980td: {said}");
        }
        Ok(())
    }

    fn load(&mut self, name: &str) -> Result<(), String> {
        let path = self.file(name);
        let file = program_file::read(&path).map_err(|error| error.to_string())?;
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        self.emulator
            .load_program(&name, &file.text)
            .map_err(|alarm| alarm.to_string())
    }
}

/// What a script did, line by line with the tick at which each began.
struct Record {
    lines: Vec<Line>,
    written: usize,
    text: String,
}

impl Record {
    fn new(script: &Script) -> Self {
        Self {
            lines: script.lines.clone(),
            written: 0,
            text: String::new(),
        }
    }

    /// The script has come to a line; it and those before it began at this tick.
    fn reached(&mut self, number: u32, tick: u64) {
        let tick = tick.saturating_sub(POWER_ON_TICKS);
        while let Some(line) = self.lines.get(self.written)
            && line.number <= number
        {
            self.written += 1;
            let acts = !matches!(
                line.action,
                Action::Wait(_)
                    | Action::WaitFor(..)
                    | Action::Expect(_)
                    | Action::Show
                    | Action::Shot { .. }
            );
            if acts {
                let text = match line.at {
                    Some(_) => line
                        .text
                        .split_once(char::is_whitespace)
                        .map_or("", |(_, rest)| rest),
                    None => &line.text,
                };
                self.text.push_str(&format!("@{tick} {}\n", text.trim()));
            }
        }
    }
}
