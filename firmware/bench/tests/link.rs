//! The step-queue link of the control drives the firmware: opening, motion, stop. It uses what
//! the dictionary of the board announces.

use std::time::Duration;

use gsk_link::step_queue::StepLink;
use gsk_link::{
    AxisRates, Backend, Drives, FINE, LinkConfig, LinkEvent, LinkState, RunTime, Sample,
};
use gsk_units::{PerAxis, Pulses};
use pico_bench::{Bench, CYCLES_PER_S, LIMIT_PIN};

/// Cycles per millisecond.
const MS: u64 = 125_000;

const WIRED: &str = r#"(
    protocol: StepQueue,
    baud: 250000,
    x: (step: "gpio2", dir: "gpio3", limit: "^gpio10"),
    z: (step: "gpio4", dir: "gpio5"),
    io: (enable: "gpio14", estop: "gpio11", spindle_cw: "gpio15", spindle_pwm: "gpio20", index: "gpio18"),
)"#;

/// The link with the board in the emulator.
struct LinkBench {
    bench: Bench,
    link: StepLink,
    run: RunTime,
    at: (f64, f64),
    events: Vec<LinkEvent>,
}

impl LinkBench {
    fn open(wired: &str) -> Self {
        let mut bench = Bench::start();
        bench.from_board = Some(Vec::new());
        let config: LinkConfig = ron::from_str(wired).unwrap();
        config.check().unwrap();
        let rates = AxisRates::new(8000.0, 100.0, 8000.0);
        let drives = Drives {
            pulse_weight: PerAxis::new(0.0025, 0.005),
            rates: PerAxis::new(rates, rates),
        };
        let now = Duration::from_secs_f64(bench.cycle() as f64 / CYCLES_PER_S);
        Self {
            bench,
            link: StepLink::open(config, &drives, now),
            run: RunTime::ZERO,
            at: (0.0, 0.0),
            events: Vec::new(),
        }
    }

    fn run_one_ms(&mut self) {
        self.bench.run(MS);
        let now = Duration::from_secs_f64(self.bench.cycle() as f64 / CYCLES_PER_S);
        let bytes = self.bench.from_board.replace(Vec::new()).unwrap();
        self.link.rx(&bytes, now);
        self.link.tick(now);
        let sent = self.link.tx().to_vec();
        self.bench.write(&sent);
        self.link.consumed(sent.len());
        self.events.extend(self.link.events());
    }

    fn reaches_state(&mut self, state: LinkState, limit_ms: u32) -> bool {
        for _ in 0..limit_ms {
            if self.link.state() == state {
                return true;
            }
            self.run_one_ms();
        }
        false
    }

    fn pulses(&self) -> PerAxis<Pulses> {
        let whole = |place: f64| Pulses((place + 0.5).floor() as i64);
        PerAxis::new(whole(self.at.0), whole(self.at.1))
    }

    /// Sends a tick of motion; returns whether the link takes it.
    fn send_sample(&mut self, x: f64, z: f64) -> bool {
        while self.link.free_lookahead() < Duration::from_millis(1) {
            if !self.link.state().takes_motion() {
                return false;
            }
            self.run_one_ms();
        }
        self.run += Duration::from_millis(1);
        self.at = (x, z);
        let fine = |place: f64| (place * FINE as f64).round() as i64;
        let sample = Sample {
            fine: PerAxis::new(fine(x), fine(z)),
            ..Sample::new(self.run, self.pulses())
        };
        self.link.push(sample).is_ok()
    }
}

#[test]
fn the_step_queue_link_opens_and_moves_and_stops_at_a_limit() {
    let mut host = LinkBench::open(WIRED);
    let is_open = host.reaches_state(LinkState::Locked, 4000);
    assert!(is_open, "{:?} {:?}", host.link.state(), host.events);
    println!(
        "{} opened after {:.0} ms",
        host.link.board().firmware,
        host.bench.cycle() as f64 / 125e3
    );
    for _ in 0..200 {
        host.run_one_ms();
    }
    host.link.set_position(host.pulses(), host.run).unwrap();
    for _ in 0..300 {
        host.run_one_ms();
    }
    host.bench.edges.clear();
    // Both axes there and back with ramps, and Z 100 pulses farther.
    for tick in 1..=500 {
        let done = f64::from(tick) / 500.0;
        let share = 0.5 - 0.5 * (std::f64::consts::TAU * done).cos();
        let rest = done * done * (3.0 - 2.0 * done);
        let is_taken = host.send_sample(800.0 * share, -2400.0 * share - 100.0 * rest);
        assert!(is_taken, "{tick} {:?}", host.events);
    }
    host.link.finish().unwrap();
    assert!(
        host.reaches_state(LinkState::Ready, 1000),
        "{:?}",
        host.events
    );
    let is_alarm = |event: &LinkEvent| matches!(event, LinkEvent::Alarm { .. });
    assert!(!host.events.iter().any(is_alarm), "{:?}", host.events);
    let made = (host.bench.sum(0), host.bench.sum(1));
    assert_eq!(host.bench.edges.len(), 1600 + 4800);
    assert_eq!((made.0.abs(), made.1.abs()), (0, 100));

    // The limit switch of X in a motion of Z: stopped by the board, the position is known.
    for tick in 1..=400 {
        if tick == 200 {
            host.bench.set_input(LIMIT_PIN, true);
        }
        if !host.send_sample(0.0, -100.0 - 4.0 * f64::from(tick)) {
            break;
        }
    }
    assert!(
        host.reaches_state(LinkState::Tripped, 1000),
        "{:?} {:?}",
        host.link.state(),
        host.events
    );
    let position = host.events.iter().rev().find_map(|event| match event {
        LinkEvent::Position(position) => Some(position.z.0),
        _ => None,
    });
    assert_eq!(position.map(i64::abs), Some(host.bench.sum(1).abs()));
}

#[test]
fn the_machine_file_for_the_pico_opens_the_board() {
    let machine = include_str!("../../../assets/machines/pico-lathe.ron");
    let from = machine.find("Some(").unwrap() + "Some(".len();
    let to = machine.rfind("),\n)").unwrap();
    let mut host = LinkBench::open(&machine[from..to]);
    let is_open = host.reaches_state(LinkState::Locked, 4000);
    assert!(is_open, "{:?} {:?}", host.link.state(), host.events);
}
