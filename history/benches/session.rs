//! Cost of going back and of recording: a session of two hours with random acts of an operator,
//! the samples, and a part with 20 000 corners.
//!
//! `cargo bench -p gsk980td-history --bench session` prints the time of seeks with the part, the
//! bytes of recording and history, and compares a thousand random moments; with the argument
//! `session` it leaves the programs out. The arguments `plain`, `stored` and `hashed` only run a
//! minute of the first sample, for a count of instructions:
//!
//! ```text
//! valgrind --tool=callgrind target/release/deps/session-* plain
//! ```

#![allow(clippy::expect_used, reason = "a bench fails by panicking")]

#[path = "../tests/random_session/mod.rs"]
mod random_session;

use std::hint::black_box;
use std::time::{Duration, Instant};

use gsk_core::cnc::ControlRequest;
use gsk_core::program::Program;
use gsk_history::history::DEFAULT_BUDGET_BYTES;
use gsk_history::moment::state_hash;
use gsk_history::recording::encode_session;
use gsk_panel::keys::Key;

use random_session::{Session, run_on};

const HOUR_TICKS: u64 = 3_600_000;
/// Length of the random session.
const SESSION_TICKS: u64 = 2 * HOUR_TICKS;
/// Random moments of the random session, and of each program.
const MOMENTS: u64 = 1000;
/// Ticks for which a random moment runs on.
const RUN_ON_TICKS: u64 = 4000;
/// Ticks of the run whose instructions are counted, and between two hashes of the recorder.
const COUNTED_TICKS: u64 = 60_000;
const HASH_TICKS: u64 = 10_000;

const SAMPLES: [(&str, &str); 3] = [
    (
        "01-stepped-shaft",
        include_str!("../../assets/programs/01-stepped-shaft.CNC"),
    ),
    (
        "02-bushing",
        include_str!("../../assets/programs/02-bushing.CNC"),
    ),
    (
        "03-grooved-pin",
        include_str!("../../assets/programs/03-grooved-pin.CNC"),
    ),
];
/// The subprogram of the third sample.
const SUBPROGRAM: &str = include_str!("../../assets/programs/O1031.CNC");

/// A session in which a program has just started.
fn started(text: &str) -> Session {
    let mut session = Session::new(1, DEFAULT_BUDGET_BYTES);
    let emulator = &mut session.moment.emulator;
    let stored = emulator.load_program("O1031", SUBPROGRAM);
    stored.expect("a subprogram");
    let open = ControlRequest::OpenExternal(Program::new(text));
    emulator.request(open).expect("a program");
    session.press(Key::Auto);
    session.press(Key::CycleStart);
    session
}

/// A session in which a program has run to its end, or for an hour.
fn finished(text: &str) -> Session {
    let mut session = started(text);
    while session.moment.ticks() < HOUR_TICKS {
        session.run(1000);
        let cnc = session.moment.emulator.cnc();
        if cnc.run_state() != gsk_core::operation::RunState::Run && !cnc.is_moving() {
            break;
        }
    }
    session
}

/// A program that cuts a saw blade of 20 000 corners, and then the whole length again.
fn saw_blade() -> String {
    let mut text =
        "G50 X100 Z100;\nG98 M03 S1000;\nT0101;\nG00 X49 Z0.5;\nG01 X48 F3000;\n".to_owned();
    for corner in 0..10_000 {
        let x = if corner % 2 == 0 { 48.02 } else { 48.0 };
        text.push_str(&format!("X{x:.2} W-0.002;\nW-0.002;\n"));
    }
    text + "G00 X54;\nZ1;\nX47.99;\nG01 Z-42 F500;\nG00 X100 Z100;\nM30;\n"
}

/// Seeks random moments, the part included, and prints the times.
fn print_seeks(name: &str, session: &mut Session, moments: u64) {
    let Session {
        history, random, ..
    } = session;
    let (start, length) = (history.start(), history.end() - history.start());
    let mut times: Vec<Duration> = (0..moments)
        .map(|_| {
            let tick = start + random.below(length);
            let begin = Instant::now();
            black_box(history.seek(tick).expect("a moment"));
            begin.elapsed()
        })
        .collect();
    times.sort_unstable();
    let ms = |index: usize| times[index.min(times.len() - 1)].as_secs_f64() * 1000.0;
    println!(
        "{name}: {:.0} s of machine time, {moments} seeks with the part: median {:.1} ms, \
         99 % {:.1} ms, worst {:.1} ms",
        length as f64 / 1000.0,
        ms(times.len() / 2),
        ms(times.len() * 99 / 100),
        ms(times.len() - 1),
    );
}

/// A thousand random moments: running on from each is the same as a seek to the later moment.
fn compare_moments(session: &mut Session) {
    let Session {
        history, random, ..
    } = session;
    let (start, length) = (history.start(), history.end() - history.start());
    for _ in 0..MOMENTS {
        let tick = start + random.below(length);
        let later = (tick + RUN_ON_TICKS).min(history.end());
        let mut reached = history.seek(tick).expect("a moment");
        run_on(&mut reached, history.inputs(), later);
        let at_once = history.seek(later).expect("a moment");
        assert!(reached.emulator == at_once.emulator, "from tick {tick}");
        let part = |moment: &gsk_history::moment::MachineMoment| {
            moment.part.machining().map(|it| it.scene().part().clone())
        };
        assert!(part(&reached) == part(&at_once), "part from tick {tick}");
    }
    let end = history.present().expect("the present");
    assert!(end.emulator == session.moment.emulator, "the end");
    println!("{MOMENTS} random moments run on to the same state, bit by bit");
}

fn print_session() {
    let mut session = Session::new(2, DEFAULT_BUDGET_BYTES);
    while session.moment.ticks() < SESSION_TICKS {
        session.act();
    }
    let history = &session.history;
    let bytes = encode_session(&history.since(history.start()), "bench").expect("encoded");
    let hours = (history.end() - history.start()) as f64 / HOUR_TICKS as f64;
    println!(
        "random session: {hours:.2} h, {} inputs, {} collisions, recording {:.0} KB an hour, \
         history {:.1} MB in {} states",
        history.inputs().len(),
        session.crashes,
        bytes.len() as f64 / 1000.0 / hours,
        history.bytes() as f64 / 1e6,
        history.state_count(),
    );
    print_seeks("random session", &mut session, MOMENTS);
    compare_moments(&mut session);
}

/// Runs a minute of the first sample. `stores` the states of the time line, `hashes` the state
/// as the flight recorder does.
fn run_counted(stores: bool, hashes: bool) {
    let mut session = started(SAMPLES[0].1);
    for tick in 0..COUNTED_TICKS {
        let moment = &mut session.moment;
        moment.emulator.tick();
        black_box(moment.part.follow_tick(moment.emulator.simulation()));
        if stores {
            session.take_inputs();
            session
                .history
                .follow(&session.moment.emulator, &session.moment.part);
        }
        if hashes && tick % HASH_TICKS == 0 {
            black_box(state_hash(&session.moment.emulator));
        }
    }
    println!(
        "{COUNTED_TICKS} ticks, {} states",
        session.history.state_count()
    );
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    match arguments.find(|it| !it.starts_with('-')).as_deref() {
        Some("plain") => run_counted(false, false),
        Some("stored") => run_counted(true, false),
        Some("hashed") => run_counted(true, true),
        Some("session") => print_session(),
        _ => {
            for (name, text) in SAMPLES {
                print_seeks(name, &mut finished(text), MOMENTS);
            }
            print_seeks("20 000 corners", &mut finished(&saw_blade()), 200);
            print_session();
        }
    }
}
