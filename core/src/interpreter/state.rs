//! What the blocks read so far have left behind.

use serde::{Deserialize, Serialize};

use crate::command::Frame;
use crate::interpreter::Modal;
use crate::interpreter::cycle_words::CycleWords;
use crate::interpreter::exact::Exact;
use crate::units::PerAxis;

/// Small and `Copy`: a block is evaluated on a copy, which replaces the
/// original only when the block raises no alarm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    pub(crate) modal: Modal,
    /// Programmed position, where the motion read so far will end.
    pub(crate) position: Exact,
    /// Machine coordinate of the work origin.
    pub(crate) zero: Exact,
    /// Tool offset in force.
    pub(crate) offset: Exact,
    /// Axes whose offset shifts the coordinates but was not travelled yet.
    pub(crate) untravelled: PerAxis<bool>,
    /// Words kept for G90, G92 and G94.
    pub(crate) cycle: CycleWords,
    /// Last surface speed of G96, m/min.
    pub(crate) surface: f64,
    /// Highest speed under G96 (G50 S), r/min.
    pub(crate) spindle_limit: Option<f64>,
}

impl State {
    /// The state at power-on.
    pub(crate) fn new(modal: Modal) -> Self {
        Self {
            modal,
            position: Exact::default(),
            zero: Exact::default(),
            offset: Exact::default(),
            untravelled: PerAxis::new(false, false),
            cycle: CycleWords::default(),
            surface: 0.0,
            spindle_limit: None,
        }
    }

    pub(crate) fn frame(&self) -> Frame {
        Frame {
            zero: self.zero.point(),
            offset: self.offset.point(),
        }
    }

    /// Machine coordinate of a programmed point.
    pub(crate) fn machine(&self, program: Exact) -> Exact {
        program + self.zero + self.offset
    }

    /// Takes the programmed position from a machine position.
    pub(crate) fn stand_at(&mut self, machine: Exact) {
        self.position = machine - self.zero - self.offset;
    }

    /// Another offset without motion: the coordinates shift.
    pub(crate) fn shift_offset(&mut self, offset: Exact) {
        self.position = self.position + self.offset - offset;
        self.offset = offset;
    }
}
