//! Fuzzes the interpreter with any text, step by step, and the preview.

use gsk_core::setup::Setup;

use super::{dry_run, settings};

/// Number of steps after which the interpreter is stopped. Programs that need more steps may
/// never end, so they are not previewed.
const MAX_STEPS: u32 = 20_000;
/// Number of steps after which a macro B program is stopped. Such programs loop more.
const MAX_STEPS_MACRO_B: u32 = 5_000;

pub(super) fn fuzz_interpreter(input: &[u8]) {
    let text = String::from_utf8_lossy(input);
    step_and_preview(&settings::setup_from_input(&text), MAX_STEPS);
}

/// Fuzzes the interpreter with the macro B option and any text.
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
