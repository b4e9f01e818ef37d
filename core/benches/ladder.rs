//! Cost of the ladder: the longest possible ladder, scanned undivided, and the effect of its
//! slots on the ticks.
//!
//! `cargo bench -p gsk980td-core --bench ladder` prints the scan of 5000 steps, then the
//! ticks of a cutting control with three ladders: a minimal one, the standard one, and the
//! longest one with level 2 undivided.

use std::fmt::Write;
use std::sync::Arc;
use std::time::{Duration, Instant};

use criterion::{Criterion, criterion_group, criterion_main};
use gsk_core::cnc::ControlRequest;
use gsk_core::plc::{Ladder, MAX_STEPS, Plc};
use gsk_core::program::Program;
use gsk_core::setup::{STANDARD_LADDER, Setup, standard_ladder};
use gsk_core::simulation::{Simulation, StopCondition};

const ENDLESS: &str = "O0001\nM03 S800\nG98\nN10 G00 X40 Z2\nG01 X40 Z-30 F300\n\
    G02 X60 Z-40 R10 F200\nG01 X80 Z-50 F400\nG00 X100 Z50\nM99 P10\n";

/// The standard ladder, extended to 5000 steps by rungs as a machine builder writes them:
/// contacts, branches, coils, and a function instruction in each fifth rung.
fn longest_ladder() -> Arc<Ladder> {
    let mut filler = String::new();
    let mut longest = standard_ladder();
    for count in 0.. {
        let (byte, bit) = (200 + count % 500, count % 8);
        let _ = write!(
            filler,
            "LD X{}.{bit}\nOR R{byte}.{bit}\nANI R{}.0\nLD F{}.{bit}\nAND G{}.{bit}\nORB\nOUT R{}.{bit}\n",
            count % 4,
            byte + 1,
            count % 200,
            count % 200,
            byte + 2,
        );
        if count % 5 == 0 {
            let _ = write!(
                filler,
                "LD R{byte}.{bit}\nCMP 2 D{} 7 R{}.1\nMOVN 4 D300 D{}\n",
                count % 900,
                byte + 3,
                304 + count % 600
            );
        }
        let text = STANDARD_LADDER.replace("\nEND2", &format!("\n{filler}END2"));
        match Ladder::compile(&format!(".OPT n1\n{text}")) {
            Ok(ladder) => longest = Arc::new(ladder),
            Err(_) => break,
        }
    }
    longest
}

fn print_figures(name: &str, mut times: Vec<Duration>) {
    times.sort_unstable();
    let mean = times.iter().sum::<Duration>() / times.len() as u32;
    println!(
        "{name}: mean {mean:?}, median {:?}, p99 {:?}, worst {:?}",
        times[times.len() / 2],
        times[times.len() * 99 / 100],
        times[times.len() - 1],
    );
}

fn measure_scan(ladder: &Arc<Ladder>) {
    let mut plc = Plc::new(Arc::clone(ladder));
    let times = (0..100_000u32)
        .map(|slot| {
            for byte in 0..4 {
                plc.memory_mut().set_x(byte, (slot >> byte) as u8);
            }
            let start = Instant::now();
            plc.run_slot();
            start.elapsed()
        })
        .collect();
    print_figures(
        &format!(
            "slot, {} of {MAX_STEPS} steps in {} part",
            ladder.steps(),
            ladder.part_count()
        ),
        times,
    );
}

/// Measures ticks with a slot of the PLC, and ticks without.
fn measure_ticks(name: &str, ladder: &Arc<Ladder>) {
    let mut simulation = Simulation::new(Setup {
        ladder: Arc::clone(ladder).into(),
        ..Setup::default()
    });
    let opened = simulation
        .cnc
        .request(ControlRequest::OpenExternal(Program::new(ENDLESS)));
    assert_eq!(opened, Ok(()));
    simulation.start_automatic();
    simulation.run_until(StopCondition::Stopped, 3000);
    let (mut with, mut without) = (Vec::new(), Vec::new());
    for _ in 0..400_000 {
        let start = Instant::now();
        simulation.tick();
        let time = start.elapsed();
        if simulation.cnc.ticks() % 8 == 1 {
            with.push(time);
        } else {
            without.push(time);
        }
    }
    print_figures(&format!("{name}: ticks with a slot"), with);
    print_figures(&format!("{name}: ticks without"), without);
}

fn bench(criterion: &mut Criterion) {
    let (longest, standard) = (longest_ladder(), standard_ladder());
    measure_scan(&longest);
    measure_scan(&standard);
    measure_ticks("standard ladder in parts", &standard);
    measure_ticks("5000 steps undivided", &longest);
    let mut plc = Plc::new(longest);
    criterion.bench_function("slot of 5000 steps", |bencher| {
        bencher.iter(|| plc.run_slot());
    });
}

criterion_group!(benches, bench);
criterion_main!(benches);
