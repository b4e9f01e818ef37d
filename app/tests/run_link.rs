//! `run --link`: a program at a board, without a window.

use std::fs::File;
use std::io::{BufRead, BufReader, Write};
use std::process::{Output, Stdio};
use std::time::Duration;

use crate::at_board::{ATTEMPTS, Folder, gsk};
use crate::twin::signal;
use serde_json::Value;
use serialport::{SerialPort, TTYPort};

const LONGEST: Duration = Duration::from_secs(120);
const PART: &str = "O0007\nG50 X60 Z20\nG98 G00 X50 Z10\nG01 Z5 F600\nM30\n";
const WITH_STOP: &str = "O0007\nG50 X60 Z20\nG98 G00 X50 Z10\nM00\nG01 Z5 F600\nM30\n";
const LONG: &str = "O0007\nG50 X60 Z20\nG98 G01 Z-20 F60\nM30\n";

/// Pulses from machine zero to X50 Z10 and to X50 Z5; 200 pulses per mm of X and Z.
const BEFORE_STOP: &str = "commanded X -2000 Z -2000 counted X -2000 Z -2000 agrees";
const AT_END: &str = "commanded X -2000 Z -3000 counted X -2000 Z -3000 agrees";

fn folder(name: &str, firmware: &'static str, program: &str) -> Folder {
    Folder::new(name, firmware, &[("part.CNC", program)])
}

fn report(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_default()
}

fn said(output: &Output) -> String {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    text(&output.stdout) + &text(&output.stderr)
}

/// Repeats the run until it reaches this end; a busy computer may end it earlier.
#[track_caller]
fn comes_to(end: &str, folder: &Folder, arguments: &[&str]) -> Output {
    let mut last = String::new();
    for _ in 0..ATTEMPTS {
        let twin = folder.board();
        let run = [&["run", "--json", "--home"], arguments].concat();
        let output = folder.at(&twin, &run).stdin(Stdio::null()).output();
        let output = output.unwrap();
        if report(&output)["end"] == end {
            return output;
        }
        last = said(&output);
    }
    panic!("never {end}: {last}");
}

pub fn a_program_runs_to_its_end_and_the_board_has_made_its_pulses() {
    let folder = folder("run-part", "grbl", PART);
    let output = comes_to("M30", &folder, &[&folder.path("part.CNC")]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let line = folder.last_count();
    assert!(line.ends_with(AT_END), "{line}");
}

pub fn a_board_of_timed_steps_makes_it_too() {
    let folder = folder("run-timed", "klipper", PART);
    let output = comes_to("M30", &folder, &[&folder.path("part.CNC")]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let line = folder.last_count();
    assert!(line.ends_with("agrees"), "{line}");
}

pub fn a_program_comes_in_through_the_line() {
    let folder = folder("run-dnc", "grbl", PART);
    let output = comes_to("M30", &folder, &["--dnc", &folder.path("part.CNC")]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let line = folder.last_count();
    assert!(line.ends_with(AT_END), "{line}");
}

pub fn nobody_answers_m00_for_a_person() {
    let folder = folder("run-stop", "grbl", WITH_STOP);
    let output = comes_to("stop", &folder, &[&folder.path("part.CNC")]);
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    let report = report(&output);
    assert_eq!(report["waits_for"], "cycle start at M00 in line 4");
    assert_eq!(report["stops"], 0);
    let line = folder.last_count();
    assert!(line.ends_with(BEFORE_STOP), "{line}");
}

/// Runs at a terminal. Types the next text of `typed` at each question.
fn at_a_terminal(folder: &Folder, arguments: &[&str], typed: &[&str]) -> (Option<i32>, String) {
    let twin = folder.board();
    let (mut keys, far) = TTYPort::pair().unwrap();
    let terminal = File::open(far.name().unwrap()).unwrap();
    let part = folder.path("part.CNC");
    let run = [&["run", &part, "--home"], arguments].concat();
    let mut run = folder.at(&twin, &run);
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

pub fn enter_at_the_terminal_goes_on_behind_m00() {
    let folder = folder("run-enter", "grbl", WITH_STOP);
    let mut last = String::new();
    let made = (0..ATTEMPTS).any(|_| {
        let (code, said) = at_a_terminal(&folder, &[], &["no\n", "\n"]);
        last = said;
        code == Some(0)
    });
    assert!(made, "{last}");
    let question = "M00 in line 4: press Enter to go on, Ctrl-C to stop";
    assert_eq!(last.matches(question).count(), 2, "{last}");
    let line = folder.last_count();
    assert!(line.ends_with(AT_END), "{line}");
}

pub fn each_part_more_is_allowed_by_a_person() {
    let folder = folder("run-parts", "grbl", PART);
    let mut last = String::new();
    let made = (0..ATTEMPTS).any(|_| {
        let (code, said) = at_a_terminal(&folder, &["--parts", "2"], &["\n"]);
        last = said;
        code == Some(0)
    });
    assert!(made, "{last}");
    assert_eq!(last.matches("part 1 of 2 is made").count(), 1, "{last}");
}

pub fn a_signal_stops_the_board_in_motion() {
    let folder = folder("run-signal", "grbl", LONG);
    let ended = (0..ATTEMPTS).any(|_| {
        let twin = folder.board();
        let run = ["run", &folder.path("part.CNC"), "--home", "--json"];
        let mut run = folder.at(&twin, &run);
        let run = run.stdin(Stdio::null()).stdout(Stdio::piped());
        let run = run.stderr(Stdio::null()).spawn().unwrap();
        // The reference return comes first, then the program.
        let homed = twin.says("Home", LONGEST).is_some();
        let moved = homed && twin.says("Run", Duration::from_secs(20)).is_some();
        signal(if moved { "TERM" } else { "KILL" }, run.id());
        let output = run.wait_with_output().unwrap();
        if !moved || report(&output)["end"] == "alarm" {
            return false;
        }
        let reset = twin.says("reset", LONGEST).expect("stopped");
        // A board that ran out of motion was already at rest.
        if reset.contains("Idle") {
            return false;
        }
        assert!(reset.contains("Alarm"), "{reset}");
        assert_eq!(output.status.code(), Some(130));
        assert_eq!(report(&output)["end"], "ended");
        true
    });
    assert!(ended);
}

pub fn a_board_that_is_gone_ends_the_run() {
    let folder = folder("run-unplugged", "grbl", LONG);
    let ended = (0..ATTEMPTS).any(|_| {
        let mut twin = folder.board();
        let run = ["run", &folder.path("part.CNC"), "--home", "--json"];
        let mut run = folder.at(&twin, &run);
        let run = run.stdin(Stdio::null()).stdout(Stdio::piped());
        let run = run.stderr(Stdio::null()).spawn().unwrap();
        let homed = twin.says("Home", LONGEST).is_some();
        let moved = homed && twin.says("Run", Duration::from_secs(20)).is_some();
        twin.unplug();
        let output = run.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(1), "{}", said(&output));
        moved && report(&output)["alarm"]["number"] == 605
    });
    assert!(ended);
}

pub fn the_limit_of_time_holds_the_program() {
    let folder = folder("run-limit", "grbl", LONG);
    let part = folder.path("part.CNC");
    let output = comes_to("limit", &folder, &[&part, "--limit", "2s"]);
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    let line = folder.last_count();
    assert!(line.ends_with("agrees"), "{line}");
    let z = report(&output)["final"]["abs"][1].as_f64().unwrap();
    assert!((16.0..19.0).contains(&z), "{z}");
}

pub fn a_program_that_begins_again_is_held_behind_its_part() {
    let text = PART.replace("M30", "M99");
    let folder = folder("run-again", "grbl", &text);
    let output = comes_to("M99", &folder, &[&folder.path("part.CNC")]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
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

pub fn without_a_reference_nothing_moves() {
    let folder = folder("run-nowhere", "grbl", PART);
    let twin = folder.board();
    let part = folder.path("part.CNC");
    let output = folder.at(&twin, &["run", &part, "--json"]).output();
    let output = output.unwrap();
    let said = said(&output);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert_eq!(report(&output)["alarm"]["number"], 610, "{said}");
    assert!(said.contains("--home makes the machine zero"), "{said}");
    let lines = twin.has_said();
    assert!(!lines.iter().any(|line| line.contains("Run")), "{lines:?}");
}

pub fn what_a_real_machine_does_not_do_is_refused_before_the_port_is_opened() {
    let folder = folder("run-refused", "grbl", PART);
    let part = folder.path("part.CNC");
    let refusals: [(&[&str], &str); 3] = [
        (&["--parts", "2"], "somebody has to allow each part"),
        (&["--spindle", "800"], "M03 or a key of the panel"),
        (&["--start", "100,50"], "where they stand"),
    ];
    for (arguments, sentence) in refusals {
        let run = [&["run", &part, "--link", "/nowhere"], arguments].concat();
        let output = gsk(&run).stdin(Stdio::null()).output().unwrap();
        let said = said(&output);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains(sentence), "{said}");
    }
}
