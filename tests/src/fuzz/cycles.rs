//! Fuzzes cycles and compensated contours. An input is the body of a program that is prepared
//! for cutting, so that its first words already have an effect.

use super::{dry_run, settings};

/// Number of steps after which the interpreter is stopped: cycles with fine cuts make many.
const MAX_STEPS: u32 = 100_000;

pub(super) fn fuzz_cycles(input: &[u8]) {
    let body = String::from_utf8_lossy(input);
    let head = body
        .lines()
        .next()
        .filter(|line| line.starts_with("(SET "))
        .unwrap_or("(SET T1=0.4/3)");
    let text = format!("{head}\nO0001\nT0101 M03 S500\nG98 G00 X100 Z10 F300\n{body}\nM30\n");
    let setup = settings::setup_from_input(&text);
    if dry_run::step_through(&setup, MAX_STEPS) {
        dry_run::preview_all(&setup);
    }
}
