//! Boards that execute times of steps: unmodified Klipper firmware.
//!
//! ```text
//!  samples ─► Steps: times of pulses ─► runs ──────┐
//!  outputs, heartbeat, questions ─────────────────►┴► SendQueue ─► blocks ─► board
//!  events ◄─ session ◄─ replies ◄─ Dictionary ◄──────── Reader ◄─ blocks ◄─┘
//! ```
//!
//! Every step has its time on the clock of the board, which is asked and
//! extrapolated. The host is not trusted to live: a stop group in the board stops
//! both axes when it is not renewed, and so does every limit switch, without the
//! host having a part in it. Where the axes then stand the board knows to the pulse.

mod block;
mod clock_sync;
mod commands;
mod compression;
mod describe;
mod dictionary;
mod dictionary_cache;
mod rate_limit;
mod rates;
mod round_trip;
mod send_queue;
mod sequence;
mod session;
mod shutdown;
mod slowdown;
mod spindle_estimator;
mod steps;
mod wiring;

pub use session::StepLink;
