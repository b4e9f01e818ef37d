//! `run --link`: a program at a board, without a window.

use std::fs::File;
use std::io::{BufRead, BufReader, Write};
use std::process::{Output, Stdio};
use std::time::Duration;

use crate::at_board::{ATTEMPTS, BoardFolder, gsk_command};
use crate::twin::send_signal;
use serde_json::Value;
use serialport::{SerialPort, TTYPort};

const TIME_LIMIT: Duration = Duration::from_secs(120);
const PART: &str = "O0007\nG50 X60 Z20\nG98 G00 X50 Z10\nG01 Z5 F600\nM30\n";
const WITH_STOP: &str = "O0007\nG50 X60 Z20\nG98 G00 X50 Z10\nM00\nG01 Z5 F600\nM30\n";
const LONG: &str = "O0007\nG50 X60 Z20\nG98 G01 Z-20 F60\nM30\n";

/// Pulses from machine zero to X50 Z10 and to X50 Z5; 200 pulses per mm of X and Z.
const BEFORE_STOP: &str = "commanded X -2000 Z -2000 counted X -2000 Z -2000 agrees";
const AT_END: &str = "commanded X -2000 Z -3000 counted X -2000 Z -3000 agrees";

fn part_folder(name: &str, firmware: &'static str, program: &str) -> BoardFolder {
    BoardFolder::new(name, firmware, &[("part.CNC", program)])
}

fn report(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_default()
}

fn all_output(output: &Output) -> String {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    text(&output.stdout) + &text(&output.stderr)
}

/// Repeats the run until it reaches this end; a busy computer may end it earlier.
#[track_caller]
fn run_until_end(end: &str, folder: &BoardFolder, arguments: &[&str]) -> Output {
    let mut last_output = String::new();
    for _ in 0..ATTEMPTS {
        let twin = folder.start_board();
        let run = [&["run", "--json", "--home"], arguments].concat();
        let output = folder.command_at(&twin, &run).stdin(Stdio::null()).output();
        let output = output.unwrap();
        if report(&output)["end"] == end {
            return output;
        }
        last_output = all_output(&output);
    }
    panic!("never {end}: {last_output}");
}

pub fn a_program_runs_to_its_end_and_the_pulses_agree() {
    let folder = part_folder("run-part", "grbl", PART);
    let output = run_until_end("M30", &folder, &[&folder.path("part.CNC")]);
    assert_eq!(output.status.code(), Some(0), "{}", all_output(&output));
    let line = folder.last_count();
    assert!(line.ends_with(AT_END), "{line}");
}

pub fn a_step_board_runs_a_program_to_its_end() {
    let folder = part_folder("run-timed", "klipper", PART);
    let output = run_until_end("M30", &folder, &[&folder.path("part.CNC")]);
    assert_eq!(output.status.code(), Some(0), "{}", all_output(&output));
    let line = folder.last_count();
    assert!(line.ends_with("agrees"), "{line}");
}

pub fn a_dnc_program_runs_to_its_end() {
    let folder = part_folder("run-dnc", "grbl", PART);
    let output = run_until_end("M30", &folder, &["--dnc", &folder.path("part.CNC")]);
    assert_eq!(output.status.code(), Some(0), "{}", all_output(&output));
    let line = folder.last_count();
    assert!(line.ends_with(AT_END), "{line}");
}

pub fn m00_ends_a_run_without_an_operator() {
    let folder = part_folder("run-stop", "grbl", WITH_STOP);
    let output = run_until_end("stop", &folder, &[&folder.path("part.CNC")]);
    assert_eq!(output.status.code(), Some(1), "{}", all_output(&output));
    let report = report(&output);
    assert_eq!(report["waits_for"], "cycle start at M00 in line 4");
    assert_eq!(report["stops"], 0);
    let line = folder.last_count();
    assert!(line.ends_with(BEFORE_STOP), "{line}");
}

/// Runs at a terminal. Types the next text of `typed` at each question.
fn run_at_terminal(
    folder: &BoardFolder,
    arguments: &[&str],
    typed: &[&str],
) -> (Option<i32>, String) {
    let twin = folder.start_board();
    let (mut keys, slave) = TTYPort::pair().unwrap();
    let terminal = File::open(slave.name().unwrap()).unwrap();
    let part = folder.path("part.CNC");
    let run = [&["run", &part, "--home"], arguments].concat();
    let mut run = folder.command_at(&twin, &run);
    let run = run.stdin(terminal).stdout(Stdio::null());
    let mut run = run.stderr(Stdio::piped()).spawn().unwrap();
    // Enter before the question has no effect.
    keys.write_all(b"\n").unwrap();
    let mut typed = typed.iter();
    let mut questions = String::new();
    for line in BufReader::new(run.stderr.take().unwrap()).lines() {
        let line = line.unwrap();
        if line.contains("press Enter")
            && let Some(typed) = typed.next()
        {
            keys.write_all(typed.as_bytes()).unwrap();
        }
        questions.push_str(&line);
        questions.push('\n');
    }
    (run.wait().unwrap().code(), questions)
}

pub fn enter_at_the_terminal_continues_after_m00() {
    let folder = part_folder("run-enter", "grbl", WITH_STOP);
    let mut last_output = String::new();
    let is_done = (0..ATTEMPTS).any(|_| {
        let (code, output) = run_at_terminal(&folder, &[], &["no\n", "\n"]);
        last_output = output;
        code == Some(0)
    });
    assert!(is_done, "{last_output}");
    let question = "M00 in line 4: press Enter to continue, Ctrl-C to stop";
    assert_eq!(last_output.matches(question).count(), 2, "{last_output}");
    let line = folder.last_count();
    assert!(line.ends_with(AT_END), "{line}");
}

pub fn the_operator_confirms_each_further_part() {
    let folder = part_folder("run-parts", "grbl", PART);
    let mut last_output = String::new();
    let is_done = (0..ATTEMPTS).any(|_| {
        let (code, output) = run_at_terminal(&folder, &["--parts", "2"], &["\n"]);
        last_output = output;
        code == Some(0)
    });
    assert!(is_done, "{last_output}");
    assert_eq!(
        last_output.matches("part 1 of 2 is finished").count(),
        1,
        "{last_output}"
    );
}

pub fn a_signal_stops_the_board_in_motion() {
    let folder = part_folder("run-signal", "grbl", LONG);
    let is_stopped = (0..ATTEMPTS).any(|_| {
        let twin = folder.start_board();
        let run = ["run", &folder.path("part.CNC"), "--home", "--json"];
        let mut run = folder.command_at(&twin, &run);
        let run = run.stdin(Stdio::null()).stdout(Stdio::piped());
        let run = run.stderr(Stdio::null()).spawn().unwrap();
        // The reference return comes first, then the program.
        let has_homed = twin.wait_for_line("Home", TIME_LIMIT).is_some();
        let has_moved = has_homed && twin.wait_for_line("Run", Duration::from_secs(20)).is_some();
        send_signal(if has_moved { "TERM" } else { "KILL" }, run.id());
        let output = run.wait_with_output().unwrap();
        if !has_moved || report(&output)["end"] == "alarm" {
            return false;
        }
        let reset = twin.wait_for_line("reset", TIME_LIMIT).expect("stopped");
        // A board that ran out of motion was already at rest.
        if reset.contains("Idle") {
            return false;
        }
        assert!(reset.contains("Alarm"), "{reset}");
        assert_eq!(output.status.code(), Some(130));
        assert_eq!(report(&output)["end"], "ended");
        true
    });
    assert!(is_stopped);
}

pub fn an_unplugged_board_ends_the_run() {
    let folder = part_folder("run-unplugged", "grbl", LONG);
    let is_ended = (0..ATTEMPTS).any(|_| {
        let mut twin = folder.start_board();
        let run = ["run", &folder.path("part.CNC"), "--home", "--json"];
        let mut run = folder.command_at(&twin, &run);
        let run = run.stdin(Stdio::null()).stdout(Stdio::piped());
        let run = run.stderr(Stdio::null()).spawn().unwrap();
        let has_homed = twin.wait_for_line("Home", TIME_LIMIT).is_some();
        let has_moved = has_homed && twin.wait_for_line("Run", Duration::from_secs(20)).is_some();
        twin.unplug();
        let output = run.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(1), "{}", all_output(&output));
        has_moved && report(&output)["alarm"]["number"] == 605
    });
    assert!(is_ended);
}

pub fn the_time_limit_holds_the_program() {
    let folder = part_folder("run-limit", "grbl", LONG);
    let part = folder.path("part.CNC");
    let output = run_until_end("limit", &folder, &[&part, "--limit", "2s"]);
    assert_eq!(output.status.code(), Some(1), "{}", all_output(&output));
    let line = folder.last_count();
    assert!(line.ends_with("agrees"), "{line}");
    let z = report(&output)["final"]["abs"][1].as_f64().unwrap();
    assert!((16.0..19.0).contains(&z), "{z}");
}

pub fn a_repeating_program_is_held_after_its_part() {
    let text = PART.replace("M30", "M99");
    let folder = part_folder("run-again", "grbl", &text);
    let output = run_until_end("M99", &folder, &[&folder.path("part.CNC")]);
    assert_eq!(output.status.code(), Some(0), "{}", all_output(&output));
    let line = folder.last_count();
    assert!(line.ends_with("agrees"), "{line}");
    let commanded = line.split_once("commanded X ").unwrap().1;
    let x = commanded.split_once(' ').unwrap().0;
    // It has started the move to X60 Z20 of the next part, and has stopped near the start of
    // that move.
    assert!(
        (-2000..-1000).contains(&x.parse::<i32>().unwrap()),
        "{line}"
    );
}

pub fn without_a_reference_no_axis_moves() {
    let folder = part_folder("run-nowhere", "grbl", PART);
    let twin = folder.start_board();
    let part = folder.path("part.CNC");
    let output = folder.command_at(&twin, &["run", &part, "--json"]).output();
    let output = output.unwrap();
    let output_text = all_output(&output);
    assert_eq!(output.status.code(), Some(1), "{output_text}");
    assert_eq!(report(&output)["alarm"]["number"], 610, "{output_text}");
    assert!(
        output_text.contains("--home to make the machine zero return"),
        "{output_text}"
    );
    let lines = twin.printed_lines();
    assert!(!lines.iter().any(|line| line.contains("Run")), "{lines:?}");
}

pub fn options_for_simulation_only_are_refused_before_the_port_is_opened() {
    let folder = part_folder("run-refused", "grbl", PART);
    let part = folder.path("part.CNC");
    let refusals: [(&[&str], &str); 3] = [
        (&["--parts", "2"], "the operator confirms each part"),
        (&["--spindle", "800"], "M03 or a panel key"),
        (
            &["--start", "100,50"],
            "the machine determines the position",
        ),
    ];
    for (arguments, message) in refusals {
        let run = [&["run", &part, "--link", "/nowhere"], arguments].concat();
        let output = gsk_command(&run).stdin(Stdio::null()).output().unwrap();
        let output_text = all_output(&output);
        assert_eq!(output.status.code(), Some(2), "{output_text}");
        assert!(output_text.contains(message), "{output_text}");
    }
}

/// Restarts at the cut in line 4. Without a terminal the run prints the list of differences with
/// a code, and begins only with this code.
pub fn a_restart_begins_with_the_code_of_its_differences() {
    let folder = part_folder("run-restart", "grbl", PART);
    let part = folder.path("part.CNC");
    let restart = [&part, "--restart", "4"];
    let refused = run_until_end("refused", &folder, &restart);
    let text = all_output(&refused);
    assert!(text.contains("Restart at"), "{text}");
    assert!(text.contains("slides, machine coordinates"), "{text}");
    let (_, code) = text.split_once("--confirm ").expect("a code");
    let code: String = code.chars().take(8).collect();
    let line = folder.last_count();
    assert!(!line.contains("X -2000"), "no motion: {line}");
    let other = [&restart[..], &["--confirm", "00000000"]].concat();
    let refused = run_until_end("refused", &folder, &other);
    assert!(all_output(&refused).contains(&code), "{text}");
    let confirmed = [&restart[..], &["--confirm", &code]].concat();
    let output = run_until_end("M30", &folder, &confirmed);
    assert_eq!(output.status.code(), Some(0), "{}", all_output(&output));
    let line = folder.last_count();
    assert!(line.ends_with(AT_END), "{line}");
}

pub fn the_operator_confirms_each_difference_of_a_restart() {
    let folder = part_folder("run-restart-enter", "grbl", PART);
    let mut last_output = String::new();
    let is_done = (0..ATTEMPTS).any(|_| {
        // One Enter for each difference, one at the start point.
        let enters = ["no\n", "\n", "\n", "\n", "\n", "\n", "\n", "\n", "\n"];
        let (code, output) = run_at_terminal(&folder, &["--restart", "4"], &enters);
        last_output = output;
        code == Some(0)
    });
    assert!(is_done, "{last_output}");
    assert!(
        last_output.matches("at the block").count() >= 3,
        "{last_output}"
    );
    let line = folder.last_count();
    assert!(line.ends_with(AT_END), "{line}");
}
