//! Cost of one millisecond of control, PLC and lathe.
//!
//! `cargo bench -p gsk980td-core --bench tick` prints mean, p99 and worst of a million ticks
//! while a program cuts, once plain and once with all axis features. It also prints how much
//! faster than machine time the samples run, then criterion's figures.

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::{Criterion, criterion_group, criterion_main};
use gsk_core::cnc::ControlRequest;
use gsk_core::machine::ServoConfig;
use gsk_core::operation::RunState;
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::simulation::{Simulation, StopCondition};
use gsk_core::units::Axis;

/// An endless program: cuts, an arc, rapids, back to the beginning.
const ENDLESS: &str = "O0001\nM03 S800\nG98\nN10 G00 X40 Z2\nG01 X40 Z-30 F300\n\
    G02 X60 Z-40 R10 F200\nG01 X80 Z-50 F400\nG00 X100 Z50\nM99 P10\n";

/// Sample parts.
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
/// The subprogram of the sample parts.
const SUBPROGRAM: &str = include_str!("../../assets/programs/O1031.CNC");

/// A setup with backlash, pitch errors, a gear ratio, blended corners, servo lag and screws
/// with play.
fn full_setup() -> Setup {
    let mut setup = Setup::default();
    for (number, value) in [
        (7, 0),
        (15, 1),
        (17, 2),
        (16, 2),
        (18, 3),
        (34, 20),
        (35, 30),
        (98, 127),
        (99, 127),
        (102, 5000),
        (103, 5000),
    ] {
        assert_eq!(setup.memory.parameters.set(number, value), Ok(()));
    }
    for point in 1..=255u8 {
        let value = i16::from(point % 7) - 3;
        assert_eq!(setup.memory.pitch.set(Axis::X, point, value), Ok(()));
        assert_eq!(setup.memory.pitch.set(Axis::Z, point, -value), Ok(()));
    }
    for axis in [&mut setup.lathe.x, &mut setup.lathe.z] {
        axis.backlash = 0.02;
        axis.servo = Some(ServoConfig::default());
    }
    setup
}

fn start_program(setup: Setup, text: &str) -> Simulation {
    let mut simulation = Simulation::new(setup);
    let opened = simulation
        .cnc
        .request(ControlRequest::OpenExternal(Program::new(text)));
    assert_eq!(opened, Ok(()));
    simulation.start_automatic();
    simulation
}

fn start_cutting(setup: Setup) -> Simulation {
    let mut simulation = start_program(setup, ENDLESS);
    simulation.run_until(StopCondition::Stopped, 3000);
    assert_eq!(simulation.cnc.run_state(), RunState::Run);
    simulation
}

fn print_distribution(name: &str, setup: Setup) {
    let mut simulation = start_cutting(setup);
    let mut times: Vec<Duration> = (0..1_000_000)
        .map(|_| {
            let start = Instant::now();
            simulation.tick();
            start.elapsed()
        })
        .collect();
    assert_eq!(simulation.cnc.run_state(), RunState::Run);
    times.sort_unstable();
    let mean = times.iter().sum::<Duration>() / times.len() as u32;
    println!(
        "tick with PLC and lathe, {name}: mean {mean:?}, median {:?}, p99 {:?}, worst {:?}; {:.0} x machine time",
        times[times.len() / 2],
        times[times.len() * 99 / 100],
        times[times.len() - 1],
        1e6 / mean.as_nanos() as f64,
    );
}

/// Runs the samples from start to end at full speed.
fn run_samples() {
    for (name, text) in SAMPLES {
        let mut setup = full_setup();
        assert!(setup.memory.programs.store(SUBPROGRAM).is_ok());
        let mut simulation = start_program(setup, text);
        let start = Instant::now();
        let mut ticks = 0u32;
        while ticks < 3_600_000 {
            simulation.tick();
            ticks += 1;
            match simulation.cnc.run_state() {
                RunState::Run => {}
                // M00: the operator presses cycle start.
                RunState::Stop if simulation.cnc.alarms().is_empty() => {
                    simulation.start_automatic();
                }
                _ => break,
            }
        }
        let machine = f64::from(ticks) / 1000.0;
        let took = start.elapsed().as_secs_f64();
        println!(
            "sample {name}: {machine:.1} s of machine time in {took:.3} s, {:.0} x; alarms {:?}",
            machine / took,
            simulation.cnc.alarms(),
        );
    }
}

fn bench(criterion: &mut Criterion) {
    print_distribution("plain", Setup::default());
    print_distribution("with everything", full_setup());
    run_samples();
    let mut simulation = start_cutting(Setup::default());
    criterion.bench_function("tick", |bencher| {
        bencher.iter(|| black_box(&mut simulation).tick());
    });
    let mut full = start_cutting(full_setup());
    criterion.bench_function("tick with everything", |bencher| {
        bencher.iter(|| black_box(&mut full).tick());
    });
    let mut idle = Simulation::new(Setup::delivered());
    criterion.bench_function("tick idle", |bencher| {
        bencher.iter(|| black_box(&mut idle).tick());
    });
}

criterion_group!(benches, bench);
criterion_main!(benches);
