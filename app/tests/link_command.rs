//! `gsk980td link` as its users call it, with a virtual board.

use std::io::{BufRead, BufReader, Read};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use crate::process::executable;
use crate::twin::{Twin, signal};

/// So long anything may take on a busy computer.
const LONGEST: Duration = Duration::from_secs(120);
const GEAR: [&str; 4] = ["--param", "17=5", "--param", "18=5"];

fn link(arguments: &[&str]) -> Command {
    let mut command = executable();
    command.arg("link").args(arguments);
    command
}

/// Exit code, standard output, standard error.
fn said(arguments: &[&str]) -> (i32, String, String) {
    let output = link(arguments).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (
        output.status.code().unwrap_or(-1),
        text(&output.stdout),
        text(&output.stderr),
    )
}

/// `link test` at a port with the gear 1/5, and more.
fn test(port: &str, more: &[&str]) -> (i32, String, String) {
    let arguments: Vec<&str> = ["test", port].into_iter().chain(GEAR).collect();
    said(&[&arguments, more].concat())
}

/// The machine file that the virtual board of timed steps prints for itself.
struct MachineFile(std::path::PathBuf);

impl MachineFile {
    fn new(name: &str) -> Self {
        let name = format!("gsk980td-{}-{name}.ron", std::process::id());
        let path = std::env::temp_dir().join(name);
        let (code, text, _) = said(&["twin", "--firmware", "klipper", "--print-machine"]);
        assert_eq!(code, 0);
        std::fs::write(&path, text).unwrap();
        Self(path)
    }

    fn path(&self) -> &str {
        self.0.to_str().unwrap()
    }
}

impl Drop for MachineFile {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

/// A process that runs on; ended with the test.
struct Running(Child);

impl Running {
    fn new(command: &mut Command) -> Self {
        let child = command.stdout(Stdio::piped()).stderr(Stdio::piped());
        Self(child.spawn().unwrap())
    }

    /// The first line on standard error.
    fn complains(&mut self) -> String {
        let mut line = String::new();
        let mut said = BufReader::new(self.0.stderr.as_mut().unwrap());
        said.read_line(&mut line).unwrap();
        line
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        // One that has ended cannot be ended again.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

pub fn a_board_at_a_network_address_is_tried_as_one_at_a_port() {
    let twin = Twin::play(&["--tcp", "127.0.0.1:0"]);
    assert!(twin.port.starts_with("tcp:127.0.0.1:"), "{}", twin.port);
    // One after the other: the board takes the next partner when one has gone.
    let (code, text, error) = test(&twin.port, &["--write-settings"]);
    assert!(!error.contains("603"), "{error}");
    assert_eq!(code, 0, "{text}{error}");
    let (code, text, error) = test(&twin.port, &["--travel", "1"]);
    assert_eq!(code, 0, "{text}{error}");
    let mut monitor = Running::new(link(&["monitor"]).arg(&twin.port).args(GEAR));
    let stdout = monitor.0.stdout.take().unwrap();
    assert!(BufReader::new(stdout).lines().next().is_some());
    let port = twin.port.clone();
    drop(twin);
    let complaint = monitor.complains();
    assert!(complaint.contains("the port is gone"), "{complaint}");
    let (code, _, error) = test(&port, &[]);
    assert_eq!(code, 2, "{error}");
    assert!(error.contains("cannot be reached"), "{error}");
}

pub fn a_slip_of_the_pen_in_data_makes_no_folder_and_is_no_new_control() {
    let twin = Twin::play(&[]);
    let name = format!("gsk980td-no-such-data-{}", std::process::id());
    let folder = std::env::temp_dir().join(name);
    let data = folder.to_str().unwrap();
    for command in ["test", "monitor"] {
        let (code, out, complaint) = said(&[command, &twin.port, "--data", data]);
        assert_eq!((code, out.as_str()), (2, ""), "{complaint}");
        assert!(complaint.contains(data), "{complaint}");
        assert!(complaint.contains("no data directory"), "{complaint}");
        assert!(!folder.exists());
    }
    let temp = std::env::temp_dir();
    let (code, _, complaint) = said(&["test", &twin.port, "--data", temp.to_str().unwrap()]);
    assert_eq!(code, 2, "a folder of something else: {complaint}");
}

pub fn a_way_or_feed_that_cannot_be_made_is_refused_before_anything_is_opened() {
    for (options, word) in [
        (["--travel=nan", "--feed=600"], "nan"),
        (["--travel=0", "--feed=600"], "0"),
        (["--travel=5", "--feed=0"], "0"),
        (["--travel=5", "--feed=-100"], "-100"),
        (["--travel=5", "--feed=inf"], "inf"),
    ] {
        let (code, _, complaint) = said(&[["test", "/no/port"], options].concat());
        assert_eq!(code, 2, "{options:?}: {complaint}");
        assert!(complaint.contains(word), "{options:?}: {complaint}");
        assert!(!complaint.contains("/no/port"), "{options:?}: {complaint}");
    }
}

pub fn a_feed_beyond_the_board_is_refused_before_anything_moves() {
    let twin = Twin::play(&[]);
    let (code, out, complaint) = test(
        &twin.port,
        &["--write-settings", "--travel", "50", "--feed", "9001"],
    );
    assert_eq!(code, 2, "{out}{complaint}");
    assert!(
        complaint.contains("30003 pulses a second") && complaint.contains("30000"),
        "{complaint}"
    );
    let lines = twin.has_said();
    assert!(!lines.iter().any(|line| line.contains("Run")), "{lines:?}");
}

pub fn a_board_that_was_never_known_is_no_board_in_order() {
    let machine = MachineFile::new("slow");
    let twin = Twin::play(&["--firmware", "klipper", "--delay-ms", "300"]);
    let (code, out, complaint) = test(&twin.port, &["--machine", machine.path()]);
    assert_eq!(code, 1, "{out}{complaint}");
    assert!(!out.contains("as they must be"), "{out}");
    // Where the computer adds its own to the 300 ms, the link breaks before that.
    let unready = ["is not ready", "601: "];
    assert!(
        unready.iter().any(|word| complaint.contains(word)),
        "{complaint}"
    );
}

pub fn a_test_leaves_a_board_of_timed_steps_stopped_by_command() {
    let machine = MachineFile::new("left");
    let twin = Twin::play(&["--firmware", "klipper"]);
    let (_, out, complaint) = test(&twin.port, &["--machine", machine.path()]);
    assert!(out.contains("as they must be"), "{out}{complaint}");
    let said = twin.says("shut down", LONGEST).unwrap();
    assert!(said.contains("Command request"), "{said}");
}

pub fn the_drill_goes_no_farther_than_it_was_sent() {
    let twin = Twin::play(&[]);
    let more = ["--write-settings", "--travel", "-4", "--feed", "4500"];
    let (_, out, complaint) = test(&twin.port, &more);
    assert!(out.contains("pulses "), "{out}{complaint}");
    let farthest = twin
        .has_said()
        .iter()
        .filter_map(|line| {
            let (_, rest) = line.split_once(" Z ")?;
            rest.strip_suffix(" pulses")?.parse::<i64>().ok()
        })
        .min();
    // 4 mm are 800 pulses; where it stands is printed, holds included.
    let farthest = farthest.unwrap();
    assert!((-800..=-700).contains(&farthest), "{farthest}: {complaint}");
}

pub fn a_monitor_tells_an_alarm_when_it_comes_and_ends_by_ctrl_c() {
    let twin = Twin::play(&[]);
    let mut monitor = Running::new(&mut link(&["monitor", &twin.port]));
    let complaint = monitor.complains();
    assert!(complaint.contains("603"), "{complaint}");
    assert!(monitor.0.try_wait().unwrap().is_none(), "it goes on");
    signal("INT", monitor.0.id());
    let code = monitor.0.wait().unwrap().code();
    assert_eq!(code, Some(0), "differing settings are no fault of the wire");
}

pub fn a_monitor_shows_what_stops_the_board_at_its_end() {
    let machine = MachineFile::new("last");
    let klipper = ["--machine", machine.path()];
    for (firmware, options, last) in [
        ("grbl", [].as_slice(), "\\x18"),
        ("klipper", &klipper, "emergency_stop"),
    ] {
        let twin = Twin::play(&["--firmware", firmware]);
        if firmware == "grbl" {
            test(&twin.port, &["--write-settings"]);
        }
        let monitor = [&["monitor", &twin.port], &GEAR[..], options].concat();
        let ends = |out: &str| {
            let outward = out.lines().rfind(|line| line.contains(" > "));
            let outward = outward.unwrap_or_else(|| panic!("{firmware}: {out}"));
            assert!(outward.contains(last), "{firmware}: {outward}");
        };
        // Before the board has said who it is there is nothing to stop.
        let asked = ["<Idle", "endstop_query_state"];
        let known = |out: &str| asked.iter().any(|word| out.matches(word).count() > 3);
        let by_itself = ["3", "10", "60"].iter().find_map(|seconds| {
            let (_, out, _) = said(&[&monitor, &["--seconds", seconds][..]].concat());
            known(&out).then_some(out)
        });
        ends(&by_itself.unwrap());
        let mut running = Running::new(&mut link(&monitor));
        let mut out = String::new();
        let mut told = BufReader::new(running.0.stdout.take().unwrap());
        while !known(&out) {
            assert!(told.read_line(&mut out).unwrap() > 0, "{out}");
        }
        signal("INT", running.0.id());
        told.read_to_string(&mut out).unwrap();
        ends(&out);
    }
}

pub fn a_test_that_is_ended_in_motion_stops_the_board() {
    let machine = MachineFile::new("ended");
    for (firmware, options, stops) in [
        ("grbl", ["--write-settings"].as_slice(), "reset"),
        ("klipper", &["--machine", machine.path()], "Command request"),
    ] {
        for name in ["INT", "TERM"] {
            // On a busy computer the signal may come before the drill moves: once more then.
            let ended = || {
                let twin = Twin::play(&["--firmware", firmware]);
                let mut command = link(&["test", &twin.port, "--travel", "500", "--feed", "600"]);
                let mut test = Running::new(command.args(GEAR).args(options));
                if firmware == "grbl" {
                    twin.says("Run", LONGEST).unwrap();
                } else {
                    // Such a board has no word for motion.
                    std::thread::sleep(Duration::from_secs(12));
                }
                signal(name, test.0.id());
                let stopped = twin.says(stops, LONGEST).unwrap();
                assert_eq!(test.0.wait().unwrap().code(), Some(1), "{firmware} {name}");
                let mut out = String::new();
                let mut report = test.0.stdout.take().unwrap();
                report.read_to_string(&mut out).unwrap();
                out.contains(" steps a second").then_some((stopped, out))
            };
            let (stopped, out) = (0..3).find_map(|_| ended()).expect("it never moves");
            assert!(out.contains("motion  "), "{firmware} {name}: {out}");
            assert!(out.contains("broke off"), "{firmware} {name}: {out}");
            // 600 mm/min are 2000 pulses a second; a drill that broke off made no more.
            let (rest, _) = out.split_once(" steps a second").unwrap();
            let rate: f64 = rest.rsplit(' ').next().unwrap().parse().unwrap();
            assert!(rate <= 2000.0, "{firmware} {name}: {out}");
            let (_, z) = stopped.split_once(" Z ").unwrap();
            let z: i64 = z.strip_suffix(" pulses").unwrap().parse().unwrap();
            assert!(z < 20_000, "1/5 of the way to the first hold: {stopped}");
        }
    }
}

pub fn a_switch_that_is_operated_is_named_before_anything_moves() {
    let machine = MachineFile::new("operated");
    let text = std::fs::read_to_string(machine.path()).unwrap();
    // Nobody presses it: it is wired the other way round.
    std::fs::write(machine.path(), text.replace("^PC1", "^!PC1")).unwrap();
    let twin = Twin::play(&["--firmware", "klipper"]);
    let more = [
        "--machine",
        machine.path(),
        "--travel",
        "2",
        "--feed",
        "300",
    ];
    let (code, out, complaint) = test(&twin.port, &more);
    assert_eq!(code, 1, "{out}{complaint}");
    assert!(
        out.contains("switches  operated: limit switch of Z\n"),
        "{out}"
    );
    assert!(complaint.contains("nothing moves"), "{complaint}");
    assert!(!complaint.contains("612"), "{complaint}");
    assert!(!out.contains("motion"), "{out}");
    let lines = twin.has_said();
    assert!(
        lines
            .iter()
            .all(|line| line.contains("X 0 Z 0") || !line.contains("pulses")),
        "{lines:?}"
    );
}

pub fn a_link_that_breaks_while_the_board_is_idle_is_told() {
    let twin = Twin::play(&[]);
    let (_, out, complaint) = test(&twin.port, &["--write-settings"]);
    assert!(out.contains("switches  none operated"), "{out}{complaint}");
    let mut running = Running::new(link(&["test", &twin.port]).args(GEAR));
    let mut told = BufReader::new(running.0.stdout.take().unwrap());
    let mut line = String::new();
    while !line.starts_with("threads") {
        line.clear();
        assert!(told.read_line(&mut line).unwrap() > 0);
    }
    drop(twin);
    let complaint = running.complains();
    assert!(complaint.contains("605"), "{complaint}");
    assert_eq!(running.0.wait().unwrap().code(), Some(1));
}
