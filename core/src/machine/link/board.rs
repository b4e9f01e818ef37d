//! What a board says of itself, and the figures of its wire.

use core::time::Duration;

/// What the board is, as far as it said.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BoardInfo {
    /// Firmware and version.
    pub firmware: String,
    /// Places in its motion queue.
    pub blocks: u16,
    /// Size of its receive buffer, bytes.
    pub receive_bytes: u16,
    /// It can cut threads behind its spindle.
    pub spindle_sync: bool,
}

/// Switches that a report names as operated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pins {
    /// Limit of X.
    pub x: bool,
    /// Limit of Z.
    pub z: bool,
    /// Emergency stop or reset input.
    pub emergency: bool,
    /// Door.
    pub door: bool,
}

/// Which way the spindle is to turn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SpindleWay {
    /// It stands.
    #[default]
    Stop,
    /// M03.
    Forward,
    /// M04.
    Reverse,
}

/// What the board switches for the control.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BoardOutputs {
    /// Spindle.
    pub spindle: SpindleWay,
    /// Analog spindle output, mV of 10 V.
    pub millivolts: u16,
    /// M08.
    pub coolant: bool,
}

/// Figures of the wire for the link page.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Traffic {
    /// Lines or blocks sent.
    pub lines: u64,
    /// Bytes sent.
    pub sent: u64,
    /// Bytes received.
    pub received: u64,
    /// Reports received.
    pub reports: u64,
    /// Lines or blocks that made no sense.
    pub garbage: u64,
    /// Pieces of motion sent.
    pub segments: u64,
    /// Lines or blocks sent again.
    pub resent: u64,
    /// Time from the last question to its answer.
    pub round_trip: Option<Duration>,
}
