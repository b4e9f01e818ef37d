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

use gsk_app::pc::{Talk, Watch};
use gsk_app::ports::{Offer, Port};
use gsk_transfer::{FileName, Partition, RemotePath, TransferFile};

use crate::process::executable;
use crate::serial::{Control, folder};

const BAUD: u32 = 115_200;
/// Count of controls that run in parallel.
const LANES: u64 = 8;

fn rounds() -> u64 {
    std::env::var("ROUNDS").map_or(LANES, |rounds| rounds.parse().expect("a number"))
}

/// A pseudo-random number generator.
struct Random(u64);

impl Random {
    fn below(&mut self, most: u64) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % most.max(1)
    }
}

/// A fault of the line.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    Lost,
    Doubled,
    Flipped(u8),
    /// The cable is unplugged from here on, in both directions.
    Out,
    /// The port of the PC is gone from here on: its adapter is unplugged.
    Gone,
    /// Both ends have different baud rates from the beginning.
    Speed,
}

/// A fault: direction (0 to the control, 1 to the PC), index of the byte, kind.
#[derive(Clone, Copy, Debug)]
struct Placed(usize, u64, Fault);

impl Placed {
    fn words(&self) -> String {
        let fault = match self.2 {
            Fault::Lost => "lost",
            Fault::Doubled => "doubled",
            Fault::Out => "out",
            Fault::Gone => "gone",
            Fault::Speed => "speed",
            Fault::Flipped(bits) => return format!("{} {} {bits}", self.0, self.1),
        };
        format!("{} {} {fault}", self.0, self.1)
    }

    fn of_words(words: &str) -> Self {
        let words: Vec<&str> = words.split(' ').collect();
        let number = |at: usize| words[at].parse::<u64>().expect("a number");
        let fault = match words[2] {
            "lost" => Fault::Lost,
            "doubled" => Fault::Doubled,
            "out" => Fault::Out,
            "gone" => Fault::Gone,
            "speed" => Fault::Speed,
            _ => Fault::Flipped(number(2) as u8),
        };
        Self(number(0) as usize, number(1), fault)
    }
}

/// The faults of a round.
#[derive(Clone, Debug)]
struct Plan {
    faults: Vec<Placed>,
}

/// The state of a line: bytes carried per direction, and faults so far.
#[derive(Debug, Default)]
struct Passed {
    counts: [u64; 2],
    hit: usize,
    out: bool,
    gone: bool,
}

impl Passed {
    /// Carries bytes in a direction. Returns what arrives at the other end.
    fn pass(&mut self, plan: &Plan, way: usize, bytes: &[u8]) -> Vec<u8> {
        let mut arrives = Vec::new();
        for byte in bytes {
            let at = self.counts[way];
            self.counts[way] += 1;
            let mut here = vec![*byte];
            for Placed(of, count, fault) in &plan.faults {
                match fault {
                    // Received at another baud rate, each byte becomes two others.
                    Fault::Speed => here = vec![byte.rotate_left(3) ^ 0xE0, byte | 0xF0],
                    _ if (*of, *count) != (way, at) => continue,
                    Fault::Lost => here.clear(),
                    Fault::Doubled => here.push(*byte),
                    Fault::Flipped(bits) => here = vec![byte ^ bits],
                    Fault::Out => self.out = true,
                    Fault::Gone => self.gone = true,
                }
                self.hit += 1;
            }
            if !self.out && !self.gone {
                arrives.extend(here);
            }
        }
        arrives
    }
}

/// A line between a new pseudo terminal and the control's. It is a separate process: child
/// processes of the test inherit its pseudo terminals, and a port would never disappear.
struct Line {
    port: String,
    child: Child,
    said: Lines<BufReader<ChildStdout>>,
}

/// Environment variable of the line's process: the port of the control and the faults as text.
const LINE: &str = "GSK980TD_TEST_LINE";

impl Line {
    fn between(control: &str, plan: &Plan) -> Self {
        let mut words = vec![control.to_owned()];
        words.extend(plan.faults.iter().map(Placed::words));
        let mut child = Command::new(std::env::current_exe().expect("this test"))
            .args(["--exact", "--nocapture", "transfer_faults::the_line_itself"])
            .env(LINE, words.join(";"))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("a process");
        let mut said = BufReader::new(child.stdout.take().expect("its output")).lines();
        let port = value(&mut said, "port:");
        Self { port, child, said }
    }

    /// Ends the line. Returns the count of faults that occurred.
    fn end(mut self) -> usize {
        drop(self.child.stdin.take());
        let hit = value(&mut self.said, "faults:");
        self.child.wait().expect("its end");
        hit.parse().expect("a number")
    }
}

/// The value after a word in the output. The test harness prints more on the same line.
fn value(said: &mut Lines<BufReader<ChildStdout>>, word: &str) -> String {
    let mut lines = said.map(|line| line.expect("a line"));
    let found = lines.find_map(|line| Some(line.split_once(word)?.1.trim().to_owned()));
    found.unwrap_or_else(|| panic!("the line never says {word}"))
}

/// The process of a line. Without its environment variable the test does nothing.
#[test]
fn the_line_itself() {
    let Ok(words) = std::env::var(LINE) else {
        return;
    };
    let mut words = words.split(';');
    let control = words.next().expect("the control's port");
    let faults = words.map(Placed::of_words).collect();
    let hit = carry(control, &Plan { faults });
    println!("\nfaults: {hit}");
}

/// Carries bytes until the standard input is closed. Returns the count of faults that
/// occurred.
fn carry(control: &str, plan: &Plan) -> usize {
    let mut near = Some(Offer::open(None).expect("a pseudo terminal"));
    let patience = Duration::from_secs(5);
    let mut far = Port::open_within(control, BAUD, patience).expect("the control's port");
    if let Some(near) = &near {
        println!("\nport: {}", near.name().expect("its name"));
    }
    let ends = Arc::new(AtomicBool::new(false));
    let ending = Arc::clone(&ends);
    thread::spawn(move || {
        let _ = std::io::stdin().read_to_end(&mut Vec::new());
        ending.store(true, Ordering::Relaxed);
    });
    let mut passed = Passed::default();
    while !ends.load(Ordering::Relaxed) {
        if let Some(end) = &mut near {
            let heard = end.read().expect("the PC's end");
            write(&mut far, &passed.pass(plan, 0, &heard));
        }
        let heard = far.read().expect("the control's end");
        let arrives = passed.pass(plan, 1, &heard);
        if passed.gone {
            near = None;
        }
        if let Some(end) = &mut near {
            end.write(&arrives).expect("the PC's end");
        }
    }
    passed.hit
}

fn write(port: &mut Port, mut bytes: &[u8]) {
    while !bytes.is_empty() {
        bytes = &bytes[port.write(bytes).expect("the control's end")..];
    }
}

/// An operation of the PC's side.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Work {
    Send,
    Receive,
    List,
    Rename,
    Delete,
}

/// Programs in the control: text by file name.
type Held = BTreeMap<String, String>;

const OLD: &str = "O0001 (OLD);\nM30;\n%\n";

/// A program of about `bytes` bytes.
fn program(number: u16, bytes: u64, random: &mut Random) -> String {
    let mut text = format!("O{number:04};\n");
    while (text.len() as u64) < bytes {
        text.push_str(&format!(
            "G01 X{}.{} F100;\n",
            random.below(90),
            random.below(1000)
        ));
    }
    text + "M30;\n%\n"
}

struct Silent;
impl Watch for Silent {}

/// Connects to the control.
fn talk(port: &str) -> Talk {
    let mut talk = Talk::open(port, BAUD, Box::new(Silent)).expect("the port");
    talk.connect().expect("the control answers");
    talk
}

fn place(name: &str) -> RemotePath {
    RemotePath {
        partition: Partition::User,
        name: FileName::new(name).expect("a name"),
    }
}

/// Stores exactly these programs in the control, over a line without faults.
fn prepare(port: &str, held: &Held) {
    let mut talk = talk(port);
    for entry in talk.list(Partition::User).expect("listed") {
        if entry.name.program_number().is_some() && !held.contains_key(entry.name.as_str()) {
            let name = entry.name.clone();
            let order = gsk_transfer::PcCommand::Delete(place(name.as_str()));
            talk.change(&name, order).expect("deleted");
        }
    }
    for (name, text) in held {
        let file = TransferFile {
            remote_path: place(name),
            bytes: text.clone().into_bytes(),
            overwrite: true,
        };
        talk.send(file).expect("sent");
    }
    talk.end();
}

/// The programs in the control, read over a line without faults.
fn held(port: &str) -> Held {
    let mut talk = talk(port);
    let entries = talk.list(Partition::User).expect("listed");
    let programs = entries
        .into_iter()
        .filter(|it| it.name.program_number().is_some());
    let held = programs.map(|entry| {
        let name = entry.name.to_string();
        let bytes = talk.receive(place(&name)).expect("received");
        (name, String::from_utf8(bytes).expect("a text"))
    });
    let held = held.collect();
    talk.end();
    held
}

/// A round at a control.
struct Round<'a> {
    work: Work,
    before: Held,
    new: String,
    into: &'a Path,
}

impl Round<'_> {
    /// The programs in the control after the operation without a fault.
    fn after(&self) -> Held {
        let mut after = self.before.clone();
        match self.work {
            Work::Send => {
                after.insert("O0001.CNC".to_owned(), self.new.clone());
            }
            Work::Rename => {
                let old = after.remove("O0001.CNC").expect("it was there");
                after.insert("O0003.CNC".to_owned(), old.replace("O0001", "O0003"));
            }
            Work::Delete => {
                after.remove("O0001.CNC");
            }
            Work::Receive | Work::List => {}
        }
        after
    }

    /// Runs the program with the operation of the round.
    fn call(&self, port: &str) -> Output {
        let file = self.into.with_extension("nc");
        std::fs::write(&file, &self.new).expect("written");
        let send = format!("{}=O0001.CNC", file.display());
        let into = self.into.display().to_string();
        let words: Vec<&str> = match self.work {
            Work::Send => vec!["send", &send, "--on-existing", "overwrite"],
            Work::Receive => vec!["receive", "O0002.CNC", "--into", &into],
            Work::List => vec!["list"],
            Work::Rename => vec!["rename", "O0001.CNC", "O0003.CNC"],
            Work::Delete => vec!["delete", "O0001.CNC"],
        };
        let mut command = executable();
        command.arg("transfer").args(words).args(["--port", port]);
        let output = command.stdin(Stdio::null()).output();
        output.expect("the program")
    }

    /// Whether a file was received. Asserts that it is complete.
    fn received(&self) -> bool {
        let names: Vec<PathBuf> = match std::fs::read_dir(self.into) {
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
                assert_eq!(Some(&text), self.before.get("O0002.CNC"));
                true
            }
            more => panic!("{more:?}"),
        }
    }
}

/// The faults of a round: one kind, at one or two random positions.
fn plan(kind: u64, work: Work, length: u64, random: &mut Random) -> Plan {
    // Approximate count of bytes: the file in its direction, the answers in the other.
    let there = |of: Work, length: u64| 60 + if work == of { length + length / 40 } else { 0 };
    let lengths = [there(Work::Send, length), there(Work::Receive, length)];
    let mut place = || {
        let way = random.below(2) as usize;
        (way, random.below(lengths[way]))
    };
    let (way, at) = place();
    let single = |fault| vec![Placed(way, at, fault)];
    let faults = match kind {
        0 => single(Fault::Lost),
        1 => single(Fault::Doubled),
        2 => single(Fault::Flipped(1 << (at % 8))),
        3 => single(Fault::Gone),
        4 => {
            let (other, there) = place();
            vec![
                Placed(way, at, Fault::Lost),
                Placed(other, there, Fault::Flipped(0x55)),
            ]
        }
        5 => single(Fault::Out),
        6 => single(Fault::Speed),
        _ => Vec::new(),
    };
    Plan { faults }
}

/// Asserts the allowed results of a round.
fn judge(round: &Round, plan: &Plan, output: &Output, held: &Held) {
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let context = format!("{:?} {plan:?}: {output:?}", round.work);
    let code = output.status.code();
    let after = round.after();
    let received = round.received();
    let whole = *held == after && (round.work != Work::Receive || received);
    assert!(
        *held == after || *held == round.before,
        "half of it: {context}"
    );
    let fault = plan.faults.first().map(|it| it.2);
    match fault {
        Some(Fault::Speed) => {
            assert_eq!(code, Some(1), "{context}");
            assert!(said.contains("speed (044)"), "{context}");
            assert!(*held == round.before && !received, "{context}");
        }
        Some(Fault::Out | Fault::Gone) if code == Some(1) => {
            let why = match fault {
                Some(Fault::Gone) => "the port is gone",
                _ => "does not answer",
            };
            assert!(said.contains(why), "{context}");
        }
        // The transfer was repeated until it succeeded, or the fault came after its end.
        _ => {
            assert_eq!(code, Some(0), "{context}");
            assert!(whole, "{context}");
        }
    }
}

/// Count of rounds with a fault, and of rounds that a fault has ended.
type Seen = (usize, usize);

fn lane(number: u64, rounds: u64, kinds: u64, seen: &Mutex<Seen>) {
    let mut random = Random(100 + number);
    let control = Control::with(&[]);
    let folder = folder(&format!("faults-{number}"));
    for at in 0..rounds {
        let works = [
            Work::Send,
            Work::Receive,
            Work::List,
            Work::Rename,
            Work::Delete,
        ];
        // The default run uses the long operations, with each kind of fault twice.
        let (kind, work) = match rounds {
            1 => ((number / 2) % kinds, works[(number % 2) as usize]),
            _ => (random.below(kinds), works[random.below(5) as usize]),
        };
        let length = 200 + random.below(4000);
        let into = folder.join(format!("into-{at}"));
        let round = Round {
            work,
            before: Held::from([
                ("O0001.CNC".to_owned(), OLD.to_owned()),
                ("O0002.CNC".to_owned(), program(2, length, &mut random)),
            ]),
            new: program(1, length, &mut random),
            into: &into,
        };
        prepare(&control.port, &round.before);
        let plan = plan(kind, work, length, &mut random);
        let line = Line::between(&control.port, &plan);
        let output = round.call(&line.port);
        let hit = line.end();
        judge(&round, &plan, &output, &held(&control.port));
        let mut seen = seen.lock().expect("the lanes go on");
        seen.0 += usize::from(hit > 0);
        seen.1 += usize::from(!output.status.success());
    }
    std::fs::remove_dir_all(folder).expect("clean");
}

#[test]
fn a_bad_line_at_random_places_loses_nothing_and_leaves_nothing_half() {
    let rounds = rounds();
    let many = rounds > LANES;
    // An unplugged cable is detected after seven seconds: only the long run includes it.
    let kinds = if many { 7 } else { 4 };
    let seen = Mutex::new((0, 0));
    thread::scope(|scope| {
        for number in 0..LANES {
            let share = rounds / LANES + u64::from(number < rounds % LANES);
            let seen = &seen;
            scope.spawn(move || lane(number, share, kinds, seen));
        }
    });
    let (hit, ended) = seen.into_inner().expect("no lane has failed");
    println!("{rounds} rounds: a fault in {hit}, {ended} ended by one");
    assert!(hit as u64 >= rounds / 2, "{hit} of {rounds}");
    assert!(ended > 0, "no round was ended by a fault");
}
