//! Inputs and outputs between control and machine.

use serde::{Deserialize, Serialize};

use crate::board::{BoardInputs, BoardOrders};
use crate::units::{PerAxis, Pulses};

/// The limit switch of an axis that is tripped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum TrippedLimit {
    /// The switch at the negative end.
    Minus,
    /// The switch at the positive end.
    Plus,
    /// A switch that is stuck without being pressed.
    Stuck,
}

/// Signals of the machine to the control in one tick.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MachineInputs {
    /// Contacts X0–X3 of the machine (1 = closed to +24 V). The control adds the panel keys
    /// X20–X26.
    pub x: [u8; 30],
    /// Zero signal nPC of each axis: the one-turn pulse of its motor, or the proximity
    /// switch. Both edges count.
    pub index_pulse: PerAxis<bool>,
    /// Command count at the change of the zero signal during this tick, which the zero
    /// input latches.
    pub index_latch: PerAxis<Option<Pulses>>,
    /// Level of each drive's alarm line (009 selects the level that means alarm).
    pub drive_alarm: PerAxis<bool>,
    /// Level of each drive's ready line (005.2 DRDY).
    pub drive_ready: PerAxis<bool>,
    /// Count of the spindle encoder since the start, four per line.
    pub encoder: i64,
    /// Encoder count at the last index pulse (once per encoder revolution).
    pub encoder_index: i64,
    /// Whether the index pulse came during this tick (DGN.008 bit 2).
    pub spindle_index: bool,
    /// Detents of the handwheel since the start, clockwise positive.
    pub handwheel: i32,
    /// Limit switches that are tripped. No wire reports them separately, because all are in
    /// the loop of *ESP; the alarm of the control names them for the operator.
    #[serde(default)]
    pub over_limit: PerAxis<Option<TrippedLimit>>,
    /// Reports of the pulse board that makes the motion; `None`: the drives of the lathe
    /// make it. A saved state never contains an open link.
    #[serde(skip)]
    pub(crate) board: Option<Box<BoardInputs>>,
}

impl MachineInputs {
    /// State of one contact by byte and bit of X; false outside the area.
    pub const fn is_closed(&self, byte: usize, bit: u8) -> bool {
        byte < self.x.len() && self.x[byte] >> (bit & 7) & 1 == 1
    }
}

/// Inputs that are wired to a pulse board.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct BoardContacts {
    /// Whether the emergency-stop chain is open.
    pub emergency_stop_open: bool,
    /// Whether the door is open.
    pub door_open: bool,
    /// Whether the deceleration switch is pressed; `None`: not wired.
    pub deceleration_switch: PerAxis<Option<bool>>,
    /// Whether the zero signal is on; `None`: not wired.
    pub zero_signal: PerAxis<Option<bool>>,
    /// Contacts X0 to X3: which are wired to the board, and which of them are closed.
    pub wired: [u8; 4],
    pub closed: [u8; 4],
}

/// Signals of the control to the machine in one tick.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MachineOutputs {
    /// Outputs Y0–Y3 to the machine (1 = sink closed), lamps above.
    pub y: [u8; 20],
    /// Command pulses of each axis, absolute count.
    pub pulses: PerAxis<Pulses>,
    /// Analog spindle output SVC, 0–10 V.
    pub spindle_volts: f64,
    /// Drive enable nEN.
    pub enable: PerAxis<bool>,
    /// Orders for the pulse board. Boxed, because few machines have one and outputs are
    /// passed on every tick.
    #[serde(skip)]
    pub(crate) board: Option<Box<BoardOrders>>,
}

impl MachineOutputs {
    /// Outputs of a control without power: everything is off, the pulse count stays.
    pub fn without_power(pulses: PerAxis<Pulses>) -> Self {
        Self {
            pulses,
            ..Self::default()
        }
    }

    /// State of one output by byte and bit of Y; false outside the area.
    pub const fn is_on(&self, byte: usize, bit: u8) -> bool {
        byte < self.y.len() && self.y[byte] >> (bit & 7) & 1 == 1
    }
}
