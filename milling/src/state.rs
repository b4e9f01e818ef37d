//! Where a run stands: what is in force, and where the tool is.

use gsk_core::program::Number;

use crate::axes::Axes;
use crate::cycles::HoleData;
use crate::memory::MillMemory;
use crate::modal::Modal;
use crate::space::{Axis, Length, Position};
use crate::transform::Transform;
use crate::words::length;

/// The state after a block.
#[derive(Clone, Debug, Default)]
pub(crate) struct State {
    /// Which axes there are.
    pub(crate) axes: Axes,
    pub(crate) modal: Modal,
    /// Where the slides stand, machine coordinates, but for the radius of the cutter.
    pub(crate) machine: Position,
    /// The programmed point, before scaling and rotation, in work coordinates.
    pub(crate) programmed: Position,
    /// The length offset in force.
    pub(crate) length: Length,
    /// G92, of all zeros.
    pub(crate) shift: Position,
    /// G52.
    pub(crate) local: Position,
    pub(crate) transform: Transform,
    /// G16.
    pub(crate) polar: Option<Polar>,
    /// The intermediate point of the last G28 or G30, machine coordinates.
    pub(crate) intermediate: Position,
    pub(crate) hole: HoleData,
    /// Where the last G31 ended, work coordinates.
    pub(crate) skipped: Position,
    /// M06 has been commanded: T only calls for a tool from then on.
    pub(crate) changes_tools: bool,
}

/// The radius and the angle that words of G16 left.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Polar {
    pub(crate) radius: Length,
    pub(crate) degrees: f64,
}

impl State {
    /// Machine coordinates of the work zero.
    pub(crate) fn zero(&self, memory: &MillMemory) -> Position {
        memory.external + memory.zero(self.modal.zero) + self.shift + self.local
    }

    /// What makes machine coordinates of work coordinates: the work zero and the length.
    pub(crate) fn frame(&self, memory: &MillMemory) -> Position {
        let mut frame = self.zero(memory);
        frame.set(Axis::Z, frame.get(Axis::Z) + self.length);
        frame
    }

    /// Where the tip stands, work coordinates.
    pub(crate) fn work(&self, memory: &MillMemory) -> Position {
        self.axes.rolled(self.machine - self.frame(memory))
    }

    /// Machine coordinates of a programmed point. Further axes are neither scaled nor
    /// rotated; they go as far as their words say, whichever turn they are in.
    pub(crate) fn place(&self, programmed: Position, memory: &MillMemory) -> Position {
        let way = programmed - self.programmed;
        let to = self.transform.apply(programmed) + self.frame(memory);
        to.turned_as(&(self.machine + way))
    }

    /// The slides have gone to a point.
    pub(crate) fn stand_at(&mut self, machine: Position) {
        self.machine = self.axes.rolled(machine);
    }

    /// A block leads to a point as it is programmed.
    pub(crate) fn programmed_at(&mut self, programmed: Position) {
        self.programmed = self.axes.rolled(programmed);
    }

    /// The number of a word of an axis: inches are lengths, and no angles.
    pub(crate) fn word(&self, axis: Axis, value: Number) -> Length {
        let rotary = self.axes.is_rotary(axis);
        let value = length(value, self.modal.inch && !rotary);
        if rotary { value.rounded() } else { value }
    }

    /// The programmed point is taken from where the tip stands.
    pub(crate) fn resync(&mut self, memory: &MillMemory) {
        self.programmed = self.transform.undo(self.work(memory));
    }
}
