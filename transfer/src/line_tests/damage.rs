//! Damage on the line: bytes lost, doubled and changed, the cable pulled, 复位.

use gsk_twins::wire::Damage;

use super::*;

/// What is tried with damage.
#[derive(Clone, Copy, Debug)]
enum Work {
    Put,
    Get,
    Push,
    List,
    Rename,
    Delete,
}

const WORKS: [Work; 6] = [
    Work::Put,
    Work::Get,
    Work::Push,
    Work::List,
    Work::Rename,
    Work::Delete,
];

const OLD: &[u8] = b"what stood there before";

impl Work {
    /// Begins it on a line with `O1.CNC` and `O2.CNC`.
    fn begin(self, line: &mut Line, bytes: &[u8]) {
        match self {
            Self::Put => line.pc.order(Order::Put(file("O1.CNC", bytes, true))),
            Self::Get => line.pc.order(Order::Get(place("O2.CNC"))),
            Self::Push => line.control.send(vec![file("O2.CNC", bytes, true)]),
            Self::List => line.pc.order(Order::Directory(Partition::User)),
            Self::Rename => line.pc.order(Order::Rename {
                from: place("O1.CNC"),
                to: name("O3.CNC"),
            }),
            Self::Delete => line.pc.order(Order::Delete(place("O1.CNC"))),
        }
    }

    /// Its outcome when all is well.
    fn good(self, bytes: &[u8]) -> Outcome {
        let entry = |named, size: usize| Entry {
            name: name(named),
            size: size as u32,
        };
        match self {
            Self::Put | Self::Rename | Self::Delete => Outcome::Done,
            Self::Get => Outcome::Got(file("O2.CNC", bytes, true)),
            Self::Push => Outcome::Pushed(file("O2.CNC", bytes, true)),
            Self::List => Outcome::Listed(vec![
                entry("O1.CNC", OLD.len()),
                entry("O2.CNC", bytes.len()),
            ]),
        }
    }

    /// The memory is as before the work, or as after it; whether it is as after it.
    fn settled(self, line: &Line, bytes: &[u8]) -> bool {
        let is = |named: &str, wanted: Option<&[u8]>| {
            line.memory.of(&name(named)).map(Vec::as_slice) == wanted
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

fn about_to(bytes: &[u8]) -> Line {
    let mut line = Line::at(115_200);
    line.memory.files = vec![
        (name("O1.CNC"), OLD.to_vec()),
        (name("O2.CNC"), bytes.to_vec()),
    ];
    assert_eq!(line.order(Order::Connect), Outcome::Done);
    line
}

/// How many bytes a work takes on both wires.
fn length(work: Work, bytes: &[u8]) -> [u64; 2] {
    let mut line = about_to(bytes);
    let before = [0, 1].map(|wire| line.wires[wire].sent_count());
    work.begin(&mut line, bytes);
    assert_eq!(line.outcome(), work.good(bytes));
    line.rest(100);
    [0, 1].map(|wire| line.wires[wire].sent_count() - before[wire])
}

#[test]
fn bytes_lost_doubled_and_changed_at_500_places_lose_nothing() {
    let mut random = Random(3);
    let mut retried = 0;
    for round in 0..500 {
        let work = WORKS[random.below(6) as usize];
        let count = random.below(3000);
        let bytes = random.bytes(count);
        let lengths = length(work, &bytes);
        let mut line = about_to(&bytes);
        let mut damages = Vec::new();
        // One place, or a few.
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
        work.begin(&mut line, &bytes);
        let outcome = line.outcome();
        assert_eq!(outcome, work.good(&bytes), "{round}: {work:?} {damages:?}");
        assert!(work.settled(&line, &bytes));
        line.rest(9000);
        let broken = |event: &&ControlEvent| {
            matches!(event, ControlEvent::Broken | ControlEvent::NotConnected)
        };
        let told = line.events.iter().find(broken);
        assert_eq!(told, None, "{round}: {work:?} {damages:?}");
        assert_eq!(line.seen.last(), Some(&Status::Idle));
        retried += u64::from(line.pc.retries() > 0);
    }
    assert!(retried > 100, "{retried}: the damage hits nothing");
}

#[test]
fn a_cable_pulled_at_500_places_leaves_all_or_nothing() {
    let mut random = Random(4);
    let mut ends = [0, 0];
    for round in 0..500 {
        let work = WORKS[random.below(6) as usize];
        let count = random.below(3000);
        let bytes = random.bytes(count);
        let lengths = length(work, &bytes);
        let mut line = about_to(&bytes);
        // Both directions at once: the cable.
        let wire = random.below(2) as usize;
        let at = line.wires[wire].sent_count() + random.below(lengths[wire].max(1));
        work.begin(&mut line, &bytes);
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
        let context = format!("{round}: {work:?} at {at} of {wire}");
        let after = work.settled(&line, &bytes);
        match outcome {
            Some(Outcome::Lost(Loss::Broken)) => ends[0] += 1,
            // Of what the control begins the PC knows nothing before it has come.
            None => {
                assert!(matches!(work, Work::Push), "{context}");
                ends[0] += 1;
            }
            Some(outcome) => {
                assert_eq!(outcome, work.good(&bytes), "{context}");
                assert!(after, "{context}");
                ends[1] += 1;
            }
        }
        // The control shows no transfer any more, and says what it was.
        assert_eq!(line.seen.last(), Some(&Status::Idle), "{context}");
        let of_transfer = |event: &ControlEvent| *event != ControlEvent::Received(name("O1.CNC"));
        let told: Vec<_> = line
            .events
            .iter()
            .filter(|event| of_transfer(event))
            .collect();
        let sent = ControlEvent::Sent(name("O2.CNC"));
        let known = [ControlEvent::Broken, ControlEvent::NotConnected, sent];
        assert!(
            told.len() <= 1 && told.iter().all(|event| known.contains(event)),
            "{context}: {told:?}"
        );
        // Put in again, all of it works.
        line.wires.iter_mut().for_each(|wire| wire.set_cut(false));
        assert_eq!(line.order(Order::Connect), Outcome::Done, "{context}");
        let again = Order::Put(file("O4.CNC", &bytes, false));
        assert_eq!(line.order(again), Outcome::Done, "{context}");
        assert_eq!(line.memory.of(&name("O4.CNC")), Some(&bytes), "{context}");
    }
    assert!(ends.iter().all(|count| *count > 20), "{ends:?}");
}

#[test]
fn a_cable_pulled_in_the_middle_of_a_file_is_a_transfer_error_on_both_sides() {
    for work in [Work::Put, Work::Get, Work::Push] {
        let bytes = Random(5).bytes(20_000);
        let mut line = about_to(&bytes);
        work.begin(&mut line, &bytes);
        line.rest(700);
        line.wires.iter_mut().for_each(|wire| wire.set_cut(true));
        let outcome = (0..40_000).find_map(|_| line.step());
        match work {
            Work::Push => assert_eq!(outcome, None),
            _ => assert_eq!(outcome, Some(Outcome::Lost(Loss::Broken))),
        }
        for _ in 0..10_000 {
            line.step();
        }
        assert_eq!(line.events, [ControlEvent::Broken], "{work:?}");
        assert!(!work.settled(&line, &bytes) || !matches!(work, Work::Put));
        assert!(line.pc.is_idle());
    }
}

#[test]
fn a_cable_pulled_in_the_first_answer_is_silence_and_no_noise() {
    // A byte takes a millisecond.
    let mut line = Line::at(9600);
    line.pc.order(Order::Connect);
    while line.wires[1].sent_count() == 0 {
        assert_eq!(line.step(), None);
    }
    // Half of the answer has come.
    line.rest(5);
    line.wires.iter_mut().for_each(|wire| wire.set_cut(true));
    assert_eq!(line.outcome(), Outcome::Lost(Loss::Silent));
}

#[test]
fn a_bad_line_is_slow_and_loses_nothing() {
    let mut random = Random(6);
    let bytes = random.bytes(60_000);
    let mut line = about_to(&bytes);
    for wire in &mut line.wires {
        // One byte of three thousand.
        let mut at = wire.sent_count();
        for _ in 0..200 {
            at += 1 + random.below(6000);
            wire.damage(at, Damage::Changed(1 + random.below(255) as u8));
        }
    }
    for work in [Work::Get, Work::Put] {
        work.begin(&mut line, &bytes);
        assert_eq!(line.outcome(), work.good(&bytes));
    }
    assert!(Work::Put.settled(&line, &bytes));
}

#[test]
fn a_reset_in_the_middle_ends_the_transfer_and_the_next_one_works() {
    let bytes = Random(7).bytes(20_000);
    for work in [Work::Put, Work::Get, Work::Push] {
        let mut line = about_to(&bytes);
        work.begin(&mut line, &bytes);
        line.rest(500);
        line.control.break_off();
        let outcome = (0..20_000).find_map(|_| line.step());
        let lost = matches!(outcome, Some(Outcome::Lost(_)) | Some(Outcome::Refused(_)));
        assert!(lost || matches!(work, Work::Push), "{work:?}: {outcome:?}");
        line.rest(500);
        assert_eq!(line.seen.last(), Some(&Status::Idle));
        assert_eq!(line.order(Order::Connect), Outcome::Done);
        Work::Put.begin(&mut line, &bytes);
        assert_eq!(line.outcome(), Outcome::Done);
        assert!(Work::Put.settled(&line, &bytes));
    }
}
