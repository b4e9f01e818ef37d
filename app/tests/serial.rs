//! Both sides of a transfer in separate processes, with a pseudo terminal between them.
//! `transfer control` is the control; the other commands are the PC.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, Output, Stdio};
use std::time::{Duration, Instant};

use gsk_core::setup::Setup;
use gsk_host::kernel::{Command as Order, Kernel, KernelEnvironment, start};
use gsk_host::serial::{SerialEnd, SerialLine};
use gsk_host::termination::TerminationFlag;
use gsk_messages::Id;
use gsk_panel::emulator::{Emulator, WaitCondition};
use gsk_panel::keys::Key;

use crate::common::folder::TempFolder;
use crate::process::executable;

pub fn serial_folder(name: &str) -> TempFolder {
    TempFolder::new(&format!("serial-{name}"))
}

/// A control in a separate process.
pub struct ControlProcess {
    child: Child,
    pub port: String,
}

impl ControlProcess {
    pub fn start(options: &[&str]) -> Self {
        let mut child = executable()
            .args(["transfer", "control", "--port", "pty"])
            .args(options)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("the program");
        let mut lines = BufReader::new(child.stdout.take().expect("its output")).lines();
        let port = lines.next().expect("a line").expect("the name of its port");
        // The rest of the output is read: a full pipe would block the process.
        std::thread::spawn(move || lines.for_each(drop));
        Self { child, port }
    }

    /// Runs a command of the PC's side.
    fn run_on_pc(&self, command: &str, arguments: &[&str]) -> Output {
        let output = executable()
            .args(["transfer", command, "--port", &self.port])
            .args(arguments)
            .stdin(Stdio::null())
            .output();
        output.expect("the program")
    }

    #[track_caller]
    fn run_successfully(&self, command: &str, arguments: &[&str]) -> String {
        let output = self.run_on_pc(command, arguments);
        assert!(
            output.status.success(),
            "{command} {arguments:?}: {output:?}"
        );
        String::from_utf8_lossy(&output.stdout).into_owned()
    }

    /// The names of its files, read over the port. No other process may use the port.
    pub fn file_names(&self) -> Vec<String> {
        let listed = self.run_successfully("list", &[]);
        let names = listed
            .lines()
            .filter_map(|line| line.split_whitespace().next());
        names.map(str::to_owned).collect()
    }

    #[track_caller]
    fn assert_refused(&self, command: &str, arguments: &[&str], reason: &str) {
        let output = self.run_on_pc(command, arguments);
        let errors = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{output:?}");
        assert!(errors.contains(reason), "{command} {arguments:?}: {errors}");
    }
}

impl Drop for ControlProcess {
    fn drop(&mut self) {
        // The process may have ended already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn write(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    std::fs::write(&path, text).expect("written");
    path.to_string_lossy().into_owned()
}

fn read_text(path: impl AsRef<Path>) -> String {
    std::fs::read_to_string(path).expect("a file")
}

const SHAFT: &str = "O0007 (轴);\nG00 X10.;\nM30;\n%\n";

#[test]
fn files_are_sent_received_renamed_and_deleted() {
    let folder = serial_folder("files");
    let control = ControlProcess::start(&[]);
    let shaft = write(&folder, "O0007.CNC", SHAFT);
    let long: String = (1..600).map(|n| format!("N{n} G01 X{n}.;\n")).collect();
    let long = format!("O0100;\n{long}M30;\n%\n");
    let named = write(&folder, "long.nc", &long);
    let output = control.run_successfully("send", &[&shaft, &named]);
    assert!(
        output.contains("O0100.CNC") && output.contains("2 file(s)"),
        "{output}"
    );
    let listed = control.run_successfully("list", &[]);
    assert!(listed.contains("O0007.CNC"), "{listed}");
    assert!(
        listed.contains(&format!("O0100.CNC    {:>8}", long.len())),
        "{listed}"
    );
    assert!(listed.contains("ParaW.par"), "{listed}");

    // Sending the same name again is refused.
    let conflict = control.run_on_pc("send", &[&shaft]);
    assert_eq!(conflict.status.code(), Some(2), "{conflict:?}");
    let other = write(&folder, "other.nc", "O0007;\nM99;\n%\n");
    let argument = format!("{other}=O0007.CNC");
    assert!(
        control
            .run_successfully("send", &[&argument, "--on-existing", "skip"])
            .contains("skipped")
    );
    let renamed = control.run_successfully("send", &[&argument, "--on-existing", "rename"]);
    assert!(renamed.contains("O0007.CNC is now O0008.CNC"), "{renamed}");
    let into = folder.join("received").to_string_lossy().into_owned();
    control.run_successfully(
        "receive",
        &["O0007.CNC", "O0008.CNC", "O0100.CNC", "--into", &into],
    );
    let received = |name: &str| read_text(Path::new(&into).join(name));
    assert_eq!(received("O0007.CNC"), "O0007;\nM99;\n%\n");
    assert_eq!(received("O0008.CNC"), SHAFT.replace("O0007", "O0008"));
    assert_eq!(received("O0100.CNC"), long);
    // An existing file is not overwritten without the option.
    let conflict = control.run_on_pc("receive", &["O0007.CNC", "--into", &into]);
    assert_eq!(conflict.status.code(), Some(2), "{conflict:?}");

    control.run_successfully("rename", &["O0008.CNC", "O0009.CNC"]);
    control.assert_refused("rename", &["O0009.CNC", "O0007.CNC"], "already exists");
    control.run_successfully("delete", &["O0009.CNC"]);
    control.assert_refused("delete", &["O0009.CNC"], "no file of this name");
    control.assert_refused("receive", &["ParaW.par", "--into", &into], "switch");
    assert!(!control.run_successfully("list", &[]).contains("O0009"));
}

#[test]
fn a_memory_is_backed_up_and_restored() {
    let folder = serial_folder("backup");
    let saved = folder.join("saved");
    let data = folder.join("data");
    let options = ["--parameter-switch", "--data", &data.to_string_lossy()];
    let control = ControlProcess::start(&options);
    let shaft = write(&folder, "O0007.CNC", SHAFT);
    control.run_successfully("send", &[&shaft]);
    let output = control.run_successfully("backup", &[&saved.to_string_lossy()]);
    assert!(output.contains("5 file(s)"), "{output}");
    drop(control);
    // Another baud rate and another offset. The last file changes the rate of the line.
    let parameters = read_text(saved.join("ParaW.par")).replace("044=115200", "044=57600");
    assert!(parameters.contains("044=57600"), "{parameters}");
    write(&saved, "ParaW.par", &parameters);
    let offsets = read_text(saved.join("Tofs.ofs"));
    let changed = offsets.replacen("001=0.000,0.000", "001=1.500,-2.000", 1);
    assert_ne!(offsets, changed);
    write(&saved, "Tofs.ofs", &changed);

    let control = ControlProcess::start(&["--parameter-switch"]);
    let output = control.run_successfully("restore", &[&saved.to_string_lossy()]);
    assert!(output.contains("5 file(s)"), "{output}");
    // The control changes its rate once the line is idle.
    std::thread::sleep(Duration::from_secs(1));
    let again = folder.join("again").to_string_lossy().into_owned();
    // The pseudo terminal has no baud rate, but the transfer uses that of parameter 044.
    control.run_successfully("backup", &[&again, "--baud", "57600"]);
    for file in [
        "O0007.CNC",
        "Tofs.ofs",
        "Wcomp.wmp",
        "Main.ldx",
        "ParaW.par",
    ] {
        assert_eq!(
            read_text(Path::new(&again).join(file)),
            read_text(saved.join(file)),
            "{file}"
        );
    }
    // An invalid line keeps the whole file out, and the control names it.
    let bad = write(&folder, "Tofs.ofs", "001=1,2,3,4\n077=0,0,0,0\n");
    control.assert_refused(
        "send",
        &[&bad, "--baud", "57600", "--on-existing", "overwrite"],
        "content",
    );
    control.run_successfully(
        "receive",
        &[
            "Tofs.ofs",
            "--into",
            &again,
            "--overwrite",
            "--baud",
            "57600",
        ],
    );
    assert_eq!(read_text(Path::new(&again).join("Tofs.ofs")), changed);
}

#[test]
fn programs_are_sent_as_text_in_both_directions() {
    let folder = serial_folder("text");
    let program = "O0331 (TEXT);\nG00 X10.;\nM30;\n%\n";
    let file = write(&folder, "O0331.CNC", program);
    let control = ControlProcess::start(&["--param", "44=19200"]);
    control.run_successfully(
        "send-text",
        &[&file, "--baud", "19200", "--line-end", "lfcrcr"],
    );
    let into = folder.join("in").to_string_lossy().into_owned();
    control.run_successfully(
        "receive",
        &["O0331.CNC", "--into", &into, "--baud", "19200"],
    );
    assert_eq!(read_text(Path::new(&into).join("O0331.CNC")), program);

    // The key OUT sends the program.
    let control = ControlProcess::start(&["--text", "cr", "--out", &file, "--out-after", "1"]);
    let out = folder.join("out").to_string_lossy().into_owned();
    control.run_successfully("receive-text", &[&out, "--wait", "30"]);
    assert_eq!(read_text(Path::new(&out).join("O0331.CNC")), program);
}

/// A control in this process: EDIT mode, program page, O0331 is typed.
fn ready_to_send(param: &[(u16, i32)]) -> Emulator {
    let mut setup = Setup::default();
    for (number, value) in param {
        setup
            .memory
            .parameters
            .set(*number, *value)
            .expect("a parameter");
    }
    let programs = &mut setup.memory.programs;
    programs
        .store("O0331;\nM30;\n")
        .expect("room for a program");
    let mut emulator = Emulator::new(setup);
    emulator.run_until(&WaitCondition::SelfTestOver, 10_000);
    emulator.press(Key::Edit);
    emulator.press(Key::Program);
    emulator.type_text("O331");
    emulator
}

#[test]
fn the_out_key_sends_to_a_pc_and_the_lcd_shows_the_line_state() {
    let folder = serial_folder("key");
    let (mut kernel, console) = Kernel::new(ready_to_send(&[]));
    kernel.connect_serial_line(SerialLine::open(SerialEnd::Terminal, None).expect("a thread"));
    let host = KernelEnvironment {
        wake: Box::new(|| {}),
        keeper: None,
        partner_folder: None,
        udisk_folder: None,
        termination: TerminationFlag::default(),
    };
    let mut thread = start(kernel, &console, host).expect("a thread");
    let wait_for_notice = |id: Id| {
        let end = Instant::now() + Duration::from_secs(60);
        loop {
            let remaining = end.saturating_duration_since(Instant::now());
            match console.notices.recv_timeout(remaining).expect("a notice") {
                gsk_host::kernel::Notice::Message(message) if message.id() == id => return message,
                _ => {}
            }
        }
    };
    let wait_for_lcd = |word: &str| {
        let end = Instant::now() + Duration::from_secs(60);
        while Instant::now() < end {
            if let Some(snapshot) = console.snapshots.pop()
                && snapshot.screen.text().contains(word)
            {
                return;
            }
            std::thread::sleep(Duration::from_millis(2));
        }
        panic!("{word} never stands on the LCD");
    };
    let port = wait_for_notice(Id::SerialLineOpened);
    let port = port.plain_value("port").expect("its name").to_owned();
    // No PC is connected.
    console.send(Order::Tap(Key::Output));
    wait_for_lcd("输出");
    wait_for_lcd("串口未连接");

    let mut pc = executable()
        .args(["transfer", "wait", "--files", "1", "--port", &port])
        .arg(&folder.0)
        .stdout(Stdio::piped())
        .spawn()
        .expect("the program");
    let mut lines = BufReader::new(pc.stdout.take().expect("its output")).lines();
    // The PC is connected now.
    assert!(lines.next().is_some_and(|line| line.is_ok()));
    wait_for_lcd("输入");
    std::thread::sleep(Duration::from_millis(600));
    for character in "O331".chars() {
        console.send(Order::Type(character));
    }
    console.send(Order::Tap(Key::Output));
    wait_for_notice(Id::SerialSent);
    assert!(pc.wait().expect("its end").success());
    assert_eq!(read_text(folder.join("O0331.CNC")), "O0331;\nM30;\n%\n");
    thread.stop();
}

#[test]
fn errors_of_the_pc_side_are_reported() {
    let folder = serial_folder("wrong");
    let file = write(&folder, "shaft.txt", "G00 X1;\n");
    let run = |arguments: &[&str]| {
        let output = executable().arg("transfer").args(arguments).output();
        let output = output.expect("the program");
        let errors = String::from_utf8_lossy(&output.stderr).into_owned();
        (output.status.code(), errors)
    };
    let (code, errors) = run(&["send", "--port", "/dev/no-such-port", &file]);
    assert!(code == Some(2) && errors.contains("FILE=NAME"), "{errors}");
    let argument = format!("{file}=O0001.CNC");
    let (code, errors) = run(&["send", "--port", "/dev/no-such-port", &argument]);
    assert!(
        code == Some(2) && errors.contains("/dev/no-such-port"),
        "{errors}"
    );
    let (code, errors) = run(&["send", "--port", "x", &argument, &argument]);
    assert!(
        code == Some(2) && errors.contains("written twice"),
        "{errors}"
    );
    let (code, errors) = run(&["send", "--port", "x", &format!("{file}=轴.CNC")]);
    assert!(
        code == Some(2) && errors.contains("eight letters"),
        "{errors}"
    );
    let chinese = write(&folder, "O0001.CNC", "O0001;\n(轴);\n");
    let (code, errors) = run(&["send-text", "--port", "x", &chinese]);
    assert!(code == Some(2) && errors.contains("line 2"), "{errors}");
}

#[test]
fn output_uses_the_requested_language_and_the_port_of_the_window() {
    let folder = serial_folder("language");
    let run = |arguments: &[&str]| {
        let mut command = executable();
        command.args(arguments).env("XDG_DATA_HOME", &folder.0);
        let output = command.output().expect("the program");
        let output_text = [&output.stdout, &output.stderr].map(|it| String::from_utf8_lossy(it));
        (output.status.code(), output_text.concat())
    };
    let (code, output_text) = run(&["transfer", "list"]);
    assert!(
        code == Some(2) && output_text.contains("--port PORT"),
        "{output_text}"
    );
    let (code, output_text) = run(&["transfer", "list", "--lang", "zh"]);
    assert!(
        code == Some(2) && output_text.contains("没有指定端口"),
        "{output_text}"
    );
    let none = ["link", "test", "/dev/no-such-port", "--lang", "zh"];
    let (code, output_text) = run(&none);
    assert!(
        code == Some(2) && output_text.contains("不能打开"),
        "{output_text}"
    );

    let control = ControlProcess::start(&[]);
    let data = folder.join("gsk980td");
    std::fs::create_dir_all(&data).expect("a folder");
    let settings = format!("(transfer:(port:{:?},baud:115200))", control.port);
    write(&data, "window.ron", &settings);
    let file = write(&folder, "O0007.CNC", SHAFT);
    let (code, output_text) = run(&["transfer", "send", &file, "--lang", "zh"]);
    assert!(
        code == Some(0) && output_text.contains("传输速率"),
        "{output_text}"
    );
    let other = ["transfer", "list", "--port", "/dev/no-such-port"];
    let (code, output_text) = run(&other);
    assert!(
        code == Some(2) && output_text.contains("/dev/no-such-port"),
        "{output_text}"
    );
}

#[test]
fn noise_and_an_interrupted_transfer_store_no_file() {
    let folder = serial_folder("noise");
    let control = ControlProcess::start(&[]);
    let mut port = std::fs::OpenOptions::new()
        .read(true)
        .write(true)
        .open(&control.port)
        .expect("the port");
    // A text without an end, then noise.
    port.write_all(b"%\nO0001\nG00 X1.\nG00 X2.\nG00 X3.\n")
        .expect("written");
    std::thread::sleep(Duration::from_millis(200));
    port.write_all(b"\x05\x06\xFE\xF8\x03").expect("written");
    std::thread::sleep(Duration::from_millis(200));
    drop(port);
    // The PC is killed in the middle of a long file.
    let long: String = (1..3700)
        .map(|n| format!("N{n} G01 X{}. Z-1.5;\n", n % 90))
        .collect();
    let long = write(
        &folder,
        "O0100.CNC",
        &format!("O0100;\n{long}{long}M30;\n%\n"),
    );
    let mut pc = executable()
        .args(["transfer", "send", "--port", &control.port, &long])
        .stdout(Stdio::null())
        .spawn()
        .expect("the program");
    std::thread::sleep(Duration::from_millis(500));
    pc.kill().expect("it still sends");
    pc.wait().expect("its end");
    let listed = control.run_successfully("list", &[]);
    assert!(!listed.contains("O0100"), "{listed}");
    let shaft = write(&folder, "O0007.CNC", SHAFT);
    control.run_successfully("send", &[&shaft]);
    let listed = control.run_successfully("list", &[]);
    assert!(
        listed.contains("O0007.CNC") && !listed.contains("O0001"),
        "{listed}"
    );
}

#[test]
fn a_ladder_is_sent_and_read_back_by_the_commands_of_gskcc() {
    let folder = serial_folder("ladder");
    let control = ControlProcess::start(&["--parameter-switch"]);
    let ladder = |arguments: &[&str]| {
        let output = executable()
            .args(["ladder"])
            .args(arguments)
            .args(["--port", &control.port])
            .stdin(Stdio::null())
            .output();
        output.expect("the program")
    };
    let text = format!("{}; changed here\r\n", gsk_core::setup::STANDARD_LADDER);
    let own = write(&folder, "own.il", &text);
    let sent = ladder(&["send", &own]);
    assert!(sent.status.success(), "{sent:?}");
    let back = folder.join("back.il");
    let read = ladder(&["read", "-o", &back.to_string_lossy()]);
    assert!(read.status.success(), "{read:?}");
    assert_eq!(read_text(&back), text);
    // `transfer` moves the same file; the name follows from its ending.
    control.run_successfully("send", &[&own, "--on-existing", "overwrite"]);
    assert!(control.file_names().contains(&"Main.ldx".to_owned()));
    let broken = write(&folder, "broken.il", "END1\nLD X0.0\nEND2\nOUT");
    assert_eq!(ladder(&["send", &broken]).status.code(), Some(1));
    drop(control);
    // Without the parameter switch the control refuses.
    let control = ControlProcess::start(&[]);
    control.assert_refused(
        "send",
        &[&own, "--on-existing", "overwrite"],
        "which a ladder needs",
    );
}
