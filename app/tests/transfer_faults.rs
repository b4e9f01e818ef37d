//! Transfers between the PC's side and the control, in separate processes, over two pseudo
//! terminals with a faulty line between them. The line loses, doubles and flips bytes, has
//! another baud rate, or is unplugged. A file arrives whole or not at all, and the messages
//! report what has happened.
//!
//! `ROUNDS=500 cargo test -p gsk980td --test program transfer_faults` tests 500 random faults
//! (about four minutes). The default is a few.

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Lines, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, Output, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::Duration;

use gsk_host::pc::{TransferObserver, TransferSession};
use gsk_host::ports::{OfferedPort, Port};
use gsk_transfer::{FileName, Partition, RemotePath, TransferFile};

use crate::process::executable;
use crate::serial::{ControlProcess, serial_folder};

const BAUD: u32 = 115_200;
/// Count of controls that run in parallel.
const PARALLEL_CONTROLS: u64 = 8;

fn rounds() -> u64 {
    std::env::var("ROUNDS").map_or(PARALLEL_CONTROLS, |rounds| {
        rounds.parse().expect("a number")
    })
}

/// A pseudo-random number generator.
struct FaultRandom(u64);

impl FaultRandom {
    fn next_below(&mut self, end: u64) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % end.max(1)
    }
}

/// A fault of the line.
#[derive(Clone, Copy, Debug, PartialEq)]
enum LineFault {
    Lost,
    Doubled,
    Flipped(u8),
    /// The cable is unplugged from here on, in both directions.
    CableUnplugged,
    /// The port of the PC is gone from here on: its adapter is unplugged.
    PortGone,
    /// Both ends have different baud rates from the beginning.
    WrongBaudRate,
}

/// A fault: direction (0 to the control, 1 to the PC), index of the byte, kind.
#[derive(Clone, Copy, Debug)]
struct PlacedFault(usize, u64, LineFault);

impl PlacedFault {
    fn to_text(self) -> String {
        let fault = match self.2 {
            LineFault::Lost => "lost",
            LineFault::Doubled => "doubled",
            LineFault::CableUnplugged => "out",
            LineFault::PortGone => "gone",
            LineFault::WrongBaudRate => "speed",
            LineFault::Flipped(bits) => return format!("{} {} {bits}", self.0, self.1),
        };
        format!("{} {} {fault}", self.0, self.1)
    }

    fn from_text(text: &str) -> Self {
        let fields: Vec<&str> = text.split(' ').collect();
        let number = |index: usize| fields[index].parse::<u64>().expect("a number");
        let fault = match fields[2] {
            "lost" => LineFault::Lost,
            "doubled" => LineFault::Doubled,
            "out" => LineFault::CableUnplugged,
            "gone" => LineFault::PortGone,
            "speed" => LineFault::WrongBaudRate,
            _ => LineFault::Flipped(number(2) as u8),
        };
        Self(number(0) as usize, number(1), fault)
    }
}

/// The faults of a round.
#[derive(Clone, Debug)]
struct FaultPlan {
    faults: Vec<PlacedFault>,
}

/// The state of a line: bytes carried per direction, and faults so far.
#[derive(Debug, Default)]
struct LineState {
    counts: [u64; 2],
    fault_count: usize,
    is_unplugged: bool,
    is_port_gone: bool,
}

impl LineState {
    /// Carries bytes in a direction. Returns what arrives at the other end.
    fn carry(&mut self, plan: &FaultPlan, direction: usize, bytes: &[u8]) -> Vec<u8> {
        let mut arriving = Vec::new();
        for byte in bytes {
            let index = self.counts[direction];
            self.counts[direction] += 1;
            let mut carried = vec![*byte];
            for PlacedFault(fault_direction, count, fault) in &plan.faults {
                match fault {
                    // Received at another baud rate, each byte becomes two others.
                    LineFault::WrongBaudRate => {
                        carried = vec![byte.rotate_left(3) ^ 0xE0, byte | 0xF0];
                    }
                    _ if (*fault_direction, *count) != (direction, index) => continue,
                    LineFault::Lost => carried.clear(),
                    LineFault::Doubled => carried.push(*byte),
                    LineFault::Flipped(bits) => carried = vec![byte ^ bits],
                    LineFault::CableUnplugged => self.is_unplugged = true,
                    LineFault::PortGone => self.is_port_gone = true,
                }
                self.fault_count += 1;
            }
            if !self.is_unplugged && !self.is_port_gone {
                arriving.extend(carried);
            }
        }
        arriving
    }
}

/// A line between a new pseudo terminal and the control's. It is a separate process: child
/// processes of the test inherit its pseudo terminals, and a port would never disappear.
struct FaultyLine {
    port: String,
    child: Child,
    output: Lines<BufReader<ChildStdout>>,
}

/// Environment variable of the line's process: the port of the control and the faults as text.
const LINE_VARIABLE: &str = "GSK980TD_TEST_LINE";

impl FaultyLine {
    fn start(control: &str, plan: &FaultPlan) -> Self {
        let mut fields = vec![control.to_owned()];
        fields.extend(plan.faults.iter().map(|fault| fault.to_text()));
        let mut child = Command::new(std::env::current_exe().expect("this test"))
            .args(["--exact", "--nocapture", "transfer_faults::the_line_itself"])
            .env(LINE_VARIABLE, fields.join(";"))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("a process");
        let mut output = BufReader::new(child.stdout.take().expect("its output")).lines();
        let port = read_value(&mut output, "port:");
        Self {
            port,
            child,
            output,
        }
    }

    /// Ends the line. Returns the count of faults that occurred.
    fn stop(mut self) -> usize {
        drop(self.child.stdin.take());
        let fault_count = read_value(&mut self.output, "faults:");
        self.child.wait().expect("its end");
        fault_count.parse().expect("a number")
    }
}

/// The value after a word in the output. The test harness prints more on the same line.
fn read_value(output: &mut Lines<BufReader<ChildStdout>>, word: &str) -> String {
    let mut lines = output.map(|line| line.expect("a line"));
    let value = lines.find_map(|line| Some(line.split_once(word)?.1.trim().to_owned()));
    value.unwrap_or_else(|| panic!("the line never says {word}"))
}

/// The process of a line. Without its environment variable the test does nothing.
#[test]
fn the_line_itself() {
    let Ok(text) = std::env::var(LINE_VARIABLE) else {
        return;
    };
    let mut fields = text.split(';');
    let control = fields.next().expect("the control's port");
    let faults = fields.map(PlacedFault::from_text).collect();
    let fault_count = run_line(control, &FaultPlan { faults });
    println!("\nfaults: {fault_count}");
}

/// Carries bytes until the standard input is closed. Returns the count of faults that
/// occurred.
fn run_line(control: &str, plan: &FaultPlan) -> usize {
    let mut pc_end = Some(OfferedPort::open(None).expect("a pseudo terminal"));
    let time_limit = Duration::from_secs(5);
    let mut control_end =
        Port::open_with_retry(control, BAUD, time_limit).expect("the control's port");
    if let Some(near) = &pc_end {
        println!("\nport: {}", near.name().expect("its name"));
    }
    let is_ended = Arc::new(AtomicBool::new(false));
    let end_flag = Arc::clone(&is_ended);
    thread::spawn(move || {
        let _ = std::io::stdin().read_to_end(&mut Vec::new());
        end_flag.store(true, Ordering::Relaxed);
    });
    let mut state = LineState::default();
    while !is_ended.load(Ordering::Relaxed) {
        if let Some(end) = &mut pc_end {
            let received = end.read().expect("the PC's end");
            write_all(&mut control_end, &state.carry(plan, 0, &received));
        }
        let received = control_end.read().expect("the control's end");
        let arriving = state.carry(plan, 1, &received);
        if state.is_port_gone {
            pc_end = None;
        }
        if let Some(end) = &mut pc_end {
            end.write(&arriving).expect("the PC's end");
        }
    }
    state.fault_count
}

fn write_all(port: &mut Port, mut bytes: &[u8]) {
    while !bytes.is_empty() {
        bytes = &bytes[port.write(bytes).expect("the control's end")..];
    }
}

/// An operation of the PC's side.
#[derive(Clone, Copy, Debug, PartialEq)]
enum TransferWork {
    Send,
    Receive,
    List,
    Rename,
    Delete,
}

/// Programs in the control: text by file name.
type ControlFiles = BTreeMap<String, String>;

const OLD: &str = "O0001 (OLD);\nM30;\n%\n";

/// A program of about `bytes` bytes.
fn make_program(number: u16, bytes: u64, random: &mut FaultRandom) -> String {
    let mut text = format!("O{number:04};\n");
    while (text.len() as u64) < bytes {
        text.push_str(&format!(
            "G01 X{}.{} F100;\n",
            random.next_below(90),
            random.next_below(1000)
        ));
    }
    text + "M30;\n%\n"
}

struct SilentWatch;
impl TransferObserver for SilentWatch {}

/// Connects to the control.
fn connect(port: &str) -> TransferSession {
    let mut session = TransferSession::open(port, BAUD, Box::new(SilentWatch)).expect("the port");
    session.connect().expect("the control answers");
    session
}

fn remote_path(name: &str) -> RemotePath {
    RemotePath {
        partition: Partition::User,
        name: FileName::new(name).expect("a name"),
    }
}

/// Stores exactly these programs in the control, over a line without faults.
fn prepare(port: &str, files: &ControlFiles) {
    let mut session = connect(port);
    for entry in session.list(Partition::User).expect("listed") {
        if entry.name.program_number().is_some() && !files.contains_key(entry.name.as_str()) {
            let name = entry.name.clone();
            let order = gsk_transfer::PcCommand::Delete(remote_path(name.as_str()));
            session.change(&name, order).expect("deleted");
        }
    }
    for (name, text) in files {
        let file = TransferFile {
            remote_path: remote_path(name),
            bytes: text.clone().into_bytes(),
            overwrite: true,
        };
        session.send(file).expect("sent");
    }
    session.close();
}

/// The programs in the control, read over a line without faults.
fn read_files(port: &str) -> ControlFiles {
    let mut session = connect(port);
    let entries = session.list(Partition::User).expect("listed");
    let programs = entries
        .into_iter()
        .filter(|it| it.name.program_number().is_some());
    let files = programs.map(|entry| {
        let name = entry.name.to_string();
        let bytes = session.receive(remote_path(&name)).expect("received");
        (name, String::from_utf8(bytes).expect("a text"))
    });
    let files = files.collect();
    session.close();
    files
}

/// A round at a control.
struct FaultRound<'a> {
    work: TransferWork,
    files_before: ControlFiles,
    new_text: String,
    receive_folder: &'a Path,
}

impl FaultRound<'_> {
    /// The programs in the control after the operation without a fault.
    fn expected_files(&self) -> ControlFiles {
        let mut files = self.files_before.clone();
        match self.work {
            TransferWork::Send => {
                files.insert("O0001.CNC".to_owned(), self.new_text.clone());
            }
            TransferWork::Rename => {
                let old = files.remove("O0001.CNC").expect("it was there");
                files.insert("O0003.CNC".to_owned(), old.replace("O0001", "O0003"));
            }
            TransferWork::Delete => {
                files.remove("O0001.CNC");
            }
            TransferWork::Receive | TransferWork::List => {}
        }
        files
    }

    /// Runs the program with the operation of the round.
    fn run(&self, port: &str) -> Output {
        let file = self.receive_folder.with_extension("nc");
        std::fs::write(&file, &self.new_text).expect("written");
        let send = format!("{}=O0001.CNC", file.display());
        let into = self.receive_folder.display().to_string();
        let arguments: Vec<&str> = match self.work {
            TransferWork::Send => vec!["send", &send, "--on-existing", "overwrite"],
            TransferWork::Receive => vec!["receive", "O0002.CNC", "--into", &into],
            TransferWork::List => vec!["list"],
            TransferWork::Rename => vec!["rename", "O0001.CNC", "O0003.CNC"],
            TransferWork::Delete => vec!["delete", "O0001.CNC"],
        };
        let mut command = executable();
        command
            .arg("transfer")
            .args(arguments)
            .args(["--port", port]);
        let output = command.stdin(Stdio::null()).output();
        output.expect("the program")
    }

    /// Whether a file was received. Asserts that it is complete.
    fn has_received(&self) -> bool {
        let names: Vec<PathBuf> = match std::fs::read_dir(self.receive_folder) {
            Ok(entries) => entries
                .map(|entry| entry.expect("an entry").path())
                .collect(),
            Err(_) => Vec::new(),
        };
        match names.as_slice() {
            [] => false,
            [one] => {
                assert_eq!(one.file_name(), Some("O0002.CNC".as_ref()));
                let text = std::fs::read_to_string(one).expect("read");
                assert_eq!(Some(&text), self.files_before.get("O0002.CNC"));
                true
            }
            more => panic!("{more:?}"),
        }
    }
}

/// The faults of a round: one kind, at one or two random positions.
fn make_plan(kind: u64, work: TransferWork, length: u64, random: &mut FaultRandom) -> FaultPlan {
    // Approximate count of bytes: the file in its direction, the answers in the other.
    let byte_count = |carrying_work: TransferWork, length: u64| {
        60 + if work == carrying_work {
            length + length / 40
        } else {
            0
        }
    };
    let lengths = [
        byte_count(TransferWork::Send, length),
        byte_count(TransferWork::Receive, length),
    ];
    let mut random_position = || {
        let direction = random.next_below(2) as usize;
        (direction, random.next_below(lengths[direction]))
    };
    let (direction, index) = random_position();
    let single = |fault| vec![PlacedFault(direction, index, fault)];
    let faults = match kind {
        0 => single(LineFault::Lost),
        1 => single(LineFault::Doubled),
        2 => single(LineFault::Flipped(1 << (index % 8))),
        3 => single(LineFault::PortGone),
        4 => {
            let (other_direction, other_index) = random_position();
            vec![
                PlacedFault(direction, index, LineFault::Lost),
                PlacedFault(other_direction, other_index, LineFault::Flipped(0x55)),
            ]
        }
        5 => single(LineFault::CableUnplugged),
        6 => single(LineFault::WrongBaudRate),
        _ => Vec::new(),
    };
    FaultPlan { faults }
}

/// Asserts the allowed results of a round.
fn assert_result(round: &FaultRound, plan: &FaultPlan, output: &Output, files: &ControlFiles) {
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    let context = format!("{:?} {plan:?}: {output:?}", round.work);
    let code = output.status.code();
    let expected = round.expected_files();
    let has_received = round.has_received();
    let is_complete = *files == expected && (round.work != TransferWork::Receive || has_received);
    assert!(
        *files == expected || *files == round.files_before,
        "half of it: {context}"
    );
    let fault = plan.faults.first().map(|it| it.2);
    match fault {
        Some(LineFault::WrongBaudRate) => {
            assert_eq!(code, Some(1), "{context}");
            assert!(errors.contains("baud rate (044)"), "{context}");
            assert!(*files == round.files_before && !has_received, "{context}");
        }
        Some(LineFault::CableUnplugged | LineFault::PortGone) if code == Some(1) => {
            let reason = match fault {
                Some(LineFault::PortGone) => "the port is gone",
                _ => "does not answer",
            };
            assert!(errors.contains(reason), "{context}");
        }
        // The transfer was repeated until it succeeded, or the fault came after its end.
        _ => {
            assert_eq!(code, Some(0), "{context}");
            assert!(is_complete, "{context}");
        }
    }
}

/// Count of rounds with a fault, and of rounds that a fault has ended.
type FaultCounts = (usize, usize);

fn run_control(number: u64, rounds: u64, kinds: u64, counts: &Mutex<FaultCounts>) {
    let mut random = FaultRandom(100 + number);
    let control = ControlProcess::start(&[]);
    let folder = serial_folder(&format!("faults-{number}"));
    for index in 0..rounds {
        let works = [
            TransferWork::Send,
            TransferWork::Receive,
            TransferWork::List,
            TransferWork::Rename,
            TransferWork::Delete,
        ];
        // The default run uses the long operations, with each kind of fault twice.
        let (kind, work) = match rounds {
            1 => ((number / 2) % kinds, works[(number % 2) as usize]),
            _ => (
                random.next_below(kinds),
                works[random.next_below(5) as usize],
            ),
        };
        let length = 200 + random.next_below(4000);
        let receive_folder = folder.join(format!("into-{index}"));
        let round = FaultRound {
            work,
            files_before: ControlFiles::from([
                ("O0001.CNC".to_owned(), OLD.to_owned()),
                ("O0002.CNC".to_owned(), make_program(2, length, &mut random)),
            ]),
            new_text: make_program(1, length, &mut random),
            receive_folder: &receive_folder,
        };
        prepare(&control.port, &round.files_before);
        let plan = make_plan(kind, work, length, &mut random);
        let line = FaultyLine::start(&control.port, &plan);
        let output = round.run(&line.port);
        let fault_count = line.stop();
        assert_result(&round, &plan, &output, &read_files(&control.port));
        let mut counts = counts.lock().expect("the lanes go on");
        counts.0 += usize::from(fault_count > 0);
        counts.1 += usize::from(!output.status.success());
    }
    std::fs::remove_dir_all(folder).expect("clean");
}

#[test]
fn a_faulty_line_never_leaves_incomplete_files() {
    let rounds = rounds();
    let is_long_run = rounds > PARALLEL_CONTROLS;
    // An unplugged cable is detected after seven seconds: only the long run includes it.
    let kinds = if is_long_run { 7 } else { 4 };
    let counts = Mutex::new((0, 0));
    thread::scope(|scope| {
        for number in 0..PARALLEL_CONTROLS {
            let share = rounds / PARALLEL_CONTROLS + u64::from(number < rounds % PARALLEL_CONTROLS);
            let counts = &counts;
            scope.spawn(move || run_control(number, share, kinds, counts));
        }
    });
    let (with_fault, ended) = counts.into_inner().expect("no lane has failed");
    println!("{rounds} rounds: a fault in {with_fault}, {ended} ended by one");
    assert!(with_fault as u64 >= rounds / 2, "{with_fault} of {rounds}");
    assert!(ended > 0, "no round was ended by a fault");
}
