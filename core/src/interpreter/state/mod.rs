//! The state of the interpreter after the blocks read so far.

pub(super) mod cycle_words;

use serde::{Deserialize, Serialize};

use crate::command::{Frame, ZeroOffset};
use crate::compensation::Nose;
use crate::interpreter::ModalState;
use crate::interpreter::exact::ExactPoint;
use crate::interpreter::state::cycle_words::CycleWords;
use crate::interpreter::words::{AxisTarget, AxisWords};
use crate::units::{Axis, PerAxis};

/// The modal codes, position and offsets after the blocks read so far. Small and `Copy`, so
/// that the reader can restore the state when a block raises an alarm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    pub(crate) modal: ModalState,
    /// Programmed position of the tool at the end of the motion read so far.
    pub(crate) position: ExactPoint,
    /// Machine coordinates of the program zero (G50).
    pub(crate) zero: ExactPoint,
    /// Tool offset in force, from a programmed point to that of the slide.
    pub(crate) offset: ExactPoint,
    /// Axes whose offset shifts the coordinates and has not been travelled yet.
    pub(crate) untravelled: PerAxis<bool>,
    /// The tool nose of the last T, from the offset table.
    pub(crate) nose: Nose,
    /// The stored words of G90, G92 and G94 that later blocks reuse.
    pub(crate) cycle: CycleWords,
    /// Programmed end point minus position: after a chamfer, a corner arc or a run-out,
    /// increments count from the programmed corner.
    #[serde(rename = "ahead")]
    pub(crate) increment_offset: ExactPoint,
    /// Thread lead in force, mm per revolution; 0 if unset. F and I of thread blocks set the
    /// lead.
    pub(crate) lead: f64,
    /// Whether the previous block cut a thread (G32 or G34), which the next one may continue.
    #[serde(rename = "threading")]
    pub(crate) is_threading: bool,
    /// Surface speed that G96 commanded last, m/min.
    pub(crate) surface: f64,
    /// Greatest spindle speed under G96 (G50 S), r/min; `None` for no limit.
    pub(crate) spindle_limit: Option<f64>,
    /// Whether G91 is in force: axis words are increments.
    #[serde(default)]
    pub(crate) incremental: bool,
    /// Offset of the zero by G55 to G57, included in `zero`.
    #[serde(default)]
    pub(crate) zero_offset: ExactPoint,
    /// Scale factor of G31, in millionths; `None` while scaling is off.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) scale: Option<i64>,
    /// Position of the tool at cycle start; `None` before the first run and on models that
    /// cannot return there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(rename = "begun")]
    pub(crate) run_start: Option<RunStart>,
}

/// Position of the tool when the run was started.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct RunStart {
    /// Position at cycle start, machine coordinates.
    pub(crate) machine: ExactPoint,
    /// Position at cycle start, work coordinates; G92 redefines it.
    pub(crate) work: ExactPoint,
}

impl State {
    /// The state at power-on: no offset, all coordinates 0, and the given modal codes.
    pub(crate) fn new(modal: ModalState) -> Self {
        Self {
            modal,
            position: ExactPoint::default(),
            zero: ExactPoint::default(),
            offset: ExactPoint::default(),
            untravelled: PerAxis::new(false, false),
            nose: Nose::default(),
            cycle: CycleWords::default(),
            increment_offset: ExactPoint::default(),
            lead: 0.0,
            is_threading: false,
            surface: 0.0,
            spindle_limit: None,
            incremental: false,
            zero_offset: ExactPoint::default(),
            scale: None,
            run_start: None,
        }
    }

    pub(crate) fn frame(&self) -> Frame {
        Frame {
            zero: self.zero.to_point(),
            offset: self.offset.to_point(),
            zero_offset: ZeroOffset::from_point(self.zero_offset.to_point()),
        }
    }

    /// Converts a programmed point to machine coordinates.
    pub(crate) fn to_machine(self, program: ExactPoint) -> ExactPoint {
        program + self.zero + self.offset
    }

    /// Sets the programmed position from a position in machine coordinates.
    pub(crate) fn set_machine_position(&mut self, machine: ExactPoint) {
        self.position = machine - self.zero - self.offset;
        self.increment_offset = ExactPoint::default();
        self.is_threading = false;
    }

    /// Sets the position to the end of a motion. The programmed axes have travelled their
    /// offset, and their increments count from the end.
    pub(crate) fn move_to(&mut self, axes: &AxisWords, end: ExactPoint) {
        self.position = end;
        for axis in [Axis::X, Axis::Z] {
            if axes.get(axis) != AxisTarget::None {
                *self.untravelled.get_mut(axis) = false;
                self.increment_offset.set(axis, 0);
            }
        }
    }

    /// Records that moves of both axes end at the current position.
    pub(crate) fn end_at_position(&mut self) {
        self.untravelled = PerAxis::new(false, false);
        self.increment_offset = ExactPoint::default();
    }

    /// Sets the offset number to 00 and deletes the nose radius.
    pub(crate) fn cancel_offset_number(&mut self) {
        self.modal.offset = 0;
        self.nose = Nose::default();
    }

    /// Whether nose radius compensation is in force for the next move.
    pub(crate) const fn is_compensating(&self) -> bool {
        self.modal.nose_compensation != 40 && self.modal.offset != 0
    }

    /// Puts another tool offset into force without motion: the programmed coordinates of the
    /// current position change instead.
    pub(crate) fn shift_offset(&mut self, offset: ExactPoint) {
        self.position = self.position + self.offset - offset;
        self.offset = offset;
    }
}
