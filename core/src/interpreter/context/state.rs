//! What the blocks read so far have left behind.

use serde::{Deserialize, Serialize};

use crate::command::{Frame, ZeroOffset};
use crate::compensation::Nose;
use crate::interpreter::Modal;
use crate::interpreter::context::cycle_words::CycleWords;
use crate::interpreter::context::exact::Exact;
use crate::interpreter::context::words::{AxisWords, Target};
use crate::units::{Axis, PerAxis};

/// Small and `Copy`: it is put back as it was when a block raises an alarm.
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
    /// The nose of the tool, taken from the offset table by the last T.
    pub(crate) nose: Nose,
    /// Words kept for G90, G92 and G94.
    pub(crate) cycle: CycleWords,
    /// Programmed end point minus position: increments count from the
    /// programmed corner after a chamfer, a corner arc and a run-out.
    pub(crate) ahead: Exact,
    /// Thread lead in force, mm; zero = none yet. F and I of threads set it.
    pub(crate) lead: f64,
    /// The block before was a G32 or G34.
    pub(crate) threading: bool,
    /// Last surface speed of G96, m/min.
    pub(crate) surface: f64,
    /// Highest speed under G96 (G50 S), r/min.
    pub(crate) spindle_limit: Option<f64>,
    /// G91: words are increments.
    #[serde(default)]
    pub(crate) incremental: bool,
    /// How far G55 to G57 have moved the zero; a part of `zero`.
    #[serde(default)]
    pub(crate) zero_offset: Exact,
    /// The factor of G31, in millionths.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) scale: Option<i64>,
    /// Where the run began, for a model that returns there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) begun: Option<Begun>,
}

/// Where the tool stood at cycle start.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Begun {
    /// In machine coordinates.
    pub(crate) machine: Exact,
    /// In work coordinates; G92 names them anew.
    pub(crate) work: Exact,
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
            nose: Nose::default(),
            cycle: CycleWords::default(),
            ahead: Exact::default(),
            lead: 0.0,
            threading: false,
            surface: 0.0,
            spindle_limit: None,
            incremental: false,
            zero_offset: Exact::default(),
            scale: None,
            begun: None,
        }
    }

    pub(crate) fn frame(&self) -> Frame {
        Frame {
            zero: self.zero.point(),
            offset: self.offset.point(),
            zero_offset: ZeroOffset::from_point(self.zero_offset.point()),
        }
    }

    /// Machine coordinate of a programmed point.
    pub(crate) fn machine(&self, program: Exact) -> Exact {
        program + self.zero + self.offset
    }

    /// Takes the programmed position from a machine position.
    pub(crate) fn stand_at(&mut self, machine: Exact) {
        self.position = machine - self.zero - self.offset;
        self.ahead = Exact::default();
        self.threading = false;
    }

    /// The motion will end at a point; its axes have travelled their offset and
    /// count from there.
    pub(crate) fn arrive(&mut self, axes: &AxisWords, end: Exact) {
        self.position = end;
        for axis in [Axis::X, Axis::Z] {
            if axes.get(axis) != Target::None {
                *self.untravelled.get_mut(axis) = false;
                self.ahead.set(axis, 0);
            }
        }
    }

    /// The tool will stand where it stands after moves of both axes.
    pub(crate) fn return_here(&mut self) {
        self.untravelled = PerAxis::new(false, false);
        self.ahead = Exact::default();
    }

    /// Nothing is left of the tool offset: its number is 00.
    pub(crate) fn cancel_offset_number(&mut self) {
        self.modal.offset = 0;
        self.nose = Nose::default();
    }

    /// Whether G41 or G42 acts on the next move.
    pub(crate) const fn compensates(&self) -> bool {
        self.modal.nose_compensation != 40 && self.modal.offset != 0
    }

    /// Another offset without motion: the coordinates shift.
    pub(crate) fn shift_offset(&mut self, offset: Exact) {
        self.position = self.position + self.offset - offset;
        self.offset = offset;
    }
}
