//! Opens the window: `gsk980td` without a command.

use std::cell::RefCell;
use std::path::{Path, PathBuf};

use gsk_core::model::ModelId;
use gsk_core::setup::Setup;
use gsk_core::units::PerAxis;
use gsk_host::files::data_dir::{self, DataDir, DataDirError};
use gsk_host::files::exams::ExamFolder;
use gsk_host::files::models;
use gsk_host::files::tool_library;
use gsk_host::flight::{self, FlightRecorder, RecordingTarget};
use gsk_host::kernel::{BoardConnection, Kernel, Notice};
use gsk_host::loading::LoadError;
use gsk_host::message_format::describe_io_error;
use gsk_host::network::ClassSettings;
use gsk_host::network::class::class_address::ClassAddress;
use gsk_host::network::mqtt::BrokerLine;
use gsk_host::network::mtconnect::AgentServer;
use gsk_host::ports::dnc::{self, DncSource};
use gsk_host::serial::{SerialEnd, SerialLine};
use gsk_host::setup_args::SetupArgs;
use gsk_host::{loading, log, platform, retained, transfer};
use gsk_messages::{Language, Message, say};
use gsk_panel::emulator::Emulator;
use gsk_panel::panel::SerialCable;
use gsk_runner::report;
use gsk_window::WindowSettings;
use gsk_window::app::{self, WindowStart};
use gsk_window::startup_error;
use tracing::level_filters::LevelFilter;
use web_time::Instant;

use super::network::{start_agent, start_broker_line};
use super::{CommandError, EXIT_OK, EXIT_USAGE};
use crate::cli::{SerialArgs, TextEnd, WindowArgs, first_window_language, system_language};

/// Opens the window and returns the exit code after it is closed. Returns an error if an option is
/// wrong or the window cannot be opened.
pub fn open(
    args: WindowArgs,
    language: Option<Language>,
    level: Option<LevelFilter>,
) -> Result<u8, CommandError> {
    let start_time = Instant::now();
    // The language of errors before the settings of the window are loaded (COMMAND-16).
    let message_language = language.or_else(system_language);
    if args.link.is_some() && args.first_start == Some(true) {
        return Err(say::first_start_at_board().into());
    }
    if let Some(program) = &args.program
        && !platform::is_taken(program)
    {
        return Err(say::subject_reason(program.display(), say::file_not_there()).into());
    }
    // Refuse before a window is opened or a directory is created.
    let request = SetupArgs {
        model: args.model,
        ..SetupArgs::default()
    };
    request.refuse_mill().map_err(LoadError::from)?;
    if !platform::has_display() {
        let message = no_display_message(args.program.as_deref());
        complain!(
            "gsk980td: {}",
            report::message_text(&message, message_language)
        );
        return Ok(EXIT_USAGE);
    }
    platform::close_own_console();
    let path: PathBuf = match &args.data {
        Some(path) => path.clone(),
        None => match data_dir::default_data_path() {
            Ok(path) => path,
            Err(error) => return Ok(report_refusal(&error, message_language)),
        },
    };
    tool_library::set_data_folder(&path);
    let requested_model = args.model;
    let is_new = !platform::is_taken(&path.join("window.ron"));
    let model = requested_model.unwrap_or_else(|| models::read_selected_model(&path));
    let folder = models::memory_folder(&path, model);
    let data = match DataDir::open(&folder) {
        Ok(data) => data,
        Err(error) => return Ok(report_refusal(&error, message_language)),
    };
    // Continue without a log if it cannot be written.
    let _log = log::start_in_data_dir(&folder, level.unwrap_or(LevelFilter::INFO)).unwrap_or_else(
        |error| {
            complain!(
                "gsk980td: {}",
                report::message_text(&error.message(), message_language)
            );
            None
        },
    );
    if let Some(model) = requested_model {
        store_model_choice(&path, model, message_language);
    }
    let starter = WindowStarter {
        args,
        language,
        path,
        agent: RefCell::default(),
        broker: RefCell::default(),
    };
    let start = WindowStart {
        program: starter.args.program.clone(),
        figures_since: starter.args.figures.then_some(start_time),
        ..starter.start_control(data, model, None, is_new)?
    };
    let class = starter.args.seat.class.clone();
    let class_seat = class.map(|class| seat_settings(class, &starter.args));
    let asks = needs_first_start(&starter.args, start.settings.first_start);
    let start = WindowStart {
        shows_first_start: asks,
        class_seat,
        start_model: Some(Box::new(move |model, settings| {
            starter.start_model(model, settings)
        })),
        ..start
    };
    match app::run(start) {
        Ok(()) => Ok(EXIT_OK),
        Err(error) => {
            complain!(
                "gsk980td: {}",
                report::message_text(&error, message_language)
            );
            Ok(EXIT_USAGE)
        }
    }
}

/// The data with which a control is started, also after a change of the model.
struct WindowStarter {
    args: WindowArgs,
    /// The language that `--lang` names; `None` without that option.
    language: Option<Language>,
    /// The data directory of the default control model.
    path: PathBuf,
    /// The MTConnect agent of the current control; `None` while it is off.
    agent: RefCell<Option<AgentServer>>,
    /// The connection of the current control to an MQTT broker; `None` while it is off.
    broker: RefCell<Option<BrokerLine>>,
}

impl WindowStarter {
    /// Starts a control with the memory of its data directory, and a window with `settings` or
    /// the stored settings. `is_new`: the data directory has no window settings yet.
    fn start_control(
        &self,
        data: DataDir,
        model: ModelId,
        settings: Option<&WindowSettings>,
        is_new: bool,
    ) -> Result<WindowStart, CommandError> {
        let (args, path) = (&self.args, data.path().to_owned());
        let stored = match data.load::<WindowSettings>("window") {
            data_dir::LoadedFile::Value(settings) => Some(settings),
            // Missing or damaged window settings are not reported.
            _ => None,
        };
        let settings = settings.cloned();
        let settings = settings.unwrap_or_else(|| self.first_settings(stored.as_ref(), is_new));
        // The machine file that was selected in the window may have been removed.
        let selected_machine = args.machine.is_none().then(|| settings.machine.clone());
        let selected_machine = selected_machine.flatten();
        let machine_error = selected_machine
            .as_ref()
            .map(|path| loading::load_machine(path).err());
        let machine_error = machine_error.flatten().map(|error| error.message());
        let lathe = args.machine.clone();
        let lathe = lathe.or(selected_machine.filter(|_| machine_error.is_none()));
        let mut setup = loading::with_training_lathe(Setup::delivered(), lathe.as_ref());
        let mut restored = retained::load(&data, &mut setup);
        if let Some(message) = machine_error {
            restored.complaints.push(say::first_lathe_missing(message));
        }
        restored.place_slides(&mut setup);
        let machine = SetupArgs {
            ladder: args.ladder.clone(),
            machine: lathe,
            macro_b: args.macro_b,
            model: Some(model),
            ..SetupArgs::default()
        };
        loading::apply_options(&mut setup, &machine)?;
        if args.link.is_none() {
            place_within_travel(&mut setup);
        }
        if let Some(parameters) = loading::missing_machine_parameters(&setup) {
            let name = setup.lathe.name.clone();
            restored
                .complaints
                .push(say::machine_needs_parameters(name, parameters));
        }
        let source = match &args.dnc {
            Some(name) => {
                loading::use_dnc_ladder(&mut setup);
                DncSource::from_name(name)
            }
            None => DncSource::File(path.join(transfer::FOLDER).join(dnc::FILE_IN_FOLDER)),
        };
        let link = board_connection(args.link.clone(), &setup, Some(&path))?;
        let mut emulator = Emulator::new(setup);
        emulator.connect_cable(SerialCable::Simulated);
        restored.restore_panel(&mut emulator);
        let (mut kernel, console) = Kernel::new(emulator);
        if let (Some(port), DncSource::Port(same)) = (&args.serial.serial, &source)
            && port == same
        {
            return Err(say::serial_and_dnc(port).into());
        }
        kernel.set_dnc_source(source);
        if let Some(line) = serial_line(&args.serial)? {
            kernel.connect_serial_line(line);
        }
        if let Some(link) = link {
            kernel.connect(link);
        }
        let recordings = path.join(flight::FOLDER);
        let notices = console.notice_sender.clone();
        // An exam that continues says so itself.
        let unfinished_exam = ExamFolder::find_unfinished(&path);
        let is_in_exam = matches!(unfinished_exam, Ok(Some(_)));
        flight::offer_unfinished(&recordings, move |message| {
            if is_in_exam {
                return;
            }
            // A window that is gone needs no message.
            let _ = notices.try_send(Notice::Message(message));
        });
        let folder = RecordingTarget::Folder(recordings);
        let file = args.record.clone().map(RecordingTarget::File);
        for target in core::iter::once(folder).chain(file) {
            let recorder = FlightRecorder::start(target).map_err(CommandError::gone)?;
            kernel.add_flight_recorder(recorder);
        }
        self.start_network(&mut kernel)?;
        Ok(WindowStart {
            kernel,
            console,
            settings,
            stored_settings: stored,
            data,
            restored,
            program: None,
            figures_since: None,
            model,
            start_model: None,
            shows_first_start: false,
            unfinished_exam,
            class_seat: None,
        })
    }

    /// The settings of a window: the stored ones, or those of the first start.
    fn first_settings(&self, stored: Option<&WindowSettings>, is_new: bool) -> WindowSettings {
        let remembered = stored.cloned().unwrap_or_else(|| WindowSettings {
            language: first_window_language(),
            ..WindowSettings::default()
        });
        WindowSettings {
            language: self.language.unwrap_or(remembered.language),
            first_start: is_new || remembered.first_start,
            ..remembered
        }
    }

    /// Starts what options request in the network for a control; what the control before it used
    /// ends. Returns an error if the agent cannot listen or a password cannot be read.
    fn start_network(&self, kernel: &mut Kernel) -> Result<(), CommandError> {
        self.agent.take();
        let simulation = kernel.emulator().simulation();
        if let Some((server, feed)) = start_agent(&self.args.mtconnect, simulation)? {
            kernel.network().connect_agent(feed, server.url());
            self.agent.replace(Some(server));
        }
        self.broker.take();
        let state = kernel.network().states().broker.clone();
        let simulation = kernel.emulator().simulation();
        if let Some((line, feed)) = start_broker_line(&self.args.mqtt, simulation, state)? {
            kernel.network().connect_broker(feed);
            self.broker.replace(Some(line));
        }
        Ok(())
    }

    /// Starts the control with another model and stores it as the model of the next start. Returns
    /// a message as error if its memory cannot be opened.
    fn start_model(
        &self,
        model: ModelId,
        settings: &WindowSettings,
    ) -> Result<WindowStart, Message> {
        let folder = models::memory_folder(&self.path, model);
        let data = DataDir::open(&folder).map_err(|error| error.message())?;
        let start = self
            .start_control(data, model, Some(settings), false)
            .map_err(|error| error.message())?;
        store_model_choice(&self.path, model, self.language);
        Ok(start)
    }
}

/// Whether to show the questions of the first start: if an option requests it, or if they are
/// unanswered (`is_unanswered`) and no option already names a program, lathe, model or port.
const fn needs_first_start(args: &WindowArgs, is_unanswered: bool) -> bool {
    let is_named = args.program.is_some()
        || args.link.is_some()
        || args.dnc.is_some()
        || args.machine.is_some()
        || args.model.is_some();
    match args.first_start {
        Some(wanted) => wanted,
        None => is_unanswered && !is_named,
    }
}

/// Opens the port of the computer for the control's serial port; `None` if no option names one.
/// Returns an error if it cannot be opened.
pub fn serial_line(args: &SerialArgs) -> Result<Option<SerialLine>, CommandError> {
    let Some(port) = &args.serial else {
        return Ok(None);
    };
    let text = args.serial_text.map(TextEnd::to_line_end);
    let line = SerialLine::open(SerialEnd::from_name(port), text).map_err(CommandError::gone)?;
    Ok(Some(line))
}

/// Stores the model for the next start. If that fails, prints the error; the next start then
/// uses the old model.
fn store_model_choice(path: &Path, model: ModelId, language: Option<Language>) {
    if let Err(error) = models::store_selected_model(path, model) {
        let file = path.join(models::MODEL_FILE);
        let message = say::file_not_written(file.display(), describe_io_error(&error));
        complain!("gsk980td: {}", report::message_text(&message, language));
    }
}

/// Reports an error on standard error and in a dialog, since a program started from a desktop
/// has no standard error. Returns the exit code.
fn report_refusal(error: &DataDirError, language: Option<Language>) -> u8 {
    let message = error.message();
    complain!("gsk980td: {}", report::message_text(&message, language));
    startup_error::show(&message, language);
    EXIT_USAGE
}

/// Configures the connection to the board that `port` or the machine file names; `None` if neither
/// does. `data`: folder for the log of the link. Returns an error if the settings of the link are
/// wrong.
pub fn board_connection(
    port: Option<String>,
    setup: &Setup,
    data: Option<&Path>,
) -> Result<Option<BoardConnection>, CommandError> {
    let mut config = setup.lathe.link.clone().unwrap_or_default();
    if let Some(port) = port {
        config.port = port;
    }
    if config.port.is_empty() {
        return Ok(None);
    }
    config.check()?;
    Ok(Some(BoardConnection {
        config,
        log_path: data.map(|data| data.join("link.log")),
        dictionary_folder: data.map(|data| data.join("boards")),
        holder_program: platform::own_executable(),
    }))
}

/// The settings of the seat that options of the command line request.
fn seat_settings(class: ClassAddress, args: &WindowArgs) -> ClassSettings {
    ClassSettings {
        is_on: true,
        code: class.code.to_string(),
        broker: class.broker.without_password(),
        ca: (args.mqtt.mqtt_ca.as_ref())
            .map_or_else(String::new, |path| path.display().to_string()),
        name: args.seat.class_name.clone().unwrap_or_default(),
        allows_faults: false,
        password: class.broker.password.unwrap_or_default(),
    }
}

fn no_display_message(program: Option<&Path>) -> Message {
    match program {
        Some(path) => say::window_no_display(path.display()),
        None => say::window_no_display("FILE"),
    }
}

/// Places the slides of a simulated lathe at its start if the stored position is beyond their
/// mechanical ends: another lathe stood there.
fn place_within_travel(setup: &mut Setup) {
    let standing = Setup {
        start: setup.slides.or(setup.start),
        ..setup.clone()
    };
    if setup.lathe.link.is_none() && !standing.axes_beyond_ends().is_empty() {
        setup.start = Some(setup.lathe.start());
        setup.absolute = None;
        setup.slides = None;
        setup.zero_kept = PerAxis::default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_core::memory::ControlParameters;
    use gsk_core::units::Point;
    use gsk_tests::test_folder;

    fn turn_on(folder: &Path, settings: Option<&WindowSettings>, fresh: bool) -> WindowStart {
        let starter = WindowStarter {
            args: WindowArgs::default(),
            language: None,
            path: folder.to_owned(),
            agent: RefCell::default(),
            broker: RefCell::default(),
        };
        let data = DataDir::open(folder).expect("a data directory");
        let model = ModelId::Gsk980td;
        let start = starter.start_control(data, model, settings, fresh);
        start.map_err(|error| error.message()).expect("turns on")
    }

    #[test]
    fn a_fresh_data_directory_asks_once() {
        let folder = test_folder("first-start");
        let start = turn_on(&folder, None, true);
        assert!(start.settings.first_start && start.stored_settings.is_none());
        // The questions were not answered: the next start asks again.
        start.data.store("window", &start.settings).expect("store");
        drop(start);
        let start = turn_on(&folder, None, false);
        assert!(start.settings.first_start);
        let answered = WindowSettings {
            first_start: false,
            ..start.settings.clone()
        };
        start.data.store("window", &answered).expect("store");
        drop(start);
        let start = turn_on(&folder, None, false);
        assert_eq!(start.stored_settings.as_ref(), Some(&answered));
        assert!(!start.settings.first_start);
        drop(start);
    }

    #[test]
    fn a_start_with_a_purpose_shows_no_questions() {
        let plain = WindowArgs::default();
        assert!(needs_first_start(&plain, true) && !needs_first_start(&plain, false));
        let program = WindowArgs {
            program: Some(PathBuf::from("shaft.CNC")),
            ..WindowArgs::default()
        };
        assert!(!needs_first_start(&program, true));
        for wanted in [false, true] {
            let args = WindowArgs {
                first_start: Some(wanted),
                ..WindowArgs::default()
            };
            assert_eq!(needs_first_start(&args, !wanted), wanted);
        }
    }

    #[test]
    fn slides_beyond_the_ends_of_this_lathe_stand_at_its_start() {
        let mut setup = Setup::delivered();
        let own = setup.lathe.start();
        setup.start = Some(Point::new(150.0, 300.0));
        setup.slides = setup.start;
        place_within_travel(&mut setup);
        assert_eq!((setup.start, setup.slides), (Some(own), None));
        // On a limit switch they are within the ends.
        let on_switch = Some(Point::new(5.5, -100.0));
        setup.start = on_switch;
        place_within_travel(&mut setup);
        assert_eq!(setup.start, on_switch);
    }

    #[test]
    fn the_slides_of_another_lathe_stand_at_its_start() {
        let folder = test_folder("other-lathe");
        drop(turn_on(&folder, None, false));
        let data = DataDir::open(&folder).expect("a data directory");
        let position = retained::SavedPosition {
            machine: Point::new(-10.0, -20.0),
            absolute: Point::default(),
            slides: Some(Point::new(-10.0, -20.0)),
            zero_kept: PerAxis::default(),
        };
        data.store("standing", &Some(position)).expect("stored");
        drop(data);
        let slides = |start: &WindowStart| start.kernel.emulator().lathe().slide_position();
        let start = turn_on(&folder, None, false);
        assert_eq!(slides(&start), Point::new(-10.0, -20.0));
        drop(start);
        retained::forget_position(&folder).expect("forgotten");
        let start = turn_on(&folder, None, false);
        let lathe = start.kernel.emulator().lathe();
        assert_eq!(slides(&start), lathe.config().start());
        assert!(start.restored.complaints.is_empty());
        drop(start);
    }

    #[test]
    fn the_selected_lathe_is_used_and_a_missing_one_is_reported() {
        let folder = test_folder("chosen-lathe");
        let machines = Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/machines");
        let chosen = |name: &str| WindowSettings {
            machine: Some(machines.join(name)),
            ..WindowSettings::default()
        };
        let start = turn_on(&folder, Some(&chosen("small-flat-bed.ron")), false);
        let lathe = |start: &WindowStart| start.kernel.emulator().lathe().config().clone();
        let read = loading::load_machine(&machines.join("small-flat-bed.ron")).expect("a machine");
        assert_eq!(lathe(&start), read);
        // The control was as delivered: it has got what this lathe needs.
        let memory = |start: &WindowStart| start.kernel.emulator().cnc().parameters().clone();
        assert_eq!(memory(&start).value(84), 6);
        assert!(start.restored.complaints.is_empty());
        // A tool change writes 075, which is no change by the user.
        let mut changed = Setup::delivered().memory.parameters;
        changed.set(75, 3).expect("a station");
        start.data.store("parameters", &changed).expect("stored");
        drop(start);
        let start = turn_on(&folder, Some(&chosen("small-flat-bed.ron")), false);
        assert_eq!(memory(&start).value(84), 6);
        assert!(start.restored.complaints.is_empty());
        let mut own = ControlParameters::default();
        own.set(22, 3800).expect("a rapid rate");
        start.data.store("parameters", &own).expect("stored");
        drop(start);
        let start = turn_on(&folder, Some(&chosen("small-flat-bed.ron")), false);
        assert_eq!(memory(&start), own);
        let texts: Vec<String> = start
            .restored
            .complaints
            .iter()
            .map(|it| it.text(Language::En))
            .collect();
        assert!(texts.len() == 1 && texts[0].contains("84=6"), "{texts:?}");
        drop(start);
        let start = turn_on(&folder, Some(&chosen("no-such-lathe.ron")), false);
        assert_eq!(lathe(&start), Setup::delivered().lathe);
        let texts = start.restored.complaints.iter();
        let texts: Vec<String> = texts.map(|it| it.text(Language::En)).collect();
        assert!(
            texts.iter().any(|it| it.contains("no-such-lathe.ron")),
            "{texts:?}"
        );
        drop(start);
    }
}
