//! Tests with damage on the line: lost, doubled and changed bytes, a disconnected cable, 复位
//! (reset).

use gsk_twins::wire::Damage;

use super::*;

/// Transfers whose bytes the tests damage.
#[derive(Clone, Copy, Debug)]
enum DamagedTransfer {
    Put,
    Get,
    Push,
    List,
    Rename,
    Delete,
}

const TRANSFERS: [DamagedTransfer; 6] = [
    DamagedTransfer::Put,
    DamagedTransfer::Get,
    DamagedTransfer::Push,
    DamagedTransfer::List,
    DamagedTransfer::Rename,
    DamagedTransfer::Delete,
];

const OLD: &[u8] = b"what stood there before";

impl DamagedTransfer {
    /// Starts the transfer; the control has `O1.CNC` and `O2.CNC`.
    fn start(self, line: &mut Line, bytes: &[u8]) {
        match self {
            Self::Put => line.pc.start(PcCommand::Put(file("O1.CNC", bytes, true))),
            Self::Get => line.pc.start(PcCommand::Get(path("O2.CNC"))),
            Self::Push => line.control.send(vec![file("O2.CNC", bytes, true)]),
            Self::List => line.pc.start(PcCommand::Directory(Partition::User)),
            Self::Rename => line.pc.start(PcCommand::Rename {
                from: path("O1.CNC"),
                to: name("O3.CNC"),
            }),
            Self::Delete => line.pc.start(PcCommand::Delete(path("O1.CNC"))),
        }
    }

    /// Returns the outcome of the transfer on an undamaged line.
    fn expected_outcome(self, bytes: &[u8]) -> TransferOutcome {
        let entry = |file_name, size: usize| DirectoryEntry {
            name: name(file_name),
            size: size as u32,
        };
        match self {
            Self::Put | Self::Rename | Self::Delete => TransferOutcome::Done,
            Self::Get => TransferOutcome::Got(file("O2.CNC", bytes, true)),
            Self::Push => TransferOutcome::Pushed(file("O2.CNC", bytes, true)),
            Self::List => TransferOutcome::Listed(vec![
                entry("O1.CNC", OLD.len()),
                entry("O2.CNC", bytes.len()),
            ]),
        }
    }

    /// Panics unless the memory is as before or after the whole transfer; returns true if it
    /// is as after it.
    fn check_memory(self, line: &Line, bytes: &[u8]) -> bool {
        let is = |file_name: &str, expected: Option<&[u8]>| {
            line.memory.content(&name(file_name)).map(Vec::as_slice) == expected
        };
        assert!(is("O2.CNC", Some(bytes)));
        let before = is("O1.CNC", Some(OLD)) && is("O3.CNC", None);
        let after = match self {
            Self::Put => is("O1.CNC", Some(bytes)) && is("O3.CNC", None),
            Self::Get | Self::Push | Self::List => before,
            Self::Rename => is("O1.CNC", None) && is("O3.CNC", Some(OLD)),
            Self::Delete => is("O1.CNC", None) && is("O3.CNC", None),
        };
        assert!(before || after, "{self:?}: half of it");
        after
    }
}

fn connected_line(bytes: &[u8]) -> Line {
    let mut line = Line::new(115_200);
    line.memory.files = vec![
        (name("O1.CNC"), OLD.to_vec()),
        (name("O2.CNC"), bytes.to_vec()),
    ];
    assert_eq!(line.run(PcCommand::Connect), TransferOutcome::Done);
    line
}

/// Returns the number of bytes of a transfer on the wire to the control and on that to the PC.
fn transfer_byte_counts(transfer: DamagedTransfer, bytes: &[u8]) -> [u64; 2] {
    let mut line = connected_line(bytes);
    let before = [0, 1].map(|wire| line.wires[wire].sent_count());
    transfer.start(&mut line, bytes);
    assert_eq!(line.outcome(), transfer.expected_outcome(bytes));
    line.run_for(100);
    [0, 1].map(|wire| line.wires[wire].sent_count() - before[wire])
}

#[test]
fn damaged_bytes_at_500_positions_lose_no_data() {
    let mut random = Random(3);
    let mut retried = 0;
    for round in 0..500 {
        let transfer = TRANSFERS[random.below(6) as usize];
        let count = random.below(3000);
        let bytes = random.bytes(count);
        let lengths = transfer_byte_counts(transfer, &bytes);
        let mut line = connected_line(&bytes);
        let mut damages = Vec::new();
        // One position, or a few.
        for _ in 0..=random.below(3) {
            let wire = random.below(2) as usize;
            let at = line.wires[wire].sent_count() + random.below(lengths[wire].max(1));
            let damage = match random.below(3) {
                0 => Damage::Lost,
                1 => Damage::Doubled,
                _ => Damage::Changed(1 + random.below(255) as u8),
            };
            line.wires[wire].damage(at, damage);
            damages.push((wire, at, damage));
        }
        transfer.start(&mut line, &bytes);
        let outcome = line.outcome();
        assert_eq!(
            outcome,
            transfer.expected_outcome(&bytes),
            "{round}: {transfer:?} {damages:?}"
        );
        assert!(transfer.check_memory(&line, &bytes));
        line.run_for(9000);
        let broken = |event: &&ControlEvent| {
            matches!(
                event,
                ControlEvent::Interrupted | ControlEvent::NotConnected
            )
        };
        let interruption = line.events.iter().find(broken);
        assert_eq!(interruption, None, "{round}: {transfer:?} {damages:?}");
        assert_eq!(line.statuses.last(), Some(&PortStatus::Idle));
        retried += u64::from(line.pc.retransmissions() > 0);
    }
    assert!(retried > 100, "{retried}: the damage hits nothing");
}

#[test]
fn disconnected_cable_stores_all_or_nothing() {
    let mut random = Random(4);
    let mut ends = [0, 0];
    for round in 0..500 {
        let transfer = TRANSFERS[random.below(6) as usize];
        let count = random.below(3000);
        let bytes = random.bytes(count);
        let lengths = transfer_byte_counts(transfer, &bytes);
        let mut line = connected_line(&bytes);
        // Both directions at once, as with a cable.
        let wire = random.below(2) as usize;
        let at = line.wires[wire].sent_count() + random.below(lengths[wire].max(1));
        transfer.start(&mut line, &bytes);
        let mut outcome = None;
        let mut within = 0;
        while line.wires[wire].sent_count() <= at && outcome.is_none() && within < 60_000 {
            outcome = line.step();
            within += 1;
        }
        line.wires.iter_mut().for_each(|wire| wire.set_cut(true));
        for _ in 0..40_000 {
            let next = line.step();
            outcome = outcome.or(next);
        }
        let context = format!("{round}: {transfer:?} at {at} of {wire}");
        let after = transfer.check_memory(&line, &bytes);
        match outcome {
            Some(TransferOutcome::Lost(ConnectionLoss::Interrupted)) => ends[0] += 1,
            // The PC cannot know a transfer of the control that has not arrived.
            None => {
                assert!(matches!(transfer, DamagedTransfer::Push), "{context}");
                ends[0] += 1;
            }
            Some(outcome) => {
                assert_eq!(outcome, transfer.expected_outcome(&bytes), "{context}");
                assert!(after, "{context}");
                ends[1] += 1;
            }
        }
        // The control shows no transfer any more and has reported the result.
        assert_eq!(line.statuses.last(), Some(&PortStatus::Idle), "{context}");
        let of_transfer = |event: &ControlEvent| *event != ControlEvent::Received(name("O1.CNC"));
        let reported: Vec<_> = line
            .events
            .iter()
            .filter(|event| of_transfer(event))
            .collect();
        let sent = ControlEvent::Sent(name("O2.CNC"));
        let known = [ControlEvent::Interrupted, ControlEvent::NotConnected, sent];
        assert!(
            reported.len() <= 1 && reported.iter().all(|event| known.contains(event)),
            "{context}: {reported:?}"
        );
        // After the cable is reconnected everything works.
        line.wires.iter_mut().for_each(|wire| wire.set_cut(false));
        assert_eq!(
            line.run(PcCommand::Connect),
            TransferOutcome::Done,
            "{context}"
        );
        let again = PcCommand::Put(file("O4.CNC", &bytes, false));
        assert_eq!(line.run(again), TransferOutcome::Done, "{context}");
        assert_eq!(
            line.memory.content(&name("O4.CNC")),
            Some(&bytes),
            "{context}"
        );
    }
    assert!(ends.iter().all(|count| *count > 20), "{ends:?}");
}

#[test]
fn both_sides_report_cable_disconnected_within_file() {
    for transfer in [
        DamagedTransfer::Put,
        DamagedTransfer::Get,
        DamagedTransfer::Push,
    ] {
        let bytes = Random(5).bytes(20_000);
        let mut line = connected_line(&bytes);
        transfer.start(&mut line, &bytes);
        line.run_for(700);
        line.wires.iter_mut().for_each(|wire| wire.set_cut(true));
        let outcome = (0..40_000).find_map(|_| line.step());
        match transfer {
            DamagedTransfer::Push => assert_eq!(outcome, None),
            _ => assert_eq!(
                outcome,
                Some(TransferOutcome::Lost(ConnectionLoss::Interrupted))
            ),
        }
        for _ in 0..10_000 {
            line.step();
        }
        assert_eq!(line.events, [ControlEvent::Interrupted], "{transfer:?}");
        assert!(!transfer.check_memory(&line, &bytes) || !matches!(transfer, DamagedTransfer::Put));
        assert!(line.pc.is_idle());
    }
}

#[test]
fn cable_disconnected_in_first_reply_is_silence() {
    // A byte takes a millisecond.
    let mut line = Line::new(9600);
    line.pc.start(PcCommand::Connect);
    while line.wires[1].sent_count() == 0 {
        assert_eq!(line.step(), None);
    }
    // Half of the reply has arrived.
    line.run_for(5);
    line.wires.iter_mut().for_each(|wire| wire.set_cut(true));
    assert_eq!(
        line.outcome(),
        TransferOutcome::Lost(ConnectionLoss::Silent)
    );
}

#[test]
fn noisy_line_loses_no_data() {
    let mut random = Random(6);
    let bytes = random.bytes(60_000);
    let mut line = connected_line(&bytes);
    for wire in &mut line.wires {
        // One byte of 3000.
        let mut at = wire.sent_count();
        for _ in 0..200 {
            at += 1 + random.below(6000);
            wire.damage(at, Damage::Changed(1 + random.below(255) as u8));
        }
    }
    for transfer in [DamagedTransfer::Get, DamagedTransfer::Put] {
        transfer.start(&mut line, &bytes);
        assert_eq!(line.outcome(), transfer.expected_outcome(&bytes));
    }
    assert!(DamagedTransfer::Put.check_memory(&line, &bytes));
}

#[test]
fn reset_aborts_transfer_and_next_one_works() {
    let bytes = Random(7).bytes(20_000);
    for transfer in [
        DamagedTransfer::Put,
        DamagedTransfer::Get,
        DamagedTransfer::Push,
    ] {
        let mut line = connected_line(&bytes);
        transfer.start(&mut line, &bytes);
        line.run_for(500);
        line.control.abort();
        let outcome = (0..20_000).find_map(|_| line.step());
        let lost = matches!(
            outcome,
            Some(TransferOutcome::Lost(_)) | Some(TransferOutcome::Refused(_))
        );
        assert!(
            lost || matches!(transfer, DamagedTransfer::Push),
            "{transfer:?}: {outcome:?}"
        );
        line.run_for(500);
        assert_eq!(line.statuses.last(), Some(&PortStatus::Idle));
        assert_eq!(line.run(PcCommand::Connect), TransferOutcome::Done);
        DamagedTransfer::Put.start(&mut line, &bytes);
        assert_eq!(line.outcome(), TransferOutcome::Done);
        assert!(DamagedTransfer::Put.check_memory(&line, &bytes));
    }
}
