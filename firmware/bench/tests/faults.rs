//! Random faults on the line and at the pins in a thread on the built firmware: the count of each
//! axis is that of its step edges, and what stops the axes is reported.

use gsk_motion::messages::{Command, Response};
use pico_bench::{Bench, CYCLES_PER_S, GROUP, GUARD_PIN, LIMIT, LIMIT_PIN};

const ROUNDS: u64 = 20;
/// Cycles per millisecond.
const MS: u64 = 125_000;
/// Steps of Z and X in the thread: 8 turns of 4096 counts in ratios 3 to 8 and 1 to 16.
const STEPS: [i64; 2] = [12_288, 2048];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fault {
    /// A block with a wrong checksum, then 64 bytes without a block.
    DamagedBlock,
    /// The host falls silent: the lease expires.
    Silence,
    Reset,
    LostIndex,
    Limit,
    Guard,
    EncoderJump,
    SpindleStops,
    SpindleReverses,
    StoppedByHost,
}

const FAULTS: [Fault; 10] = [
    Fault::DamagedBlock,
    Fault::Silence,
    Fault::Reset,
    Fault::LostIndex,
    Fault::Limit,
    Fault::Guard,
    Fault::EncoderJump,
    Fault::SpindleStops,
    Fault::SpindleReverses,
    Fault::StoppedByHost,
];

/// Numbers that are always the same.
struct Dice(u64);

impl Dice {
    fn below(&mut self, most: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0 % most
    }
}

/// Starts a thread of both axes at 1200 r/min, with an armed limit switch for both axes.
fn start_thread(bench: &mut Bench) {
    bench.index_counts = 4;
    bench.configure();
    bench.begin();
    let clock = bench.clock() as u32;
    bench.send(Command::TrsyncStart, &[GROUP, clock.into(), 0, 4]);
    for axis in 0..2 {
        bench.send(Command::StepperStopOnTrigger, &[axis, GROUP]);
    }
    let samples = [LIMIT, clock.into(), 125, 4, 15_625, 1, GROUP, 1];
    bench.send(Command::EndstopHome, &samples);
    for (axis, steps, counts) in [(0, 3, 8), (1, 1, 16)] {
        let begin = [axis, clock.into(), 0, counts, counts / 2, 0];
        bench.send(Command::BeginAngle, &begin);
        for _ in 0..4 {
            bench.send(Command::QueueAngle, &[axis, 8192, steps, 0]);
        }
        bench.send(Command::EndAngle, &[axis]);
    }
    bench.flush();
}

/// Sets a spindle that runs on from the current count at a speed, counts per second.
fn turn_spindle(bench: &mut Bench, speed: f64) {
    let (from, begun) = (bench.cycle(), bench.count);
    bench.set_spindle(move |cycle| begun + ((cycle - from) as f64 * speed / CYCLES_PER_S) as i64);
}

/// Makes a fault in a thread; returns the steps of both axes after it.
fn run_round(number: u64) -> (Fault, i64) {
    let fault = FAULTS[number as usize % FAULTS.len()];
    let mut dice = Dice((number + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15));
    let mut bench = Bench::start();
    start_thread(&mut bench);
    let speed = 81_920.0 * (0.8 + dice.below(400) as f64 / 1000.0);
    turn_spindle(&mut bench, speed);
    bench.run(60 * MS + dice.below(200 * MS));
    let sums = |bench: &Bench| [bench.sum(0), bench.sum(1)];
    let at = sums(&bench);
    let replies = bench.replies.len();
    match fault {
        Fault::DamagedBlock => {
            bench.write(&[8, 0x10, 3, 1, 2, 9, 9, 0x7E]);
            bench.write(&[0x55; 64]);
            bench.write(&[0x7E; 4]);
        }
        Fault::Silence => bench.renew_at = None,
        Fault::Reset => {
            // The emulator counts its cycles anew.
            bench.press_reset();
            turn_spindle(&mut bench, speed);
        }
        Fault::LostIndex => bench.index_counts = 0,
        Fault::Limit => bench.set_input(LIMIT_PIN, true),
        Fault::Guard => bench.set_input(GUARD_PIN, true),
        Fault::EncoderJump => bench.index_at = 9 + dice.below(4078) as i64,
        Fault::SpindleStops => turn_spindle(&mut bench, 0.0),
        Fault::SpindleReverses => {
            turn_spindle(&mut bench, -speed);
            bench.run(10 * MS);
            turn_spindle(&mut bench, speed);
        }
        Fault::StoppedByHost => bench.send(Command::EmergencyStop, &[]),
    }
    bench.run(620 * MS);
    let after = sums(&bench);
    let run_on = (after[0] - at[0]).abs() + (after[1] - at[1]).abs();
    let name = format!(
        "{number}: {fault:?} after {at:?}, {:?}",
        bench.shutdown_text()
    );
    // The board has stopped, or it has made the whole thread.
    bench.run(20 * MS);
    assert_eq!(sums(&bench), after, "{name}: it moves on");
    let reported = |response: Response| {
        let mut replies = bench.replies[replies..].iter();
        replies.any(|reply| reply.response == response)
    };
    let is_stopped = bench.shutdown_text().is_some()
        || reported(Response::Starting)
        || reported(Response::TrsyncState);
    if fault != Fault::Reset {
        for axis in 0..2 {
            let position = bench.query_position(axis);
            assert_eq!(position, after[axis as usize], "{name}: axis {axis}");
        }
    }
    match fault {
        Fault::DamagedBlock | Fault::LostIndex | Fault::SpindleReverses => {
            assert!(!is_stopped, "{name}");
            assert_eq!(after, STEPS, "{name}");
        }
        // It stands with the spindle.
        Fault::SpindleStops => assert!(!is_stopped, "{name}"),
        _ => assert!(is_stopped, "{name}"),
    }
    match fault {
        Fault::Limit | Fault::Guard | Fault::Reset => assert!(run_on <= 4, "{name}: {run_on}"),
        _ => {}
    }
    (fault, run_on)
}

#[test]
fn the_count_is_that_of_the_edges_after_each_fault() {
    let mut run_ons = [0; FAULTS.len()];
    for number in 0..ROUNDS {
        let (fault, run_on) = run_round(number);
        let greatest = &mut run_ons[fault as usize];
        *greatest = run_on.max(*greatest);
    }
    for (fault, run_on) in FAULTS.iter().zip(run_ons) {
        println!("{fault:?}: at most {run_on} steps of both axes after the fault");
    }
}
