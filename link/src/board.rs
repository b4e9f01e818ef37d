//! Data that a board reports, and traffic counters.

use core::time::Duration;

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

/// The properties of a board, as far as it has reported them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BoardInfo {
    /// Firmware and version.
    pub firmware: String,
    /// Entries of the motion queue.
    pub blocks: u16,
    /// Size of the receive buffer, bytes.
    pub receive_bytes: u16,
    /// Whether the firmware can synchronize a thread pass with the spindle.
    pub spindle_sync: bool,
    /// Whether written settings are lost at power-off.
    pub forgets: bool,
}

/// The greatest pulse rates of a board, pulses per second.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PulseRates {
    /// Rates of X and of Z.
    pub each: [f64; 2],
    /// Rate of both axes together.
    pub both: f64,
}

/// Which threads a board can cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ThreadCapability {
    /// No threads, because of these missing conditions.
    None(MissingForThreads),
    /// All threads: the board measures the spindle, and the control follows it.
    Followed,
    /// Straight passes of constant lead: the board synchronizes each pass with its
    /// one-turn signal.
    Passes,
}

impl ThreadCapability {
    /// The text for the operator: possible threads, or the missing conditions.
    pub fn text(self) -> Message {
        match self {
            Self::None(lacks) => say::threads_none(lacks.text()),
            Self::Followed => say::threads_followed(),
            Self::Passes => say::threads_passes(),
        }
    }
}

impl Default for ThreadCapability {
    fn default() -> Self {
        Self::None(MissingForThreads::default())
    }
}

/// The conditions for threads that a board does not meet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MissingForThreads {
    /// The firmware has no spindle synchronization.
    pub sync: bool,
    /// The proof thread has not been cut.
    pub proof: bool,
    /// The setting for the encoder pulses ($38) is 0.
    pub encoder: bool,
    /// The gains of the spindle control loop ($90 to $92) are not 0: the board would
    /// correct a pass while it cuts.
    pub gains: bool,
    /// A work offset in the board is not 0.
    pub offset: bool,
    /// The one-turn signal of the spindle is not wired.
    pub index: bool,
}

impl MissingForThreads {
    /// The text for the operator: all missing conditions.
    pub fn text(self) -> Message {
        let lacks = [
            (self.sync, say::lacks_sync()),
            (self.proof, say::lacks_proof()),
            (self.encoder, say::lacks_encoder()),
            (self.gains, say::lacks_zero_gains()),
            (self.offset, say::lacks_zero_offset()),
            (self.index, say::lacks_index()),
        ];
        let named: Vec<_> = lacks
            .into_iter()
            .filter_map(|(lacks, text)| lacks.then_some(text))
            .collect();
        if named.is_empty() {
            return say::lacks_spindle();
        }
        say::several(named)
    }
}

/// The switches that a status report names as operated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pins {
    /// Limit switch of X.
    pub x: bool,
    /// Limit switch of Z.
    pub z: bool,
    /// Emergency stop input or reset input.
    pub emergency: bool,
    /// Safety door.
    pub door: bool,
    /// Probe.
    pub probe: bool,
    /// Feed hold button.
    pub hold: bool,
    /// Cycle start button.
    pub start: bool,
}

impl Pins {
    /// Whether the pin with this letter in Grbl's status report is operated.
    pub(super) const fn letter(self, letter: char) -> bool {
        match letter {
            'P' => self.probe,
            'D' => self.door,
            'H' => self.hold,
            'R' | 'E' => self.emergency,
            'S' => self.start,
            _ => false,
        }
    }
}

/// The commanded direction of the spindle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SpindleDirection {
    /// The spindle is stopped (M05).
    #[default]
    Stop,
    /// Forward (M03).
    Forward,
    /// Reverse (M04).
    Reverse,
}

/// The outputs that the board switches for the control.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BoardOutputs {
    /// Direction of the spindle.
    pub spindle: SpindleDirection,
    /// Analog output of the spindle speed, 0 to 10 000 mV.
    pub millivolts: u16,
    /// Coolant (M08).
    pub coolant: bool,
}

/// The spindle in one tick of the kernel, predicted from its one-turn signal at the board.
/// The turns count up in both directions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpindleView {
    /// Speed, r/min; 0 if the spindle is stopped or no speed is known yet.
    pub rpm: f64,
    /// Turns at the start of the tick. Equal to `now` if the angle is not known.
    pub before: f64,
    /// Turns at the end of the tick.
    pub now: f64,
    /// Whether the one-turn signal occurs within the tick.
    pub passed: bool,
    /// Greatest difference between recent periods as a fraction of their mean, over 20
    /// turns and 2 s; `None` with fewer turns.
    pub variation: Option<f64>,
    /// How far a one-turn signal was from the angle that the axes followed, turns, if that
    /// is too far for a thread. Reported once.
    pub deviation: Option<f64>,
    /// Whether the one-turn signal is missing while the axes follow the spindle.
    pub lost: bool,
}

/// Counters of the serial traffic for the link page. A board reads lines or blocks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Traffic {
    /// Lines or blocks sent.
    pub lines: u64,
    /// Bytes sent.
    pub sent: u64,
    /// Bytes received.
    pub received: u64,
    /// Status reports received.
    pub reports: u64,
    /// Invalid lines or blocks received.
    pub garbage: u64,
    /// Motion segments or step runs sent.
    pub segments: u64,
    /// Blocks retransmitted.
    pub resent: u64,
    /// Time from the last query to its answer.
    pub round_trip: Option<Duration>,
}
