//! Random sessions: every moment that is reached again equals the original, and running on
//! from it leads to the same end.
#![allow(clippy::expect_used, reason = "tests fail by panicking")]

mod random_session;

use gsk_core::setup::Setup;
use gsk_history::moment::{HistoryInput, MachineMoment, RecordedInput, state_hash};
use gsk_history::recording::{
    FORMAT, RecordingEncoder, RecordingError, RecordingEvent, encode_session,
};
use gsk_history::replay::replay;
use gsk_panel::emulator::{Emulator, EmulatorInput};
use gsk_panel::panel::KeyEvent;

use random_session::{Session, run_on};

fn assert_same(reached: &MachineMoment, original: &MachineMoment, context: &str) {
    assert!(reached.emulator == original.emulator, "{context}");
    let part = |moment: &MachineMoment| {
        let machining = moment.part.machining().expect("a job");
        (machining.scene().part().clone(), machining.findings().len())
    };
    assert_eq!(part(reached), part(original), "{context}");
}

/// Number of sessions: the environment variable `HISTORY_SESSIONS`. Ten sessions have a thousand
/// random moments and take minutes without optimisation.
fn session_count() -> u64 {
    std::env::var("HISTORY_SESSIONS").map_or(1, |count| count.parse().expect("a number"))
}

/// A hundred random moments of a session: the state there is the original one, and running on
/// with the recorded inputs leads to the state of a later moment.
#[test]
fn random_moments_are_reached_and_lead_to_later_ones() {
    let sessions = session_count();
    let (mut crashes, mut inputs) = (0, 0);
    for seed in 0..sessions {
        let mut session = Session::new(seed, usize::MAX);
        let mut originals = Vec::new();
        for _ in 0..100 {
            session.act();
            let before_inputs = session.history.inputs().last();
            if before_inputs.is_none_or(|last| last.tick < session.moment.ticks()) {
                originals.push(session.moment.clone());
            }
        }
        let end = session.history.present().expect("the present");
        assert_same(&end, &session.moment, "the present");
        assert_eq!(session.history.end(), session.moment.ticks());
        for original in &originals {
            let context = format!("seed {seed}, tick {}", original.ticks());
            let reached = session.history.seek(original.ticks()).expect("a moment");
            assert_same(&reached, original, &context);
        }
        for _ in 0..100 {
            let start = session.history.start();
            let length = session.history.end() - start;
            let tick = start + session.random.below(length);
            let mut reached = session.history.seek(tick).expect("a moment");
            assert_eq!(reached.ticks(), tick);
            let later = (tick + 4_000).min(session.history.end());
            run_on(&mut reached, session.history.inputs(), later);
            let at_once = session.history.seek(later).expect("a moment");
            assert_same(&reached, &at_once, &format!("seed {seed}, from {tick}"));
        }
        crashes += session.crashes;
        inputs += session.history.inputs().len();
    }
    assert!(crashes > 0 || sessions < 10, "{crashes} collisions");
    let least = 100 * usize::try_from(sessions).expect("a number");
    assert!(inputs > least, "{inputs} inputs");
}

#[test]
fn a_small_budget_thins_the_oldest_and_keeps_every_moment_exact() {
    let mut session = Session::new(7, 600_000);
    let mut originals = Vec::new();
    while session.moment.ticks() < 400_000 {
        session.act();
        session.run(500);
        originals.push(session.moment.clone());
        assert!(session.history.bytes() <= 600_000);
    }
    assert!(session.history.state_count() < 20);
    let first = session.history.start();
    let reachable = originals.iter().filter(|moment| moment.ticks() >= first);
    let mut count = 0;
    for original in reachable.step_by(9) {
        let reached = session.history.seek(original.ticks()).expect("a moment");
        assert_same(&reached, original, &format!("tick {}", original.ticks()));
        count += 1;
    }
    assert!(count > 5);
    assert!(session.history.seek(session.history.end() + 1).is_none());
}

#[test]
fn another_future_keeps_the_abandoned_one_as_a_branch() {
    let mut session = Session::new(3, usize::MAX);
    for _ in 0..30 {
        session.act();
    }
    let abandoned = session.moment.clone();
    let middle = (session.history.start() + session.history.end()) / 2;
    session.moment = session.history.continue_from(middle).expect("a moment");
    session.moment.emulator.record_inputs();
    assert_eq!(session.history.end(), middle);
    assert_eq!(session.history.branch(), Some((middle, abandoned.ticks())));
    for _ in 0..10 {
        session.act();
    }
    let new_future = session.moment.clone();
    let end = session.history.present().expect("the present");
    assert_same(&end, &new_future, "the new future");
    let back = session.history.return_to_branch().expect("the branch");
    assert_same(&back, &abandoned, "the abandoned future");
    let end = session.history.present().expect("the present");
    assert_same(&end, &abandoned, "the abandoned future again");
    let again = session.history.return_to_branch().expect("the branch");
    assert_same(&again, &new_future, "the new future again");
}

#[test]
fn a_seek_in_slices_and_one_of_the_machine_alone_reach_the_same_moment() {
    let mut session = Session::new(4, usize::MAX);
    for _ in 0..20 {
        session.act();
    }
    let (history, random) = (&session.history, &mut session.random);
    let mut seek = history.begin_seek(history.start()).expect("a moment");
    for _ in 0..20 {
        let tick = history.start() + random.below(history.end() - history.start());
        seek = history.redirect_seek(seek, tick).expect("a moment");
        while !history.advance_seek(&mut seek, 700) {}
        let at_once = history.seek(tick).expect("a moment");
        assert_same(seek.moment(), &at_once, &format!("tick {tick}"));
        let machine = history.seek_machine(tick).expect("a moment");
        assert!(machine == at_once.emulator, "the machine at {tick}");
    }
    let middle = (history.start() + history.end()) / 2;
    let bytes = encode_session(&history.since(middle), "test").expect("encoded");
    let replayed = replay(&bytes).expect("a recording");
    assert_eq!((replayed.error, replayed.difference), (None, None));
    assert!(replayed.is_complete);
    let half = replayed.history.expect("a session");
    assert!(half.start() <= middle && half.start() + 10_000 >= middle);
    let end = half.present().expect("the end");
    assert!(end.emulator == session.moment.emulator);
}

/// The bytes of a recorded session, and its end.
fn recorded_session(seed: u64, acts: u32) -> (Vec<u8>, MachineMoment) {
    let mut session = Session::new(seed, usize::MAX);
    for _ in 0..acts {
        session.act();
    }
    session.take_inputs();
    let mut bytes = Vec::new();
    let mut encoder = RecordingEncoder::new(&mut bytes);
    let start = session
        .history
        .seek(session.history.start())
        .expect("start");
    let mut events = vec![
        RecordingEvent::Start {
            format: FORMAT,
            program: "test".to_owned(),
        },
        RecordingEvent::State {
            emulator: Box::new(start.emulator),
            part: Vec::new(),
        },
    ];
    for recorded in session.history.inputs() {
        events.push(RecordingEvent::Input(Box::new(recorded.clone())));
    }
    let tick = session.history.end();
    events.push(RecordingEvent::Reached(tick));
    let hash = state_hash(&session.moment.emulator).expect("a hash");
    events.push(RecordingEvent::Hash { tick, hash });
    events.push(RecordingEvent::End(tick));
    for event in &events {
        encoder.encode(event, &mut bytes).expect("encoded");
    }
    (bytes, session.moment)
}

#[test]
fn a_recording_replays_to_the_same_state_and_stores_texts_once() {
    let (bytes, end) = recorded_session(11, 60);
    let replayed = replay(&bytes).expect("a recording");
    assert_eq!(replayed.error, None);
    assert_eq!((replayed.equal_hashes, replayed.difference), (1, None));
    assert!(replayed.is_complete);
    let history = replayed.history.expect("a session");
    assert_same(&history.present().expect("the end"), &end, "the replay");
    let ladder = end.emulator.cnc().plc().ladder().source();
    let line = ladder
        .lines()
        .nth(ladder.lines().count() / 2)
        .expect("a line");
    let copies = |text: &str| {
        let found = bytes.windows(text.len());
        found.filter(|window| *window == text.as_bytes()).count()
    };
    assert_eq!(copies(ladder), 1, "the ladder that holds {line}");
}

#[test]
fn every_flipped_bit_is_noticed() {
    let (bytes, _) = recorded_session(5, 12);
    let events = |bytes: &[u8]| -> Option<usize> {
        let mut reader = gsk_history::recording::RecordingReader::new(bytes).ok()?;
        let mut count = 0;
        while reader.next_event().ok()?.is_some() {
            count += 1;
        }
        Some(count)
    };
    assert!(events(&bytes).expect("intact") > 10);
    let mut damaged = bytes.clone();
    // Each byte once, each bit position in turn; the last frames with all bits.
    for position in 0..bytes.len() {
        let all_bits = position < 100 || position + 60 > bytes.len();
        for bit in 0..8 {
            if all_bits || bit == position % 8 && position % 61 == 0 {
                damaged[position] ^= 1 << bit;
                assert_eq!(events(&damaged), None, "byte {position}, bit {bit}");
                damaged[position] ^= 1 << bit;
            }
        }
    }
    // Every end within a frame is noticed; what came before it is still read.
    for length in (1..bytes.len()).step_by(997) {
        let cut = replay(&bytes[..length]);
        assert!(cut.is_err() || cut.is_ok_and(|cut| !cut.is_complete));
    }
}

/// Events that are valid and make no session.
#[test]
fn events_out_of_order_are_refused() {
    let start = RecordingEvent::Start {
        format: FORMAT,
        program: "test".to_owned(),
    };
    let newer = RecordingEvent::Start {
        format: FORMAT + 1,
        program: "test".to_owned(),
    };
    let state = RecordingEvent::State {
        emulator: Box::new(Emulator::new(Setup::default())),
        part: Vec::new(),
    };
    let far = RecordingEvent::Reached(1 << 60);
    let near = RecordingEvent::Reached(50);
    let past = RecordingEvent::Reached(20);
    let error = |events: &[&RecordingEvent]| {
        let mut bytes = Vec::new();
        let mut encoder = RecordingEncoder::new(&mut bytes);
        for event in events {
            encoder.encode(event, &mut bytes).expect("encoded");
        }
        replay(&bytes).map_or_else(Some, |replayed| replayed.error)
    };
    assert_eq!(error(&[&start, &state, &near]), None);
    assert_eq!(
        error(&[&newer]),
        Some(RecordingError::NewerFormat(FORMAT + 1))
    );
    for events in [
        &[&state][..],
        &[&start, &start],
        &[&start, &near],
        &[&start, &state, &far],
        &[&start, &state, &near, &past],
    ] {
        let found = error(events);
        assert!(
            matches!(found, Some(RecordingError::OutOfOrder(offset)) if offset > 18),
            "{found:?}"
        );
    }
}

#[test]
fn an_input_survives_the_encoding() {
    let recorded = RecordedInput {
        tick: 7,
        input: HistoryInput::Machine(EmulatorInput::Key(KeyEvent::Type('中'))),
    };
    let (mut bytes, text) = (Vec::new(), "long ".repeat(100));
    let mut encoder = RecordingEncoder::new(&mut bytes);
    let events = [
        RecordingEvent::Start {
            format: FORMAT,
            program: text.clone(),
        },
        RecordingEvent::Input(Box::new(recorded)),
        RecordingEvent::BoardLinked(9),
    ];
    for event in &events {
        encoder.encode(event, &mut bytes).expect("encoded");
    }
    let mut reader = gsk_history::recording::RecordingReader::new(&bytes).expect("a recording");
    for event in &events {
        assert_eq!(reader.next_event(), Ok(Some(event.clone())));
    }
    assert_eq!(reader.next_event(), Ok(None));
}
