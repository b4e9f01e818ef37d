//! The wires between control and machine.

use serde::{Deserialize, Serialize};

use crate::board::{BoardInputs, BoardOrders};
use crate::units::{PerAxis, Pulses};

/// Which limit switch of an axis is tripped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum OverLimit {
    /// The one at its negative end.
    Minus,
    /// The one at its positive end.
    Plus,
    /// One that no slide presses.
    Stuck,
}

/// What the machine tells the control.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Inputs {
    /// Contacts: X0–X3 from the machine (1 = closed to +24 V). The control adds
    /// the panel keys X20–X26 itself.
    pub x: [u8; 30],
    /// Zero signal nPC of each axis: the one-turn pulse of its motor, or the
    /// proximity switch; either edge counts.
    pub index_pulse: PerAxis<bool>,
    /// Command count at which the zero signal changed during this tick: what the
    /// zero input latches.
    pub index_latch: PerAxis<Option<Pulses>>,
    /// Alarm line of each drive: its level (009 says which one is the alarm).
    pub drive_alarm: PerAxis<bool>,
    /// Ready line of each drive: its level (005.2 DRDY).
    pub drive_ready: PerAxis<bool>,
    /// Spindle encoder, four counts a line, absolute since the start.
    pub encoder: i64,
    /// Encoder count at its last index pulse (once per encoder turn).
    pub encoder_index: i64,
    /// The index pulse came during this tick (DGN.008 bit 2).
    pub spindle_index: bool,
    /// Detents of the handwheel since the start, clockwise positive.
    pub handwheel: i32,
    /// Limit switches that are tripped. No wire tells this, all of them are in the
    /// loop of *ESP: the control says with the alarm what a look at the machine shows.
    #[serde(default)]
    pub over_limit: PerAxis<Option<OverLimit>>,
    /// The pulse board that makes the motion; none: the drives of the lathe do. An open
    /// link is never part of what is saved.
    #[serde(skip)]
    pub(crate) board: Option<Box<BoardInputs>>,
}

impl Inputs {
    /// One contact, byte and bit of X.
    pub const fn contact(&self, byte: usize, bit: u8) -> bool {
        byte < self.x.len() && self.x[byte] >> (bit & 7) & 1 == 1
    }
}

/// What a pulse board says of the inputs that are wired to it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct BoardContacts {
    /// The emergency stop chain is open.
    pub emergency: bool,
    /// The door is open.
    pub door: bool,
    /// The deceleration switch is pressed; none: not wired.
    pub switch: PerAxis<Option<bool>>,
    /// The zero signal stands; none: not wired.
    pub signal: PerAxis<Option<bool>>,
    /// Contacts X0 to X3: which are wired, and which of them are closed.
    pub wired: [u8; 4],
    pub closed: [u8; 4],
}

/// What the control tells the machine.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Outputs {
    /// Outputs: Y0–Y3 to the machine (1 = sink closed), lamps above.
    pub y: [u8; 20],
    /// Command pulses, absolute count.
    pub pulses: PerAxis<Pulses>,
    /// Analog spindle output SVC, 0…10 V.
    pub spindle_volts: f64,
    /// Drive enable nEN.
    pub enable: PerAxis<bool>,
    /// What the pulse board is to do. Boxed: hardly any machine has one, and outputs are
    /// handed on every millisecond.
    #[serde(skip)]
    pub(crate) board: Option<Box<BoardOrders>>,
}

impl Outputs {
    /// A control without power: everything is off, the count stands.
    pub fn without_power(pulses: PerAxis<Pulses>) -> Self {
        Self {
            pulses,
            ..Self::default()
        }
    }

    /// One output, byte and bit of Y.
    pub const fn output(&self, byte: usize, bit: u8) -> bool {
        byte < self.y.len() && self.y[byte] >> (bit & 7) & 1 == 1
    }
}
