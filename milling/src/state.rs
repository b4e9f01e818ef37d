//! Stores the state of a run between blocks: modal codes, offsets and positions.

use gsk_core::program::WordNumber;

use crate::axes::Axes;
use crate::cycles::HoleData;
use crate::memory::MillMemory;
use crate::modal::MillModal;
use crate::space::{Length, MillAxis, MillPosition};
use crate::transform::Transform;
use crate::words::length;

/// The state of a program run between two blocks.
#[derive(Clone, Debug, Default)]
pub(crate) struct MillState {
    /// The fourth and fifth axis of the machine, if it has them.
    pub(crate) axes: Axes,
    pub(crate) modal: MillModal,
    /// Position in machine coordinates, without cutter radius compensation.
    pub(crate) machine: MillPosition,
    /// The programmed point before scaling and rotation, work coordinates.
    pub(crate) programmed: MillPosition,
    /// The tool length offset in force, which is added to Z.
    pub(crate) length: Length,
    /// The work zero in force, if it was changed and the change waits for the next code that
    /// selects a zero (540.1 = 0).
    pub(crate) held_zero: Option<MillPosition>,
    /// Shift of all work zeros by G92, mm or degrees.
    pub(crate) shift: MillPosition,
    /// Origin of the local coordinates (G52), relative to the work zero.
    pub(crate) local: MillPosition,
    pub(crate) transform: Transform,
    /// Radius and angle of polar coordinates (G16); `None` if they are off (G15).
    pub(crate) polar: Option<Polar>,
    /// The intermediate point of the last G28 or G30, machine coordinates.
    pub(crate) intermediate: MillPosition,
    pub(crate) hole: HoleData,
    /// End position of the last G31 (skip), work coordinates.
    pub(crate) skipped: MillPosition,
    /// Whether M06 has been commanded; from then on T only selects a tool for M06.
    pub(crate) changes_tools: bool,
}

/// The last radius and angle that were programmed under G16.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Polar {
    pub(crate) radius: Length,
    pub(crate) degrees: f64,
}

impl MillState {
    /// Returns the work zero in force in machine coordinates, with external, G92 and G52
    /// offsets.
    pub(crate) fn zero(&self, memory: &MillMemory) -> MillPosition {
        let selected = self.held_zero;
        let selected = selected.unwrap_or_else(|| memory.zero(self.modal.zero));
        memory.external + selected + self.shift + self.local
    }

    /// Returns the offset that converts work coordinates to machine coordinates: work zero and
    /// length offset.
    pub(crate) fn frame(&self, memory: &MillMemory) -> MillPosition {
        let mut frame = self.zero(memory);
        frame.set(MillAxis::Z, frame.get(MillAxis::Z) + self.length);
        frame
    }

    /// Returns the position of the tool tip, work coordinates.
    pub(crate) fn work(&self, memory: &MillMemory) -> MillPosition {
        self.axes.wrapped(self.machine - self.frame(memory))
    }

    /// Returns a programmed point in machine coordinates. The fourth and fifth axis are
    /// neither scaled nor rotated. They move by the programmed distance, whatever turn they
    /// are in.
    pub(crate) fn to_machine(&self, programmed: MillPosition, memory: &MillMemory) -> MillPosition {
        let distance = programmed - self.programmed;
        let to = self.transform.apply(programmed, &self.axes) + self.frame(memory);
        to.with_further_of(&(self.machine + distance))
    }

    /// Sets the machine position after a move, with rotary axes reduced to one turn.
    pub(crate) fn set_machine(&mut self, machine: MillPosition) {
        self.machine = self.axes.wrapped(machine);
    }

    /// Sets the programmed point after a block, with rotary axes reduced to one turn.
    pub(crate) fn set_programmed(&mut self, programmed: MillPosition) {
        self.programmed = self.axes.wrapped(programmed);
    }

    /// Returns the value of an axis word as a length or angle. Inches apply to lengths, not to
    /// angles.
    pub(crate) fn axis_value(&self, axis: MillAxis, value: WordNumber) -> Length {
        let rotary = self.axes.is_rotary(axis);
        let inch = self.modal.inch && !rotary;
        self.axes.rounded_word(axis, length(value, inch), inch)
    }

    /// Sets the programmed point to the current position of the tool tip.
    pub(crate) fn resync(&mut self, memory: &MillMemory) {
        self.programmed = self.transform.undo(self.work(memory));
    }
}
