//! Twins of pulse boards: models that behave like the real boards on the serial line and at the
//! pins, in virtual time. They include the behaviour that hosts get wrong.
//!
//! ```text
//!   host ──bytes──► Wire ──► receive buffer ──► firmware ──► planner ──► pulses
//!   host ◄──bytes── Wire ◄─────────── answers, reports, alarms ◄── pins
//! ```
//!
//! A twin reads no clock: [`advance`](grbl::GrblTwin::advance) advances its virtual time. The
//! same twin runs in a test, eight hours in seconds, and on a pseudo terminal in real time.

#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod grbl;
pub mod klipper;
pub mod pico;
pub mod wire;
