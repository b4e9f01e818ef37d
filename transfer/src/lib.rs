//! File transfer through the serial port (manual III-9 and part V): the protocol of frames at the
//! control and at the PC, and programs as plain text.
//!
//! ```text
//!   PcSide ──┐                                ┌── ControlSide ── FileStore (the memory)
//!            Station ══ frames on the wire ══ Station
//!   a DNC program ═════ % text % ════════════ TextReader, TextWriter
//! ```
//!
//! This crate opens no port and reads no clock. The caller passes received bytes and the host
//! time, and takes bytes to send and events. A file is stored completely or not at all.

mod control_port;
mod control_side;
mod file_name;
mod frame;
mod pc_side;
mod program_text;
mod station;
mod transfer_fault;
mod transfer_file;
mod wire_time;

#[cfg(test)]
mod line_tests;

use core::time::Duration;

pub use control_port::{ControlPort, Framing};
pub use control_side::{ControlEvent, ControlSide, FileStore, PortStatus};
pub use file_name::{FileName, FileNameError, Partition, is_device_name};
pub use frame::{BLOCK_BYTES, PutRequest, RemotePath, TransferRequest};
pub use pc_side::{ConnectionLoss, PcCommand, PcSide, TransferOutcome};
pub use program_text::{
    InvalidCharacter, TextEvent, TextLineEnd, TextReader, TextWriter, parse_program_number,
    split_programs,
};
pub use transfer_fault::TransferFault;
pub use transfer_file::{DirectoryEntry, TransferFile, TransferProgress};
pub use wire_time::WireTime;

/// Monotonic time of the host.
pub type PortTime = Duration;

/// Lowest rate for frames, bits per second. Below it the control exchanges plain text only (manual
/// III-9.3).
pub const MIN_FRAME_BAUD: u32 = 4800;
