//! Tests at a real board with unpowered drives: `docs/real-lathe.md`, "First contact, motors
//! off".
//!
//! ```sh
//! DRIVE_LINK_PORT=/dev/ttyACM0 cargo test -p gsk980td --test hardware -- --ignored hw_
//! ```
//!
//! `DRIVE_LINK_MACHINE` names a machine file (pins, protocol, lookahead),
//! `DRIVE_LINK_DIVIDE` the denominators of the electronic gear (5), `DRIVE_LINK_ASK=1`
//! adds the tests that need an operator. The results are appended to `DRIVE_LINK_REPORT`, or
//! to `gsk980td-board.txt` in the folder of temporary files.

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

use gsk_core::memory::ControlParameters;
use gsk_core::units::{Axis, PerAxis, Pulses};
use gsk_host::board::BoardSession;
use gsk_host::files::time::format_utc;
use gsk_link::{FINE, LinkConfig, LinkEvent, LinkState, RunTime, Sample, Stop};

/// One test at a time uses the board.
static PORT: Mutex<()> = Mutex::new(());
/// Greatest speed of the moves, pulses/ms, and the time to reach it.
const MAX_PULSES_PER_MS: f64 = 8.0;
const RAMP_MS: f64 = 100.0;

fn environment_variable(name: &str) -> Option<String> {
    std::env::var(name).ok().filter(|value| !value.is_empty())
}

fn config() -> LinkConfig {
    let file = environment_variable("DRIVE_LINK_MACHINE");
    let mut config = file.map_or_else(LinkConfig::default, |file| {
        let text = std::fs::read_to_string(file).unwrap();
        let machine: gsk_core::machine::LatheConfig = ron::from_str(&text).unwrap();
        machine.link.expect("a section `link` in the machine file")
    });
    if let Some(port) = environment_variable("DRIVE_LINK_PORT") {
        config.port = port;
    }
    assert!(!config.port.is_empty(), "DRIVE_LINK_PORT names the board");
    config.check().unwrap();
    config
}

fn parameters() -> ControlParameters {
    let divide = environment_variable("DRIVE_LINK_DIVIDE").map_or(5, |text| text.parse().unwrap());
    let mut parameters = ControlParameters::default();
    for number in [17, 18] {
        parameters.set(number, divide).unwrap();
    }
    parameters
}

fn report(line: &str) {
    let path = environment_variable("DRIVE_LINK_REPORT").map_or_else(
        || std::env::temp_dir().join("gsk980td-board.txt"),
        PathBuf::from,
    );
    let mut file = OpenOptions::new()
        .create(true)
        .append(true)
        .open(path)
        .unwrap();
    writeln!(file, "{} {line}", format_utc(SystemTime::now())).unwrap();
    print_line(line);
}

/// Writes to standard error past the capture of the test runner.
fn print_line(line: &str) {
    let _ = writeln!(io::stderr(), "{line}");
}

/// Asks the operator for a manual action and waits for Enter. Returns false when no operator
/// is present.
fn wait_for_operator(instruction: &str) -> bool {
    if environment_variable("DRIVE_LINK_ASK").is_none() {
        print_line("left out: needs a hand (DRIVE_LINK_ASK=1)");
        return false;
    }
    print_line(&format!(">>> {instruction}, then press Enter"));
    let mut line = String::new();
    io::stdin().read_line(&mut line).unwrap();
    true
}

struct BoardBench {
    board: BoardSession,
    run_time: RunTime,
    target_pulses: [f64; 2],
    pulses_per_ms: f64,
    events: Vec<LinkEvent>,
    _port: MutexGuard<'static, ()>,
}

impl BoardBench {
    fn open() -> Self {
        let port = PORT
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        let board = BoardSession::open(
            config(),
            &parameters(),
            Path::new(env!("CARGO_BIN_EXE_gsk980td")),
        )
        .unwrap();
        let mut bench = Self {
            board,
            run_time: RunTime::ZERO,
            target_pulses: [0.0; 2],
            pulses_per_ms: 0.0,
            events: Vec::new(),
            _port: port,
        };
        bench.events = bench.board.wait_until_ready();
        bench
    }

    /// Opens the board, writes its settings, and sets its position to 0.
    fn open_ready() -> Self {
        let mut bench = Self::open();
        if bench.has_different_settings() {
            bench.board.link.write_settings();
            bench.wait_for_state(10, |state| state == LinkState::Locked);
        }
        assert_eq!(bench.state(), LinkState::Locked, "{:?}", bench.events);
        bench.run_for(500);
        bench.board.link.reset();
        bench.run_for(500);
        let at = PerAxis::default();
        bench.board.link.set_position(at, RunTime::ZERO).unwrap();
        bench.events.clear();
        bench
    }

    fn has_different_settings(&self) -> bool {
        let is_difference = |event: &LinkEvent| matches!(event, LinkEvent::Differs(_));
        self.events.iter().any(is_difference)
    }

    fn state(&self) -> LinkState {
        self.board.link.state()
    }

    fn run_for(&mut self, ms: u64) {
        let events = self
            .board
            .pump_until(Duration::from_millis(ms), |_, _| false);
        self.events.extend(events);
    }

    fn wait_for_state(&mut self, seconds: u64, is_met: impl Fn(LinkState) -> bool) -> bool {
        let limit = Duration::from_secs(seconds);
        let events = self.board.pump_until(limit, |link, _| is_met(link.state()));
        self.events.extend(events);
        is_met(self.state())
    }

    fn pulses(&self) -> PerAxis<Pulses> {
        let [x, z] = self.target_pulses.map(|at| Pulses(at.round() as i64));
        PerAxis::new(x, z)
    }

    /// Sends a tick of motion as soon as the board accepts one. Returns false if the motion
    /// has ended early.
    fn send_tick(&mut self) -> bool {
        while self.board.link.free_lookahead() == Duration::ZERO {
            let events = self.board.pump();
            self.events.extend(events);
            if !self.state().takes_motion() {
                return false;
            }
        }
        self.run_time += Duration::from_millis(1);
        let fine = self
            .target_pulses
            .map(|at| (at * FINE as f64).round() as i64);
        let sample = Sample {
            fine: PerAxis::new(fine[0], fine[1]),
            ..Sample::new(self.run_time, self.pulses())
        };
        self.board.link.push(sample).is_ok()
    }

    /// Moves an axis toward a position, with ramps, for at most `max_ms`.
    fn move_axis(&mut self, axis: Axis, position: f64, max_ms: u32) -> bool {
        let axis = usize::from(axis == Axis::Z);
        let step = MAX_PULSES_PER_MS / RAMP_MS;
        for _ in 0..max_ms {
            let distance_to_go = position - self.target_pulses[axis];
            if distance_to_go.abs() < 0.5 {
                self.target_pulses[axis] = position;
                self.pulses_per_ms = 0.0;
                return self.send_tick();
            }
            // The speed from which the axis can still brake within the distance to go.
            let max_speed = (2.0 * step * distance_to_go.abs())
                .sqrt()
                .clamp(step, MAX_PULSES_PER_MS);
            self.pulses_per_ms = (self.pulses_per_ms + step)
                .min(max_speed)
                .min(distance_to_go.abs());
            self.target_pulses[axis] += self.pulses_per_ms * distance_to_go.signum();
            if !self.send_tick() {
                return false;
            }
        }
        true
    }

    /// Brakes with the ramp, and waits until the axis stands.
    fn brake(&mut self, axis: Axis, direction: f64) -> bool {
        let axis = usize::from(axis == Axis::Z);
        while self.pulses_per_ms > 0.0 {
            self.pulses_per_ms = (self.pulses_per_ms - MAX_PULSES_PER_MS / RAMP_MS).max(0.0);
            self.target_pulses[axis] += self.pulses_per_ms * direction;
            if !self.send_tick() {
                return false;
            }
        }
        self.target_pulses[axis] = self.target_pulses[axis].round();
        self.send_tick() && self.wait_until_executed()
    }

    fn wait_until_executed(&mut self) -> bool {
        self.board.link.finish().is_ok()
            && self.wait_for_state(5, |state| state != LinkState::Moving)
    }

    /// Asserts that the board has counted the commanded pulses.
    #[track_caller]
    fn assert_counts_agree(&self) {
        assert_eq!(self.state(), LinkState::Ready, "{:?}", self.events);
        assert_eq!(self.board.link.counted(), Some(self.pulses()));
    }

    fn has_alarm(&self, wanted: u16) -> bool {
        let is_wanted = |event: &LinkEvent| matches!(event, LinkEvent::Alarm { number, .. } if *number == wanted);
        self.events.iter().any(is_wanted)
    }
}

#[test]
#[ignore = "needs a board"]
fn hw_1_identify() {
    let mut bench = BoardBench::open();
    let info = bench.board.link.board().clone();
    assert!(!info.firmware.is_empty(), "{:?}", bench.events);
    let mut trips = Vec::new();
    for _ in 0..30 {
        bench.run_for(100);
        trips.extend(bench.board.link.traffic().round_trip);
    }
    trips.sort_unstable();
    report(&format!(
        "board {}, {} blocks, {} bytes",
        info.firmware, info.blocks, info.receive_bytes
    ));
    // A board with different settings is not queried for reports.
    if let (Some(median), Some(worst)) = (trips.get(trips.len() / 2), trips.last()) {
        report(&format!("round trip {median:?}, worst {worst:?}"));
    }
}

#[test]
#[ignore = "needs a board, and writes its settings"]
fn hw_2_settings() {
    let bench = BoardBench::open_ready();
    drop(bench);
    let bench = BoardBench::open();
    assert!(!bench.has_different_settings(), "{:?}", bench.events);
    assert_eq!(bench.state(), LinkState::Locked);
    report("settings as they must be");
}

#[test]
#[ignore = "moves a board: drives without current"]
fn hw_3_ten_thousand_pulses_each_way() {
    let mut bench = BoardBench::open_ready();
    for (axis, position) in [
        (Axis::Z, -10_000.0),
        (Axis::Z, 0.0),
        (Axis::X, -10_000.0),
        (Axis::X, 0.0),
    ] {
        let (from, before) = (bench.board.now(), bench.board.link.traffic());
        let is_done = bench.move_axis(axis, position, 60_000) && bench.wait_until_executed();
        assert!(is_done, "{:?}", bench.events);
        bench.assert_counts_agree();
        let seconds = (bench.board.now() - from).as_secs_f64();
        let after = bench.board.link.traffic();
        report(&format!(
            "{axis:?} to {position}: agrees; {seconds:.2} s, {:.0} segments/s, {:.0} bytes/s",
            (after.segments - before.segments) as f64 / seconds,
            (after.sent - before.sent) as f64 / seconds
        ));
    }
}

#[test]
#[ignore = "moves a board: drives without current"]
fn hw_4_hold() {
    let mut bench = BoardBench::open_ready();
    let mut times = Vec::new();
    for hold in 0..10 {
        let direction = if hold % 2 == 0 { -1.0 } else { 1.0 };
        let is_done = bench.move_axis(Axis::Z, bench.target_pulses[1] + direction * 100_000.0, 600);
        assert!(is_done, "{:?}", bench.events);
        let pressed = bench.board.now();
        assert!(bench.brake(Axis::Z, direction), "{:?}", bench.events);
        bench.assert_counts_agree();
        let standing_since = bench.board.link.standing_since().unwrap();
        times.push(standing_since.saturating_sub(pressed).as_millis());
    }
    times.sort_unstable();
    let max_time_ms = config().lookahead().as_millis() + RAMP_MS as u128;
    report(&format!(
        "hold: {times:?} ms to standstill; lookahead and ramp are {max_time_ms} ms"
    ));
    assert!(times[5] <= max_time_ms * 6 / 5 + 50, "{times:?}");
}

#[test]
#[ignore = "moves a board: drives without current"]
fn hw_5_flush() {
    let mut bench = BoardBench::open_ready();
    for k in 0..5 {
        assert!(bench.move_axis(Axis::Z, bench.target_pulses[1] - 100_000.0, 300 + 100 * k));
        bench.board.link.stop(Stop::Flush);
        bench.events.clear();
        assert!(bench.wait_for_state(5, |state| matches!(
            state,
            LinkState::Ready | LinkState::Locked
        )));
        let reported = bench.events.iter().rev().find_map(|event| match event {
            LinkEvent::Position(pulses) => Some(*pulses),
            _ => None,
        });
        let position = reported.expect("the board says where it stands");
        report(&format!(
            "flush: stands at Z {}, {:?}",
            position.z.0,
            bench.state()
        ));
        bench.target_pulses = [position.x.0 as f64, position.z.0 as f64];
        bench.pulses_per_ms = 0.0;
        bench.run_for(300);
        bench
            .board
            .link
            .set_position(position, bench.run_time)
            .unwrap();
        bench.run_for(300);
        assert!(
            bench.move_axis(Axis::Z, bench.target_pulses[1] + 500.0, 5000)
                && bench.wait_until_executed()
        );
        bench.assert_counts_agree();
    }
}

/// The program is killed in motion. The board stops, and the next client finds it standing
/// with an unknown position.
#[test]
#[ignore = "moves a board: drives without current"]
fn hw_6_heartbeat() {
    let config = config();
    {
        let _ = BoardBench::open_ready();
    }
    let lock = PORT
        .lock()
        .unwrap_or_else(std::sync::PoisonError::into_inner);
    let mut test = Command::new(env!("CARGO_BIN_EXE_gsk980td"));
    test.args(["link", "test", "--travel", "60", "--feed", "600"]);
    test.args(["--param", "17=5", "--param", "18=5"]);
    if let Some(machine) = environment_variable("DRIVE_LINK_MACHINE") {
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
    let mut bench = BoardBench::open();
    if bench.state() != LinkState::Locked {
        bench.board.link.reset();
        bench.wait_for_state(10, |state| state == LinkState::Locked);
    }
    assert_eq!(bench.state(), LinkState::Locked, "{:?}", bench.events);
    assert!(!bench.board.link.knows_position());
    bench.run_for(1000);
    let counted = bench.board.link.counted();
    bench.run_for(2000);
    assert_eq!(bench.board.link.counted(), counted, "it moves on");
    report("killed in motion: stands, place unknown");
}

#[test]
#[ignore = "needs a board and a hand"]
fn hw_7_cable_pull() {
    let mut bench = BoardBench::open_ready();
    if !wait_for_operator(
        "Z is going to move for 20 s: pull the plug of the board in that time. Ready",
    ) {
        return;
    }
    assert!(
        !bench.move_axis(Axis::Z, -150_000.0, 20_000),
        "nobody pulled it"
    );
    bench.wait_for_state(3, |state| state == LinkState::Lost);
    assert!(bench.has_alarm(605), "{:?}", bench.events);
    assert!(!bench.board.link.knows_position());
    report("plug pulled in motion: 605, place unknown");
    drop(bench);
    wait_for_operator("Plug it in again");
    let bench = BoardBench::open();
    assert!(!bench.board.link.knows_position());
}

#[test]
#[ignore = "needs a board and a hand"]
fn hw_8_limit_by_hand() {
    let mut bench = BoardBench::open_ready();
    if !wait_for_operator("Z is going to move for 20 s: press its limit switch in that time. Ready")
    {
        return;
    }
    assert!(
        !bench.move_axis(Axis::Z, -150_000.0, 20_000),
        "nobody pressed it"
    );
    bench.wait_for_state(3, |state| state == LinkState::Tripped);
    bench.run_for(300);
    assert!(bench.has_alarm(622), "{:?}", bench.events);
    report(&format!(
        "limit of Z pressed in motion: 622, {:?}",
        bench.state()
    ));
}
