//! Measures the cost of a keystroke in a long program.
//!
//! `cargo bench -p gsk980td-language --bench keystroke` prints criterion's figures for a
//! program of 100 000 blocks: the change of the text, its analysis, and the requests for its
//! symbols and folds.

use std::fmt::Write as _;
use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use gsk_core::command::ProgramId;
use gsk_core::model::ModelId;
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_language::{Position, Structure, TextChange, TextDocument, analyse, folds, symbols};
use gsk_messages::Language;

/// Blocks of the program.
const BLOCKS: u32 = 100_000;

/// A program of short cuts with a tool change every 5000 blocks.
fn program() -> String {
    let mut text = String::from("O0001 (long)\nM03 S800 T0101\nG00 X100 Z2\nG98 F300\n");
    for block in 0..BLOCKS {
        let (x, z) = (20 + block % 50, block % 90);
        let _ = match block % 5000 {
            4999 => writeln!(text, "G00 X100 Z5 T0{}01", 1 + block / 5000 % 4),
            _ => writeln!(
                text,
                "N{:04} G01 X{x}.{:03} Z-{z}.5",
                block % 9999,
                block % 997
            ),
        };
    }
    text.push_str("G00 X100 Z100\nM30\n");
    text
}

fn analyse_text(text: &TextDocument) -> usize {
    let mut setup = Setup::default();
    setup
        .memory
        .programs
        .open_external(Program::new(text.as_str()));
    setup.memory.programs.select(ProgramId::External);
    analyse(&setup, Language::En, &mut |_| true).findings.len()
}

fn keystroke(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("keystroke");
    group.sample_size(20);
    let mut text = TextDocument::new(program());
    let at = Position {
        line: BLOCKS / 2,
        byte: 5,
    };
    let insertion = TextChange {
        from: at,
        to: at,
        text: " ".to_owned(),
    };
    let end = Position {
        byte: at.byte + 1,
        ..at
    };
    let removal = TextChange {
        from: at,
        to: end,
        text: String::new(),
    };
    group.bench_function("change", |bench| {
        bench.iter(|| {
            text.apply(&insertion);
            text.apply(&removal);
        });
    });
    group.bench_function("look", |bench| {
        bench.iter(|| black_box(analyse_text(&text)));
    });
    group.bench_function("structure", |bench| {
        bench.iter(|| black_box(Structure::read(&text)));
    });
    let structure = Structure::read(&text);
    group.bench_function("symbols", |bench| {
        bench.iter(|| black_box(symbols(&text, &structure, ModelId::default())));
    });
    group.bench_function("folds", |bench| {
        bench.iter(|| black_box(folds(&text, &structure)));
    });
    group.finish();
}

criterion_group!(benches, keystroke);
criterion_main!(benches);
