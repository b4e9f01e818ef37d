//! The data of the link page: state of the board, traffic and counts at one moment.

use std::time::Duration;

use gsk_core::units::{PerAxis, Pulses};
use gsk_link::{
    BoardInfo, BoardOutputs, EncoderReading, Input, LinkState, Output, Protocol, SettingDifference,
    SpindleView, Traffic,
};

use gsk_messages::Message;

use crate::board::port_io::TrafficLine;

/// A comparison of the board's count with the commanded pulses.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PositionCheck {
    /// The line of the position log: time, program and both counts.
    pub message: Message,
    /// Whether the counts of board and control agree.
    pub agrees: bool,
}

/// The state of the link at one moment, made only while the link page is open.
#[derive(Clone, Debug, PartialEq)]
pub struct LinkView {
    pub state: LinkState,
    /// True if the board is connected and has reported its settings, so that its reports are
    /// current.
    pub is_connected: bool,
    /// The protocol of the board.
    pub protocol: Protocol,
    /// Name of the board's port.
    pub port: String,
    /// Properties that the board has reported: firmware, sizes of queue and buffer, capabilities.
    pub board: BoardInfo,
    /// Whether the position of the slides is known.
    pub position_known: bool,
    /// Median and longest of the last round trips; `None` before the first one.
    pub round_trip: Option<(Duration, Duration)>,
    /// Longest times between two reads of the port by the computer: in the last 5 to 10 s, and
    /// since the board was connected.
    pub absence: (Duration, Duration),
    /// Duration of the motion that the board holds and may not have made yet.
    pub outstanding: Duration,
    /// Longest duration of motion that the board may hold: the limit of `outstanding`.
    pub lookahead: Duration,
    /// Counters of the bytes, lines and reports on the serial line.
    pub traffic: Traffic,
    /// Inputs of the board: true if operated (contact closed), `None` if not wired.
    pub inputs: Vec<(Input, Option<bool>)>,
    /// Outputs of the control that are not wired to the board.
    pub missing_outputs: Vec<Output>,
    /// States of the outputs that the board has switched; `None` while the board has not answered a
    /// command to switch.
    pub outputs: Option<BoardOutputs>,
    /// The spindle whose one-turn signal the board reads; `None` if it reads none.
    pub spindle: Option<SpindleView>,
    /// The spindle as its encoder reports it; `None` without an encoder at the board.
    pub encoder: Option<EncoderReading>,
    /// Number of pulses that the control has commanded, per axis.
    pub commanded: PerAxis<Pulses>,
    /// Pulses that the board has counted, as last reported, per axis; `None` before the first
    /// report.
    pub counted: Option<PerAxis<Pulses>>,
    /// Settings of the board that must be written before it can move.
    pub differences: Vec<SettingDifference>,
    /// The last 200 lines of traffic, the newest last.
    pub traffic_lines: Vec<TrafficLine>,
    /// The last 20 lines of the position log, the newest last.
    pub position_checks: Vec<PositionCheck>,
}
