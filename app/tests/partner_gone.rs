//! The program ends without a stop command while a board moves: the process that holds the
//! port stops the board.
//!
//! `ROUNDS=20 cargo test -p gsk980td --test boards partner_gone` runs each test 20 times.

use std::io::{self, BufRead, BufReader, Read};
use std::path::PathBuf;
use std::process::{Child, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use crate::process::executable;
use crate::twin::{Twin, signal};

/// Time limit of each wait on a busy computer, and attempts until a board moves.
const LONGEST: Duration = Duration::from_secs(120);
const ATTEMPTS: u32 = 20;
/// Time within which the board must receive the stop.
const STOPPED_WITHIN: Duration = Duration::from_secs(10);
/// Time for which the board moves before the fault.
const IN_MOTION: Duration = Duration::from_millis(500);
/// Position of the limit switch of Z that would stop the virtual board.
const LIMIT: &str = "Z 8000 ";
/// Travel of the motion, mm. Without a stop it takes 50 s at the feed of the tests.
const WAY: &str = "500";

/// Runs one test at a time: on a computer that is busy with other boards a motion stops early.
static ALONE: Mutex<()> = Mutex::new(());

fn alone() -> MutexGuard<'static, ()> {
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}

fn rounds() -> u32 {
    std::env::var("ROUNDS").map_or(1, |rounds| rounds.parse().unwrap())
}

/// A process that is killed when it is dropped.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Starts `link test`, which moves Z of a board. `None` if the computer was too busy.
fn moves(twin: &Twin, case: &Case) -> Option<Running> {
    let mut command = executable();
    command
        .args(["link", "test", &twin.port, "--travel", WAY, "--feed", "600"])
        .args(["--param", "17=5", "--param", "18=5"])
        .args(case.options)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let mut running = Running(command.spawn().unwrap());
    let mut said = BufReader::new(running.0.stdout.take().unwrap()).lines();
    let answers = |line: &io::Result<String>| line.as_ref().is_ok_and(|it| it.contains("answers"));
    let _ = said.find(answers)?;
    // After its answers the board is unlocked, with two pauses of half a second, and moves.
    match case.begins {
        Some(begins) => drop(twin.says(begins, LONGEST)?),
        None => {
            thread::sleep(Duration::from_secs(2));
            drop(twin.has_said());
        }
    }
    thread::sleep(IN_MOTION);
    let ended = running.0.try_wait().unwrap().is_some();
    // A board that has printed another line by now no longer moves.
    (!ended && twin.has_said().is_empty()).then_some(running)
}

/// Process id of the process that holds this port.
fn holder(port: &str) -> Option<u32> {
    let processes = std::fs::read_dir("/proc").unwrap().flatten();
    processes
        .filter_map(|entry| entry.file_name().to_str()?.parse().ok())
        .find(|process: &u32| {
            let line = std::fs::read_to_string(format!("/proc/{process}/cmdline"));
            line.is_ok_and(|line| line.contains("hold-port") && line.contains(port))
        })
}

fn wait_until(longest: Duration, so: impl Fn() -> bool) -> bool {
    let end = Instant::now() + longest;
    while Instant::now() < end {
        if so() {
            return true;
        }
        thread::sleep(Duration::from_millis(10));
    }
    so()
}

/// The machine file that the virtual board with timed steps prints.
fn klipper_machine() -> PathBuf {
    let name = format!("gsk980td-{}-gone.ron", std::process::id());
    let path = std::env::temp_dir().join(name);
    let output = executable()
        .args(["link", "twin", "--firmware", "klipper", "--print-machine"])
        .output()
        .unwrap();
    std::fs::write(&path, output.stdout).unwrap();
    path
}

/// A firmware with its options and messages.
struct Case<'a> {
    firmware: &'a str,
    options: &'a [&'a str],
    /// Options of the virtual board.
    twin: &'a [&'a str],
    /// Printed when the board starts to move; `None` if it prints nothing.
    begins: Option<&'a str>,
    /// Printed when the board receives the stop.
    stops: &'a str,
}

/// Lets something happen to the program while the board moves. Asserts that the board is
/// stopped long before the end of its motion, and that no process holds the port afterwards.
fn is_stopped(case: &Case, what: &str, happens: impl Fn(&mut Child, u32)) {
    let _alone = alone();
    for round in 1..=rounds() {
        let place = format!("{} {what}, round {round}", case.firmware);
        let moving = (0..ATTEMPTS).find_map(|_| {
            let twin = Twin::play(&[&["--firmware", case.firmware], case.twin].concat());
            let running = moves(&twin, case)?;
            Some((twin, running))
        });
        let (twin, mut running) = moving.unwrap_or_else(|| panic!("{place}: never moves"));
        let held = holder(&twin.port).unwrap_or_else(|| panic!("{place}: nobody holds it"));
        happens(&mut running.0, held);
        let begun = Instant::now();
        let stopped = twin.says(case.stops, STOPPED_WITHIN);
        assert!(stopped.is_some(), "{place}: not stopped");
        // The limit switch has not stopped it.
        let at_limit = stopped.as_ref().is_some_and(|line| line.contains(LIMIT));
        assert!(!at_limit, "{place}: {stopped:?}");
        eprintln!(
            "{place}: {:.0?}, {}",
            begun.elapsed(),
            stopped.unwrap_or_default()
        );
        let freed = wait_until(LONGEST, || holder(&twin.port).is_none());
        assert!(freed, "{place}: the port is still held");
    }
}

const LINE_BOARDS: [&str; 3] = ["grbl", "grblhal", "fluidnc"];

/// A board that executes lines.
const fn line_case(firmware: &str) -> Case<'_> {
    Case {
        firmware,
        options: &["--write-settings"],
        twin: &[],
        begins: Some("Run"),
        // The reset is sent in motion and at rest: on a busy computer the board may have run
        // out of motion.
        stops: "reset",
    }
}

fn line_board(firmware: &str, what: &str, happens: impl Fn(&mut Child, u32)) {
    is_stopped(&line_case(firmware), what, happens);
}

fn ends_by(name: &'static str) -> impl Fn(&mut Child, u32) {
    move |program, _| {
        // The first SIGSEGV that no invalid access has caused is ignored.
        while program.try_wait().unwrap().is_none() {
            signal(name, program.id());
            thread::sleep(Duration::from_millis(20));
        }
    }
}

pub fn a_line_board_is_stopped_when_the_program_is_killed() {
    for firmware in LINE_BOARDS {
        line_board(firmware, "kill -9", ends_by("KILL"));
    }
}

pub fn a_board_at_a_network_address_is_stopped_when_the_program_is_killed() {
    let case = Case {
        twin: &["--tcp", "127.0.0.1:0"],
        ..line_case("grbl")
    };
    is_stopped(&case, "over tcp, kill -9", ends_by("KILL"));
}

pub fn a_line_board_is_stopped_when_the_program_breaks_down() {
    for name in ["SEGV", "ABRT"] {
        line_board("grbl", name, ends_by(name));
    }
}

pub fn a_board_of_timed_steps_is_stopped_when_the_program_is_killed() {
    let machine = klipper_machine();
    let case = Case {
        firmware: "klipper",
        options: &["--machine", machine.to_str().unwrap()],
        twin: &[],
        begins: None,
        // The stop command, not the timeout after a quarter of a second without messages.
        stops: "Command request",
    };
    is_stopped(&case, "kill -9", ends_by("KILL"));
    let _ = std::fs::remove_file(machine);
}

/// The process exists but is suspended, as if it waited for a missing disk.
pub fn a_line_board_is_stopped_when_the_program_stands_still() {
    for firmware in LINE_BOARDS {
        line_board(firmware, "stopped", |program, _| {
            signal("STOP", program.id());
        });
    }
}

/// Signals to the session reach the holder, too. They do not end it before its work is done.
pub fn the_holder_outlives_the_signals_of_the_session() {
    line_board("grbl", "signals, then kill -9", |program, holder| {
        for name in ["INT", "TERM", "HUP", "QUIT", "PIPE"] {
            signal(name, holder);
        }
        ends_by("KILL")(program, holder);
    });
}

/// The program detects it, and another holder stops the board.
pub fn when_the_holder_is_killed_another_one_stops_the_board_and_the_program_says_it() {
    let _alone = alone();
    for _ in 0..rounds() {
        let twin = Twin::play(&[]);
        let begins = || moves(&twin, &line_case("grbl"));
        let mut program = (0..ATTEMPTS).find_map(|_| begins()).unwrap();
        let held = holder(&twin.port).unwrap();
        signal("KILL", held);
        let another = || holder(&twin.port).is_some_and(|other| other != held);
        assert!(
            wait_until(STOPPED_WITHIN, another),
            "nobody stops the board"
        );
        let mut said = String::new();
        let mut complaints = program.0.stderr.take().unwrap();
        complaints.read_to_string(&mut said).unwrap();
        assert_eq!(program.0.wait().unwrap().code(), Some(1), "{said}");
        assert!(said.contains("605"), "{said}");
        assert!(
            said.contains("the process that holds the port has ended"),
            "{said}"
        );
        assert!(wait_until(LONGEST, || holder(&twin.port).is_none()));
    }
}

/// A normal end leaves no process, not even a zombie.
pub fn a_normal_end_leaves_no_process_behind() {
    let _alone = alone();
    let twin = Twin::play(&[]);
    let status = executable()
        .args(["link", "monitor", &twin.port, "--seconds", "2"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .unwrap();
    assert!(status.code().is_some());
    assert_eq!(holder(&twin.port), None);
}

pub fn whoever_starts_the_holder_by_hand_is_told_what_it_is() {
    let output = executable()
        .args(["hold-port", "--baud", "115200", "/dev/null"])
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("by itself"), "{said}");
}
