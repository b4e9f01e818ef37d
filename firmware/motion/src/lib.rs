//! The pulse board without its hardware.
//!
//! ```text
//!  bytes ─► Session: blocks, dictionary ─► Request ─► Engine: queues, stops ─► StepPort: pins
//!  bytes ◄───────────────────────────────── Event ◄──┘
//! ```
//!
//! An entry of the queue of steps runs on the clock of the board or on the angle of the
//! spindle. [`Engine::poll`] makes what is due; a processor of the board calls it all the time.

#![no_std]

mod angle;
mod block;
mod clock_steps;
mod encoders;
mod engine;
pub mod messages;
mod outputs;
mod session;
mod stepper;
mod stops;
mod storage;

pub use block::{BlockBytes, crc16, encode_block};
pub use engine::{Engine, EngineState, Event, Request, StepPort};
pub use session::{DICTIONARY, Session};
