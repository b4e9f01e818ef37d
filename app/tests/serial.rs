//! Both sides of a transfer in separate processes, with a pseudo terminal between them.
//! `transfer control` is the control; the other commands are the PC.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, Output, Stdio};
use std::time::{Duration, Instant};

use gsk_app::ending::Ending;
use gsk_app::kernel::{Command as Order, Kernel, Outside, start};
use gsk_app::serial::{End, SerialLine};
use gsk_core::setup::Setup;
use gsk_messages::Id;
use gsk_panel::emulator::{Emulator, WaitCondition};
use gsk_panel::keys::Key;

use crate::common::folder::Folder;
use crate::process::executable;

pub fn folder(name: &str) -> Folder {
    Folder::new(&format!("serial-{name}"))
}

/// A control in a separate process.
pub struct Control {
    child: Child,
    pub port: String,
}

impl Control {
    pub fn with(options: &[&str]) -> Self {
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
    fn pc(&self, command: &str, words: &[&str]) -> Output {
        let output = executable()
            .args(["transfer", command, "--port", &self.port])
            .args(words)
            .stdin(Stdio::null())
            .output();
        output.expect("the program")
    }

    #[track_caller]
    fn does(&self, command: &str, words: &[&str]) -> String {
        let output = self.pc(command, words);
        assert!(output.status.success(), "{command} {words:?}: {output:?}");
        String::from_utf8_lossy(&output.stdout).into_owned()
    }

    /// The names of its files, read over the port. No other process may use the port.
    pub fn listed(&self) -> Vec<String> {
        let listed = self.does("list", &[]);
        let names = listed
            .lines()
            .filter_map(|line| line.split_whitespace().next());
        names.map(str::to_owned).collect()
    }

    #[track_caller]
    fn refuses(&self, command: &str, words: &[&str], why: &str) {
        let output = self.pc(command, words);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{output:?}");
        assert!(said.contains(why), "{command} {words:?}: {said}");
    }
}

impl Drop for Control {
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

fn text(path: impl AsRef<Path>) -> String {
    std::fs::read_to_string(path).expect("a file")
}

const SHAFT: &str = "O0007 (轴);\nG00 X10.;\nM30;\n%\n";

#[test]
fn files_go_both_ways_and_are_renamed_and_deleted() {
    let folder = folder("files");
    let control = Control::with(&[]);
    let shaft = write(&folder, "O0007.CNC", SHAFT);
    let long: String = (1..600).map(|n| format!("N{n} G01 X{n}.;\n")).collect();
    let long = format!("O0100;\n{long}M30;\n%\n");
    let named = write(&folder, "long.nc", &long);
    let said = control.does("send", &[&shaft, &named]);
    assert!(
        said.contains("O0100.CNC") && said.contains("2 file(s)"),
        "{said}"
    );
    let listed = control.does("list", &[]);
    assert!(listed.contains("O0007.CNC"), "{listed}");
    assert!(
        listed.contains(&format!("O0100.CNC    {:>8}", long.len())),
        "{listed}"
    );
    assert!(listed.contains("ParaW.par"), "{listed}");

    // Sending the same name again is refused.
    let asked = control.pc("send", &[&shaft]);
    assert_eq!(asked.status.code(), Some(2), "{asked:?}");
    let other = write(&folder, "other.nc", "O0007;\nM99;\n%\n");
    let word = format!("{other}=O0007.CNC");
    assert!(
        control
            .does("send", &[&word, "--on-existing", "skip"])
            .contains("skipped")
    );
    let renamed = control.does("send", &[&word, "--on-existing", "rename"]);
    assert!(renamed.contains("O0007.CNC is now O0008.CNC"), "{renamed}");
    let into = folder.join("received").to_string_lossy().into_owned();
    control.does(
        "receive",
        &["O0007.CNC", "O0008.CNC", "O0100.CNC", "--into", &into],
    );
    let got = |name: &str| text(Path::new(&into).join(name));
    assert_eq!(got("O0007.CNC"), "O0007;\nM99;\n%\n");
    assert_eq!(got("O0008.CNC"), SHAFT.replace("O0007", "O0008"));
    assert_eq!(got("O0100.CNC"), long);
    // An existing file is not overwritten without the option.
    let again = control.pc("receive", &["O0007.CNC", "--into", &into]);
    assert_eq!(again.status.code(), Some(2), "{again:?}");

    control.does("rename", &["O0008.CNC", "O0009.CNC"]);
    control.refuses("rename", &["O0009.CNC", "O0007.CNC"], "there already");
    control.does("delete", &["O0009.CNC"]);
    control.refuses("delete", &["O0009.CNC"], "no file of this name");
    control.refuses("receive", &["ParaW.par", "--into", &into], "switch");
    assert!(!control.does("list", &[]).contains("O0009"));
}

#[test]
fn a_whole_memory_is_saved_and_brought_back() {
    let folder = folder("backup");
    let saved = folder.join("saved");
    let data = folder.join("data");
    let options = ["--parameter-switch", "--data", &data.to_string_lossy()];
    let control = Control::with(&options);
    let shaft = write(&folder, "O0007.CNC", SHAFT);
    control.does("send", &[&shaft]);
    let said = control.does("backup", &[&saved.to_string_lossy()]);
    assert!(said.contains("4 file(s)"), "{said}");
    drop(control);
    // Another baud rate and another offset. The last file changes the rate of the line.
    let parameters = text(saved.join("ParaW.par")).replace("044=115200", "044=9600");
    assert!(parameters.contains("044=9600"), "{parameters}");
    write(&saved, "ParaW.par", &parameters);
    let offsets = text(saved.join("Tofs.ofs"));
    let changed = offsets.replacen("001=0.000,0.000", "001=1.500,-2.000", 1);
    assert_ne!(offsets, changed);
    write(&saved, "Tofs.ofs", &changed);

    let control = Control::with(&["--parameter-switch"]);
    let said = control.does("restore", &[&saved.to_string_lossy()]);
    assert!(said.contains("4 file(s)"), "{said}");
    let again = folder.join("again").to_string_lossy().into_owned();
    // The pseudo terminal has no baud rate, but the transfer uses that of parameter 044.
    control.does("backup", &[&again, "--baud", "9600"]);
    for file in ["O0007.CNC", "Tofs.ofs", "Wcomp.wmp", "ParaW.par"] {
        assert_eq!(
            text(Path::new(&again).join(file)),
            text(saved.join(file)),
            "{file}"
        );
    }
    // An invalid line keeps the whole file out, and the control names it.
    let bad = write(&folder, "Tofs.ofs", "001=1,2,3,4\n077=0,0,0,0\n");
    control.refuses(
        "send",
        &[&bad, "--baud", "9600", "--on-existing", "overwrite"],
        "content",
    );
    control.does(
        "receive",
        &[
            "Tofs.ofs",
            "--into",
            &again,
            "--overwrite",
            "--baud",
            "9600",
        ],
    );
    assert_eq!(text(Path::new(&again).join("Tofs.ofs")), changed);
}

#[test]
fn programs_go_as_text_into_a_control_and_out_of_it() {
    let folder = folder("text");
    let program = "O0331 (TEXT);\nG00 X10.;\nM30;\n%\n";
    let file = write(&folder, "O0331.CNC", program);
    let control = Control::with(&["--param", "44=19200"]);
    control.does(
        "send-text",
        &[&file, "--baud", "19200", "--line-end", "lfcrcr"],
    );
    let into = folder.join("in").to_string_lossy().into_owned();
    control.does(
        "receive",
        &["O0331.CNC", "--into", &into, "--baud", "19200"],
    );
    assert_eq!(text(Path::new(&into).join("O0331.CNC")), program);

    // The key OUT sends the program.
    let control = Control::with(&["--text", "cr", "--out", &file, "--out-after", "1"]);
    let out = folder.join("out").to_string_lossy().into_owned();
    control.does("receive-text", &[&out, "--wait", "30"]);
    assert_eq!(text(Path::new(&out).join("O0331.CNC")), program);
}

/// A control in this process: EDIT mode, program page, O0331 is typed.
fn about_to_send(param: &[(u16, i32)]) -> Emulator {
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
fn what_the_key_sends_comes_to_a_pc_and_the_lcd_follows_the_line() {
    let folder = folder("key");
    let (mut kernel, console) = Kernel::new(about_to_send(&[]));
    kernel.take_serial_line(SerialLine::open(End::Terminal, None).expect("a thread"));
    let outside = Outside {
        wake: Box::new(|| {}),
        keeper: None,
        partner: None,
        ending: Ending::default(),
    };
    let mut thread = start(kernel, &console, outside).expect("a thread");
    let said = |id: Id| {
        let end = Instant::now() + Duration::from_secs(60);
        loop {
            let left = end.saturating_duration_since(Instant::now());
            match console.notices.recv_timeout(left).expect("a notice") {
                gsk_app::kernel::Notice::Said(said) if said.id() == id => return said,
                _ => {}
            }
        }
    };
    let shows = |word: &str| {
        let end = Instant::now() + Duration::from_secs(60);
        while Instant::now() < end {
            if let Some(picture) = console.pictures.pop()
                && picture.screen.text().contains(word)
            {
                return;
            }
            std::thread::sleep(Duration::from_millis(2));
        }
        panic!("{word} never stands on the LCD");
    };
    let port = said(Id::SerialLineOpened);
    let port = port.plain_value("port").expect("its name").to_owned();
    // No PC is connected.
    console.send(Order::Tap(Key::Output));
    shows("输出");
    shows("串口未连接");

    let mut pc = executable()
        .args(["transfer", "wait", "--files", "1", "--port", &port])
        .arg(&folder.0)
        .stdout(Stdio::piped())
        .spawn()
        .expect("the program");
    let mut lines = BufReader::new(pc.stdout.take().expect("its output")).lines();
    // The PC is connected now.
    assert!(lines.next().is_some_and(|line| line.is_ok()));
    shows("输入");
    std::thread::sleep(Duration::from_millis(600));
    for character in "O331".chars() {
        console.send(Order::Type(character));
    }
    console.send(Order::Tap(Key::Output));
    said(Id::SerialSent);
    assert!(pc.wait().expect("its end").success());
    assert_eq!(text(folder.join("O0331.CNC")), "O0331;\nM30;\n%\n");
    thread.stop();
}

#[test]
fn what_is_wrong_at_the_pc_is_said() {
    let folder = folder("wrong");
    let file = write(&folder, "shaft.txt", "G00 X1;\n");
    let call = |words: &[&str]| {
        let output = executable().arg("transfer").args(words).output();
        let output = output.expect("the program");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        (output.status.code(), said)
    };
    let (code, said) = call(&["send", "--port", "/dev/no-such-port", &file]);
    assert!(code == Some(2) && said.contains("FILE=NAME"), "{said}");
    let word = format!("{file}=O0001.CNC");
    let (code, said) = call(&["send", "--port", "/dev/no-such-port", &word]);
    assert!(
        code == Some(2) && said.contains("/dev/no-such-port"),
        "{said}"
    );
    let (code, said) = call(&["send", "--port", "x", &word, &word]);
    assert!(code == Some(2) && said.contains("written twice"), "{said}");
    let (code, said) = call(&["send", "--port", "x", &format!("{file}=轴.CNC")]);
    assert!(code == Some(2) && said.contains("eight letters"), "{said}");
    let chinese = write(&folder, "O0001.CNC", "O0001;\n(轴);\n");
    let (code, said) = call(&["send-text", "--port", "x", &chinese]);
    assert!(code == Some(2) && said.contains("line 2"), "{said}");
}

#[test]
fn words_are_in_the_language_that_is_asked_for_and_the_port_that_of_the_window() {
    let folder = folder("language");
    let call = |words: &[&str]| {
        let mut command = executable();
        command.args(words).env("XDG_DATA_HOME", &folder.0);
        let output = command.output().expect("the program");
        let said = [&output.stdout, &output.stderr].map(|it| String::from_utf8_lossy(it));
        (output.status.code(), said.concat())
    };
    let (code, said) = call(&["transfer", "list"]);
    assert!(code == Some(2) && said.contains("--port PORT"), "{said}");
    let (code, said) = call(&["transfer", "list", "--lang", "zh"]);
    assert!(code == Some(2) && said.contains("没有指定端口"), "{said}");
    let none = ["link", "test", "/dev/no-such-port", "--lang", "zh"];
    let (code, said) = call(&none);
    assert!(code == Some(2) && said.contains("不能打开"), "{said}");

    let control = Control::with(&[]);
    let data = folder.join("gsk980td");
    std::fs::create_dir_all(&data).expect("a folder");
    let settings = format!("(transfer:(port:{:?},baud:115200))", control.port);
    write(&data, "window.ron", &settings);
    let file = write(&folder, "O0007.CNC", SHAFT);
    let (code, said) = call(&["transfer", "send", &file, "--lang", "zh"]);
    assert!(code == Some(0) && said.contains("传输速率"), "{said}");
    let other = ["transfer", "list", "--port", "/dev/no-such-port"];
    let (code, said) = call(&other);
    assert!(
        code == Some(2) && said.contains("/dev/no-such-port"),
        "{said}"
    );
}

#[test]
fn noise_and_a_partner_that_breaks_off_leave_nothing_behind() {
    let folder = folder("noise");
    let control = Control::with(&[]);
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
    let listed = control.does("list", &[]);
    assert!(!listed.contains("O0100"), "{listed}");
    let shaft = write(&folder, "O0007.CNC", SHAFT);
    control.does("send", &[&shaft]);
    let listed = control.does("list", &[]);
    assert!(
        listed.contains("O0007.CNC") && !listed.contains("O0001"),
        "{listed}"
    );
}
