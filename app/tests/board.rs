//! The control and a board in two processes, wired by a pseudo terminal, in real time.
//!
//! Nothing here depends on how fast the computer is: a computer that was too busy is an
//! alarm of the control, and what the operator does then the tests do, too.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::process::executable;
use crate::twin::Twin;
use crossbeam::queue::ArrayQueue;
use gsk_app::carrier::{Carrier, Line};
use gsk_app::kernel::probe::Probe;
use gsk_app::kernel::{Command, Connection, Console, Kernel, LinkOrder, Opened, Storing};
use gsk_core::linked::drives;
use gsk_core::memory::Parameters;
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
/// So often a computer may be too busy, and so long anything may take.
const ATTEMPTS: u32 = 20;
const LONGEST: Duration = Duration::from_secs(120);

/// A control with a board.
struct Lathe {
    kernel: Kernel,
    console: Console,
    state: LinkState,
    differs: bool,
    /// The longest that the computer was away, as the link page shows it.
    away: Duration,
    /// The most questions for what the board understands that one view of the link
    /// has shown.
    asked: usize,
    log: PathBuf,
}

impl Lathe {
    fn at(port: &str, config: &str) -> Self {
        Self::with_boards(port, config, None)
    }

    /// `boards`: the folder with what boards met before said they understand.
    fn with_boards(port: &str, config: &str, boards: Option<PathBuf>) -> Self {
        let mut setup = Setup::delivered();
        for number in [17, 18] {
            setup.memory.parameters.set(number, 5).unwrap();
        }
        // A press of the axis key is enough for the whole return.
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
        // There is no display to be asked.
        console.watch.trust_window();
        kernel.connect(Connection {
            config,
            log: Some(log.clone()),
            boards,
            program: PROGRAM_FILE.into(),
        });
        Self {
            kernel,
            console,
            state: LinkState::Opening,
            differs: false,
            away: Duration::ZERO,
            asked: 0,
            log,
        }
    }

    fn alarms(&self) -> Vec<u16> {
        let alarms = self.kernel.emulator().simulation.cnc.alarms();
        alarms.iter().map(|alarm| alarm.number).collect()
    }

    fn log(&self) -> String {
        std::fs::read_to_string(&self.log).unwrap_or_default()
    }

    /// Lets time pass until something is so; whether it came to be.
    fn until(&mut self, longest: Duration, so: impl Fn(&Self) -> bool) -> bool {
        let begun = Instant::now();
        while begun.elapsed() < longest {
            self.kernel.run_linked();
            if let Some(view) = self.console.link.pop() {
                self.state = view.state;
                self.differs = !view.differences.is_empty();
                self.away = view.away.1;
                let asks = |line: &&Line| line.outward && line.text.contains("identify offset");
                self.asked = self.asked.max(view.exchanges.iter().filter(asks).count());
            }
            if so(self) {
                return true;
            }
        }
        false
    }

    fn gets(&mut self, state: LinkState) -> bool {
        self.until(LONGEST, |lathe| {
            lathe.state == state || !lathe.alarms().is_empty()
        }) && self.state == state
    }

    fn tap(&mut self, key: Key) {
        self.console.send(Command::Tap(key));
        let ticks = self.kernel.emulator().simulation.cnc.ticks();
        self.until(LONGEST, |lathe| {
            lathe.kernel.emulator().simulation.cnc.ticks() >= ticks + 300
        });
    }

    /// Connected, settings as they must be.
    fn opens(&mut self) -> bool {
        let known = |lathe: &Self| {
            matches!(
                lathe.state,
                LinkState::Locked | LinkState::Fault | LinkState::Lost
            )
        };
        self.until(LONGEST, |lathe| known(lathe) || lathe.differs);
        if self.differs {
            self.console.send(Command::Link(LinkOrder::WriteSettings));
            self.until(LONGEST, known);
        }
        self.tap(Key::Reset);
        self.state == LinkState::Locked
    }

    fn finds_its_reference(&mut self) -> bool {
        self.tap(Key::MachineZero);
        for (key, axis) in [(Key::XDown, Axis::X), (Key::ZRight, Axis::Z)] {
            let found = move |lathe: &Self| {
                let cnc = &lathe.kernel.emulator().simulation.cnc;
                *cnc.referenced().get(axis) || !cnc.alarms().is_empty()
            };
            if !found(self) {
                self.tap(key);
                self.until(LONGEST, found);
            }
        }
        self.gets(LinkState::Ready)
    }

    fn starts(&mut self) {
        self.console.send(Command::Open(Box::new(Opened {
            name: "seven.CNC".to_owned(),
            path: None,
            storing: Storing::RunOnly,
            program: Program::new(PROGRAM),
            subprograms: Vec::new(),
        })));
        self.tap(Key::Auto);
        self.tap(Key::CycleStart);
    }

    /// The program to its end, and its check in the log.
    fn works(&mut self) -> bool {
        self.starts();
        self.until(LONGEST, |lathe| {
            let over = lathe.kernel.emulator().simulation.cnc.run_state() == RunState::Reset
                && lathe.state == LinkState::Ready
                && lathe.log().contains("O0007");
            over || !lathe.alarms().is_empty()
        });
        self.alarms().is_empty() && self.state == LinkState::Ready
    }

    /// What the operator does after an alarm.
    fn begins_again(&mut self) {
        eprintln!("busy: {:?} {:?}", self.alarms(), self.state);
        self.console.send(Command::Link(LinkOrder::Reconnect));
        self.state = LinkState::Opening;
        self.tap(Key::Reset);
    }
}

/// Connect, reference return, a part, its check; then the plug is pulled in motion.
fn works_and_is_unplugged(firmware: &str, config: &str) {
    let mut twin = Twin::play(&["--firmware", firmware]);
    let mut lathe = Lathe::at(&twin.port, config);
    let made = (0..ATTEMPTS).any(|_| {
        let made = lathe.opens() && lathe.finds_its_reference() && lathe.works();
        if !made {
            lathe.begins_again();
        }
        made
    });
    assert!(made, "{:?} {:?}", lathe.alarms(), lathe.state);
    let log = lathe.log();
    let line = log.lines().find(|line| line.contains("O0007")).unwrap();
    let (_, counts) = line.split_once(" commanded ").unwrap();
    let (commanded, counted) = counts.split_once(" counted ").unwrap();
    assert_eq!(counted, format!("{commanded} agrees"), "{line}");

    lathe.starts();
    lathe.until(LONGEST, |lathe| {
        lathe.kernel.emulator().simulation.cnc.is_moving() || !lathe.alarms().is_empty()
    });
    twin.unplug();
    assert!(lathe.until(LONGEST, |lathe| lathe.state == LinkState::Lost));
    assert!(lathe.alarms().contains(&605), "{:?}", lathe.alarms());
    let cnc = &lathe.kernel.emulator().simulation.cnc;
    assert!(!cnc.referenced().x && !cnc.is_moving());
    // RESET asks for the port again: it is not there, and says so.
    lathe.tap(Key::Reset);
    lathe.until(Duration::from_secs(1), |_| false);
    let alarms = lathe.kernel.emulator().simulation.cnc.alarms();
    let told = alarms
        .iter()
        .find(|alarm| matches!(alarm.number, 601 | 605))
        .map(gsk_core::alarm::Alarm::detail_en)
        .unwrap_or_default();
    assert!(told.contains(&twin.port), "{alarms:?}");
    let _ = std::fs::remove_file(&lathe.log);
}

pub fn a_line_board_in_another_process_makes_a_part_and_is_unplugged() {
    works_and_is_unplugged("grbl", LINE);
}

pub fn a_board_of_timed_steps_in_another_process_makes_a_part_and_is_unplugged() {
    works_and_is_unplugged("klipper", TIMED);
}

/// The simulated slides and spindle beside a board are not the ones that move.
pub fn the_scope_shows_what_is_known_of_the_real_lathe() {
    let mut lathe = Lathe::at("/nowhere/at/all", TIMED);
    let queue = Arc::new(ArrayQueue::new(10));
    lathe.console.send(Command::Probe(Some(Probe {
        queue: Arc::clone(&queue),
        bits: Vec::new(),
    })));
    assert!(lathe.until(LONGEST, |_| queue.is_full()));
    let sample = queue.pop().unwrap();
    assert_eq!(sample.actual, sample.commanded);
    assert_eq!((sample.following, sample.spindle), (None, None));
}

/// A computer that did something else is shown, before it does harm.
pub fn the_link_page_is_told_how_long_the_computer_was_away() {
    const AWAY: Duration = Duration::from_millis(150);
    let twin = Twin::play(&[]);
    let mut lathe = Lathe::at(&twin.port, LINE);
    assert!((0..ATTEMPTS).any(|_| {
        let opens = lathe.opens();
        if !opens {
            lathe.begins_again();
        }
        opens
    }));
    let before = lathe.away;
    std::thread::sleep(before + AWAY);
    assert!(lathe.until(LONGEST, |lathe| lathe.away >= before + AWAY));
    let _ = std::fs::remove_file(&lathe.log);
}

/// One client has the board: the next one is told, whoever it is.
pub fn a_port_in_use_is_refused_with_its_name() {
    let twin = Twin::play(&[]);
    let config = LinkConfig {
        port: twin.port.clone(),
        ..LinkConfig::default()
    };
    let first = Carrier::open(&config, Path::new(PROGRAM_FILE)).unwrap();
    let refused = Carrier::open(&config, Path::new(PROGRAM_FILE))
        .err()
        .expect("a second client")
        .to_string();
    assert!(refused.contains(&twin.port), "{refused}");
    assert!(refused.contains("another program"), "{refused}");
    let test = executable()
        .args(["link", "test", &twin.port])
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&test.stderr);
    assert_eq!(test.status.code(), Some(2), "{said}");
    assert!(
        said.contains(&twin.port) && said.contains("another program"),
        "{said}"
    );
    // The panel says it, too.
    let mut lathe = Lathe::at(&twin.port, LINE);
    assert!(lathe.until(LONGEST, |lathe| lathe.state == LinkState::Lost
        && !lathe.alarms().is_empty()));
    assert_eq!(lathe.alarms(), [601]);
    drop(first);
    assert!(Carrier::open(&config, Path::new(PROGRAM_FILE)).is_ok());
}

/// What another board says it understands.
fn foreign() -> Vec<u8> {
    let mut twin = KlipperTwin::new(KlipperHardware {
        has_reset_command: false,
        ..KlipperHardware::default()
    });
    let config = ron::from_str(TIMED).unwrap();
    let mut link = StepLink::open(config, &drives(&Parameters::default()), Duration::ZERO);
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

/// A connection with these files in the folder of the boards: how much was asked, and
/// the files afterwards.
fn meets(port: &str, files: &[(&str, &[u8])]) -> (usize, Vec<(String, Vec<u8>)>) {
    let folder = std::env::temp_dir().join(format!("gsk980td-boards-{}", std::process::id()));
    for _ in 0..ATTEMPTS {
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).unwrap();
        for (name, content) in files {
            std::fs::write(folder.join(name), content).unwrap();
        }
        let mut lathe = Lathe::with_boards(port, TIMED, Some(folder.clone()));
        let over = [LinkState::Locked, LinkState::Fault, LinkState::Lost];
        lathe.until(LONGEST, |lathe| over.contains(&lathe.state));
        if lathe.state == LinkState::Locked {
            let mut found: Vec<_> = std::fs::read_dir(&folder)
                .unwrap()
                .map(|entry| entry.unwrap().path())
                .map(|path| {
                    let name = path.file_name().unwrap().to_string_lossy().into_owned();
                    (name, std::fs::read(&path).unwrap())
                })
                .collect();
            found.sort();
            std::fs::remove_dir_all(&folder).unwrap();
            return (lathe.asked, found);
        }
    }
    panic!("the board is never set up");
}

/// Whatever lies in the folder: the board understands what it says it does.
pub fn a_board_met_before_is_asked_little_and_no_file_is_trusted() {
    const FEW: usize = 3;
    let twin = Twin::play(&["--firmware", "klipper"]);
    let (asked, files) = meets(&twin.port, &[]);
    assert!(asked > FEW, "{asked}");
    let [(name, good)] = &files[..] else {
        panic!("{files:?}");
    };
    assert!(name.ends_with(".dictionary"), "{name}");

    let (asked, files) = meets(&twin.port, &[(name, good)]);
    assert!((1..=FEW).contains(&asked), "{asked}");
    assert_eq!(files, [(name.clone(), good.clone())]);

    let mut damaged = good.clone();
    damaged[good.len() / 2] ^= 4;
    let long = [&good[..], &[0; 10]].concat();
    let foreign = foreign();
    assert!(foreign != *good);
    for (what, content) in [
        // It begins and ends as the right one.
        ("a flipped bit", &damaged[..]),
        ("half of it", &good[..good.len() / 2]),
        ("more than it", &long),
        ("nothing", b""),
        ("another file", b"(protocol: StepQueue)"),
        ("that of another board", &foreign),
    ] {
        // Asked anew, and right from then on.
        let (asked, files) = meets(&twin.port, &[(name, content)]);
        assert!(asked > FEW, "{what}: {asked}");
        assert_eq!(files, [(name.clone(), good.clone())], "{what}");
    }
    // Beside others the right one is found.
    let (asked, _) = meets(&twin.port, &[("a.dictionary", &foreign), (name, good)]);
    assert!((1..=FEW + 1).contains(&asked), "{asked}");
}
