//! Tests the whole control from outside, in one binary: a test is `subject::name`.

#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::unwrap_used,
    reason = "tests fail by panicking"
)]

mod bench;
mod commission;
mod cycles;
mod dnc;
mod intervention;
mod ladder;
mod line_link;
mod line_opening;
mod linked;
mod macros;
mod nose_compensation;
mod pico_link;
mod pulses;
mod signals;
mod simulation;
mod slide_ends;
mod spindle;
mod step_link;
mod threads;
mod transitions;
mod zero_return;
