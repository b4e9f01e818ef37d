//! Tests of both sides over a line in virtual time that loses, doubles and changes bytes, and whose
//! cable is disconnected.

#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "tests fail by panicking"
)]

use gsk_twins::wire::TwinWire;

use super::*;

mod damage;

const STEP_NS: u64 = 1_000_000;

/// A file memory of the control without restrictions.
#[derive(Default)]
struct Memory {
    files: Vec<(FileName, Vec<u8>)>,
    refusal: Option<TransferFault>,
}

impl Memory {
    fn content(&self, name: &FileName) -> Option<&Vec<u8>> {
        let mut files = self.files.iter();
        files
            .find(|(known, _)| known == name)
            .map(|(_, bytes)| bytes)
    }

    fn check_allowed(&self) -> Result<(), TransferFault> {
        self.refusal.map_or(Ok(()), Err)
    }
}

impl FileStore for Memory {
    fn directory(&mut self, _: Partition) -> Result<Vec<DirectoryEntry>, TransferFault> {
        let files = self.files.iter().map(|(name, bytes)| DirectoryEntry {
            name: name.clone(),
            size: bytes.len() as u32,
        });
        Ok(files.collect())
    }

    fn check_put(&mut self, put: &PutRequest) -> Result<(), TransferFault> {
        self.check_allowed()?;
        match self.content(&put.remote_path.name) {
            Some(_) if !put.overwrite => Err(TransferFault::Exists),
            _ => Ok(()),
        }
    }

    fn put(&mut self, file: &TransferFile) -> Result<(), TransferFault> {
        self.check_allowed()?;
        self.files
            .retain(|(name, _)| *name != file.remote_path.name);
        let (name, bytes) = (file.remote_path.name.clone(), file.bytes.clone());
        self.files.push((name, bytes));
        Ok(())
    }

    fn get(&mut self, path: &RemotePath) -> Result<Vec<u8>, TransferFault> {
        self.check_allowed()?;
        self.content(&path.name)
            .cloned()
            .ok_or(TransferFault::NotFound)
    }

    fn delete(&mut self, path: &RemotePath) -> Result<(), TransferFault> {
        self.content(&path.name).ok_or(TransferFault::NotFound)?;
        self.files.retain(|(name, _)| *name != path.name);
        Ok(())
    }

    fn rename(&mut self, from: &RemotePath, to: &FileName) -> Result<(), TransferFault> {
        if self.content(to).is_some() {
            return Err(TransferFault::Exists);
        }
        let mut files = self.files.iter_mut();
        let file = files.find(|(name, _)| *name == from.name);
        file.ok_or(TransferFault::NotFound)?.0 = to.clone();
        Ok(())
    }
}

/// A PC and a control that a line in virtual time connects.
struct Line {
    pc: PcSide,
    control: ControlPort,
    memory: Memory,
    /// The wire towards the control, then the wire towards the PC.
    wires: [TwinWire; 2],
    now_ns: u64,
    events: Vec<ControlEvent>,
    statuses: Vec<PortStatus>,
    has_rate_mismatch: bool,
}

impl Line {
    fn new(baud: u32) -> Self {
        Self {
            pc: PcSide::new(baud),
            control: ControlPort::new(baud, Framing::Frames, TextLineEnd::CrLf),
            memory: Memory::default(),
            wires: [TwinWire::new(baud), TwinWire::new(baud)],
            now_ns: 0,
            events: Vec::new(),
            statuses: Vec::new(),
            has_rate_mismatch: false,
        }
    }

    fn now(&self) -> PortTime {
        PortTime::from_nanos(self.now_ns)
    }

    fn take_arrived(&mut self, wire: usize) -> Vec<u8> {
        let now = self.now_ns;
        let arrived: Vec<u8> = core::iter::from_fn(|| self.wires[wire].receive(now)).collect();
        match self.has_rate_mismatch {
            false => arrived,
            // A byte read at twice the rate becomes two other bytes.
            true => arrived
                .iter()
                .flat_map(|b| [b.rotate_left(3) ^ 0xE0, b | 0xF0])
                .collect(),
        }
    }

    /// Advances the virtual time by 1 ms and returns an outcome of the PC, if any.
    fn step(&mut self) -> Option<TransferOutcome> {
        self.now_ns += STEP_NS;
        let (now, now_ns) = (self.now(), self.now_ns);
        let received = self.take_arrived(0);
        self.control.receive(&received, now);
        self.control.advance(now, &mut self.memory);
        while let Some(event) = self.control.next_event() {
            self.events.push(event);
        }
        let status = self.control.status(now);
        if self.statuses.last() != Some(&status) {
            self.statuses.push(status);
        }
        let wire = &mut self.wires[1];
        self.control.write(now, |bytes| {
            wire.send(bytes, now_ns);
            bytes.len()
        });
        let received = self.take_arrived(1);
        self.pc.receive(&received, now);
        let outcome = self.pc.advance(now);
        let due = self.pc.pending_bytes(now).to_vec();
        self.wires[0].send(&due, now_ns);
        self.pc.mark_sent(due.len());
        outcome
    }

    fn outcome(&mut self) -> TransferOutcome {
        let outcome = (0..300_000).find_map(|_| self.step());
        outcome.expect("an outcome within five minutes")
    }

    fn run(&mut self, command: PcCommand) -> TransferOutcome {
        self.pc.start(command);
        self.outcome()
    }

    /// Runs for `ms` milliseconds; panics if the PC reports an outcome.
    fn run_for(&mut self, ms: u64) {
        for _ in 0..ms {
            if let Some(outcome) = self.step() {
                panic!("{outcome:?}");
            }
        }
    }
}

/// Pseudo-random numbers with a fixed seed.
struct Random(u64);

impl Random {
    fn below(&mut self, limit: u64) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % limit
    }

    fn bytes(&mut self, count: u64) -> Vec<u8> {
        (0..count).map(|_| self.below(256) as u8).collect()
    }
}

fn path(name: &str) -> RemotePath {
    RemotePath {
        partition: Partition::User,
        name: FileName::new(name).unwrap(),
    }
}

fn file(name: &str, bytes: &[u8], overwrite: bool) -> TransferFile {
    TransferFile {
        remote_path: path(name),
        bytes: bytes.to_vec(),
        overwrite,
    }
}

fn name(name: &str) -> FileName {
    FileName::new(name).unwrap()
}

#[test]
fn all_commands_succeed() {
    let mut line = Line::new(115_200);
    let bytes = Random(1).bytes(2000);
    assert_eq!(line.run(PcCommand::Connect), TransferOutcome::Done);
    let put = |overwrite| PcCommand::Put(file("O0001.CNC", &bytes, overwrite));
    assert_eq!(line.run(put(false)), TransferOutcome::Done);
    assert_eq!(line.events, [ControlEvent::Received(name("O0001.CNC"))]);
    assert_eq!(
        line.run(put(false)),
        TransferOutcome::Refused(TransferFault::Exists)
    );
    assert_eq!(line.run(put(true)), TransferOutcome::Done);
    assert_eq!(
        line.run(PcCommand::Put(file("A.CNC", b"", false))),
        TransferOutcome::Done
    );
    let TransferOutcome::Listed(entries) = line.run(PcCommand::Directory(Partition::User)) else {
        panic!("no list");
    };
    let sizes: Vec<_> = entries
        .iter()
        .map(|entry| (entry.name.as_str(), entry.size))
        .collect();
    assert_eq!(sizes, [("O0001.CNC", 2000), ("A.CNC", 0)]);
    let got = line.run(PcCommand::Get(path("O0001.CNC")));
    assert_eq!(got, TransferOutcome::Got(file("O0001.CNC", &bytes, true)));
    let rename = |from, to| PcCommand::Rename {
        from: path(from),
        to: name(to),
    };
    assert_eq!(
        line.run(rename("A.CNC", "O0001.CNC")),
        TransferOutcome::Refused(TransferFault::Exists)
    );
    assert_eq!(line.run(rename("A.CNC", "B.CNC")), TransferOutcome::Done);
    assert_eq!(
        line.run(PcCommand::Delete(path("B.CNC"))),
        TransferOutcome::Done
    );
    assert_eq!(
        line.run(PcCommand::Delete(path("B.CNC"))),
        TransferOutcome::Refused(TransferFault::NotFound)
    );
    assert_eq!(
        line.run(PcCommand::Get(path("B.CNC"))),
        TransferOutcome::Refused(TransferFault::NotFound)
    );
    assert_eq!(line.run(PcCommand::Bye), TransferOutcome::Done);
    line.run_for(1000);
    assert_eq!(line.pc.retransmissions(), 0);
    assert_eq!(line.statuses.last(), Some(&PortStatus::Idle));
    assert!(
        line.statuses.contains(&PortStatus::Receiving)
            && !line.statuses.contains(&PortStatus::Sending)
    );
}

#[test]
fn refusal_reports_reason_before_file_bytes() {
    for refusal in [
        TransferFault::Busy,
        TransferFault::SwitchOff,
        TransferFault::NoRight,
        TransferFault::Full,
    ] {
        let mut line = Line::new(115_200);
        line.memory.refusal = Some(refusal);
        line.run(PcCommand::Connect);
        let before = line.wires[0].sent_count();
        let outcome = line.run(PcCommand::Put(file("O1.CNC", &[b'X'; 5000], false)));
        assert_eq!(outcome, TransferOutcome::Refused(refusal));
        assert!(line.wires[0].sent_count() - before < 100);
        assert!(line.memory.files.is_empty());
        let refused = ControlEvent::Refused(name("O1.CNC"), refusal);
        assert_eq!(line.events, [refused]);
    }
}

#[test]
fn control_sends_files_to_idle_pc() {
    let mut line = Line::new(115_200);
    let bytes = Random(2).bytes(1500);
    line.control.send(vec![
        file("O1.CNC", &bytes, false),
        file("O2.CNC", b"x", false),
    ]);
    // Without a connection the control connects.
    assert_eq!(
        line.outcome(),
        TransferOutcome::Pushed(file("O1.CNC", &bytes, false))
    );
    assert_eq!(
        line.outcome(),
        TransferOutcome::Pushed(file("O2.CNC", b"x", false))
    );
    line.run_for(500);
    let sent = ["O1.CNC", "O2.CNC"].map(|sent| ControlEvent::Sent(name(sent)));
    assert_eq!(line.events, sent);
    assert_eq!(line.statuses, [PortStatus::Sending, PortStatus::Idle]);
    // A restarted PC knows no connection.
    line.pc = PcSide::new(115_200);
    line.control.send(vec![file("O3.CNC", b"y", false)]);
    assert_eq!(
        line.outcome(),
        TransferOutcome::Pushed(file("O3.CNC", b"y", false))
    );
    // A restarted control knows no connection.
    line.control = ControlPort::new(115_200, Framing::Frames, TextLineEnd::CrLf);
    let lost = line.run(PcCommand::Get(path("O1.CNC")));
    assert_eq!(lost, TransferOutcome::Lost(ConnectionLoss::PeerRestarted));
    assert_eq!(line.run(PcCommand::Connect), TransferOutcome::Done);
}

#[test]
fn both_sides_report_missing_peer() {
    let mut line = Line::new(115_200);
    line.wires.iter_mut().for_each(|wire| wire.set_cut(true));
    assert_eq!(
        line.run(PcCommand::Connect),
        TransferOutcome::Lost(ConnectionLoss::Silent)
    );
    assert_eq!(line.events, []);
    line.control.send(vec![file("O1.CNC", b"x", false)]);
    line.run_for(10_000);
    assert_eq!(line.events, [ControlEvent::NotConnected]);
    assert_eq!(
        line.statuses,
        [PortStatus::Idle, PortStatus::Sending, PortStatus::Idle]
    );
}

#[test]
fn both_sides_report_rate_mismatch() {
    let mut line = Line::new(115_200);
    line.has_rate_mismatch = true;
    line.pc.start(PcCommand::Connect);
    line.control.send(vec![file("O1.CNC", b"x", false)]);
    assert_eq!(line.outcome(), TransferOutcome::Lost(ConnectionLoss::Noise));
    line.run_for(10_000);
    assert!(!line.events.is_empty());
    let not_connected = |event: &ControlEvent| *event == ControlEvent::NotConnected;
    assert!(line.events.iter().all(not_connected), "{:?}", line.events);
    assert!(line.memory.files.is_empty());
    // The control detects it without sending, too.
    let mut line = Line::new(115_200);
    line.has_rate_mismatch = true;
    assert_eq!(
        line.run(PcCommand::Connect),
        TransferOutcome::Lost(ConnectionLoss::Silent)
    );
    assert!(line.events.iter().any(not_connected), "{:?}", line.events);
}

#[test]
fn two_controls_send_to_each_other() {
    let bytes = Random(8).bytes(3000);
    let mut controls =
        [(); 2].map(|()| ControlPort::new(115_200, Framing::Frames, TextLineEnd::CrLf));
    let mut memories = [Memory::default(), Memory::default()];
    let mut wires = [TwinWire::new(115_200), TwinWire::new(115_200)];
    controls[0].send(vec![file("O1.CNC", &bytes, false)]);
    let mut events = Vec::new();
    for ms in 1..20_000_u64 {
        // The second control replies in the same way, later.
        if ms == 5000 {
            controls[1].send(vec![file("O2.CNC", &bytes, false)]);
        }
        let now = PortTime::from_millis(ms);
        for at in 0..2 {
            let received: Vec<u8> =
                core::iter::from_fn(|| wires[at].receive(ms * STEP_NS)).collect();
            controls[at].receive(&received, now);
            controls[at].advance(now, &mut memories[at]);
            events
                .extend(core::iter::from_fn(|| controls[at].next_event()).map(|event| (at, event)));
            let wire = &mut wires[1 - at];
            controls[at].write(now, |bytes| {
                wire.send(bytes, ms * STEP_NS);
                bytes.len()
            });
        }
    }
    let expected = [
        (1, ControlEvent::Received(name("O1.CNC"))),
        (0, ControlEvent::Sent(name("O1.CNC"))),
        (0, ControlEvent::Received(name("O2.CNC"))),
        (1, ControlEvent::Sent(name("O2.CNC"))),
    ];
    assert_eq!(events, expected);
    assert_eq!(memories[1].content(&name("O1.CNC")), Some(&bytes));
    assert_eq!(memories[0].content(&name("O2.CNC")), Some(&bytes));
}

#[test]
fn text_is_received_beside_frames_and_sent_in_text_mode() {
    let mut line = Line::new(9600);
    let text = "O0007 (TEXT)\nG00 X10.\nM30\n";
    let mut writer = TextWriter::new(text, TextLineEnd::Lf, 9600).unwrap();
    while !writer.is_finished(line.now()) {
        let due = writer.pending_bytes(line.now()).to_vec();
        line.wires[0].send(&due, line.now_ns);
        writer.mark_sent(due.len(), line.now());
        line.run_for(1);
    }
    line.run_for(100);
    assert_eq!(line.events, [ControlEvent::Received(name("O0007.CNC"))]);
    assert_eq!(
        line.memory.content(&name("O0007.CNC")).unwrap(),
        text.as_bytes()
    );
    assert_eq!(
        line.statuses,
        [PortStatus::Idle, PortStatus::Receiving, PortStatus::Idle]
    );
    // All bytes at once, as from a pseudo terminal.
    let text = text.replace("O0007", "O0008");
    for chunk in ["%\n", &text, "%\n"] {
        line.control.receive(chunk.as_bytes(), line.now());
    }
    line.run_for(500);
    assert_eq!(
        line.memory.content(&name("O0008.CNC")).unwrap(),
        text.as_bytes()
    );
    // Frames are accepted after a text.
    assert_eq!(line.run(PcCommand::Connect), TransferOutcome::Done);

    // A slow line carries text only.
    let text = text.replace("O0008", "O0007");
    let mut slow = ControlPort::new(1200, Framing::Frames, TextLineEnd::CrLf);
    slow.send(vec![
        file("O0007.CNC", text.as_bytes(), false),
        file("ParaW.par", b"001=1\n", true),
    ]);
    let mut reader = TextReader::new(1200);
    let (mut read, mut events) = (Vec::new(), Vec::new());
    for ms in 1..3000 {
        let now = PortTime::from_millis(ms);
        slow.advance(now, &mut line.memory);
        slow.write(now, |bytes| {
            reader.receive(bytes, now);
            bytes.len()
        });
        read.extend(reader.advance(now));
        events.extend(slow.next_event());
    }
    assert_eq!(
        read,
        [TextEvent::Started, TextEvent::Complete(text.to_owned())]
    );
    let sent = ControlEvent::Sent(name("O0007.CNC"));
    assert_eq!(
        events,
        [sent, ControlEvent::OnlyPrograms(name("ParaW.par"))]
    );
}

/// Returns the share of the line rate that file bytes reach: to the control, and to the PC.
fn throughput(baud: u32) -> [f64; 2] {
    let bytes = Random(9).bytes(97 * 1024);
    [
        PcCommand::Put(file("O9.CNC", &bytes, true)),
        PcCommand::Get(path("O2.CNC")),
    ]
    .map(|command| {
        let mut line = Line::new(baud);
        line.memory.files = vec![(name("O2.CNC"), bytes.clone())];
        line.run(PcCommand::Connect);
        let begun = line.now_ns;
        assert!(!matches!(line.run(command), TransferOutcome::Lost(_)));
        assert_eq!(line.pc.retransmissions(), 0);
        let seconds = (line.now_ns - begun) as f64 * 1e-9;
        bytes.len() as f64 / seconds / (f64::from(baud) / 10.0)
    })
}

#[test]
fn file_throughput_is_near_line_rate() {
    for baud in [4800, 19_200, 115_200] {
        let [put, get] = throughput(baud);
        println!(
            "{baud} bits a second: {:.1} % of the wire to the control, {:.1} % from it",
            put * 100.0,
            get * 100.0
        );
        assert!(put > 0.95 && get > 0.95, "{baud}: {put} {get}");
    }
}
