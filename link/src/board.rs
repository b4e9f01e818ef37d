//! Data that a board reports, and traffic counters.

use core::time::Duration;

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

/// The properties of a board that the board has reported so far.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BoardInfo {
    /// Name and version of the firmware, as the board reports them.
    pub firmware: String,
    /// Number of entries of the board's motion queue.
    pub blocks: u16,
    /// Size of the receive buffer, bytes.
    pub receive_bytes: u16,
    /// Whether the firmware can synchronize a thread pass with the spindle.
    pub spindle_sync: bool,
    /// Whether the board loses settings written by the link at power-off.
    pub forgets: bool,
}

/// The greatest pulse rates of a board, pulses per second.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PulseRates {
    /// Greatest rates of X (index 0) and of Z (index 1) alone, pulses per second.
    pub each: [f64; 2],
    /// Greatest sum of the rates of both axes, pulses per second.
    pub both: f64,
}

/// Which threads a board can cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ThreadCapability {
    /// The board cannot cut threads because of these missing conditions.
    None(MissingForThreads),
    /// The board measures the spindle, and the control lets the axes follow the spindle: all
    /// threads are possible.
    Followed,
    /// The board synchronizes each pass with the one-turn signal of the spindle: only straight
    /// passes of constant lead are possible.
    Passes,
}

impl ThreadCapability {
    /// Returns the text for the operator: which threads are possible, or what is missing.
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

/// Whether a board can tap (G33).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TapCapability {
    /// The board has no spindle encoder, which shows how the spindle stops and reverses.
    #[default]
    NoEncoder,
    /// The firmware of the board is older: it has no entry that ends back at its start.
    OldFirmware,
    /// The board follows the spindle in and back.
    Followed,
}

/// The conditions for threads that a board does not meet; a missing condition is `true`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MissingForThreads {
    /// Whether the firmware cannot synchronize a thread pass with the spindle.
    pub sync: bool,
    /// Whether the machine file does not confirm that the owner has cut the proof thread and
    /// measured its lead.
    pub proof: bool,
    /// Whether the setting for the encoder pulses ($38) is 0.
    pub encoder: bool,
    /// Whether a gain of the spindle control loop ($90 to $92) is not 0: the board would correct a
    /// pass while cutting.
    pub gains: bool,
    /// Whether a work offset in the board is not 0.
    pub offset: bool,
    /// Whether the one-turn signal of the spindle is not wired to the board.
    pub index: bool,
}

impl MissingForThreads {
    /// Returns the text for the operator that lists the missing conditions.
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
    /// Whether the limit switch of X is operated.
    pub x: bool,
    /// Whether the limit switch of Z is operated.
    pub z: bool,
    /// Whether the emergency stop input or the reset input is operated.
    pub emergency: bool,
    /// Whether the safety door input is operated: the door is open.
    pub door: bool,
    /// Whether the probe is operated.
    pub probe: bool,
    /// Whether the feed hold button is pressed.
    pub hold: bool,
    /// Whether the cycle start button is pressed.
    pub start: bool,
}

impl Pins {
    /// Whether the pin with this letter in Grbl's status report is operated; false for other
    /// letters.
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
    /// The spindle turns forward (M03).
    Forward,
    /// The spindle turns in reverse (M04).
    Reverse,
}

/// The outputs that the board switches for the control.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BoardOutputs {
    /// Commanded direction of the spindle: stopped, forward or reverse.
    pub spindle: SpindleDirection,
    /// Analog output of the spindle speed, 0 to 10 000 mV.
    pub millivolts: u16,
    /// Whether the coolant is on (M08).
    pub coolant: bool,
}

/// The spindle in one tick of the kernel, predicted from its one-turn signal at the board. The
/// angle is a number of turns that increases in both directions of the spindle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpindleView {
    /// Spindle speed, r/min; 0 if the spindle is stopped or no speed is known yet.
    pub rpm: f64,
    /// Predicted angle at the start of the tick, turns. Equal to `now` if the angle is not known.
    pub before: f64,
    /// Predicted angle of the spindle at the end of the tick, turns.
    pub now: f64,
    /// Whether the one-turn signal of the spindle occurs within the tick.
    pub passed: bool,
    /// Variation of the spindle speed: greatest difference between the recent durations of a turn,
    /// as a fraction of their mean. `None` until the spindle has made 20 turns and turned for 2 s.
    pub variation: Option<f64>,
    /// Angle between a one-turn signal and the prediction that the axes followed, turns, if it is
    /// too large for a thread. `None` if it is not, or if it was reported before.
    pub deviation: Option<f64>,
    /// Whether the one-turn signal of the spindle is missing while the axes follow the spindle.
    pub lost: bool,
}

/// The spindle as its encoder at the board reports it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EncoderReading {
    /// Angle after the index, turns, 0 to 1; `None` before the first index.
    pub angle: Option<f64>,
    /// Ripple: greatest deviation of the speed from its mean over the last turn, as a fraction of
    /// the mean. A report every 10 ms does not show a faster ripple. `None` until a turn is
    /// complete, and at standstill.
    pub ripple: Option<f64>,
    /// Greatest phase error of the current or last thread, pulses, as the board has measured it:
    /// the distance of the slide from its path at a count of the encoder. `None` before the first
    /// thread, and from a board that does not report it.
    pub phase_error: Option<f64>,
}

/// Counters of the serial traffic for the link page. A board reads lines or blocks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Traffic {
    /// Number of lines or blocks sent.
    pub lines: u64,
    /// Number of bytes sent.
    pub sent: u64,
    /// Number of bytes received.
    pub received: u64,
    /// Number of status reports, or of answers to clock queries, received.
    pub reports: u64,
    /// Number of invalid lines or blocks received.
    pub garbage: u64,
    /// Number of motion segments or step runs sent.
    pub segments: u64,
    /// Number of blocks retransmitted.
    pub resent: u64,
    /// Time from the last query to its answer; `None` before the first answer.
    pub round_trip: Option<Duration>,
}
