//! The program ends without a stop command while a board moves: the process that holds the
//! port stops the board.
//!
//! `ROUNDS=20 cargo test -p gsk980td --test boards partner_gone` runs each test 20 times.

use std::io::{self, BufRead, BufReader, Read};
use std::path::PathBuf;
use std::process::{Child, Stdio};
use std::sync::{Condvar, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use crate::process::executable;
use crate::twin::{TwinProcess, send_signal};

/// Time limit of each wait on a busy computer, and attempts until a board moves.
const TIME_LIMIT: Duration = Duration::from_secs(120);
const ATTEMPTS: u32 = 20;
/// Time within which the board must receive the stop.
const STOPPED_WITHIN: Duration = Duration::from_secs(10);
/// Time for which the board moves before the fault.
const MOTION_BEFORE_FAULT: Duration = Duration::from_millis(500);
/// Position of the limit switch of Z that would stop the virtual board.
const LIMIT_POSITION: &str = "Z 8000 ";
/// Travel of the motion, mm. Without a stop it takes 50 s at the feed of the tests.
const TRAVEL_MM: &str = "500";

/// Number of these tests that may still start. Two run at a time: on a computer that is busy with
/// more boards a motion stops early, and has to be tried again.
static FREE_LANES: Mutex<u32> = Mutex::new(2);
static LANE_RELEASED: Condvar = Condvar::new();

/// One of the tests that run at a time; dropping it lets another one start.
struct TestLane;

impl Drop for TestLane {
    fn drop(&mut self) {
        *FREE_LANES.lock().unwrap_or_else(PoisonError::into_inner) += 1;
        LANE_RELEASED.notify_one();
    }
}

fn wait_for_lane() -> TestLane {
    let free = FREE_LANES.lock().unwrap_or_else(PoisonError::into_inner);
    let waited = LANE_RELEASED.wait_while(free, |free| *free == 0);
    *waited.unwrap_or_else(PoisonError::into_inner) -= 1;
    TestLane
}

fn rounds() -> u32 {
    std::env::var("ROUNDS").map_or(1, |rounds| rounds.parse().unwrap())
}

/// A process that is killed when it is dropped.
struct MovingProcess(Child);

impl Drop for MovingProcess {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Starts `link test`, which moves Z of a board. `None` if the computer was too busy.
fn start_motion(twin: &TwinProcess, case: &FirmwareCase) -> Option<MovingProcess> {
    let mut command = executable();
    command
        .args([
            "link", "test", &twin.port, "--travel", TRAVEL_MM, "--feed", "600",
        ])
        .args(["--param", "17=5", "--param", "18=5"])
        .args(case.options)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let mut running = MovingProcess(command.spawn().unwrap());
    let mut output = BufReader::new(running.0.stdout.take().unwrap()).lines();
    let has_answered =
        |line: &io::Result<String>| line.as_ref().is_ok_and(|it| it.contains("answers"));
    let _ = output.find(has_answered)?;
    // After its answers the board is unlocked, with two pauses of half a second, and moves.
    match case.motion_message {
        Some(motion_message) => drop(twin.wait_for_line(motion_message, TIME_LIMIT)?),
        None => {
            thread::sleep(Duration::from_secs(2));
            drop(twin.printed_lines());
        }
    }
    thread::sleep(MOTION_BEFORE_FAULT);
    let has_ended = running.0.try_wait().unwrap().is_some();
    // A board that has printed another line by now no longer moves.
    (!has_ended && twin.printed_lines().is_empty()).then_some(running)
}

/// Process id of the process that holds this port.
fn find_holder(port: &str) -> Option<u32> {
    let processes = std::fs::read_dir("/proc").unwrap().flatten();
    processes
        .filter_map(|entry| entry.file_name().to_str()?.parse().ok())
        .find(|process: &u32| {
            let line = std::fs::read_to_string(format!("/proc/{process}/cmdline"));
            line.is_ok_and(|line| line.contains("hold-port") && line.contains(port))
        })
}

fn wait_until(time_limit: Duration, is_met: impl Fn() -> bool) -> bool {
    let end = Instant::now() + time_limit;
    while Instant::now() < end {
        if is_met() {
            return true;
        }
        thread::sleep(Duration::from_millis(10));
    }
    is_met()
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
struct FirmwareCase<'a> {
    firmware: &'a str,
    options: &'a [&'a str],
    /// Options of the virtual board.
    twin: &'a [&'a str],
    /// Printed when the board starts to move; `None` if it prints nothing.
    motion_message: Option<&'a str>,
    /// Printed when the board receives the stop.
    stop_message: &'a str,
}

/// Lets something happen to the program while the board moves. Asserts that the board is
/// stopped long before the end of its motion, and that no process holds the port afterwards.
fn assert_board_stops(
    case: &FirmwareCase,
    fault_name: &str,
    cause_fault: impl Fn(&mut Child, u32),
) {
    let _lane = wait_for_lane();
    for round in 1..=rounds() {
        let context = format!("{} {fault_name}, round {round}", case.firmware);
        let moving = (0..ATTEMPTS).find_map(|_| {
            let twin = TwinProcess::start(&[&["--firmware", case.firmware], case.twin].concat());
            let running = start_motion(&twin, case)?;
            Some((twin, running))
        });
        let (twin, mut running) = moving.unwrap_or_else(|| panic!("{context}: never moves"));
        let holder_id =
            find_holder(&twin.port).unwrap_or_else(|| panic!("{context}: nobody holds it"));
        cause_fault(&mut running.0, holder_id);
        let start_time = Instant::now();
        let stop_line = twin.wait_for_line(case.stop_message, STOPPED_WITHIN);
        assert!(stop_line.is_some(), "{context}: not stopped");
        // The limit switch has not stopped it.
        let at_limit = stop_line
            .as_ref()
            .is_some_and(|line| line.contains(LIMIT_POSITION));
        assert!(!at_limit, "{context}: {stop_line:?}");
        eprintln!(
            "{context}: {:.0?}, {}",
            start_time.elapsed(),
            stop_line.unwrap_or_default()
        );
        let is_released = wait_until(TIME_LIMIT, || find_holder(&twin.port).is_none());
        assert!(is_released, "{context}: the port is still held");
    }
}

const LINE_BOARDS: [&str; 3] = ["grbl", "grblhal", "fluidnc"];

/// A board that executes lines.
const fn line_case(firmware: &str) -> FirmwareCase<'_> {
    FirmwareCase {
        firmware,
        options: &["--write-settings"],
        twin: &[],
        motion_message: Some("Run"),
        // The reset is sent in motion and at rest: on a busy computer the board may have run
        // out of motion.
        stop_message: "reset",
    }
}

fn assert_line_board_stops(
    firmware: &str,
    fault_name: &str,
    cause_fault: impl Fn(&mut Child, u32),
) {
    assert_board_stops(&line_case(firmware), fault_name, cause_fault);
}

fn kill_with(name: &'static str) -> impl Fn(&mut Child, u32) {
    move |program, _| {
        // The first SIGSEGV that no invalid access has caused is ignored.
        while program.try_wait().unwrap().is_none() {
            send_signal(name, program.id());
            thread::sleep(Duration::from_millis(20));
        }
    }
}

pub fn a_line_board_is_stopped_when_the_program_is_killed() {
    for firmware in LINE_BOARDS {
        assert_line_board_stops(firmware, "kill -9", kill_with("KILL"));
    }
}

pub fn a_board_at_a_network_address_is_stopped_when_the_program_is_killed() {
    let case = FirmwareCase {
        twin: &["--tcp", "127.0.0.1:0"],
        ..line_case("grbl")
    };
    assert_board_stops(&case, "over tcp, kill -9", kill_with("KILL"));
}

pub fn a_line_board_is_stopped_when_the_program_crashes() {
    for name in ["SEGV", "ABRT"] {
        assert_line_board_stops("grbl", name, kill_with(name));
    }
}

pub fn a_board_of_timed_steps_is_stopped_when_the_program_is_killed() {
    let machine = klipper_machine();
    let case = FirmwareCase {
        firmware: "klipper",
        options: &["--machine", machine.to_str().unwrap()],
        twin: &[],
        motion_message: None,
        // The stop command, not the timeout after a quarter of a second without messages.
        stop_message: "Command request",
    };
    assert_board_stops(&case, "kill -9", kill_with("KILL"));
    let _ = std::fs::remove_file(machine);
}

/// The process exists but is suspended, as if it waited for a missing disk. The bytes that stop
/// each firmware are those after a kill.
pub fn a_line_board_is_stopped_when_the_program_is_suspended() {
    assert_line_board_stops("grblhal", "stopped", |program, _| {
        send_signal("STOP", program.id());
    });
}

/// Signals to the session reach the holder, too. They do not end it before its work is done.
pub fn session_signals_do_not_end_the_holder() {
    assert_line_board_stops("grbl", "signals, then kill -9", |program, holder| {
        for name in ["INT", "TERM", "HUP", "QUIT", "PIPE"] {
            send_signal(name, holder);
        }
        kill_with("KILL")(program, holder);
    });
}

/// The program detects it, and another holder stops the board.
pub fn a_killed_holder_is_replaced_and_reported() {
    let _lane = wait_for_lane();
    for _ in 0..rounds() {
        let twin = TwinProcess::start(&[]);
        let start = || start_motion(&twin, &line_case("grbl"));
        let mut program = (0..ATTEMPTS).find_map(|_| start()).unwrap();
        let first_holder = find_holder(&twin.port).unwrap();
        send_signal("KILL", first_holder);
        let has_new_holder = || find_holder(&twin.port).is_some_and(|other| other != first_holder);
        assert!(
            wait_until(STOPPED_WITHIN, has_new_holder),
            "nobody stops the board"
        );
        let mut errors = String::new();
        let mut stderr = program.0.stderr.take().unwrap();
        stderr.read_to_string(&mut errors).unwrap();
        assert_eq!(program.0.wait().unwrap().code(), Some(1), "{errors}");
        assert!(errors.contains("605"), "{errors}");
        assert!(errors.contains("the port guard has ended"), "{errors}");
        assert!(wait_until(TIME_LIMIT, || find_holder(&twin.port).is_none()));
    }
}

/// A normal end leaves no process, not even a zombie.
pub fn a_normal_end_leaves_no_process() {
    let _lane = wait_for_lane();
    let twin = TwinProcess::start(&[]);
    let status = executable()
        .args(["link", "monitor", &twin.port, "--seconds", "2"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .unwrap();
    assert!(status.code().is_some());
    assert_eq!(find_holder(&twin.port), None);
}

pub fn a_holder_started_by_hand_explains_itself() {
    let output = executable()
        .args(["hold-port", "--baud", "115200", "/dev/null"])
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{errors}");
    assert!(errors.contains("automatically"), "{errors}");
}
