//! Taps with a spindle that varies, stalls, runs on after its stop, and reverses: Z follows it in
//! both directions and ends exactly at its start.

mod support;

use core::f64::consts::TAU;

use gsk_motion::messages::{Command, Response};
use support::{ENABLE_PIN, GROUP, GUARD_PIN, INDEX_PIN, LIMIT, LIMIT_PIN, TestBoard, Z};

/// Counts per turn.
const COUNTS: i64 = 4096;
/// Clock rate, ticks per second.
const CLOCK_HZ: f64 = 15_625_000.0;
/// Ticks between two checks of a condition: 2 ms.
const CHECK_TICKS: u64 = 31_250;
const DENOMINATOR: i64 = 1 << 24;

/// A spindle that follows its target with a time constant.
struct TapSpindle {
    turns: f64,
    /// Turns per second, without the ripple.
    speed: f64,
    target: f64,
    time_constant_s: f64,
    /// Amplitude of the ripple as a share of the speed, and its number in a turn.
    ripple: (f64, f64),
    is_stalled: bool,
    /// Whether the encoder gives no more counts.
    is_dead: bool,
}

impl TapSpindle {
    const fn new(speed: f64) -> Self {
        Self {
            turns: 0.0,
            speed,
            target: speed,
            time_constant_s: 0.15,
            ripple: (0.2, 3.0),
            is_stalled: false,
            is_dead: false,
        }
    }

    fn advance(&mut self, seconds: f64) {
        self.speed += (self.target - self.speed) * seconds / self.time_constant_s;
        if !self.is_stalled {
            let ripple = 1.0 + self.ripple.0 * (self.turns * self.ripple.1 * TAU).sin();
            self.turns += self.speed * ripple * seconds;
        }
    }
}

/// A tap for the board.
#[derive(Clone, Copy)]
struct Tap {
    start: i64,
    is_reverse: bool,
    segments: [[i64; 3]; 2],
    depth: i64,
}

impl Tap {
    /// A tap with a lead-in over half a turn, which ends 4 turns below its depth.
    fn new(steps_per_turn: i64, depth_turns: f64) -> Self {
        let rate = steps_per_turn * DENOMINATOR / COUNTS;
        let add = rate / (COUNTS / 2);
        let lead_in = if add == 0 { 0 } else { rate / add };
        let depth = (depth_turns * COUNTS as f64) as i64;
        Self {
            start: 1000,
            is_reverse: false,
            segments: [[lead_in, 0, add], [depth + 4 * COUNTS - lead_in, rate, 0]],
            depth,
        }
    }

    /// The position at a count from the start, steps, and its greatest change in a count.
    fn position(&self, count: i64) -> (f64, f64) {
        let (mut rest, mut sum, mut slope) = (count.max(0), 0_i64, 0_i64);
        for [length, numerator, add] in self.segments {
            let part = rest.min(length);
            sum += numerator * part + add * part * (part - 1) / 2;
            slope = slope.max((numerator + add * part).abs());
            rest -= part;
        }
        let steps = |sum: i64| sum as f64 / DENOMINATOR as f64;
        (steps(sum), steps(slope))
    }
}

/// A board with a spindle that makes a tap.
struct TapBench {
    board: TestBoard,
    spindle: TapSpindle,
    tap: Tap,
}

impl TapBench {
    /// Begins a tap with the spindle at a speed, turns per second.
    fn begin(tap: Tap, speed: f64) -> Self {
        let sign = if tap.is_reverse { -1.0 } else { 1.0 };
        let mut board = TestBoard::default();
        board.configure(COUNTS as u32);
        board.begin();
        let spindle = TapSpindle::new(sign * speed);
        let mut bench = Self {
            board,
            spindle,
            tap,
        };
        // The first turns show the index.
        bench.run((1.5 / speed * CLOCK_HZ) as u64);
        let now = i64::from(bench.board.port.now as u32);
        let begin = [
            Z.into(),
            now,
            tap.start,
            DENOMINATOR,
            DENOMINATOR / 2,
            tap.is_reverse.into(),
            tap.depth,
        ];
        bench.board.send(Command::BeginTap, &begin);
        for [length, numerator, add] in tap.segments {
            let segment = [Z.into(), length, numerator, add];
            bench.board.send(Command::QueueAngle, &segment);
        }
        bench.board.send(Command::EndAngle, &[Z.into()]);
        bench
    }

    fn run(&mut self, ticks: u64) {
        let spindle = &mut self.spindle;
        self.board.run_with(ticks, |_| {
            spindle.advance(support::POLL_TICKS as f64 / CLOCK_HZ);
            let count = (spindle.turns * COUNTS as f64).floor() as i32;
            (!spindle.is_dead).then_some(count)
        });
    }

    /// Runs until a condition holds; fails after a minute.
    #[track_caller]
    fn run_until(&mut self, mut is_met: impl FnMut(&Self) -> bool) {
        for _ in 0..30_000 {
            if is_met(self) {
                return;
            }
            self.run(CHECK_TICKS);
        }
        panic!("{:?}", self.board.shutdown_text());
    }

    /// The count of the encoder at the start of the tap, or at its end.
    fn reported_count(&self, state: i64) -> Option<i64> {
        let mut events = self.board.events.iter();
        let is_state = |event: &&gsk_motion::Event| {
            event.response == Response::AngleState && event.values()[1] == state
        };
        events.find(is_state).map(|event| event.values()[2])
    }

    /// The count of the encoder at the start of the tap. The board reports it in the poll that
    /// passes the start.
    fn begun(&self) -> Option<i64> {
        let (count, start) = (self.reported_count(1)?, self.tap.start);
        let past = (count - start).rem_euclid(COUNTS);
        Some(match self.tap.is_reverse {
            true => count + (COUNTS - past) % COUNTS,
            false => count - past,
        })
    }

    /// Counts along the tap; negative before its start.
    fn along(&self) -> i64 {
        let count = i64::from(self.board.port.counts[0]);
        let turned = count - self.begun().unwrap_or(count);
        if self.tap.is_reverse { -turned } else { turned }
    }

    fn is_ended(&self) -> bool {
        self.reported_count(0).is_some()
    }

    /// In to the depth, run-on, reversal and back to the start.
    #[track_caller]
    fn follow_to_end(&mut self) {
        let forward = self.spindle.speed.signum() * self.spindle.target.abs();
        let depth = self.tap.depth;
        self.run_until(|bench| bench.along() >= depth);
        self.reverse(forward);
    }

    /// Stops the spindle, reverses it, and follows it back to the start.
    #[track_caller]
    fn reverse(&mut self, forward: f64) {
        self.spindle.target = 0.0;
        self.run_until(|bench| bench.spindle.speed.abs() < 0.02);
        self.spindle.target = -forward;
        self.run_until(|bench| bench.is_ended() || bench.board.shutdown_text().is_some());
    }

    /// The greatest distance of a step from the path beyond the steps of one count.
    fn greatest_error(&self, begun: i64) -> f64 {
        let mut position = 0_i64;
        let mut worst: f64 = 0.0;
        for step in self.board.port.steps.iter().filter(|step| step.axis == 0) {
            let before = position;
            position += if step.is_up { 1 } else { -1 };
            let along = if self.tap.is_reverse {
                begun - i64::from(step.count)
            } else {
                i64::from(step.count) - begun
            };
            let (ideal, slope) = self.tap.position(along);
            for position in [before, position] {
                worst = worst.max((position as f64 - ideal).abs() - slope);
            }
        }
        worst
    }

    #[track_caller]
    fn assert_count_is_true(&self) {
        let (counted, made) = (self.board.engine.position(0), self.board.port.sum(0));
        assert_eq!(counted, made);
    }
}

fn cases() -> Vec<(Tap, f64)> {
    let mut cases = Vec::new();
    for (index, steps) in [300, -300, 200, -2000, 90, 1350].into_iter().enumerate() {
        for is_reverse in [false, true] {
            let tap = Tap {
                is_reverse,
                start: [1000, 0, 4095, 17][index % 4],
                ..Tap::new(steps, 3.0)
            };
            cases.push((tap, [5.0, 10.0, 2.5][index % 3]));
        }
    }
    cases
}

#[test]
fn a_tap_follows_the_spindle_and_ends_at_its_start() {
    let mut worst: f64 = 0.0;
    for (index, (tap, speed)) in cases().into_iter().enumerate() {
        let mut bench = TapBench::begin(tap, speed);
        bench.run_until(|bench| bench.reported_count(1).is_some());
        let begun = bench.begun().unwrap();
        // Two stalls, at other depths in each case.
        for share in [0.3, 0.7] {
            let depth = (tap.depth as f64 * share) as i64 + 111 * index as i64;
            bench.run_until(|bench| bench.along() >= depth.min(bench.tap.depth));
            bench.spindle.is_stalled = true;
            bench.run(CHECK_TICKS * 20);
            bench.spindle.is_stalled = false;
        }
        bench.follow_to_end();
        assert_eq!(bench.board.shutdown_text(), None, "case {index}");
        let deepest = bench.board.port.steps.len() / 2;
        let (programmed, _) = tap.position(tap.depth);
        assert!(deepest as f64 > programmed.abs() + 1.0, "the run-on");
        assert_eq!(
            (bench.board.port.sum(0), bench.board.engine.position(0)),
            (0, 0)
        );
        let error = bench.greatest_error(begun);
        worst = worst.max(error);
        // The spindle runs on, stops, and turns forward again: Z stays.
        let steps = bench.board.port.steps.len();
        for target in [0.0, speed] {
            bench.spindle.target = target;
            bench.run(8_000_000);
        }
        assert_eq!(bench.board.port.steps.len(), steps);
        assert!(bench.board.engine.is_idle());
    }
    println!("greatest phase error beyond one count: {worst:.3} steps");
    assert!(worst <= 1.0, "{worst}");
}

#[test]
fn a_spindle_that_turns_back_early_does_not_end_the_tap() {
    let mut bench = TapBench::begin(Tap::new(300, 3.0), 5.0);
    bench.run_until(|bench| bench.along() >= COUNTS);
    bench.spindle.target = -2.0;
    bench.run_until(|bench| bench.along() < -COUNTS);
    assert_eq!((bench.board.port.sum(0), bench.is_ended()), (0, false));
    // A spindle that trembles at the start moves nothing.
    let steps = bench.board.port.steps.len();
    bench.spindle.target = 5.0;
    bench.run_until(|bench| bench.along() >= 0);
    for target in [-0.5, 0.5, -0.5] {
        (bench.spindle.speed, bench.spindle.target) = (target, target);
        bench.run(1_000_000);
    }
    assert!(bench.board.port.steps.len() <= steps + 40);
    (bench.spindle.speed, bench.spindle.target) = (5.0, 5.0);
    bench.follow_to_end();
    assert_eq!((bench.board.port.sum(0), bench.is_ended()), (0, true));
    assert_eq!(bench.board.shutdown_text(), None);
}

#[test]
fn a_spindle_that_is_not_reversed_shuts_the_board_down() {
    let tap = Tap::new(-300, 3.0);
    let mut bench = TapBench::begin(tap, 5.0);
    bench.run_until(|bench| bench.board.shutdown_text().is_some());
    assert_eq!(
        bench.board.shutdown_text(),
        Some("Tap beyond its last segment")
    );
    bench.assert_count_is_true();
    let (deepest, _) = tap.position(tap.depth + 4 * COUNTS);
    assert!((f64::from(bench.board.port.sum(0)) - deepest).abs() <= 1.0);
    assert_eq!(bench.board.port.outputs.last(), Some(&(ENABLE_PIN, 0)));
    let steps = bench.board.port.steps.len();
    bench.run(10_000_000);
    assert_eq!(bench.board.port.steps.len(), steps);
}

#[test]
fn whatever_stops_a_tap_leaves_a_true_count_and_no_motion() {
    for depth in [COUNTS / 4, COUNTS, 3 * COUNTS] {
        for cause in 0..6 {
            let mut bench = TapBench::begin(Tap::new(300, 4.0), 5.0);
            if cause == 1 {
                let now = bench.board.port.now as i64;
                let group = i64::from(GROUP);
                let board = &mut bench.board;
                board.send(Command::TrsyncStart, &[group, now + 100, 0, 4]);
                board.send(Command::StepperStopOnTrigger, &[Z.into(), group]);
                let home = [LIMIT.into(), now + 100, 234, 4, 15_625, 1, group, 1];
                board.send(Command::EndstopHome, &home);
                let ends = now + 0x4000_0000;
                board.send(Command::TrsyncSetTimeout, &[group, ends]);
            }
            bench.run_until(|bench| bench.along() >= depth);
            let expected = match cause {
                0 => {
                    bench.board.renewed = None;
                    Some("Lease expired")
                }
                1 => {
                    bench.board.port.levels |= 1 << LIMIT_PIN;
                    None
                }
                2 => {
                    bench.board.port.levels |= 1 << GUARD_PIN;
                    Some("Guard input tripped")
                }
                3 => {
                    bench.board.send(Command::EmergencyStop, &[]);
                    Some("Command request")
                }
                4 => {
                    // An index pulse an eighth of a turn beside the angle 0.
                    bench.board.port.index_turn = 0;
                    bench.run_until(|bench| bench.along() >= depth + COUNTS / 8);
                    bench.board.port.levels |= 1 << INDEX_PIN;
                    Some("Spindle index at another count")
                }
                _ => {
                    bench.spindle.is_dead = true;
                    None
                }
            };
            bench.run(6_000_000);
            assert_eq!(bench.board.shutdown_text(), expected, "{cause}");
            bench.assert_count_is_true();
            let steps = bench.board.port.steps.len();
            bench.spindle.target = -5.0;
            bench.run(10_000_000);
            assert_eq!(bench.board.port.steps.len(), steps, "{cause}");
        }
    }
}

#[test]
fn the_next_steps_need_a_clock_and_a_lease() {
    let mut bench = TapBench::begin(Tap::new(300, 2.0), 5.0);
    bench.follow_to_end();
    bench.run(100_000);
    let now = i64::from(bench.board.port.now as u32);
    bench.board.send(Command::ResetStepClock, &[Z.into(), now]);
    bench.board.send(Command::SetNextStepDir, &[Z.into(), 1]);
    let run = [Z.into(), 20_000, 100, 0];
    bench.board.send(Command::QueueStep, &run);
    bench.run(3_000_000);
    assert_eq!(
        (bench.board.shutdown_text(), bench.board.port.sum(0)),
        (None, 100)
    );

    let mut bench = TapBench::begin(Tap::new(300, 2.0), 5.0);
    bench.follow_to_end();
    bench.board.send(Command::QueueStep, &run);
    assert_eq!(
        bench.board.shutdown_text(),
        Some("Step clock not set after a thread")
    );
}

#[test]
fn an_invalid_tap_is_refused() {
    for (values, text) in [
        ([0, 4096, 2], "Angle entry without spindle encoder"),
        ([0, 0, 0], "Invalid count parameter"),
        ([0, 0, 0x8000_0000], "Invalid count parameter"),
    ] {
        let mut board = TestBoard::default();
        board.configure(COUNTS as u32);
        board.begin();
        let [clock, start, depth] = values;
        let begin = [Z.into(), clock, start, 16, 8, 0, depth];
        board.send(Command::BeginTap, &begin);
        assert_eq!(board.shutdown_text(), Some(text));
    }
}
