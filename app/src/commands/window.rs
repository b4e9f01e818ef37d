//! The window: what stands behind `gsk980td` without a command.

use std::path::{Path, PathBuf};
use std::time::Instant;

use gsk_core::setup::Setup;
use gsk_panel::emulator::Emulator;

use super::{FINE, USAGE};
use crate::cli::WindowArgs;
use crate::files::data_dir::{self, DataDir};
use crate::kernel::{Connection, Kernel};
use crate::setup_args::SetupArgs;
use crate::window::Settings;
use crate::window::app::{self, Start};
use crate::{loading, retained};

/// Opens the window and returns when it is closed.
pub fn open(args: WindowArgs) -> Result<u8, String> {
    let begun = Instant::now();
    if let Some(program) = &args.program
        && !program.exists()
    {
        return Err(format!("{}: there is no such file", program.display()));
    }
    if !app::has_display() {
        eprintln!("gsk980td: {}", without_display(args.program.as_deref()));
        return Ok(USAGE);
    }
    let path: PathBuf = match args.data {
        Some(path) => path,
        None => data_dir::default_path().map_err(|error| error.to_string())?,
    };
    let data = DataDir::open(&path).map_err(|error| error.to_string())?;
    let mut setup = Setup::delivered();
    let restored = retained::load(&data, &mut setup);
    restored.place(&mut setup);
    let machine = SetupArgs {
        ladder: args.ladder,
        machine: args.machine,
        ..SetupArgs::default()
    };
    loading::apply(&mut setup, &machine)?;
    let settings = match data.load::<Settings>("window") {
        data_dir::Loaded::Value(settings) => settings,
        // What the window remembers is not worth a complaint.
        _ => Settings::default(),
    };
    let settings = Settings {
        language: args.lang.unwrap_or(settings.language),
        ..settings
    };
    let link = connection(args.link, &setup, &path)?;
    let mut emulator = Emulator::new(setup);
    emulator.panel.connect(true);
    restored.restore_panel(&mut emulator);
    let (mut kernel, console) = Kernel::new(emulator);
    if let Some(link) = link {
        kernel.connect(link);
    }
    let start = Start {
        kernel,
        console,
        settings,
        data,
        restored,
        program: args.program,
        figures: args.figures.then_some(begun),
    };
    match app::run(start) {
        Ok(()) => Ok(FINE),
        Err(said) => {
            eprintln!("gsk980td: {said}");
            Ok(USAGE)
        }
    }
}

/// The board that moves the slides, if one is named on the command line or in the
/// machine file.
fn connection(
    port: Option<String>,
    setup: &Setup,
    data: &Path,
) -> Result<Option<Connection>, String> {
    let mut config = setup.lathe.link.clone().unwrap_or_default();
    if let Some(port) = port {
        config.port = port;
    }
    if config.port.is_empty() {
        return Ok(None);
    }
    config.check().map_err(|error| error.to_string())?;
    Ok(Some(Connection {
        config,
        log: Some(data.join("link.log")),
        boards: Some(data.join("boards")),
    }))
}

fn without_display(program: Option<&Path>) -> String {
    let program = program.map_or_else(|| "FILE".to_owned(), |path| path.display().to_string());
    format!(
        "there is no display to open the window on; without one, `gsk980td run {program}` \
         executes a program and `gsk980td operate SCRIPT` operates the panel"
    )
}
