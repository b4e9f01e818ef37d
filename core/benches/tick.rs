//! Cost of one millisecond of control, PLC and lathe.
//!
//! `cargo bench -p gsk980td-core --bench tick` prints mean, p99 and worst of a
//! million ticks while a program cuts, then criterion's figures.

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::{Criterion, criterion_group, criterion_main};
use gsk_core::cnc::Request;
use gsk_core::operation::RunState;
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::simulation::{Simulation, Until};

/// A program that never ends: cuts, an arc, rapids, back to the top.
const ENDLESS: &str = "O0001\nM03 S800\nG98\nN10 G00 X40 Z2\nG01 X40 Z-30 F300\n\
    G02 X60 Z-40 R10 F200\nG01 X80 Z-50 F400\nG00 X100 Z50\nM99 P10\n";

fn cutting() -> Simulation {
    let mut simulation = Simulation::new(Setup::default());
    let opened = simulation
        .cnc
        .request(Request::OpenExternal(Program::new(ENDLESS)));
    assert_eq!(opened, Ok(()));
    simulation.start_automatic();
    simulation.run_until(Until::Stopped, 3000);
    assert_eq!(simulation.cnc.run_state(), RunState::Run);
    simulation
}

fn distribution() {
    let mut simulation = cutting();
    let mut times: Vec<Duration> = (0..1_000_000)
        .map(|_| {
            let start = Instant::now();
            simulation.tick();
            start.elapsed()
        })
        .collect();
    times.sort_unstable();
    let mean = times.iter().sum::<Duration>() / times.len() as u32;
    println!(
        "tick with PLC and lathe: mean {mean:?}, median {:?}, p99 {:?}, worst {:?}; {:.0} x machine time",
        times[times.len() / 2],
        times[times.len() * 99 / 100],
        times[times.len() - 1],
        1e6 / mean.as_nanos() as f64,
    );
}

fn bench(criterion: &mut Criterion) {
    distribution();
    let mut simulation = cutting();
    criterion.bench_function("tick", |bencher| {
        bencher.iter(|| black_box(&mut simulation).tick());
    });
    let mut idle = Simulation::new(Setup::delivered());
    criterion.bench_function("tick idle", |bencher| {
        bencher.iter(|| black_box(&mut idle).tick());
    });
}

criterion_group!(benches, bench);
criterion_main!(benches);
