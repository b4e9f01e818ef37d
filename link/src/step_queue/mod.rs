//! Boards that execute timed steps: unmodified Klipper firmware, and our own for the Pico, whose
//! steps run on the angle of the spindle as well (`docs/board-protocol.md`).
//!
//! ```text
//!  samples ─► Steps: times of pulses ─► runs ──────┐
//!  outputs, heartbeat, queries ───────────────────►┴► SendQueue ─► blocks ─► board
//!  events ◄─ session ◄─ replies ◄─ Dictionary ◄──────── Reader ◄─ blocks ◄─┘
//! ```
//!
//! Each step has its time on the clock of the board. The link queries this clock and
//! extrapolates it. A stop group in the board (Klipper's `trsync`) stops both axes without
//! the host: at a limit switch, and when the host does not renew it in time. The board then
//! reports the position of the axes to the pulse.

mod angle_segments;
mod block;
mod clock_sync;
mod commands;
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
mod spindle_angle;
mod spindle_estimator;
mod step_compress;
mod steps;
mod tap_path;
mod wiring;

pub use session::StepLink;
