//! What the link page sees: the board, its wire and its counts at one moment.

use std::time::Duration;

use gsk_core::units::{PerAxis, Pulses};
use gsk_link::{
    BoardInfo, BoardOutputs, Input, LinkState, Output, Protocol, SettingDifference, SpindleView,
    Traffic,
};

use gsk_messages::Message;

use crate::carrier::Line;

/// A comparison of the board's count with the commanded pulses.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PositionCheck {
    /// When, after which program, and both counts.
    pub said: Message,
    /// Whether they are the same.
    pub agrees: bool,
}

/// The link at one moment. Taken only while somebody asks for it.
#[derive(Clone, Debug, PartialEq)]
pub struct LinkView {
    /// Where the link stands.
    pub state: LinkState,
    /// The board is there and has said how it is set: what it tells holds now.
    pub connected: bool,
    /// What the board understands.
    pub protocol: Protocol,
    /// Its port.
    pub port: String,
    /// What it said it is.
    pub board: BoardInfo,
    /// Whether it is known where the slides stand.
    pub position_known: bool,
    /// Median and worst of the last round trips.
    pub round_trip: Option<(Duration, Duration)>,
    /// The longest that the computer was away from the port, in the last seconds and
    /// since the board was connected.
    pub away: (Duration, Duration),
    /// Motion handed over that may not have been made yet.
    pub outstanding: Duration,
    /// How much that may be.
    pub lookahead: Duration,
    /// Counters of the wire.
    pub traffic: Traffic,
    /// Inputs of the board: whether each is operated, a contact closed; none: not
    /// wired.
    pub inputs: Vec<(Input, Option<bool>)>,
    /// Outputs that are not wired.
    pub missing_outputs: Vec<Output>,
    /// What the board has switched; none while an order is under way.
    pub outputs: Option<BoardOutputs>,
    /// The spindle whose index the board sees.
    pub spindle: Option<SpindleView>,
    /// Pulses commanded.
    pub commanded: PerAxis<Pulses>,
    /// Pulses the board has counted, as last reported.
    pub counted: Option<PerAxis<Pulses>>,
    /// Settings of the board that must be written first.
    pub differences: Vec<SettingDifference>,
    /// The last 200 lines on the wire, the newest last.
    pub exchanges: Vec<Line>,
    /// The last lines of the log, the newest last.
    pub log: Vec<PositionCheck>,
}
