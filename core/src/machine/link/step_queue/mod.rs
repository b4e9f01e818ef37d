//! Boards that execute times of steps: unmodified Klipper firmware.
//!
//! ```text
//!  samples ─► Steps: times of pulses ─► fit: runs ─┐
//!  outputs, heartbeat, questions ─────────────────►┴► Delivery ─► blocks ─► board
//!  events ◄─ session ◄─ replies ◄─ Dictionary ◄──────── Reader ◄─ blocks ◄─┘
//! ```
//!
//! Every step has its time on the clock of the board, which is asked and
//! extrapolated. The host is not trusted to live: a stop group in the board stops
//! both axes when it is not renewed, and so does every limit switch, without the
//! host having a part in it. Where the axes then stand the board knows to the pulse.

mod block;
mod clock;
mod commands;
mod delivery;
mod describe;
mod dictionary;
mod fit;
mod meter;
mod pace;
mod rates;
mod session;
mod shelf;
mod shutdown;
mod steps;
mod turns;
mod wiring;

pub use session::StepLink;
