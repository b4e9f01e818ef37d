//! A real board, its drives without current: `docs/real-lathe.md`, "First contact, motors off".
//!
//! ```sh
//! DRIVE_LINK_PORT=/dev/ttyACM0 cargo test -p gsk980td --test hardware -- --ignored hw_
//! ```
//!
//! `DRIVE_LINK_MACHINE` names a machine file (pins, protocol, lookahead),
//! `DRIVE_LINK_DIVIDE` the denominators of the electronic gear (5), `DRIVE_LINK_ASK=1`
//! adds what needs a hand. What was found is appended to `DRIVE_LINK_REPORT`, or to
//! `gsk980td-board.txt` in the folder of temporary files.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "tests fail by panicking"
)]

use std::fs::OpenOptions;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::{Mutex, MutexGuard};
use std::time::{Duration, SystemTime};

use gsk_app::board::Board;
use gsk_app::files::time::utc;
use gsk_core::memory::Parameters;
use gsk_core::units::{Axis, PerAxis, Pulses};
use gsk_link::{FINE, LinkConfig, LinkEvent, LinkState, RunTime, Sample, Stop};

/// One board, one test at a time.
static PORT: Mutex<()> = Mutex::new(());
/// Fastest speed of the moves, pulses a ms, and the time to reach it.
const SPEED: f64 = 8.0;
const RAMP_MS: f64 = 100.0;

fn variable(name: &str) -> Option<String> {
    std::env::var(name).ok().filter(|value| !value.is_empty())
}

fn config() -> LinkConfig {
    let file = variable("DRIVE_LINK_MACHINE");
    let mut config = file.map_or_else(LinkConfig::default, |file| {
        let text = std::fs::read_to_string(file).unwrap();
        let machine: gsk_core::machine::LatheConfig = ron::from_str(&text).unwrap();
        machine.link.expect("a section `link` in the machine file")
    });
    if let Some(port) = variable("DRIVE_LINK_PORT") {
        config.port = port;
    }
    assert!(!config.port.is_empty(), "DRIVE_LINK_PORT names the board");
    config.check().unwrap();
    config
}

fn parameters() -> Parameters {
    let divide = variable("DRIVE_LINK_DIVIDE").map_or(5, |text| text.parse().unwrap());
    let mut parameters = Parameters::default();
    for number in [17, 18] {
        parameters.set(number, divide).unwrap();
    }
    parameters
}

fn report(line: &str) {
    let path = variable("DRIVE_LINK_REPORT").map_or_else(
        || std::env::temp_dir().join("gsk980td-board.txt"),
        PathBuf::from,
    );
    let mut file = OpenOptions::new()
        .create(true)
        .append(true)
        .open(path)
        .unwrap();
    writeln!(file, "{} {line}", utc(SystemTime::now())).unwrap();
    say(line);
}

/// Past what the test runner catches.
fn say(line: &str) {
    let _ = writeln!(io::stderr(), "{line}");
}

/// Asks for a hand; false: nobody is there.
fn asks(what: &str) -> bool {
    if variable("DRIVE_LINK_ASK").is_none() {
        say("left out: needs a hand (DRIVE_LINK_ASK=1)");
        return false;
    }
    say(&format!(">>> {what}, then press Enter"));
    let mut line = String::new();
    io::stdin().read_line(&mut line).unwrap();
    true
}

struct Bench {
    board: Board,
    run: RunTime,
    at: [f64; 2],
    speed: f64,
    events: Vec<LinkEvent>,
    _port: MutexGuard<'static, ()>,
}

impl Bench {
    fn open() -> Self {
        let port = PORT
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        let board = Board::open(
            config(),
            &parameters(),
            Path::new(env!("CARGO_BIN_EXE_gsk980td")),
        )
        .unwrap();
        let mut bench = Self {
            board,
            run: RunTime::ZERO,
            at: [0.0; 2],
            speed: 0.0,
            events: Vec::new(),
            _port: port,
        };
        bench.events = bench.board.get_known();
        bench
    }

    /// Set up, and taken to stand at 0.
    fn ready() -> Self {
        let mut bench = Self::open();
        if bench.differs() {
            bench.board.link.write_settings();
            bench.waits(10, |state| state == LinkState::Locked);
        }
        assert_eq!(bench.state(), LinkState::Locked, "{:?}", bench.events);
        bench.passes(500);
        bench.board.link.reset();
        bench.passes(500);
        let at = PerAxis::default();
        bench.board.link.set_position(at, RunTime::ZERO).unwrap();
        bench.events.clear();
        bench
    }

    fn differs(&self) -> bool {
        let differs = |event: &LinkEvent| matches!(event, LinkEvent::Differs(_));
        self.events.iter().any(differs)
    }

    fn state(&self) -> LinkState {
        self.board.link.state()
    }

    fn passes(&mut self, ms: u64) {
        let events = self.board.wait(Duration::from_millis(ms), |_, _| false);
        self.events.extend(events);
    }

    fn waits(&mut self, seconds: u64, so: impl Fn(LinkState) -> bool) -> bool {
        let limit = Duration::from_secs(seconds);
        let events = self.board.wait(limit, |link, _| so(link.state()));
        self.events.extend(events);
        so(self.state())
    }

    fn pulses(&self) -> PerAxis<Pulses> {
        let [x, z] = self.at.map(|at| Pulses(at.round() as i64));
        PerAxis::new(x, z)
    }

    /// A tick of motion, as soon as there is room; false when it broke off.
    fn tick(&mut self) -> bool {
        while self.board.link.free_lookahead() == Duration::ZERO {
            let events = self.board.pump();
            self.events.extend(events);
            if !self.state().takes_motion() {
                return false;
            }
        }
        self.run += Duration::from_millis(1);
        let fine = self.at.map(|at| (at * FINE as f64).round() as i64);
        let sample = Sample {
            fine: PerAxis::new(fine[0], fine[1]),
            ..Sample::new(self.run, self.pulses())
        };
        self.board.link.push(sample).is_ok()
    }

    /// The axis toward a place with ramps, for so many ms at the most.
    fn goes(&mut self, axis: Axis, place: f64, most_ms: u32) -> bool {
        let axis = usize::from(axis == Axis::Z);
        let step = SPEED / RAMP_MS;
        for _ in 0..most_ms {
            let left = place - self.at[axis];
            if left.abs() < 0.5 {
                self.at[axis] = place;
                self.speed = 0.0;
                return self.tick();
            }
            // Braking from this speed takes so long a way.
            let most = (2.0 * step * left.abs()).sqrt().clamp(step, SPEED);
            self.speed = (self.speed + step).min(most).min(left.abs());
            self.at[axis] += self.speed * left.signum();
            if !self.tick() {
                return false;
            }
        }
        true
    }

    /// Brakes with the ramp to rest, and waits for it.
    fn stands(&mut self, axis: Axis, way: f64) -> bool {
        let axis = usize::from(axis == Axis::Z);
        while self.speed > 0.0 {
            self.speed = (self.speed - SPEED / RAMP_MS).max(0.0);
            self.at[axis] += self.speed * way;
            if !self.tick() {
                return false;
            }
        }
        self.at[axis] = self.at[axis].round();
        self.tick() && self.drains()
    }

    fn drains(&mut self) -> bool {
        self.board.link.finish().is_ok() && self.waits(5, |state| state != LinkState::Moving)
    }

    /// The board stands where it was told to, by its own count.
    #[track_caller]
    fn agrees(&self) {
        assert_eq!(self.state(), LinkState::Ready, "{:?}", self.events);
        assert_eq!(self.board.link.counted(), Some(self.pulses()));
    }

    fn has_alarm(&self, wanted: u16) -> bool {
        let is = |event: &LinkEvent| matches!(event, LinkEvent::Alarm { number, .. } if *number == wanted);
        self.events.iter().any(is)
    }
}

#[test]
#[ignore = "needs a board"]
fn hw_1_identify() {
    let mut bench = Bench::open();
    let info = bench.board.link.board().clone();
    assert!(!info.firmware.is_empty(), "{:?}", bench.events);
    let mut trips = Vec::new();
    for _ in 0..30 {
        bench.passes(100);
        trips.extend(bench.board.link.traffic().round_trip);
    }
    trips.sort_unstable();
    report(&format!(
        "board {}, {} blocks, {} bytes",
        info.firmware, info.blocks, info.receive_bytes
    ));
    // A board whose settings differ is not asked for reports.
    if let (Some(median), Some(worst)) = (trips.get(trips.len() / 2), trips.last()) {
        report(&format!("round trip {median:?}, worst {worst:?}"));
    }
}

#[test]
#[ignore = "needs a board, and writes its settings"]
fn hw_2_settings() {
    let bench = Bench::ready();
    drop(bench);
    let bench = Bench::open();
    assert!(!bench.differs(), "{:?}", bench.events);
    assert_eq!(bench.state(), LinkState::Locked);
    report("settings as they must be");
}

#[test]
#[ignore = "moves a board: drives without current"]
fn hw_3_ten_thousand_pulses_each_way() {
    let mut bench = Bench::ready();
    for (axis, place) in [
        (Axis::Z, -10_000.0),
        (Axis::Z, 0.0),
        (Axis::X, -10_000.0),
        (Axis::X, 0.0),
    ] {
        let (from, before) = (bench.board.now(), bench.board.link.traffic());
        let made = bench.goes(axis, place, 60_000) && bench.drains();
        assert!(made, "{:?}", bench.events);
        bench.agrees();
        let seconds = (bench.board.now() - from).as_secs_f64();
        let after = bench.board.link.traffic();
        report(&format!(
            "{axis:?} to {place}: agrees; {seconds:.2} s, {:.0} segments/s, {:.0} bytes/s",
            (after.segments - before.segments) as f64 / seconds,
            (after.sent - before.sent) as f64 / seconds
        ));
    }
}

#[test]
#[ignore = "moves a board: drives without current"]
fn hw_4_hold() {
    let mut bench = Bench::ready();
    let mut times = Vec::new();
    for hold in 0..10 {
        let way = if hold % 2 == 0 { -1.0 } else { 1.0 };
        let goes = bench.goes(Axis::Z, bench.at[1] + way * 100_000.0, 600);
        assert!(goes, "{:?}", bench.events);
        let pressed = bench.board.now();
        assert!(bench.stands(Axis::Z, way), "{:?}", bench.events);
        bench.agrees();
        let stood = bench.board.link.standing_since().unwrap();
        times.push(stood.saturating_sub(pressed).as_millis());
    }
    times.sort_unstable();
    let most = config().lookahead().as_millis() + RAMP_MS as u128;
    report(&format!(
        "hold: {times:?} ms to standstill; lookahead and ramp are {most} ms"
    ));
    assert!(times[5] <= most * 6 / 5 + 50, "{times:?}");
}

#[test]
#[ignore = "moves a board: drives without current"]
fn hw_5_flush() {
    let mut bench = Bench::ready();
    for k in 0..5 {
        assert!(bench.goes(Axis::Z, bench.at[1] - 100_000.0, 300 + 100 * k));
        bench.board.link.stop(Stop::Flush);
        bench.events.clear();
        assert!(bench.waits(5, |state| matches!(
            state,
            LinkState::Ready | LinkState::Locked
        )));
        let told = bench.events.iter().rev().find_map(|event| match event {
            LinkEvent::Position(pulses) => Some(*pulses),
            _ => None,
        });
        let at = told.expect("the board says where it stands");
        report(&format!(
            "flush: stands at Z {}, {:?}",
            at.z.0,
            bench.state()
        ));
        bench.at = [at.x.0 as f64, at.z.0 as f64];
        bench.speed = 0.0;
        bench.passes(300);
        bench.board.link.set_position(at, bench.run).unwrap();
        bench.passes(300);
        assert!(bench.goes(Axis::Z, bench.at[1] + 500.0, 5000) && bench.drains());
        bench.agrees();
    }
}

/// The program dies in motion: the board stops, and whoever comes next finds it
/// standing, its place unknown.
#[test]
#[ignore = "moves a board: drives without current"]
fn hw_6_heartbeat() {
    let config = config();
    {
        let _ = Bench::ready();
    }
    let lock = PORT
        .lock()
        .unwrap_or_else(std::sync::PoisonError::into_inner);
    let mut test = Command::new(env!("CARGO_BIN_EXE_gsk980td"));
    test.args(["link", "test", "--travel", "60", "--feed", "600"]);
    test.args(["--param", "17=5", "--param", "18=5"]);
    if let Some(machine) = variable("DRIVE_LINK_MACHINE") {
        test.args(["--machine", &machine]);
    }
    let mut child = test
        .arg(&config.port)
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    std::thread::sleep(Duration::from_secs(12));
    child.kill().unwrap();
    child.wait().unwrap();
    drop(lock);
    let mut bench = Bench::open();
    if bench.state() != LinkState::Locked {
        bench.board.link.reset();
        bench.waits(10, |state| state == LinkState::Locked);
    }
    assert_eq!(bench.state(), LinkState::Locked, "{:?}", bench.events);
    assert!(!bench.board.link.knows_position());
    bench.passes(1000);
    let stood = bench.board.link.counted();
    bench.passes(2000);
    assert_eq!(bench.board.link.counted(), stood, "it moves on");
    report("killed in motion: stands, place unknown");
}

#[test]
#[ignore = "needs a board and a hand"]
fn hw_7_cable_pull() {
    let mut bench = Bench::ready();
    if !asks("Z is going to move for 20 s: pull the plug of the board in that time. Ready") {
        return;
    }
    assert!(!bench.goes(Axis::Z, -150_000.0, 20_000), "nobody pulled it");
    bench.waits(3, |state| state == LinkState::Lost);
    assert!(bench.has_alarm(605), "{:?}", bench.events);
    assert!(!bench.board.link.knows_position());
    report("plug pulled in motion: 605, place unknown");
    drop(bench);
    asks("Plug it in again");
    let bench = Bench::open();
    assert!(!bench.board.link.knows_position());
}

#[test]
#[ignore = "needs a board and a hand"]
fn hw_8_limit_by_hand() {
    let mut bench = Bench::ready();
    if !asks("Z is going to move for 20 s: press its limit switch in that time. Ready") {
        return;
    }
    assert!(
        !bench.goes(Axis::Z, -150_000.0, 20_000),
        "nobody pressed it"
    );
    bench.waits(3, |state| state == LinkState::Tripped);
    bench.passes(300);
    assert!(bench.has_alarm(622), "{:?}", bench.events);
    report(&format!(
        "limit of Z pressed in motion: 622, {:?}",
        bench.state()
    ));
}
