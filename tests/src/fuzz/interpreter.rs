//! Any text through the interpreter, step by step, and through the preview.

use super::{dry_run, settings};

/// Steps of the interpreter; programs that need more are not previewed, for
/// they may never end.
const STEPS: u32 = 20_000;

pub(super) fn run(input: &[u8]) {
    let text = String::from_utf8_lossy(input);
    let setup = settings::setup(&text);
    if dry_run::step_through(&setup, STEPS) {
        dry_run::preview_all(&setup);
    }
}
