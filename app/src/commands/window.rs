//! Opens the window: `gsk980td` without a command.

use std::path::{Path, PathBuf};

use gsk_core::model::ModelId;
use gsk_core::setup::Setup;
use gsk_messages::{Language, Message, say};
use gsk_panel::emulator::Emulator;
use gsk_runner::report;
use tracing::level_filters::LevelFilter;
use web_time::Instant;

use super::{CommandError, FINE, USAGE};
use crate::cli::{SerialArgs, TextEnd, WindowArgs, of_the_system};
use crate::dnc::{self, Source};
use crate::files::data_dir::{self, DataDir, DataError};
use crate::files::models;
use crate::kernel::{Connection, Kernel};
use crate::loading::LoadError;
use crate::saying::of_system;
use crate::serial::{End, SerialLine};
use crate::setup_args::SetupArgs;
use crate::window::app::{self, Start};
use crate::window::{Settings, refusal};
use crate::{loading, log, platform, retained, transfer};

/// Opens the window and returns after it is closed.
pub fn open(
    args: WindowArgs,
    language: Option<Language>,
    level: Option<LevelFilter>,
) -> Result<u8, CommandError> {
    let begun = Instant::now();
    // The language of errors before the settings of the window are loaded (COMMAND-16).
    let told = language.or_else(of_the_system);
    if args.link.is_some() && args.first_start == Some(true) {
        return Err(CommandError::FirstStartAtBoard);
    }
    if let Some(program) = &args.program
        && !platform::is_taken(program)
    {
        return Err(CommandError::NoFile(program.clone()));
    }
    // Refuse before a window is opened or a directory is created.
    let asked = SetupArgs {
        model: args.model,
        ..SetupArgs::default()
    };
    asked.refuse_mill().map_err(LoadError::from)?;
    if !platform::has_display() {
        let said = without_display(args.program.as_deref());
        complain!("gsk980td: {}", report::said(&said, told));
        return Ok(USAGE);
    }
    platform::leave_console();
    let path: PathBuf = match &args.data {
        Some(path) => path.clone(),
        None => match data_dir::default_path() {
            Ok(path) => path,
            Err(error) => return Ok(refused(&error, told)),
        },
    };
    let asked = args.model;
    let fresh = !platform::is_taken(&path.join("window.ron"));
    let model = asked.unwrap_or_else(|| models::chosen(&path));
    let folder = models::folder(&path, model);
    let data = match DataDir::open(&folder) {
        Ok(data) => data,
        Err(error) => return Ok(refused(&error, told)),
    };
    // Continue without a log if it cannot be written.
    let _log = log::in_data(&folder, level.unwrap_or(LevelFilter::INFO)).unwrap_or_else(|error| {
        complain!("gsk980td: {}", report::said(&error.message(), told));
        None
    });
    if let Some(model) = asked {
        keep_choice(&path, model, told);
    }
    let opener = Opener {
        args,
        language,
        path,
    };
    let start = Start {
        program: opener.args.program.clone(),
        figures: opener.args.figures.then_some(begun),
        ..opener.turn_on(data, model, None, fresh)?
    };
    let asks = asks_first(&opener.args, start.settings.first_start);
    let start = Start {
        asks,
        another: Some(Box::new(move |model, settings| {
            opener.another(model, settings)
        })),
        ..start
    };
    match app::run(start) {
        Ok(()) => Ok(FINE),
        Err(said) => {
            complain!("gsk980td: {}", report::said(&said, told));
            Ok(USAGE)
        }
    }
}

/// Everything needed to start the control again with another model.
struct Opener {
    args: WindowArgs,
    /// The language of `--lang`.
    language: Option<Language>,
    /// The data directory of the default model.
    path: PathBuf,
}

impl Opener {
    /// Starts a control with the memory of its directory, and a window with `settings` or
    /// the stored settings. `fresh`: the data directory has no window settings yet.
    fn turn_on(
        &self,
        data: DataDir,
        model: ModelId,
        settings: Option<&Settings>,
        fresh: bool,
    ) -> Result<Start, CommandError> {
        let (args, path) = (&self.args, data.path().to_owned());
        let stored = match data.load::<Settings>("window") {
            data_dir::Loaded::Value(settings) => Some(settings),
            // Missing or damaged window settings are not reported.
            _ => None,
        };
        let remembered = || stored.clone().unwrap_or_default();
        let settings = settings.cloned().unwrap_or_else(|| Settings {
            language: self.language.unwrap_or(remembered().language),
            first_start: fresh || remembered().first_start,
            ..remembered()
        });
        // The machine file that was selected in the window may have been removed.
        let chosen = args.machine.is_none().then(|| settings.machine.clone());
        let chosen = chosen.flatten();
        let wrong = chosen.as_ref().map(|path| loading::machine(path).err());
        let wrong = wrong.flatten().map(|error| error.message());
        let lathe = args.machine.clone();
        let lathe = lathe.or(chosen.filter(|_| wrong.is_none()));
        let mut setup = loading::fitted(Setup::delivered(), lathe.as_ref());
        let mut restored = retained::load(&data, &mut setup);
        if let Some(said) = wrong {
            restored.complaints.push(say::first_lathe_missing(said));
        }
        restored.place(&mut setup);
        let machine = SetupArgs {
            ladder: args.ladder.clone(),
            machine: lathe,
            macro_b: args.macro_b,
            model: Some(model),
            ..SetupArgs::default()
        };
        loading::apply(&mut setup, &machine)?;
        let source = match &args.dnc {
            Some(name) => {
                loading::with_keys_for_dnc(&mut setup);
                Source::of(name)
            }
            None => Source::File(path.join(transfer::FOLDER).join(dnc::IN_FOLDER)),
        };
        let link = connection(args.link.clone(), &setup, Some(&path))?;
        let mut emulator = Emulator::new(setup);
        emulator.panel.connect(true);
        restored.restore_panel(&mut emulator);
        let (mut kernel, console) = Kernel::new(emulator);
        if let (Some(port), Source::Port(same)) = (&args.serial.serial, &source)
            && port == same
        {
            return Err(CommandError::SamePort(port.clone()));
        }
        kernel.take_programs_from(source);
        if let Some(line) = serial_line(&args.serial)? {
            kernel.take_serial_line(line);
        }
        if let Some(link) = link {
            kernel.connect(link);
        }
        Ok(Start {
            kernel,
            console,
            settings,
            stored,
            data,
            restored,
            program: None,
            figures: None,
            model,
            another: None,
            asks: false,
        })
    }

    /// Starts the control with another model and stores it as the model of the next start.
    fn another(&self, model: ModelId, settings: &Settings) -> Result<Start, Message> {
        let folder = models::folder(&self.path, model);
        let data = DataDir::open(&folder).map_err(|error| error.message())?;
        let start = self
            .turn_on(data, model, Some(settings), false)
            .map_err(|error| error.message())?;
        keep_choice(&self.path, model, self.language);
        Ok(start)
    }
}

/// Whether to show the questions of the first start: if an option requests it, or if they
/// are unanswered (`wait`) and no option already names a program, lathe, model or port.
const fn asks_first(args: &WindowArgs, wait: bool) -> bool {
    let named = args.program.is_some()
        || args.link.is_some()
        || args.dnc.is_some()
        || args.machine.is_some()
        || args.model.is_some();
    match args.first_start {
        Some(wanted) => wanted,
        None => wait && !named,
    }
}

/// Opens the control's serial port if an option names one.
pub fn serial_line(args: &SerialArgs) -> Result<Option<SerialLine>, CommandError> {
    let Some(port) = &args.serial else {
        return Ok(None);
    };
    let text = args.serial_text.map(TextEnd::line_end);
    let line = SerialLine::open(End::of(port), text).map_err(CommandError::Gone)?;
    Ok(Some(line))
}

/// Stores the selected model; an error is reported, and the next start uses the old model.
fn keep_choice(path: &Path, model: ModelId, language: Option<Language>) {
    if let Err(error) = models::choose(path, model) {
        let file = path.join(models::CHOICE);
        let said = say::file_not_written(file.display(), of_system(&error));
        complain!("gsk980td: {}", report::said(&said, language));
    }
}

/// Reports an error in a dialog, too: a program started from a desktop has no standard
/// error.
fn refused(error: &DataError, language: Option<Language>) -> u8 {
    let said = error.message();
    complain!("gsk980td: {}", report::said(&said, language));
    refusal::tell(&said, language);
    USAGE
}

/// The connection to the board named on the command line or in the machine file; `None`
/// without one. `data`: folder for the log of the link.
pub fn connection(
    port: Option<String>,
    setup: &Setup,
    data: Option<&Path>,
) -> Result<Option<Connection>, CommandError> {
    let mut config = setup.lathe.link.clone().unwrap_or_default();
    if let Some(port) = port {
        config.port = port;
    }
    if config.port.is_empty() {
        return Ok(None);
    }
    config.check()?;
    Ok(Some(Connection {
        config,
        log: data.map(|data| data.join("link.log")),
        boards: data.map(|data| data.join("boards")),
        program: platform::own_program(),
    }))
}

fn without_display(program: Option<&Path>) -> Message {
    match program {
        Some(path) => say::window_no_display(path.display()),
        None => say::window_no_display("FILE"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::test_folder;

    fn turned_on(folder: &Path, settings: Option<&Settings>, fresh: bool) -> Start {
        let opener = Opener {
            args: WindowArgs::default(),
            language: None,
            path: folder.to_owned(),
        };
        let data = DataDir::open(folder).expect("a data directory");
        let model = ModelId::Gsk980td;
        let start = opener.turn_on(data, model, settings, fresh);
        start.map_err(|error| error.message()).expect("turns on")
    }

    #[test]
    fn a_fresh_data_directory_asks_once() {
        let folder = test_folder("first-start");
        let start = turned_on(&folder, None, true);
        assert!(start.settings.first_start && start.stored.is_none());
        // The questions were not answered: the next start asks again.
        start.data.store("window", &start.settings).expect("store");
        drop(start);
        let start = turned_on(&folder, None, false);
        assert!(start.settings.first_start);
        let answered = Settings {
            first_start: false,
            ..start.settings.clone()
        };
        start.data.store("window", &answered).expect("store");
        drop(start);
        let start = turned_on(&folder, None, false);
        assert_eq!(start.stored.as_ref(), Some(&answered));
        assert!(!start.settings.first_start);
        drop(start);
    }

    #[test]
    fn a_start_that_says_what_it_is_for_is_not_held_up() {
        let plain = WindowArgs::default();
        assert!(asks_first(&plain, true) && !asks_first(&plain, false));
        let program = WindowArgs {
            program: Some(PathBuf::from("shaft.CNC")),
            ..WindowArgs::default()
        };
        assert!(!asks_first(&program, true));
        for wanted in [false, true] {
            let said = WindowArgs {
                first_start: Some(wanted),
                ..WindowArgs::default()
            };
            assert_eq!(asks_first(&said, !wanted), wanted);
        }
    }

    #[test]
    fn the_lathe_that_was_chosen_is_turned_on_and_one_that_is_gone_is_named() {
        let folder = test_folder("chosen-lathe");
        let machines = Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/machines");
        let chosen = |name: &str| Settings {
            machine: Some(machines.join(name)),
            ..Settings::default()
        };
        let start = turned_on(&folder, Some(&chosen("small-flat-bed.ron")), false);
        let lathe = |start: &Start| start.kernel.emulator().simulation.lathe.config().clone();
        let read = loading::machine(&machines.join("small-flat-bed.ron")).expect("a machine");
        assert_eq!(lathe(&start), read);
        drop(start);
        let start = turned_on(&folder, Some(&chosen("no-such-lathe.ron")), false);
        assert_eq!(lathe(&start), Setup::delivered().lathe);
        let said = start.restored.complaints.iter();
        let said: Vec<String> = said.map(|it| it.text(Language::En)).collect();
        assert!(
            said.iter().any(|it| it.contains("no-such-lathe.ron")),
            "{said:?}"
        );
        drop(start);
    }
}
