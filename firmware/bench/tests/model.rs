//! A hundred random motions: the step edges of the emulated board are those of the engine on
//! this computer.

#[path = "../../motion/tests/support/mod.rs"]
mod support;

use gsk_motion::messages::Command;
use pico_bench::{Bench, CYCLES_PER_TICK};
use support::TestBoard;

/// Number of motions.
const MOTIONS: u32 = 100;
/// Ticks from the first command to the zero of the step clocks.
const LEAD_TICKS: i64 = 150_000;

/// A command with its values.
type Message = (Command, Vec<i64>);

/// A step: axis, direction, ticks after the zero of the step clocks.
type TimedStep = (usize, bool, i64);

struct Dice(u64);

impl Dice {
    fn between(&mut self, least: i64, most: i64) -> i64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        least + ((self.0 >> 33) as i64) % (most - least + 1)
    }
}

/// Returns the runs of a random motion: axis, direction, interval, count, growth.
fn random_motion(dice: &mut Dice) -> Vec<[i64; 5]> {
    let mut runs = Vec::new();
    for axis in 0..2 {
        let mut is_up = 0;
        for _ in 0..dice.between(2, 5) {
            let count = dice.between(1, 40);
            let add = dice.between(-6, 6);
            // No interval is shorter than 90 ticks, and a reversal has time.
            let mut interval = dice.between(90, 900) + (-add * count).max(0);
            if dice.between(0, 2) == 0 {
                is_up = 1 - is_up;
                interval = interval.max(300);
            }
            runs.push([axis, is_up, interval, count, add]);
        }
    }
    runs
}

/// Returns the messages of a motion whose step clocks are zero at `from`.
fn messages(runs: &[[i64; 5]], from: i64) -> Vec<Message> {
    let from = i64::from(from as u32);
    let resets = (0..2).map(|axis| (Command::ResetStepClock, vec![axis, from]));
    let runs = runs.iter().flat_map(|[axis, is_up, interval, count, add]| {
        [
            (Command::SetNextStepDir, vec![*axis, *is_up]),
            (Command::QueueStep, vec![*axis, *interval, *count, *add]),
        ]
    });
    resets.chain(runs).collect()
}

/// Sorts the steps by time and counts the time from the first.
fn from_the_first(mut steps: Vec<TimedStep>) -> Vec<TimedStep> {
    steps.sort_by_key(|step| (step.0, step.2));
    let first = steps.iter().map(|step| step.2).min().unwrap_or_default();
    steps
        .iter()
        .map(|step| (step.0, step.1, step.2 - first))
        .collect()
}

/// Makes a motion on this computer.
fn make_on_host(runs: &[[i64; 5]]) -> Vec<TimedStep> {
    let mut board = TestBoard::default();
    board.configure(4096);
    board.renew();
    for (command, values) in messages(runs, LEAD_TICKS) {
        board.send(command, &values);
    }
    board.run(LEAD_TICKS as u64 + 1_200_000);
    assert_eq!(board.shutdown_text(), None);
    let steps = board.port.steps.iter();
    from_the_first(
        steps
            .map(|step| (step.axis, step.is_up, step.at as i64))
            .collect(),
    )
}

#[test]
fn the_emulated_board_makes_the_steps_of_the_engine() {
    let mut dice = Dice(1);
    let mut bench = Bench::start();
    bench.configure();
    bench.begin();
    let mut total = 0;
    let mut worst = 0;
    for motion in 0..MOTIONS {
        let runs = random_motion(&mut dice);
        let expected = make_on_host(&runs);
        bench.edges.clear();
        let from = bench.clock() + LEAD_TICKS;
        for (command, values) in messages(&runs, from) {
            bench.send(command, &values);
        }
        bench.run_until(20_000_000, |bench| bench.edges.len() >= expected.len());
        bench.run(50_000);
        assert_eq!(bench.shutdown_text(), None, "motion {motion}");
        let edges = bench.edges.iter().map(|edge| {
            let ticks = edge.cycle / CYCLES_PER_TICK;
            (edge.axis, edge.is_up, ticks as i64)
        });
        let made = from_the_first(edges.collect());
        assert_eq!(made.len(), expected.len(), "motion {motion}");
        for (made, expected) in made.iter().zip(&expected) {
            assert_eq!(
                (made.0, made.1),
                (expected.0, expected.1),
                "motion {motion}"
            );
            worst = worst.max((made.2 - expected.2).abs());
        }
        total += made.len();
    }
    println!("{total} steps of {MOTIONS} motions, at most {worst} ticks apart");
    assert!(worst <= 6, "{worst} ticks of 64 ns");
}
