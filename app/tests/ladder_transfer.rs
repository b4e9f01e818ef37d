//! A ladder through the serial port, over a line in virtual time with faults: it is read back bit
//! for bit, or the control keeps the ladder it had.

use gsk_core::cnc::ControlRequest;
use gsk_core::plc::Ladder;
use gsk_core::setup::{STANDARD_LADDER, Setup};
use gsk_host::serial::SerialFileStore;
use gsk_panel::emulator::{Emulator, WaitCondition};
use gsk_panel::keys::Key;
use gsk_panel::panel::{LADDER_FILE, SerialCable};
use gsk_transfer::{
    ControlPort, FileName, Framing, Partition, PcCommand, PcSide, PortTime, RemotePath,
    TextLineEnd, TransferFault, TransferFile, TransferOutcome,
};
use gsk_twins::wire::{Damage, TwinWire};

const BAUD: u32 = 115_200;
/// Time limit of a command, ms.
const MAX_COMMAND_MS: u64 = 300_000;

/// GSKCC at the PC, a control, and the wires to the control and to the PC.
struct LadderLine {
    pc: PcSide,
    port: ControlPort,
    control: Emulator,
    wires: [TwinWire; 2],
    now_ms: u64,
}

impl LadderLine {
    /// Creates the line to a control in edit mode with the parameter switch on, and connects.
    fn connected() -> Self {
        let mut control = Emulator::new(Setup::default());
        control.run_until(&WaitCondition::SelfTestOver, 20_000);
        control.connect_cable(SerialCable::Line);
        for request in [
            ControlRequest::SetParameterSwitch(true),
            ControlRequest::CancelSwitchAlarm,
        ] {
            control.request(request).expect("the switch");
        }
        control.press(Key::Edit);
        let mut line = Self {
            pc: PcSide::new(BAUD),
            port: ControlPort::new(BAUD, Framing::Frames, TextLineEnd::CrLf),
            control,
            wires: [TwinWire::new(BAUD), TwinWire::new(BAUD)],
            now_ms: 0,
        };
        assert_eq!(line.run(PcCommand::Connect), TransferOutcome::Done);
        line
    }

    fn step(&mut self) -> Option<TransferOutcome> {
        self.now_ms += 1;
        let now = PortTime::from_millis(self.now_ms);
        let now_ns = self.now_ms * 1_000_000;
        let [to_control, to_pc] = &mut self.wires;
        let arrived: Vec<u8> = std::iter::from_fn(|| to_control.receive(now_ns)).collect();
        self.port.receive(&arrived, now);
        self.port
            .advance(now, &mut SerialFileStore::new(&mut self.control));
        while self.port.next_event().is_some() {}
        self.port.write(now, |bytes| {
            to_pc.send(bytes, now_ns);
            bytes.len()
        });
        let arrived: Vec<u8> = std::iter::from_fn(|| to_pc.receive(now_ns)).collect();
        self.pc.receive(&arrived, now);
        let outcome = self.pc.advance(now);
        let due = self.pc.pending_bytes(now).to_vec();
        to_control.send(&due, now_ns);
        self.pc.mark_sent(due.len());
        outcome
    }

    fn run(&mut self, command: PcCommand) -> TransferOutcome {
        self.pc.start(command);
        let outcome = (0..MAX_COMMAND_MS).find_map(|_| self.step());
        outcome.expect("an outcome within five minutes")
    }

    fn send(&mut self, list: &str) -> TransferOutcome {
        self.run(PcCommand::Put(TransferFile {
            remote_path: ladder_path(),
            bytes: list.as_bytes().to_vec(),
            overwrite: true,
        }))
    }

    /// Reads the ladder of the control.
    fn read(&mut self) -> Vec<u8> {
        match self.run(PcCommand::Get(ladder_path())) {
            TransferOutcome::Got(file) => file.bytes,
            other => panic!("{other:?}"),
        }
    }

    /// The ladder that the control runs after its next power-on.
    fn stored(&self) -> String {
        self.control.cnc().stored_ladder().source().to_owned()
    }
}

fn ladder_path() -> RemotePath {
    RemotePath {
        partition: Partition::User,
        name: FileName::new(LADDER_FILE).expect("a name"),
    }
}

/// A ladder with a rung, message and remark of this round.
fn changed_ladder(round: u64) -> String {
    let rung = format!(
        ".NET \"轮 {round}\"\nLD R1.{}\nOUT R500.{}\nEND2",
        round % 8,
        round % 7
    );
    let list = STANDARD_LADDER.replacen("END2", &rung, 1);
    format!("{list}; round {round}\r\n")
}

struct LadderRandom(u64);

impl LadderRandom {
    fn below(&mut self, end: u64) -> u64 {
        let next = self.0.wrapping_mul(6_364_136_223_846_793_005);
        self.0 = next.wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % end.max(1)
    }

    fn damage(&mut self) -> Damage {
        match self.below(4) {
            0 => Damage::Lost,
            1 => Damage::Doubled,
            2 => Damage::Delayed(self.below(40) * 1_000_000),
            _ => Damage::Changed(1 + self.below(255) as u8),
        }
    }
}

#[test]
fn a_sent_ladder_is_read_back_bit_for_bit_with_faults_on_the_line() {
    let mut random = LadderRandom(980);
    let mut line = LadderLine::connected();
    let mut retries = 0;
    for round in 0..60 {
        let list = changed_ladder(round);
        assert!(Ladder::compile(&list).is_ok(), "round {round}");
        // The ladder goes out once and comes back once: faults on both wires, in both transfers.
        for transfer in 0..2 {
            for wire in 0..2 {
                let length = if wire == transfer { list.len() } else { 600 };
                for _ in 0..=random.below(3) {
                    let at = line.wires[wire].sent_count() + random.below(length as u64);
                    let damage = random.damage();
                    line.wires[wire].damage(at, damage);
                }
            }
            match transfer {
                0 => assert_eq!(line.send(&list), TransferOutcome::Done, "round {round}"),
                _ => assert_eq!(line.read(), list.as_bytes(), "round {round}"),
            }
            assert_eq!(line.stored(), list, "round {round}");
        }
        retries = line.pc.retransmissions();
    }
    assert!(retries > 20, "{retries}");
}

#[test]
fn a_cut_cable_leaves_the_whole_old_or_the_whole_new_ladder() {
    let mut random = LadderRandom(7);
    let mut kept = 0;
    for round in 0..24 {
        let mut line = LadderLine::connected();
        let old = line.stored();
        let new = changed_ladder(round);
        let length = new.len() as u64 + new.len() as u64 / 40;
        let at = line.wires[0].sent_count() + random.below(length);
        line.wires[0].damage(at, Damage::Cut);
        let outcome = line.send(&new);
        assert!(matches!(outcome, TransferOutcome::Lost(_)), "{outcome:?}");
        assert!([&old, &new].contains(&&line.stored()), "round {round}");
        kept += u32::from(line.stored() == old);
        line.wires[0].set_cut(false);
        assert_eq!(line.run(PcCommand::Connect), TransferOutcome::Done);
        assert_eq!(line.send(&new), TransferOutcome::Done);
        assert_eq!(line.read(), new.as_bytes());
    }
    assert!(kept > 20, "{kept}");
}

#[test]
fn a_ladder_needs_edit_mode_the_switch_and_no_errors() {
    let mut line = LadderLine::connected();
    let old = line.stored();
    let refused = TransferOutcome::Refused;
    // 6.1 of the PLC manual, part 3: edit mode, and the parameter switch on.
    line.control.press(Key::Jog);
    assert_eq!(line.send(&changed_ladder(1)), refused(TransferFault::Busy));
    // Reading needs no mode.
    assert_eq!(line.read(), old.as_bytes());
    line.control.press(Key::Edit);
    let switch_off = ControlRequest::SetParameterSwitch(false);
    line.control.request(switch_off).expect("the switch");
    let switch = refused(TransferFault::SwitchOff);
    assert_eq!(line.send(&changed_ladder(1)), switch);
    assert_eq!(line.run(PcCommand::Get(ladder_path())), switch);
    let switch_on = ControlRequest::SetParameterSwitch(true);
    line.control.request(switch_on).expect("the switch");
    for broken in ["", "END1\nLD X0.0\nEND2\nOUT", "O0001;\nM30;\n%\n"] {
        assert_eq!(line.send(broken), refused(TransferFault::Content));
    }
    assert_eq!(line.stored(), old);
    let once = PcCommand::Put(TransferFile {
        remote_path: ladder_path(),
        bytes: changed_ladder(1).into_bytes(),
        overwrite: false,
    });
    assert_eq!(line.run(once), refused(TransferFault::Exists));
    // It runs from the next power-on (manual PLC-I 1.2).
    let new = changed_ladder(2);
    assert_eq!(line.send(&new), TransferOutcome::Done);
    assert_eq!(line.control.cnc().plc().ladder().source(), old);
    line.control.power_cycle();
    assert_eq!(line.control.cnc().plc().ladder().source(), new);
}
