//! Both sides against each other over a line in virtual time that loses, doubles and
//! changes bytes, and whose cable is pulled.

#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "tests fail by panicking"
)]

use gsk_twins::wire::Wire;

use super::*;

mod damage;

const STEP_NS: u64 = 1_000_000;

/// A memory that keeps whatever it is given.
#[derive(Default)]
struct Memory {
    files: Vec<(FileName, Vec<u8>)>,
    refuses: Option<Fault>,
}

impl Memory {
    fn of(&self, name: &FileName) -> Option<&Vec<u8>> {
        let mut files = self.files.iter();
        files
            .find(|(known, _)| known == name)
            .map(|(_, bytes)| bytes)
    }

    fn allowed(&self) -> Result<(), Fault> {
        self.refuses.map_or(Ok(()), Err)
    }
}

impl Store for Memory {
    fn directory(&mut self, _: Partition) -> Result<Vec<Entry>, Fault> {
        let files = self.files.iter().map(|(name, bytes)| Entry {
            name: name.clone(),
            size: bytes.len() as u32,
        });
        Ok(files.collect())
    }

    fn may_put(&mut self, put: &Put) -> Result<(), Fault> {
        self.allowed()?;
        match self.of(&put.place.name) {
            Some(_) if !put.overwrite => Err(Fault::Exists),
            _ => Ok(()),
        }
    }

    fn put(&mut self, file: &NewFile) -> Result<(), Fault> {
        self.allowed()?;
        self.files.retain(|(name, _)| *name != file.place.name);
        let (name, bytes) = (file.place.name.clone(), file.bytes.clone());
        self.files.push((name, bytes));
        Ok(())
    }

    fn get(&mut self, place: &Place) -> Result<Vec<u8>, Fault> {
        self.allowed()?;
        self.of(&place.name).cloned().ok_or(Fault::NotFound)
    }

    fn delete(&mut self, place: &Place) -> Result<(), Fault> {
        self.of(&place.name).ok_or(Fault::NotFound)?;
        self.files.retain(|(name, _)| *name != place.name);
        Ok(())
    }

    fn rename(&mut self, from: &Place, to: &FileName) -> Result<(), Fault> {
        if self.of(to).is_some() {
            return Err(Fault::Exists);
        }
        let mut files = self.files.iter_mut();
        let file = files.find(|(name, _)| *name == from.name);
        file.ok_or(Fault::NotFound)?.0 = to.clone();
        Ok(())
    }
}

/// A PC and a control at the ends of a line.
struct Line {
    pc: PcSide,
    control: ControlPort,
    memory: Memory,
    /// To the control, and to the PC.
    wires: [Wire; 2],
    now_ns: u64,
    events: Vec<ControlEvent>,
    seen: Vec<Status>,
    /// The two sides have different rates.
    garbled: bool,
}

impl Line {
    fn at(baud: u32) -> Self {
        Self {
            pc: PcSide::new(baud),
            control: ControlPort::new(baud, Framing::Frames, LineEnd::CrLf),
            memory: Memory::default(),
            wires: [Wire::new(baud), Wire::new(baud)],
            now_ns: 0,
            events: Vec::new(),
            seen: Vec::new(),
            garbled: false,
        }
    }

    fn now(&self) -> HostTime {
        HostTime::from_nanos(self.now_ns)
    }

    fn arrived(&mut self, wire: usize) -> Vec<u8> {
        let now = self.now_ns;
        let arrived: Vec<u8> = core::iter::from_fn(|| self.wires[wire].receive(now)).collect();
        match self.garbled {
            false => arrived,
            // Read at twice the rate every byte becomes two others.
            true => arrived
                .iter()
                .flat_map(|b| [b.rotate_left(3) ^ 0xE0, b | 0xF0])
                .collect(),
        }
    }

    /// A millisecond.
    fn step(&mut self) -> Option<Outcome> {
        self.now_ns += STEP_NS;
        let (now, now_ns) = (self.now(), self.now_ns);
        let heard = self.arrived(0);
        self.control.hear(&heard, now);
        self.control.advance(now, &mut self.memory);
        while let Some(event) = self.control.next_event() {
            self.events.push(event);
        }
        let status = self.control.status(now);
        if self.seen.last() != Some(&status) {
            self.seen.push(status);
        }
        let wire = &mut self.wires[1];
        self.control.write(now, |bytes| {
            wire.send(bytes, now_ns);
            bytes.len()
        });
        let heard = self.arrived(1);
        self.pc.hear(&heard, now);
        let outcome = self.pc.advance(now);
        let due = self.pc.due(now).to_vec();
        self.wires[0].send(&due, now_ns);
        self.pc.sent(due.len());
        outcome
    }

    fn outcome(&mut self) -> Outcome {
        let outcome = (0..300_000).find_map(|_| self.step());
        outcome.expect("an outcome within five minutes")
    }

    fn order(&mut self, order: Order) -> Outcome {
        self.pc.order(order);
        self.outcome()
    }

    /// Lets time pass in which nothing is to come out.
    fn rest(&mut self, ms: u64) {
        for _ in 0..ms {
            if let Some(outcome) = self.step() {
                panic!("{outcome:?}");
            }
        }
    }
}

/// Numbers that look random.
struct Random(u64);

impl Random {
    fn below(&mut self, most: u64) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % most
    }

    fn bytes(&mut self, count: u64) -> Vec<u8> {
        (0..count).map(|_| self.below(256) as u8).collect()
    }
}

fn place(name: &str) -> Place {
    Place {
        partition: Partition::User,
        name: FileName::new(name).unwrap(),
    }
}

fn file(name: &str, bytes: &[u8], overwrite: bool) -> NewFile {
    NewFile {
        place: place(name),
        bytes: bytes.to_vec(),
        overwrite,
    }
}

fn name(name: &str) -> FileName {
    FileName::new(name).unwrap()
}

#[test]
fn every_kind_of_order_is_carried_out() {
    let mut line = Line::at(115_200);
    let bytes = Random(1).bytes(2000);
    assert_eq!(line.order(Order::Connect), Outcome::Done);
    let put = |overwrite| Order::Put(file("O0001.CNC", &bytes, overwrite));
    assert_eq!(line.order(put(false)), Outcome::Done);
    assert_eq!(line.events, [ControlEvent::Received(name("O0001.CNC"))]);
    assert_eq!(line.order(put(false)), Outcome::Refused(Fault::Exists));
    assert_eq!(line.order(put(true)), Outcome::Done);
    assert_eq!(
        line.order(Order::Put(file("A.CNC", b"", false))),
        Outcome::Done
    );
    let Outcome::Listed(entries) = line.order(Order::Directory(Partition::User)) else {
        panic!("no list");
    };
    let sizes: Vec<_> = entries
        .iter()
        .map(|entry| (entry.name.as_str(), entry.size))
        .collect();
    assert_eq!(sizes, [("O0001.CNC", 2000), ("A.CNC", 0)]);
    let got = line.order(Order::Get(place("O0001.CNC")));
    assert_eq!(got, Outcome::Got(file("O0001.CNC", &bytes, true)));
    let rename = |from, to| Order::Rename {
        from: place(from),
        to: name(to),
    };
    assert_eq!(
        line.order(rename("A.CNC", "O0001.CNC")),
        Outcome::Refused(Fault::Exists)
    );
    assert_eq!(line.order(rename("A.CNC", "B.CNC")), Outcome::Done);
    assert_eq!(line.order(Order::Delete(place("B.CNC"))), Outcome::Done);
    assert_eq!(
        line.order(Order::Delete(place("B.CNC"))),
        Outcome::Refused(Fault::NotFound)
    );
    assert_eq!(
        line.order(Order::Get(place("B.CNC"))),
        Outcome::Refused(Fault::NotFound)
    );
    assert_eq!(line.order(Order::Bye), Outcome::Done);
    line.rest(1000);
    assert_eq!(line.pc.retries(), 0);
    assert_eq!(line.seen.last(), Some(&Status::Idle));
    assert!(line.seen.contains(&Status::Receiving) && !line.seen.contains(&Status::Sending));
}

#[test]
fn what_the_control_refuses_is_refused_with_its_reason_before_a_byte_of_it_goes() {
    for refuses in [Fault::Busy, Fault::SwitchOff, Fault::NoRight, Fault::Full] {
        let mut line = Line::at(115_200);
        line.memory.refuses = Some(refuses);
        line.order(Order::Connect);
        let before = line.wires[0].sent_count();
        let outcome = line.order(Order::Put(file("O1.CNC", &[b'X'; 5000], false)));
        assert_eq!(outcome, Outcome::Refused(refuses));
        assert!(line.wires[0].sent_count() - before < 100);
        assert!(line.memory.files.is_empty());
        let refused = ControlEvent::Refused(name("O1.CNC"), refuses);
        assert_eq!(line.events, [refused]);
    }
}

#[test]
fn the_control_sends_by_itself_to_a_pc_that_is_idle() {
    let mut line = Line::at(115_200);
    let bytes = Random(2).bytes(1500);
    line.control.send(vec![
        file("O1.CNC", &bytes, false),
        file("O2.CNC", b"x", false),
    ]);
    // Not connected: the control does it.
    assert_eq!(
        line.outcome(),
        Outcome::Pushed(file("O1.CNC", &bytes, false))
    );
    assert_eq!(line.outcome(), Outcome::Pushed(file("O2.CNC", b"x", false)));
    line.rest(500);
    let sent = ["O1.CNC", "O2.CNC"].map(|sent| ControlEvent::Sent(name(sent)));
    assert_eq!(line.events, sent);
    assert_eq!(line.seen, [Status::Sending, Status::Idle]);
    // A PC that was started anew knows of no connection.
    line.pc = PcSide::new(115_200);
    line.control.send(vec![file("O3.CNC", b"y", false)]);
    assert_eq!(line.outcome(), Outcome::Pushed(file("O3.CNC", b"y", false)));
    // Nor does a control that was started anew.
    line.control = ControlPort::new(115_200, Framing::Frames, LineEnd::CrLf);
    let lost = line.order(Order::Get(place("O1.CNC")));
    assert_eq!(lost, Outcome::Lost(Loss::Forgotten));
    assert_eq!(line.order(Order::Connect), Outcome::Done);
}

#[test]
fn nobody_at_the_other_end_is_said_by_both_sides() {
    let mut line = Line::at(115_200);
    line.wires.iter_mut().for_each(|wire| wire.set_cut(true));
    assert_eq!(line.order(Order::Connect), Outcome::Lost(Loss::Silent));
    assert_eq!(line.events, []);
    line.control.send(vec![file("O1.CNC", b"x", false)]);
    line.rest(10_000);
    assert_eq!(line.events, [ControlEvent::NotConnected]);
    assert_eq!(line.seen, [Status::Idle, Status::Sending, Status::Idle]);
}

#[test]
fn another_rate_at_the_other_end_is_said_by_both_sides() {
    let mut line = Line::at(115_200);
    line.garbled = true;
    line.pc.order(Order::Connect);
    line.control.send(vec![file("O1.CNC", b"x", false)]);
    assert_eq!(line.outcome(), Outcome::Lost(Loss::Noise));
    line.rest(10_000);
    assert!(!line.events.is_empty());
    let not_connected = |event: &ControlEvent| *event == ControlEvent::NotConnected;
    assert!(line.events.iter().all(not_connected), "{:?}", line.events);
    assert!(line.memory.files.is_empty());
    // The control alone hears it, too.
    let mut line = Line::at(115_200);
    line.garbled = true;
    assert_eq!(line.order(Order::Connect), Outcome::Lost(Loss::Silent));
    assert!(line.events.iter().any(not_connected), "{:?}", line.events);
}

#[test]
fn two_controls_send_to_each_other() {
    let bytes = Random(8).bytes(3000);
    let mut controls = [(); 2].map(|()| ControlPort::new(115_200, Framing::Frames, LineEnd::CrLf));
    let mut memories = [Memory::default(), Memory::default()];
    let mut wires = [Wire::new(115_200), Wire::new(115_200)];
    controls[0].send(vec![file("O1.CNC", &bytes, false)]);
    let mut events = Vec::new();
    for ms in 1..20_000_u64 {
        // The second one answers in kind, later.
        if ms == 5000 {
            controls[1].send(vec![file("O2.CNC", &bytes, false)]);
        }
        let now = HostTime::from_millis(ms);
        for at in 0..2 {
            let heard: Vec<u8> = core::iter::from_fn(|| wires[at].receive(ms * STEP_NS)).collect();
            controls[at].hear(&heard, now);
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
    assert_eq!(memories[1].of(&name("O1.CNC")), Some(&bytes));
    assert_eq!(memories[0].of(&name("O2.CNC")), Some(&bytes));
}

#[test]
fn text_comes_in_beside_frames_and_goes_out_where_text_is_chosen() {
    let mut line = Line::at(9600);
    let text = "O0007 (TEXT)\nG00 X10.\nM30\n";
    let mut writer = TextWriter::new(text, LineEnd::Lf, 9600).unwrap();
    while !writer.is_over(line.now()) {
        let due = writer.due(line.now()).to_vec();
        line.wires[0].send(&due, line.now_ns);
        writer.sent(due.len(), line.now());
        line.rest(1);
    }
    line.rest(100);
    assert_eq!(line.events, [ControlEvent::Received(name("O0007.CNC"))]);
    assert_eq!(line.memory.of(&name("O0007.CNC")).unwrap(), text.as_bytes());
    assert_eq!(line.seen, [Status::Idle, Status::Receiving, Status::Idle]);
    // All at once, as a pseudo terminal brings it.
    let text = text.replace("O0007", "O0008");
    for chunk in ["%\n", &text, "%\n"] {
        line.control.hear(chunk.as_bytes(), line.now());
    }
    line.rest(500);
    assert_eq!(line.memory.of(&name("O0008.CNC")).unwrap(), text.as_bytes());
    // Frames are understood after it.
    assert_eq!(line.order(Order::Connect), Outcome::Done);

    // A slow line carries text only.
    let text = text.replace("O0008", "O0007");
    let mut slow = ControlPort::new(1200, Framing::Frames, LineEnd::CrLf);
    slow.send(vec![
        file("O0007.CNC", text.as_bytes(), false),
        file("ParaW.par", b"001=1\n", true),
    ]);
    let mut reader = TextReader::new(1200);
    let (mut read, mut events) = (Vec::new(), Vec::new());
    for ms in 1..3000 {
        let now = HostTime::from_millis(ms);
        slow.advance(now, &mut line.memory);
        slow.write(now, |bytes| {
            reader.hear(bytes, now);
            bytes.len()
        });
        read.extend(reader.advance(now));
        events.extend(slow.next_event());
    }
    assert_eq!(read, [TextEvent::Begun, TextEvent::Whole(text.to_owned())]);
    let sent = ControlEvent::Sent(name("O0007.CNC"));
    assert_eq!(
        events,
        [sent, ControlEvent::OnlyPrograms(name("ParaW.par"))]
    );
}

/// Bytes of a file a second over what the wire carries, both ways.
fn throughput(baud: u32) -> [f64; 2] {
    let bytes = Random(9).bytes(97 * 1024);
    [
        Order::Put(file("O9.CNC", &bytes, true)),
        Order::Get(place("O2.CNC")),
    ]
    .map(|order| {
        let mut line = Line::at(baud);
        line.memory.files = vec![(name("O2.CNC"), bytes.clone())];
        line.order(Order::Connect);
        let begun = line.now_ns;
        assert!(!matches!(line.order(order), Outcome::Lost(_)));
        assert_eq!(line.pc.retries(), 0);
        let seconds = (line.now_ns - begun) as f64 * 1e-9;
        bytes.len() as f64 / seconds / (f64::from(baud) / 10.0)
    })
}

#[test]
fn a_file_goes_nearly_as_fast_as_the_wire() {
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
