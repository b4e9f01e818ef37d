//! Any text as a program of macro B, step by step and through the preview.

use super::{dry_run, settings};

/// Steps of the interpreter; programs that need more are not previewed, for they may
/// never end.
const STEPS: u32 = 5_000;

pub(super) fn run(input: &[u8]) {
    let text = String::from_utf8_lossy(input);
    let mut setup = settings::setup(&text);
    setup.memory.settings.macro_b = true;
    if dry_run::step_through(&setup, STEPS) {
        dry_run::preview_all(&setup);
    }
}
