//! Files through the serial port (manual III-9 and part V): the control's side and the
//! PC's side of the transfer in frames, and programs as plain text.
//!
//! ```text
//!   PcSide ──┐                                ┌── ControlSide ── Store (the memory)
//!            Station ══ frames on the wire ══ Station
//!   a DNC program ═════ % text % ════════════ TextReader, TextWriter
//! ```
//!
//! Nothing here opens a port or reads a clock: bytes and the host's time are handed in,
//! bytes and outcomes come out. A file counts when all of it has arrived, or not at all.

mod control_port;
mod control_side;
mod fault;
mod file;
mod frame;
mod name;
mod pc_side;
mod station;
mod text;
mod wire_time;

#[cfg(test)]
mod line_tests;

use core::time::Duration;

pub use control_port::{ControlPort, Framing};
pub use control_side::{ControlEvent, ControlSide, Status, Store};
pub use fault::Fault;
pub use file::{Entry, NewFile, Progress};
pub use frame::{BLOCK, Body, Place, Put};
pub use name::{FileName, NameError, Partition, is_device_name};
pub use pc_side::{Loss, Order, Outcome, PcSide};
pub use text::{LineEnd, NotText, TextEvent, TextReader, TextWriter, program_number, programs};
pub use wire_time::WireTime;

/// Monotonic time of the host.
pub type HostTime = Duration;

/// Below this rate, bits a second, a PC and the control exchange text only (manual III-9.3).
pub const SLOWEST_FRAMES: u32 = 4800;
