//! The control and a board in two processes, connected by a pseudo terminal, in real time.
//!
//! No test depends on the speed of the computer. A computer that is too busy raises an alarm
//! of the control; the tests recover from it as the operator does.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use gsk_host::board::port_io::{PortIo, TrafficLine};
use gsk_host::kernel::probe::Probe;
use gsk_host::kernel::{
    BoardConnection, Command, Console, Kernel, LinkAction, OpenedProgram, StorePolicy,
};

use crate::process::executable;
use crate::twin::TwinProcess;
use crossbeam::queue::ArrayQueue;
use gsk_core::linked::drives_from_parameters;
use gsk_core::memory::ControlParameters;
use gsk_core::operation::RunState;
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::units::Axis;
use gsk_link::step_queue::StepLink;
use gsk_link::{Backend, LinkConfig, LinkEvent, LinkState};
use gsk_panel::emulator::Emulator;
use gsk_panel::keys::Key;
use gsk_twins::klipper::{KlipperHardware, KlipperTwin};

const PROGRAM_FILE: &str = env!("CARGO_BIN_EXE_gsk980td");
const PROGRAM: &str = "O0007\nG50 X60 Z20\nG98 G97 S500 M03\nG00 X50 Z10 M08\n\
    G01 Z5 F600\nG02 X56 Z2 R3\nG00 X60 Z20\nM05\nM09\nM30\n";
const LINE: &str = "(lookahead_ms: Some(400), line: (home: (seek: 3000, locate: 200)))";
const TIMED: &str = r#"(
    protocol: StepQueue,
    lookahead_ms: Some(400),
    x: (step: "PA0", dir: "PA1", limit: "^PC0"),
    z: (step: "PA2", dir: "PA3", limit: "^PC1"),
    io: (enable: "PL0", coolant: "PB7"),
    line: (home: (seek: 3000, locate: 200)),
)"#;
/// Attempts of a test that may fail because the computer is too busy, and the time limit of
/// each wait.
const ATTEMPTS: u32 = 20;
const TIME_LIMIT: Duration = Duration::from_secs(120);

/// A control with a board.
struct BoardLathe {
    kernel: Kernel,
    console: Console,
    state: LinkState,
    has_different_settings: bool,
    /// The longest gap between two polls of the port, as the link page shows it.
    max_poll_gap: Duration,
    /// The greatest count of dictionary queries that one view of the link has shown.
    dictionary_queries: usize,
    log: PathBuf,
}

impl BoardLathe {
    fn connect(port: &str, config: &str) -> Self {
        Self::connect_with_dictionaries(port, config, None)
    }

    /// `boards`: the folder with the stored dictionaries of known boards.
    fn connect_with_dictionaries(port: &str, config: &str, boards: Option<PathBuf>) -> Self {
        let mut setup = Setup::delivered();
        for number in [17, 18] {
            setup.memory.parameters.set(number, 5).unwrap();
        }
        // One press of the axis key is enough for the whole return.
        setup.memory.parameters.set_bit(11, 2, true).unwrap();
        let config = LinkConfig {
            port: port.to_owned(),
            ..ron::from_str(config).unwrap()
        };
        config.check().unwrap();
        let name = format!(
            "gsk980td-board-{}-{}.log",
            std::process::id(),
            port.replace('/', "-")
        );
        let log = std::env::temp_dir().join(name);
        let _ = std::fs::remove_file(&log);
        let (mut kernel, console) = Kernel::new(Emulator::new(setup));
        kernel.run(4000);
        console.send(Command::WatchLink(true));
        // There is no display to query.
        console.input_watch.trust_window();
        kernel.connect(BoardConnection {
            config,
            log_path: Some(log.clone()),
            dictionary_folder: boards,
            holder_program: PROGRAM_FILE.into(),
        });
        Self {
            kernel,
            console,
            state: LinkState::Opening,
            has_different_settings: false,
            max_poll_gap: Duration::ZERO,
            dictionary_queries: 0,
            log,
        }
    }

    fn alarm_numbers(&self) -> Vec<u16> {
        let alarms = self.kernel.emulator().cnc().alarms();
        alarms.iter().map(|alarm| alarm.number).collect()
    }

    fn log_text(&self) -> String {
        std::fs::read_to_string(&self.log).unwrap_or_default()
    }

    /// Runs the control until a condition is met. Returns false after the time limit.
    fn run_until(&mut self, time_limit: Duration, is_met: impl Fn(&Self) -> bool) -> bool {
        let start = Instant::now();
        while start.elapsed() < time_limit {
            self.kernel.run_linked();
            if let Some(view) = self.console.link.pop() {
                self.state = view.state;
                self.has_different_settings = !view.differences.is_empty();
                self.max_poll_gap = view.absence.1;
                let is_query =
                    |line: &&TrafficLine| line.is_outward && line.text.contains("identify offset");
                self.dictionary_queries = self
                    .dictionary_queries
                    .max(view.traffic_lines.iter().filter(is_query).count());
            }
            if is_met(self) {
                return true;
            }
        }
        false
    }

    fn reaches(&mut self, state: LinkState) -> bool {
        self.run_until(TIME_LIMIT, |lathe| {
            lathe.state == state || !lathe.alarm_numbers().is_empty()
        }) && self.state == state
    }

    fn tap(&mut self, key: Key) {
        self.console.send(Command::Tap(key));
        let ticks = self.kernel.emulator().cnc().ticks();
        self.run_until(TIME_LIMIT, |lathe| {
            lathe.kernel.emulator().cnc().ticks() >= ticks + 300
        });
    }

    /// Connects and writes the settings. Returns whether the board is ready for the reference
    /// return.
    fn connect_board(&mut self) -> bool {
        let is_settled = |lathe: &Self| {
            matches!(
                lathe.state,
                LinkState::Locked | LinkState::Fault | LinkState::Lost
            )
        };
        self.run_until(TIME_LIMIT, |lathe| {
            is_settled(lathe) || lathe.has_different_settings
        });
        if self.has_different_settings {
            self.console.send(Command::Link(LinkAction::WriteSettings));
            self.run_until(TIME_LIMIT, is_settled);
        }
        self.tap(Key::Reset);
        self.state == LinkState::Locked
    }

    fn return_to_reference(&mut self) -> bool {
        self.tap(Key::MachineZero);
        for (key, axis) in [(Key::XDown, Axis::X), (Key::ZRight, Axis::Z)] {
            let is_referenced = move |lathe: &Self| {
                let cnc = lathe.kernel.emulator().cnc();
                *cnc.referenced_axes().get(axis) || !cnc.alarms().is_empty()
            };
            if !is_referenced(self) {
                self.tap(key);
                self.run_until(TIME_LIMIT, is_referenced);
            }
        }
        self.reaches(LinkState::Ready)
    }

    fn start_program(&mut self) {
        self.console.send(Command::Open(Box::new(OpenedProgram {
            name: "seven.CNC".to_owned(),
            path: None,
            store_policy: StorePolicy::RunOnly,
            program: Program::new(PROGRAM),
            subprograms: Vec::new(),
        })));
        self.tap(Key::Auto);
        self.tap(Key::CycleStart);
    }

    /// Runs the program to its end and waits for the comparison of the pulses in the log.
    fn run_program(&mut self) -> bool {
        self.start_program();
        self.run_until(TIME_LIMIT, |lathe| {
            let is_finished = lathe.kernel.emulator().cnc().run_state() == RunState::Reset
                && lathe.state == LinkState::Ready
                && lathe.log_text().contains("O0007");
            is_finished || !lathe.alarm_numbers().is_empty()
        });
        self.alarm_numbers().is_empty() && self.state == LinkState::Ready
    }

    /// Recovers from an alarm as the operator does.
    fn recover(&mut self) {
        eprintln!("busy: {:?} {:?}", self.alarm_numbers(), self.state);
        self.console.send(Command::Link(LinkAction::Reconnect));
        self.state = LinkState::Opening;
        self.tap(Key::Reset);
    }
}

/// Connects, returns to the reference, makes a part and checks it; then unplugs the board in
/// motion.
fn make_part_and_unplug(firmware: &str, config: &str) {
    let mut twin = TwinProcess::start(&["--firmware", firmware]);
    let mut lathe = BoardLathe::connect(&twin.port, config);
    let is_made = (0..ATTEMPTS).any(|_| {
        let is_made = lathe.connect_board() && lathe.return_to_reference() && lathe.run_program();
        if !is_made {
            lathe.recover();
        }
        is_made
    });
    assert!(is_made, "{:?} {:?}", lathe.alarm_numbers(), lathe.state);
    let log = lathe.log_text();
    let line = log.lines().find(|line| line.contains("O0007")).unwrap();
    let (_, counts) = line.split_once(" commanded ").unwrap();
    let (commanded, counted) = counts.split_once(" counted ").unwrap();
    assert_eq!(counted, format!("{commanded} agrees"), "{line}");

    lathe.start_program();
    lathe.run_until(TIME_LIMIT, |lathe| {
        lathe.kernel.emulator().cnc().is_moving() || !lathe.alarm_numbers().is_empty()
    });
    twin.unplug();
    assert!(lathe.run_until(TIME_LIMIT, |lathe| lathe.state == LinkState::Lost));
    assert!(
        lathe.alarm_numbers().contains(&605),
        "{:?}",
        lathe.alarm_numbers()
    );
    let cnc = lathe.kernel.emulator().cnc();
    assert!(!cnc.referenced_axes().x && !cnc.is_moving());
    // RESET opens the port again: it is missing, and the alarm names it.
    lathe.tap(Key::Reset);
    lathe.run_until(Duration::from_secs(1), |_| false);
    let alarms = lathe.kernel.emulator().cnc().alarms();
    let detail = alarms
        .iter()
        .find(|alarm| matches!(alarm.number, 601 | 605))
        .map(gsk_core::alarm::Alarm::detail_en)
        .unwrap_or_default();
    assert!(detail.contains(&twin.port), "{alarms:?}");
    let _ = std::fs::remove_file(&lathe.log);
}

pub fn a_line_board_in_another_process_makes_a_part_and_is_unplugged() {
    make_part_and_unplug("grbl", LINE);
}

pub fn a_board_of_timed_steps_in_another_process_makes_a_part_and_is_unplugged() {
    make_part_and_unplug("klipper", TIMED);
}

/// The simulated slides and spindle are not the real ones: the scope shows no value for them.
pub fn the_scope_shows_only_known_values_of_the_real_lathe() {
    let mut lathe = BoardLathe::connect("/nowhere/at/all", TIMED);
    let queue = Arc::new(ArrayQueue::new(10));
    lathe.console.send(Command::Probe(Some(Probe {
        queue: Arc::clone(&queue),
        bits: Vec::new(),
    })));
    assert!(lathe.run_until(TIME_LIMIT, |_| queue.is_full()));
    let sample = queue.pop().unwrap();
    assert_eq!(sample.actual, sample.commanded);
    assert_eq!((sample.following_error, sample.spindle_rpm), (None, None));
}

/// A gap in polling the port is shown before it can do harm.
pub fn the_link_page_shows_the_longest_poll_gap() {
    const POLL_GAP: Duration = Duration::from_millis(150);
    let twin = TwinProcess::start(&[]);
    let mut lathe = BoardLathe::connect(&twin.port, LINE);
    assert!((0..ATTEMPTS).any(|_| {
        let opens = lathe.connect_board();
        if !opens {
            lathe.recover();
        }
        opens
    }));
    let previous = lathe.max_poll_gap;
    std::thread::sleep(previous + POLL_GAP);
    assert!(lathe.run_until(TIME_LIMIT, |lathe| lathe.max_poll_gap
        >= previous + POLL_GAP));
    let _ = std::fs::remove_file(&lathe.log);
}

/// One client has the port: any other client gets an error with the name of the port.
pub fn a_port_in_use_is_refused_with_its_name() {
    let twin = TwinProcess::start(&[]);
    let config = LinkConfig {
        port: twin.port.clone(),
        ..LinkConfig::default()
    };
    let first = PortIo::open(&config, Path::new(PROGRAM_FILE)).unwrap();
    let refused = PortIo::open(&config, Path::new(PROGRAM_FILE))
        .err()
        .expect("a second client")
        .to_string();
    assert!(refused.contains(&twin.port), "{refused}");
    assert!(refused.contains("another program"), "{refused}");
    let test = executable()
        .args(["link", "test", &twin.port])
        .output()
        .unwrap();
    let errors = String::from_utf8_lossy(&test.stderr);
    assert_eq!(test.status.code(), Some(2), "{errors}");
    assert!(
        errors.contains(&twin.port) && errors.contains("another program"),
        "{errors}"
    );
    // The control raises the alarm, too.
    let mut lathe = BoardLathe::connect(&twin.port, LINE);
    assert!(
        lathe.run_until(TIME_LIMIT, |lathe| lathe.state == LinkState::Lost
            && !lathe.alarm_numbers().is_empty())
    );
    assert_eq!(lathe.alarm_numbers(), [601]);
    drop(first);
    assert!(PortIo::open(&config, Path::new(PROGRAM_FILE)).is_ok());
}

/// The dictionary of another board.
fn foreign_dictionary() -> Vec<u8> {
    let mut twin = KlipperTwin::new(KlipperHardware {
        has_reset_command: false,
        ..KlipperHardware::default()
    });
    let config = ron::from_str(TIMED).unwrap();
    let mut link = StepLink::open(
        config,
        &drives_from_parameters(&ControlParameters::default()),
        Duration::ZERO,
    );
    for ms in 1..5000 {
        twin.advance(1_000_000);
        let now = Duration::from_millis(ms);
        link.rx(&twin.read(), now);
        link.tick(now);
        let bytes = link.tx().to_vec();
        twin.write(&bytes);
        link.consumed(bytes.len());
        for event in link.events() {
            if let LinkEvent::Learned { packed, .. } = event {
                return packed;
            }
        }
    }
    panic!("the board says nothing");
}

/// Connects with these files in the folder of dictionaries. Returns the count of queries, and
/// the files afterwards.
fn connect_with_files(port: &str, files: &[(&str, &[u8])]) -> (usize, Vec<(String, Vec<u8>)>) {
    let folder = std::env::temp_dir().join(format!("gsk980td-boards-{}", std::process::id()));
    for _ in 0..ATTEMPTS {
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).unwrap();
        for (name, content) in files {
            std::fs::write(folder.join(name), content).unwrap();
        }
        let mut lathe = BoardLathe::connect_with_dictionaries(port, TIMED, Some(folder.clone()));
        let settled = [LinkState::Locked, LinkState::Fault, LinkState::Lost];
        lathe.run_until(TIME_LIMIT, |lathe| settled.contains(&lathe.state));
        if lathe.state == LinkState::Locked {
            let mut files_after: Vec<_> = std::fs::read_dir(&folder)
                .unwrap()
                .map(|entry| entry.unwrap().path())
                .map(|path| {
                    let name = path.file_name().unwrap().to_string_lossy().into_owned();
                    (name, std::fs::read(&path).unwrap())
                })
                .collect();
            files_after.sort();
            std::fs::remove_dir_all(&folder).unwrap();
            return (lathe.dictionary_queries, files_after);
        }
    }
    panic!("the board is never set up");
}

/// The dictionary that the board sends is used, whatever the stored files contain.
pub fn a_known_board_is_queried_little_and_no_file_is_trusted() {
    const MAX_QUERIES: usize = 3;
    let twin = TwinProcess::start(&["--firmware", "klipper"]);
    let (queries, files) = connect_with_files(&twin.port, &[]);
    assert!(queries > MAX_QUERIES, "{queries}");
    let [(name, good)] = &files[..] else {
        panic!("{files:?}");
    };
    assert!(name.ends_with(".dictionary"), "{name}");

    let (queries, files) = connect_with_files(&twin.port, &[(name, good)]);
    assert!((1..=MAX_QUERIES).contains(&queries), "{queries}");
    assert_eq!(files, [(name.clone(), good.clone())]);

    let mut damaged = good.clone();
    damaged[good.len() / 2] ^= 4;
    let long = [&good[..], &[0; 10]].concat();
    let foreign = foreign_dictionary();
    assert!(foreign != *good);
    for (what, content) in [
        // It begins and ends like the right one.
        ("a flipped bit", &damaged[..]),
        ("half of it", &good[..good.len() / 2]),
        ("more than it", &long),
        ("nothing", b""),
        ("another file", b"(protocol: StepQueue)"),
        ("that of another board", &foreign),
    ] {
        // The dictionary is queried again, and stored correctly.
        let (queries, files) = connect_with_files(&twin.port, &[(name, content)]);
        assert!(queries > MAX_QUERIES, "{what}: {queries}");
        assert_eq!(files, [(name.clone(), good.clone())], "{what}");
    }
    // The right file is found among others.
    let (queries, _) = connect_with_files(&twin.port, &[("a.dictionary", &foreign), (name, good)]);
    assert!((1..=MAX_QUERIES + 1).contains(&queries), "{queries}");
}
