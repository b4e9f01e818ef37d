//! The command `gsk980td link` with a virtual board.

use std::io::{BufRead, BufReader, Read};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use crate::process::executable;
use crate::twin::{TwinProcess, send_signal};

/// Time limit of each wait, on a busy computer.
const TIME_LIMIT: Duration = Duration::from_secs(120);
const GEAR: [&str; 4] = ["--param", "17=5", "--param", "18=5"];

fn link_command(arguments: &[&str]) -> Command {
    let mut command = executable();
    command.arg("link").args(arguments);
    command
}

/// Runs `link`. Returns exit code, standard output and standard error.
fn run_link(arguments: &[&str]) -> (i32, String, String) {
    let output = link_command(arguments).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (
        output.status.code().unwrap_or(-1),
        text(&output.stdout),
        text(&output.stderr),
    )
}

/// Runs `link test` at a port with the gear 1/5 and more options.
fn run_test(port: &str, options: &[&str]) -> (i32, String, String) {
    let arguments: Vec<&str> = ["test", port].into_iter().chain(GEAR).collect();
    run_link(&[&arguments, options].concat())
}

/// The machine file that the virtual board with timed steps prints.
struct MachineFile(std::path::PathBuf);

impl MachineFile {
    fn new(name: &str) -> Self {
        let name = format!("gsk980td-{}-{name}.ron", std::process::id());
        let path = std::env::temp_dir().join(name);
        let (code, text, _) = run_link(&["twin", "--firmware", "klipper", "--print-machine"]);
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

/// A running process. It is killed when it is dropped.
struct RunningProcess(Child);

impl RunningProcess {
    fn new(command: &mut Command) -> Self {
        let child = command.stdout(Stdio::piped()).stderr(Stdio::piped());
        Self(child.spawn().unwrap())
    }

    /// Reads the next line of standard error.
    fn read_error_line(&mut self) -> String {
        let mut line = String::new();
        let mut stderr = BufReader::new(self.0.stderr.as_mut().unwrap());
        stderr.read_line(&mut line).unwrap();
        line
    }
}

impl Drop for RunningProcess {
    fn drop(&mut self) {
        // The process may have ended already.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

pub fn a_board_at_a_network_address_is_tested_like_one_at_a_port() {
    let twin = TwinProcess::start(&["--tcp", "127.0.0.1:0"]);
    assert!(twin.port.starts_with("tcp:127.0.0.1:"), "{}", twin.port);
    // One connection after the other: the board accepts the next one when the last has ended.
    let (code, text, error) = run_test(&twin.port, &["--write-settings"]);
    assert!(!error.contains("603"), "{error}");
    assert_eq!(code, 0, "{text}{error}");
    let (code, text, error) = run_test(&twin.port, &["--travel", "1"]);
    assert_eq!(code, 0, "{text}{error}");
    let mut monitor = RunningProcess::new(link_command(&["monitor"]).arg(&twin.port).args(GEAR));
    let stdout = monitor.0.stdout.take().unwrap();
    assert!(BufReader::new(stdout).lines().next().is_some());
    let port = twin.port.clone();
    drop(twin);
    let error = monitor.read_error_line();
    assert!(error.contains("the port is gone"), "{error}");
    let (code, _, error) = run_test(&port, &[]);
    assert_eq!(code, 2, "{error}");
    assert!(error.contains("cannot be reached"), "{error}");
}

pub fn a_wrong_data_path_creates_no_folder_and_no_new_control() {
    let twin = TwinProcess::start(&[]);
    let name = format!("gsk980td-no-such-data-{}", std::process::id());
    let folder = std::env::temp_dir().join(name);
    let data = folder.to_str().unwrap();
    for command in ["test", "monitor"] {
        let (code, out, errors) = run_link(&[command, &twin.port, "--data", data]);
        assert_eq!((code, out.as_str()), (2, ""), "{errors}");
        assert!(errors.contains(data), "{errors}");
        assert!(errors.contains("not a data directory yet"), "{errors}");
        assert!(!folder.exists());
    }
    let temp = std::env::temp_dir();
    let (code, _, errors) = run_link(&["test", &twin.port, "--data", temp.to_str().unwrap()]);
    assert_eq!(code, 2, "a folder of something else: {errors}");
}

pub fn an_invalid_travel_or_feed_is_refused_before_the_port_is_opened() {
    for (options, word) in [
        (["--travel=nan", "--feed=600"], "nan"),
        (["--travel=0", "--feed=600"], "0"),
        (["--travel=5", "--feed=0"], "0"),
        (["--travel=5", "--feed=-100"], "-100"),
        (["--travel=5", "--feed=inf"], "inf"),
    ] {
        let (code, _, complaint) = run_link(&[["test", "/no/port"], options].concat());
        assert_eq!(code, 2, "{options:?}: {complaint}");
        assert!(complaint.contains(word), "{options:?}: {complaint}");
        assert!(!complaint.contains("/no/port"), "{options:?}: {complaint}");
    }
}

pub fn a_feed_above_the_limit_of_the_board_is_refused_before_motion() {
    let twin = TwinProcess::start(&[]);
    let (code, out, complaint) = run_test(
        &twin.port,
        &["--write-settings", "--travel", "50", "--feed", "9001"],
    );
    assert_eq!(code, 2, "{out}{complaint}");
    assert!(
        complaint.contains("30003 pulses a second") && complaint.contains("30000"),
        "{complaint}"
    );
    let lines = twin.printed_lines();
    assert!(!lines.iter().any(|line| line.contains("Run")), "{lines:?}");
}

pub fn a_board_that_is_not_ready_in_time_fails_the_test() {
    let machine = MachineFile::new("slow");
    let twin = TwinProcess::start(&["--firmware", "klipper", "--delay-ms", "300"]);
    let (code, out, complaint) = run_test(&twin.port, &["--machine", machine.path()]);
    assert_eq!(code, 1, "{out}{complaint}");
    assert!(!out.contains("settings  correct"), "{out}");
    // If the computer adds to the 300 ms, the link fails earlier.
    let unready = ["is not ready", "601: "];
    assert!(
        unready.iter().any(|word| complaint.contains(word)),
        "{complaint}"
    );
}

pub fn a_test_ends_with_a_stop_command_to_a_step_board() {
    let machine = MachineFile::new("left");
    let twin = TwinProcess::start(&["--firmware", "klipper"]);
    let (_, out, complaint) = run_test(&twin.port, &["--machine", machine.path()]);
    assert!(out.contains("settings  correct"), "{out}{complaint}");
    let line = twin.wait_for_line("shut down", TIME_LIMIT).unwrap();
    assert!(line.contains("Command request"), "{line}");
}

pub fn the_test_motion_does_not_exceed_its_travel() {
    let twin = TwinProcess::start(&[]);
    let options = ["--write-settings", "--travel", "-4", "--feed", "4500"];
    let (_, out, complaint) = run_test(&twin.port, &options);
    assert!(out.contains("pulses "), "{out}{complaint}");
    let farthest = twin
        .printed_lines()
        .iter()
        .filter_map(|line| {
            let (_, pulses) = line.split_once(" Z ")?;
            pulses.strip_suffix(" pulses")?.parse::<i64>().ok()
        })
        .min();
    // 4 mm are 800 pulses. The board prints its position, also at the holds.
    let farthest = farthest.unwrap();
    assert!((-800..=-700).contains(&farthest), "{farthest}: {complaint}");
}

pub fn a_monitor_reports_an_alarm_at_once_and_ends_by_ctrl_c() {
    let twin = TwinProcess::start(&[]);
    let mut monitor = RunningProcess::new(&mut link_command(&["monitor", &twin.port]));
    let complaint = monitor.read_error_line();
    assert!(complaint.contains("603"), "{complaint}");
    assert!(monitor.0.try_wait().unwrap().is_none(), "it goes on");
    send_signal("INT", monitor.0.id());
    let code = monitor.0.wait().unwrap().code();
    assert_eq!(code, Some(0), "differing settings are no fault of the wire");
}

pub fn a_monitor_shows_the_stop_command_at_its_end() {
    let machine = MachineFile::new("last");
    let klipper = ["--machine", machine.path()];
    for (firmware, options, stop_command) in [
        ("grbl", [].as_slice(), "\\x18"),
        ("klipper", &klipper, "emergency_stop"),
    ] {
        let twin = TwinProcess::start(&["--firmware", firmware]);
        if firmware == "grbl" {
            run_test(&twin.port, &["--write-settings"]);
        }
        let monitor = [&["monitor", &twin.port], &GEAR[..], options].concat();
        let assert_ends_with_stop = |out: &str| {
            let outward = out.lines().rfind(|line| line.contains(" > "));
            let outward = outward.unwrap_or_else(|| panic!("{firmware}: {out}"));
            assert!(outward.contains(stop_command), "{firmware}: {outward}");
        };
        // Before the board has identified itself, no stop is needed.
        let replies = ["<Idle", "endstop_query_state"];
        let is_identified = |out: &str| replies.iter().any(|word| out.matches(word).count() > 3);
        let output_at_time_limit = ["3", "10", "60"].iter().find_map(|seconds| {
            let (_, out, _) = run_link(&[&monitor, &["--seconds", seconds][..]].concat());
            is_identified(&out).then_some(out)
        });
        assert_ends_with_stop(&output_at_time_limit.unwrap());
        let mut running = RunningProcess::new(&mut link_command(&monitor));
        let mut out = String::new();
        let mut stdout = BufReader::new(running.0.stdout.take().unwrap());
        while !is_identified(&out) {
            assert!(stdout.read_line(&mut out).unwrap() > 0, "{out}");
        }
        send_signal("INT", running.0.id());
        stdout.read_to_string(&mut out).unwrap();
        assert_ends_with_stop(&out);
    }
}

pub fn a_test_that_is_interrupted_in_motion_stops_the_board() {
    let machine = MachineFile::new("ended");
    for (firmware, options, stop_message) in [
        ("grbl", ["--write-settings"].as_slice(), "reset"),
        ("klipper", &["--machine", machine.path()], "Command request"),
    ] {
        for name in ["INT", "TERM"] {
            // On a busy computer the signal may come before the motion: then the run is
            // repeated.
            let interrupt_test = || {
                let twin = TwinProcess::start(&["--firmware", firmware]);
                let mut command =
                    link_command(&["test", &twin.port, "--travel", "500", "--feed", "600"]);
                let mut test = RunningProcess::new(command.args(GEAR).args(options));
                if firmware == "grbl" {
                    twin.wait_for_line("Run", TIME_LIMIT).unwrap();
                } else {
                    // Such a board does not report motion.
                    std::thread::sleep(Duration::from_secs(12));
                }
                send_signal(name, test.0.id());
                let stop_line = twin.wait_for_line(stop_message, TIME_LIMIT).unwrap();
                assert_eq!(test.0.wait().unwrap().code(), Some(1), "{firmware} {name}");
                let mut out = String::new();
                let mut report = test.0.stdout.take().unwrap();
                report.read_to_string(&mut out).unwrap();
                out.contains(" steps a second").then_some((stop_line, out))
            };
            let (stopped, out) = (0..3)
                .find_map(|_| interrupt_test())
                .expect("it never moves");
            assert!(out.contains("motion  "), "{firmware} {name}: {out}");
            assert!(out.contains("was aborted"), "{firmware} {name}: {out}");
            // 600 mm/min are 2000 pulses/s. An interrupted motion has a lower average.
            let (before_rate, _) = out.split_once(" steps a second").unwrap();
            let rate: f64 = before_rate.rsplit(' ').next().unwrap().parse().unwrap();
            assert!(rate <= 2000.0, "{firmware} {name}: {out}");
            let (_, z) = stopped.split_once(" Z ").unwrap();
            let z: i64 = z.strip_suffix(" pulses").unwrap().parse().unwrap();
            assert!(z < 20_000, "1/5 of the way to the first hold: {stopped}");
        }
    }
}

pub fn an_operated_switch_is_named_before_motion() {
    let machine = MachineFile::new("operated");
    let text = std::fs::read_to_string(machine.path()).unwrap();
    // The inverted pin makes the switch operated.
    std::fs::write(machine.path(), text.replace("^PC1", "^!PC1")).unwrap();
    let twin = TwinProcess::start(&["--firmware", "klipper"]);
    let options = [
        "--machine",
        machine.path(),
        "--travel",
        "2",
        "--feed",
        "300",
    ];
    let (code, out, complaint) = run_test(&twin.port, &options);
    assert_eq!(code, 1, "{out}{complaint}");
    assert!(
        out.contains("switches  operated: limit switch of Z\n"),
        "{out}"
    );
    assert!(complaint.contains("nothing moves"), "{complaint}");
    assert!(!complaint.contains("612"), "{complaint}");
    assert!(!out.contains("motion"), "{out}");
    let lines = twin.printed_lines();
    assert!(
        lines
            .iter()
            .all(|line| line.contains("X 0 Z 0") || !line.contains("pulses")),
        "{lines:?}"
    );
}

pub fn a_link_that_breaks_while_the_board_is_idle_is_reported() {
    let twin = TwinProcess::start(&[]);
    let (_, out, complaint) = run_test(&twin.port, &["--write-settings"]);
    assert!(out.contains("switches  none operated"), "{out}{complaint}");
    let mut running = RunningProcess::new(link_command(&["test", &twin.port]).args(GEAR));
    let mut stdout = BufReader::new(running.0.stdout.take().unwrap());
    let mut line = String::new();
    while !line.starts_with("threads") {
        line.clear();
        assert!(stdout.read_line(&mut line).unwrap() > 0);
    }
    drop(twin);
    let complaint = running.read_error_line();
    assert!(complaint.contains("605"), "{complaint}");
    assert_eq!(running.0.wait().unwrap().code(), Some(1));
}

/// The firmware is checked, then the board, then it is copied.
pub fn firmware_is_copied_to_the_drive_of_a_pico_only() {
    let folder = std::env::temp_dir().join(format!("gsk980td-flash-{}", std::process::id()));
    let drive = folder.join("RPI-RP2");
    std::fs::create_dir_all(&drive).unwrap();
    let file = folder.join("firmware.uf2");
    let block = |family: u32| {
        let words = [
            0x0A32_4655,
            0x9E5D_5157,
            0x2000,
            0x1000_0000,
            256,
            0,
            1,
            family,
        ];
        let mut block: Vec<u8> = words
            .iter()
            .flat_map(|word: &u32| word.to_le_bytes())
            .collect();
        block.resize(508, 1);
        block.extend(0x0AB1_6F30_u32.to_le_bytes());
        block
    };
    let flash = || {
        let (file, drive) = (file.to_str().unwrap(), drive.to_str().unwrap());
        run_link(&["flash", file, "--to", drive, "--lang", "en"])
    };
    std::fs::write(&file, block(0xE48B_FF59)).unwrap();
    let (code, _, error) = flash();
    assert!(code != 0 && error.contains("family E48BFF59"), "{error}");
    let firmware = block(0xE48B_FF56);
    std::fs::write(&file, &firmware).unwrap();
    let (code, _, error) = flash();
    assert!(code != 0 && error.contains("INFO_UF2.TXT"), "{error}");
    let info = |id: &str| format!("UF2 Bootloader v1.0\r\nBoard-ID: {id}\r\n");
    std::fs::write(drive.join("INFO_UF2.TXT"), info("Other-Board")).unwrap();
    let (code, _, error) = flash();
    assert!(code != 0 && error.contains("Other-Board"), "{error}");
    assert!(!drive.join("firmware.uf2").exists(), "nothing is copied");
    std::fs::write(drive.join("INFO_UF2.TXT"), info("RPI-RP2")).unwrap();
    let (code, out, error) = flash();
    assert_eq!((code, error.as_str()), (0, ""), "{out}");
    assert!(out.contains("1 blocks copied"), "{out}");
    assert_eq!(std::fs::read(drive.join("firmware.uf2")).unwrap(), firmware);
    std::fs::remove_dir_all(&folder).unwrap();
}
