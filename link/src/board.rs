//! What a board says of itself, and the figures of its wire.

use core::time::Duration;

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

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
    /// It forgets settings that were written when it is switched off.
    pub forgets: bool,
}

/// The most pulses a second that a board makes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PulseRates {
    /// Of X and of Z.
    pub each: [f64; 2],
    /// Of both together.
    pub both: f64,
}

/// Which threads the drives behind a board cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ThreadCapability {
    /// None: what is lacking.
    None(MissingForThreads),
    /// The control follows the spindle as the board measures it: every thread.
    Followed,
    /// The board follows its spindle by itself, one straight pass of one lead at a
    /// time, from the one-turn signal.
    Passes,
}

impl ThreadCapability {
    /// What it cuts, or what it lacks, in words.
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

/// What a board lacks for threads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MissingForThreads {
    /// Its firmware synchronises nothing with the spindle.
    pub sync: bool,
    /// The owner has not cut the proof thread.
    pub proof: bool,
    /// It was not told the pulses of its encoder.
    pub encoder: bool,
    /// It corrects the pass while it cuts it, wrongly.
    pub gains: bool,
    /// It counts a pass from a work offset of its own.
    pub offset: bool,
    /// No one-turn signal of the spindle is wired.
    pub index: bool,
}

impl MissingForThreads {
    /// All that is lacking, in words.
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
    /// Probe.
    pub probe: bool,
    /// Feed hold.
    pub hold: bool,
    /// Cycle start.
    pub start: bool,
}

impl Pins {
    /// Whether the pin is operated for which a report has this letter.
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

/// Which way the spindle is to turn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SpindleDirection {
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
    pub spindle: SpindleDirection,
    /// Analog spindle output, mV of 10 V.
    pub millivolts: u16,
    /// M08.
    pub coolant: bool,
}

/// The spindle in a tick of the kernel, as its one-turn signal at the board lets it be
/// foreseen; turns count up whichever way it goes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpindleView {
    /// Speed, r/min; 0: it stands, or nothing is known yet.
    pub rpm: f64,
    /// Turns at the beginning of the tick and at its end; alike: the angle is not
    /// known.
    pub before: f64,
    /// See `before`.
    pub now: f64,
    /// The index came by within the tick.
    pub passed: bool,
    /// Greatest difference of the last periods (20 turns, 2 s), a part of their mean;
    /// none: not so many turns yet.
    pub variation: Option<f64>,
    /// An index came farther from where the axes followed than a thread bears, turns;
    /// told once.
    pub deviation: Option<f64>,
    /// The axes follow it, and no index comes any more.
    pub lost: bool,
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
