//! Stores the state of a run between blocks: modal codes, offsets and positions.

use gsk_core::program::WordNumber;

use crate::axes::Axes;
use crate::cycles::HoleData;
use crate::memory::MillMemory;
use crate::modal::MillModal;
use crate::space::{Length, MillAxis, MillPosition};
use crate::transform::Transform;
use crate::words::length;

/// The state after a block.
#[derive(Clone, Debug, Default)]
pub(crate) struct MillState {
    /// The fourth and fifth axis of the machine.
    pub(crate) axes: Axes,
    pub(crate) modal: MillModal,
    /// Position in machine coordinates, without cutter radius compensation.
    pub(crate) machine: MillPosition,
    /// The programmed point before scaling and rotation, work coordinates.
    pub(crate) programmed: MillPosition,
    /// The length offset in force.
    pub(crate) length: Length,
    /// Shift of all zeros by G92.
    pub(crate) shift: MillPosition,
    /// Local coordinates of G52.
    pub(crate) local: MillPosition,
    pub(crate) transform: Transform,
    /// Polar coordinates of G16.
    pub(crate) polar: Option<Polar>,
    /// The intermediate point of the last G28 or G30, machine coordinates.
    pub(crate) intermediate: MillPosition,
    pub(crate) hole: HoleData,
    /// End of the last G31, work coordinates.
    pub(crate) skipped: MillPosition,
    /// Whether M06 has been commanded. From then on T only calls a tool.
    pub(crate) changes_tools: bool,
}

/// The last radius and angle programmed under G16.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Polar {
    pub(crate) radius: Length,
    pub(crate) degrees: f64,
}

impl MillState {
    /// Returns the work zero in machine coordinates.
    pub(crate) fn zero(&self, memory: &MillMemory) -> MillPosition {
        memory.external + memory.zero(self.modal.zero) + self.shift + self.local
    }

    /// Returns the offset from work to machine coordinates: work zero and length offset.
    pub(crate) fn frame(&self, memory: &MillMemory) -> MillPosition {
        let mut frame = self.zero(memory);
        frame.set(MillAxis::Z, frame.get(MillAxis::Z) + self.length);
        frame
    }

    /// Returns the position of the tool tip, work coordinates.
    pub(crate) fn work(&self, memory: &MillMemory) -> MillPosition {
        self.axes.wrapped(self.machine - self.frame(memory))
    }

    /// Returns a programmed point in machine coordinates. The fourth and fifth axis are neither
    /// scaled nor rotated. They move by the programmed distance, in whichever turn they are.
    pub(crate) fn to_machine(&self, programmed: MillPosition, memory: &MillMemory) -> MillPosition {
        let distance = programmed - self.programmed;
        let to = self.transform.apply(programmed) + self.frame(memory);
        to.with_further_of(&(self.machine + distance))
    }

    /// Sets the position after a move.
    pub(crate) fn set_machine(&mut self, machine: MillPosition) {
        self.machine = self.axes.wrapped(machine);
    }

    /// Sets the programmed point after a block.
    pub(crate) fn set_programmed(&mut self, programmed: MillPosition) {
        self.programmed = self.axes.wrapped(programmed);
    }

    /// Returns the value of an axis word. Inches apply to lengths, not to angles.
    pub(crate) fn axis_value(&self, axis: MillAxis, value: WordNumber) -> Length {
        let rotary = self.axes.is_rotary(axis);
        let value = length(value, self.modal.inch && !rotary);
        if rotary { value.rounded() } else { value }
    }

    /// Sets the programmed point to the position of the tool tip.
    pub(crate) fn resync(&mut self, memory: &MillMemory) {
        self.programmed = self.transform.undo(self.work(memory));
    }
}
