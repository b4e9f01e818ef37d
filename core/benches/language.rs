//! Cost of loading a program and interpreting it to its end, as `check` does.
//!
//! `cargo bench -p gsk980td-core --bench language` prints the memory of a loaded block, then
//! criterion's figures. An element is a block; for roughing it is a move.

mod shapes;

use std::hint::black_box;
use std::time::Duration;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use gsk_core::command::ProgramId;
use gsk_core::memory::ToolOffset;
use gsk_core::preview::{Preview, PreviewEnd, preview};
use gsk_core::program::{Program, split_programs};
use gsk_core::setup::Setup;

/// Number of short blocks for the memory measurement.
const BLOCKS: u32 = 1_000_000;

/// A setup with nose radius compensation and a tool for it.
fn nose_setup() -> Setup {
    let mut setup = Setup::default();
    assert_eq!(setup.memory.parameters.set_bit(2, 1, true), Ok(()));
    let tool = ToolOffset {
        r: 0.4,
        t: 3,
        ..ToolOffset::default()
    };
    assert_eq!(setup.memory.offsets.set(1, tool), Ok(()));
    setup
}

/// Loads a file and interprets it.
fn check_program(setup: &Setup, text: &str) -> Preview {
    let mut programs = setup.memory.programs.clone();
    let mut parts = split_programs(text).into_iter();
    if let Some(main) = parts.next() {
        programs.open_external(main);
    }
    for subprogram in parts {
        assert!(programs.store(subprogram.text()).is_ok());
    }
    programs.select(ProgramId::External);
    preview(setup, &programs, &mut |executed| {
        black_box(executed);
    })
}

/// Resident memory of this process, bytes; `None` if the system does not report it.
fn resident_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmRSS:"))?;
    let kilobytes: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kilobytes * 1024)
}

fn print_memory() {
    let text = shapes::short_lines(BLOCKS);
    let length = text.len();
    let before = resident_bytes();
    let program = black_box(Program::new(text.as_str()));
    let after = resident_bytes();
    let blocks = f64::from(program.block_count());
    if let (Some(before), Some(after)) = (before, after) {
        println!(
            "memory of a loaded block: {:.1} bytes with its text, which is {:.1} bytes",
            after.saturating_sub(before) as f64 / blocks,
            length as f64 / blocks,
        );
    }
}

fn bench(criterion: &mut Criterion) {
    print_memory();
    let setup = nose_setup();
    let mut group = criterion.benchmark_group("check");
    group
        .sample_size(10)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(4));
    for (name, text) in shapes::all_shapes() {
        let seen = check_program(&setup, &text);
        assert_eq!(seen.end, PreviewEnd::M30, "{name}: {:?}", seen.alarm);
        let elements = seen.blocks.max(seen.moves);
        group.throughput(Throughput::Elements(elements));
        group.bench_function(name, |bencher| {
            bencher.iter(|| check_program(&setup, &text));
        });
    }
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
