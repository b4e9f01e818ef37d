//! A thread and a tap of the step-queue link on the built firmware in the emulator and on the twin:
//! each step comes at the same count of the spindle.

use std::cell::Cell;
use std::rc::Rc;
use std::time::Duration;

use gsk_link::step_queue::StepLink;
use gsk_link::{
    AxisRates, Backend, Drives, FINE, LinkConfig, LinkEvent, LinkState, RunTime, Sample, TapOrder,
    ThreadPlan,
};
use gsk_twins::pico::{PicoTwin, SpindleEncoderWiring};
use gsk_units::{PerAxis, Pulses};
use pico_bench::{Bench, CYCLES_PER_S};

/// Counts per turn of the spindle.
const COUNTS: f64 = 4096.0;
/// Steps of Z per turn: a lead of 2 mm with 5 µm a step.
const LEAD_STEPS: f64 = 400.0;
/// Turns of lead-in and of lead-out, and of the thread between their middles.
const RAMP_TURNS: f64 = 0.5;
const THREAD_TURNS: f64 = 3.0;
/// Ripples of the spindle in a turn, and their amplitude.
const RIPPLES: f64 = 3.0;
const RIPPLE: f64 = 0.2;
/// Greatest time from a count to its step, in counts at 720 r/min: 20 µs.
const LATENCY_COUNTS: f64 = 1.0;

const WIRED: &str = r#"(
    protocol: StepQueue,
    baud: 250000,
    x: (step: "gpio2", dir: "gpio3"),
    z: (step: "gpio4", dir: "gpio5"),
    io: (enable: "gpio14", index: "gpio18", encoder: "gpio16", encoder_counts: 4096),
)"#;

/// Greatest difference of the counts of a step in two passes: twice an eighth of a step, the
/// tolerance of the segments, and the times from the count to the step.
const MOST_APART: i64 = 5;

/// Turns of the tap from its start to its depth, and its start, counts after the index.
const TAP_TURNS: f64 = 2.0;
const TAP_START: f64 = 1024.0;

/// A step of Z: its direction, and the count of the spindle.
type ThreadStep = (bool, i64);

/// A board with a spindle of 600 r/min that varies.
trait ThreadBoard {
    /// Sets the speed of the spindle without its ripple, r/min.
    fn set_speed(&mut self, rpm: f64);
    fn now(&self) -> Duration;
    fn run_one_ms(&mut self);
    fn read(&mut self) -> Vec<u8>;
    fn write(&mut self, bytes: &[u8]);
    fn take_steps(&mut self) -> Vec<ThreadStep>;
}

/// The emulated board and the speed of its spindle, r/min.
struct EmulatedBoard {
    bench: Bench,
    rpm: Rc<Cell<f64>>,
}

impl ThreadBoard for EmulatedBoard {
    fn set_speed(&mut self, rpm: f64) {
        self.rpm.set(rpm);
    }

    fn now(&self) -> Duration {
        Duration::from_secs_f64(self.bench.cycle() as f64 / CYCLES_PER_S)
    }

    fn run_one_ms(&mut self) {
        self.bench.run(125_000);
    }

    fn read(&mut self) -> Vec<u8> {
        let from_board = self.bench.from_board.replace(Vec::new());
        from_board.unwrap_or_default()
    }

    fn write(&mut self, bytes: &[u8]) {
        self.bench.write(bytes);
    }

    fn take_steps(&mut self) -> Vec<ThreadStep> {
        let edges = self.bench.edges.drain(..).filter(|edge| edge.axis == 1);
        edges.map(|edge| (edge.is_up, edge.count)).collect()
    }
}

impl ThreadBoard for PicoTwin {
    fn set_speed(&mut self, rpm: f64) {
        self.run_spindle(rpm);
    }

    fn now(&self) -> Duration {
        Duration::from_nanos(PicoTwin::now(self))
    }

    fn run_one_ms(&mut self) {
        self.advance(1_000_000);
    }

    fn read(&mut self) -> Vec<u8> {
        PicoTwin::read(self)
    }

    fn write(&mut self, bytes: &[u8]) {
        PicoTwin::write(self, bytes);
    }

    fn take_steps(&mut self) -> Vec<ThreadStep> {
        let mut steps = Vec::new();
        for step in self.take_recorded_steps() {
            if step.stepper == 1 {
                steps.push((step.position, step.count));
            }
        }
        let mut last = 0;
        let up = |&(position, count): &(i64, i64)| {
            let is_up = position > last;
            last = position;
            (is_up, count)
        };
        steps.iter().map(up).collect()
    }
}

fn emulator() -> EmulatedBoard {
    let rpm = Rc::new(Cell::new(600.0));
    let speed = Rc::clone(&rpm);
    let mut bench = Bench::start();
    bench.from_board = Some(Vec::new());
    bench.index_counts = 4;
    let (mut turns, mut last) = (0.3, bench.cycle());
    bench.set_spindle(move |cycle| {
        let seconds = (cycle - last) as f64 / CYCLES_PER_S;
        last = cycle;
        let phase: f64 = turns * RIPPLES * std::f64::consts::TAU;
        turns += speed.get() / 60.0 * (1.0 + RIPPLE * phase.sin()) * seconds;
        (turns * COUNTS).floor() as i64
    });
    EmulatedBoard { bench, rpm }
}

fn twin() -> PicoTwin {
    let mut twin = PicoTwin::new();
    twin.attach_spindle(SpindleEncoderWiring {
        index_pin: 18,
        direction_pins: None,
        speed_pin: None,
        counts_per_turn: COUNTS as u32,
        full_speed_rpm: 0.0,
        time_constant_s: 0.0,
    });
    twin.run_spindle(600.0);
    twin.set_speed_ripple(100.0 * RIPPLE, RIPPLES);
    twin.start_recording_steps();
    twin
}

/// The way of Z after some turns of the thread, turns of lead.
fn way(turns: f64) -> f64 {
    let ramp = |turns: f64| {
        let turns = turns.max(0.0);
        if turns < RAMP_TURNS {
            turns * turns / (2.0 * RAMP_TURNS)
        } else {
            turns - RAMP_TURNS / 2.0
        }
    };
    ramp(turns) - ramp(turns - THREAD_TURNS)
}

/// The link with a board.
struct ThreadHost<B> {
    board: B,
    link: StepLink,
    run: RunTime,
    events: Vec<LinkEvent>,
}

impl<B: ThreadBoard> ThreadHost<B> {
    fn open(board: B) -> Self {
        let config: LinkConfig = ron::from_str(WIRED).unwrap();
        config.check().unwrap();
        let rates = AxisRates::new(8000.0, 100.0, 8000.0);
        let drives = Drives {
            pulse_weight: PerAxis::new(0.0025, 0.005),
            rates: PerAxis::new(rates, rates),
        };
        let link = StepLink::open(config, &drives, board.now());
        let mut host = Self {
            board,
            link,
            run: RunTime::ZERO,
            events: Vec::new(),
        };
        host.reach(LinkState::Locked);
        host.run_ms(200);
        let zero = PerAxis::new(Pulses(0), Pulses(0));
        host.link.set_position(zero, host.run).unwrap();
        host.run_ms(300);
        host.board.take_steps();
        host
    }

    fn run_ms(&mut self, ms: u32) {
        for _ in 0..ms {
            self.board.run_one_ms();
            let (now, bytes) = (self.board.now(), self.board.read());
            self.link.rx(&bytes, now);
            self.link.tick(now);
            let sent = self.link.tx().to_vec();
            self.board.write(&sent);
            self.link.consumed(sent.len());
            self.events.extend(self.link.events());
        }
    }

    fn reach(&mut self, state: LinkState) {
        for _ in 0..6000 {
            if self.link.state() == state {
                return;
            }
            self.run_ms(1);
        }
        panic!("{:?} {:?}", self.link.state(), self.events);
    }

    /// Sends a tick of Z at a position, steps.
    fn send(&mut self, z: f64) {
        let mut waited = 0;
        while self.link.free_lookahead() < Duration::from_millis(1) {
            assert!(waited < 5000, "{:?} {:?}", self.link.state(), self.events);
            waited += 1;
            self.run_ms(1);
        }
        self.run += Duration::from_millis(1);
        let pulses = PerAxis::new(Pulses(0), Pulses((z + 0.5).floor() as i64));
        let sample = Sample {
            fine: PerAxis::new(0, (z * FINE as f64).round() as i64),
            ..Sample::new(self.run, pulses)
        };
        self.link.push(sample).unwrap();
    }

    /// Taps: in to the depth, run-on and reversal of the spindle, and back. Returns the steps.
    fn tap(&mut self) -> Vec<ThreadStep> {
        let order = TapOrder {
            start: PerAxis::new(Pulses(0), Pulses(0)),
            depth: -TAP_TURNS * LEAD_STEPS,
            bound: 4.0 * TAP_TURNS * LEAD_STEPS,
            lead: LEAD_STEPS,
            start_degrees: 360.0 * TAP_START / COUNTS,
            lead_in_turns: RAMP_TURNS,
            first_share: 0.0,
        };
        self.reach(LinkState::Ready);
        self.link.tap(&order).unwrap();
        let depth = TAP_TURNS * LEAD_STEPS;
        for _ in 0..5000 {
            if self.link.tap_distance().is_some_and(|at| at >= depth) {
                break;
            }
            self.run_ms(1);
        }
        // 200 ms each: it slows down, stands, and turns back faster and faster.
        for ms in 0..600 {
            let rpm = match ms {
                0..200 => f64::from(200 - ms) * 3.0,
                200..400 => 0.0,
                _ => f64::from(400 - ms) * 3.0,
            };
            self.board.set_speed(rpm);
            self.run_ms(1);
        }
        self.reach(LinkState::Ready);
        self.run_ms(100);
        let is_alarm = |event: &LinkEvent| matches!(event, LinkEvent::Alarm { .. });
        assert!(!self.events.iter().any(is_alarm), "{:?}", self.events);
        assert!(self.events.contains(&LinkEvent::Drained));
        assert_eq!(self.link.counted(), Some(order.start));
        self.board.take_steps()
    }

    /// Cuts a pass and returns to its start. Returns the steps of the cut, their counts from an
    /// index on.
    fn cut(&mut self) -> Vec<ThreadStep> {
        let end = THREAD_TURNS + RAMP_TURNS;
        let mut begun = None;
        for tick in 0.. {
            let waits = tick < 2;
            self.link
                .plan_thread(Some(ThreadPlan { rpm: 600.0, waits }));
            let view = self.link.spindle(Some(0.0)).unwrap();
            let begun = *begun.get_or_insert(view.before + 1.0);
            let turns: f64 = view.now - begun;
            let z = -LEAD_STEPS * way(turns.min(end));
            if tick < 2 {
                self.link.keep_time(true);
            }
            self.send(if waits { 0.0 } else { z });
            if turns >= end {
                break;
            }
        }
        self.link.plan_thread(None);
        self.link.finish().unwrap();
        self.reach(LinkState::Ready);
        let steps = self.board.take_steps();
        let bottom = -LEAD_STEPS * way(end);
        for tick in 1..=300 {
            let done = f64::from(tick) / 300.0;
            self.send(bottom * (1.0 - done * done * (3.0 - 2.0 * done)));
        }
        self.link.finish().unwrap();
        self.reach(LinkState::Ready);
        self.board.take_steps();
        let is_alarm = |event: &LinkEvent| matches!(event, LinkEvent::Alarm { .. });
        assert!(!self.events.iter().any(is_alarm), "{:?}", self.events);
        steps
    }
}

/// Returns the greatest difference of the counts of a step in two passes, between the ramps.
fn counts_apart(one: &[i64], other: &[i64]) -> i64 {
    let is_between = |count: i64| {
        let turns = count as f64 / COUNTS;
        turns > RAMP_TURNS && turns < THREAD_TURNS
    };
    let pairs = one.iter().zip(other).filter(|(one, _)| is_between(**one));
    pairs
        .map(|(one, other)| (one - other).abs())
        .max()
        .unwrap_or(i64::MAX)
}

/// Cuts two passes; returns the counts of their steps from the first index of each on, and prints
/// the greatest phase error.
fn counts_of_two_passes<B: ThreadBoard>(name: &str, board: B) -> Vec<i64> {
    let mut host = ThreadHost::open(board);
    let passes: Vec<Vec<i64>> = [0, 1]
        .map(|_| {
            let steps = host.cut();
            assert!(steps.iter().all(|(is_up, _)| !is_up), "{name}");
            assert_eq!(steps.len() as f64, LEAD_STEPS * way(10.0), "{name}");
            // The first step is within the first turn after the start.
            let start = (steps[0].1 as f64 / COUNTS).floor() * COUNTS;
            let counts = steps.iter().map(|(_, count)| count - start as i64);
            counts.collect()
        })
        .into();
    let mut worst: f64 = 0.0;
    for (made, count) in passes.iter().flat_map(|pass| pass.iter().enumerate()) {
        let due = LEAD_STEPS * way(*count as f64 / COUNTS);
        worst = worst.max((made as f64 + 0.5 - due).abs());
    }
    let apart = counts_apart(&passes[0], &passes[1]);
    println!("{name}: phase error at most {worst:.2} steps, passes {apart} counts apart");
    let count_steps = LEAD_STEPS / COUNTS;
    assert!(
        worst <= 1.0 + (1.0 + LATENCY_COUNTS) * count_steps,
        "{name}: {worst}"
    );
    assert!(apart <= MOST_APART, "{name}: {apart}");
    passes[0].clone()
}

#[test]
fn a_thread_has_its_steps_at_the_same_counts_in_the_emulator_and_on_the_twin() {
    let on_twin = counts_of_two_passes("twin", twin());
    let in_emulator = counts_of_two_passes("emulator", emulator());
    let apart = counts_apart(&on_twin, &in_emulator);
    println!("twin and emulator: {apart} counts apart");
    assert!(apart <= MOST_APART, "{apart}");
}

/// Taps; returns the counts of the steps on the way in from the start on, and prints the greatest
/// phase error.
fn counts_of_a_tap<B: ThreadBoard>(name: &str, board: B) -> Vec<i64> {
    let mut host = ThreadHost::open(board);
    let steps = host.tap();
    let ups = steps.iter().filter(|(is_up, _)| *is_up).count();
    assert_eq!(2 * ups, steps.len(), "{name}: net zero steps");
    assert!(
        ups as f64 > LEAD_STEPS * way(TAP_TURNS + RAMP_TURNS / 2.0),
        "{name}: the run-on"
    );
    // The first step is within the first turn after the start.
    let begun = ((steps[0].1 as f64 - TAP_START) / COUNTS).floor() * COUNTS + TAP_START;
    let tap_way = |turns: f64| {
        let turns = turns.max(0.0);
        if turns < RAMP_TURNS {
            turns * turns / (2.0 * RAMP_TURNS)
        } else {
            turns - RAMP_TURNS / 2.0
        }
    };
    let (mut position, mut worst) = (0.0_f64, 0.0_f64);
    for (is_up, count) in &steps {
        let due = LEAD_STEPS * tap_way((*count as f64 - begun) / COUNTS);
        worst = worst.max((position - due).abs());
        position += if *is_up { -1.0 } else { 1.0 };
        worst = worst.max((position - due).abs());
    }
    println!(
        "{name}: {} edges of a tap, phase error at most {worst:.2} steps",
        steps.len()
    );
    let count_steps = LEAD_STEPS / COUNTS;
    assert!(
        worst <= 1.0 + (1.0 + LATENCY_COUNTS) * count_steps,
        "{name}: {worst}"
    );
    let inwards = steps.iter().take_while(|(is_up, _)| !is_up);
    inwards.map(|(_, count)| count - begun as i64).collect()
}

#[test]
fn a_tap_has_its_steps_at_the_same_counts_in_the_emulator_and_on_the_twin() {
    let on_twin = counts_of_a_tap("twin", twin());
    let in_emulator = counts_of_a_tap("emulator", emulator());
    let pairs = on_twin.iter().zip(&in_emulator);
    let apart = pairs.map(|(one, other)| (one - other).abs()).max();
    println!("twin and emulator: {apart:?} counts apart in a tap");
    // A step that the spindle's ripple delays by a count, and the latency.
    assert!(apart.is_some_and(|apart| apart <= MOST_APART), "{apart:?}");
}
