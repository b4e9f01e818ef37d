//! Inputs and outputs between control and machine.

use serde::{Deserialize, Serialize};

use crate::board::{BoardInputs, BoardOrders};
use crate::units::{PerAxis, Pulses};

/// Which limit switches of an axis are tripped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum TrippedLimit {
    /// The switch at the negative end of the slide.
    Minus,
    /// The switch at the positive end of the slide.
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
    /// Level of the zero signal nPC of each axis: the one-turn signal of its motor, or the
    /// proximity switch. The control uses both edges.
    pub index_pulse: PerAxis<bool>,
    /// Command count at which the zero signal changed in this tick, latched by the zero
    /// input; `None` without a change.
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
    /// The tripped limit switch of each axis; `None` if none is tripped. No wire reports
    /// the switches separately, because all are in the loop of *ESP; the alarm of the
    /// control names them for the operator.
    #[serde(default)]
    pub over_limit: PerAxis<Option<TrippedLimit>>,
    /// Reports of the pulse board that makes the motion; `None`: the drives of the lathe
    /// make it. A saved state never contains an open link.
    #[serde(skip)]
    pub(crate) board: Option<Box<BoardInputs>>,
}

impl MachineInputs {
    /// Whether a contact, given by byte and bit of X, is closed; false outside the area.
    pub const fn is_closed(&self, byte: usize, bit: u8) -> bool {
        byte < self.x.len() && self.x[byte] >> (bit & 7) & 1 == 1
    }
}

/// Inputs that are wired to a pulse board, with their state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct BoardContacts {
    /// Whether the emergency-stop chain is open.
    pub emergency_stop_open: bool,
    /// Whether the guard door is open.
    pub door_open: bool,
    /// Whether the deceleration switch of each axis is pressed; `None`: not wired.
    pub deceleration_switch: PerAxis<Option<bool>>,
    /// Whether the zero signal of each axis is on; `None`: not wired.
    pub zero_signal: PerAxis<Option<bool>>,
    /// Masks of the contacts X0 to X3 that are wired to the board (bytes of `wired`) and of
    /// those that are closed.
    pub wired: [u8; 4],
    pub closed: [u8; 4],
}

/// Signals of the control to the machine in one tick.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MachineOutputs {
    /// Outputs of the ladder: Y0–Y3 to the machine (1 = sink closed), then the lamps of the
    /// panel.
    pub y: [u8; 20],
    /// Command pulses of each axis, counted from power-on.
    pub pulses: PerAxis<Pulses>,
    /// Analog spindle output SVC, 0–10 V.
    pub spindle_volts: f64,
    /// Whether the control enables each drive (nEN).
    pub enable: PerAxis<bool>,
    /// Orders for the pulse board; `None` without a board. Boxed, because few machines have
    /// a board and outputs are passed on every tick.
    #[serde(skip)]
    pub(crate) board: Option<Box<BoardOrders>>,
}

impl MachineOutputs {
    /// Outputs of a control without power: everything is off, and the pulse count stays at
    /// `pulses`.
    pub fn without_power(pulses: PerAxis<Pulses>) -> Self {
        Self {
            pulses,
            ..Self::default()
        }
    }

    /// Whether an output, given by byte and bit of Y, is on; false outside the area.
    pub const fn is_on(&self, byte: usize, bit: u8) -> bool {
        byte < self.y.len() && self.y[byte] >> (bit & 7) & 1 == 1
    }
}
