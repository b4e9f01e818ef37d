//! Twins of pulse boards: programs that behave at their serial line and their
//! pins as the real boards do, traps included, in virtual time.
//!
//! ```text
//!   host ──bytes──► Wire ──► receive buffer ──► firmware ──► planner ──► pulses
//!   host ◄──bytes── Wire ◄─────────── answers, reports, alarms ◄── pins
//! ```
//!
//! A twin reads no clock: [`advance`](grbl::GrblTwin::advance) tells it how much
//! time has passed. The same twin runs in a test, eight hours in seconds, and
//! behind a pseudo terminal at the pace of the wall clock.

#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod grbl;
pub mod klipper;
pub mod wire;
