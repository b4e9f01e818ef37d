//! Fuzzes the interpreter with any text, step by step, and the preview.

use gsk_core::setup::Setup;

use super::{dry_run, settings};

/// Step limit of the interpreter. Programs that need more steps may never end, so they are not
/// previewed.
const MAX_STEPS: u32 = 20_000;
/// The same for programs of macro B, which loop more.
const MAX_STEPS_MACRO_B: u32 = 5_000;

pub(super) fn fuzz_interpreter(input: &[u8]) {
    let text = String::from_utf8_lossy(input);
    step_and_preview(&settings::setup_from_input(&text), MAX_STEPS);
}

/// The same with the option of macro B.
pub(super) fn fuzz_macro_b(input: &[u8]) {
    let text = String::from_utf8_lossy(input);
    let mut setup = settings::setup_from_input(&text);
    setup.memory.settings.macro_b = true;
    step_and_preview(&setup, MAX_STEPS_MACRO_B);
}

fn step_and_preview(setup: &Setup, steps: u32) {
    if dry_run::step_through(setup, steps) {
        dry_run::preview_all(setup);
    }
}
