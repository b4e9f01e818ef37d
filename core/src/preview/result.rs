//! What a preview finds, and its progress.

use super::caution::Caution;
use super::{FurtherAlarms, PathBounds, SpindleRotation};
use crate::alarm::Alarm;
use crate::command::{Frame, ProgramId};
use crate::interpreter::ModalState;
use crate::memory::ControlParameters;
use crate::units::Point;

/// The reason or position at which a preview ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PreviewEnd {
    /// The preview ended at M30.
    M30,
    /// The preview ended at M02, on models that have it.
    M02,
    /// The preview ended at M99 of the main program.
    M99,
    /// At the end of the text without M30 or M99.
    Text,
    /// The preview ended at an alarm, which is in [`Preview::alarm`].
    Alarm,
    /// At 1000 hours of machine time, or where the caller cancelled the preview.
    Limit,
}

/// Lengths of the path by kind of move, mm; a rapid counts as its chord.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PathLengths {
    /// Length of all rapids, mm.
    pub rapid: f64,
    /// Length of all straight cuts, mm.
    pub feed: f64,
    /// Length of all clockwise arcs, mm.
    pub clockwise: f64,
    /// Length of all counter-clockwise arcs, mm.
    pub counter_clockwise: f64,
    /// Length of all threads with their run-outs, and of all taps, mm.
    pub thread: f64,
}

/// The result of a preview: motion, times and state as running the program would give. X of points
/// is a radius, mm.
#[derive(Clone, Debug, PartialEq)]
pub struct Preview {
    /// The reason or position at which the preview ended.
    pub end: PreviewEnd,
    /// The alarm at which the program ended; `None` if it ended without one.
    pub alarm: Option<Alarm>,
    /// Alarms of the rest of the program. All other fields describe the run up to `alarm`.
    pub further: FurtherAlarms,
    /// Estimated machine time, s: motion, M, S, T and dwell.
    pub time_s: f64,
    /// Part of [`Self::time_s`] spent in cutting moves, s.
    pub cutting_s: f64,
    /// Number of blocks that were executed.
    pub blocks: u64,
    /// Number of moves and dwells, without those of zero length.
    pub moves: u64,
    /// Number of program stops (M00) that were executed.
    pub stops: u32,
    /// Number of finished parts that the control counts during the program.
    pub parts: u32,
    /// Programs that executed a block, in the order of first use; each once, the main program first.
    pub programs: Vec<ProgramId>,
    /// Tool and offset number of each T word, in the order of first use; each pair once.
    pub tools: Vec<(u8, u8)>,
    /// Bounding box of the path in work coordinates, mm; `None` without motion.
    pub bounds: Option<PathBounds>,
    /// Probable mistakes that raise no alarm. Most kinds are listed at their first
    /// occurrence only.
    pub cautions: Vec<Caution>,
    /// Lengths of the path, by kind of move.
    pub lengths: PathLengths,
    /// Absolute position (work coordinates) at the end, mm.
    pub absolute: Point,
    /// Machine position at the end, mm.
    pub machine: Point,
    /// Relative position at the end, mm.
    pub relative: Point,
    /// Work zero and tool offset at the end.
    pub frame: Frame,
    /// Modal codes and values at the end of the program.
    pub modal: ModalState,
    /// Direction of the spindle at the end.
    pub spindle: SpindleRotation,
    /// Whether coolant is on at the end.
    pub coolant: bool,
    /// Parameters at the end; cycles may have written some of them.
    pub parameters: ControlParameters,
}

/// Progress of a running preview, passed to `should_continue`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PreviewProgress {
    /// Line of the last executed block, from 1; 0 before the first block.
    pub line: u32,
    /// Number of blocks that were executed so far.
    pub blocks: u64,
    /// Number of moves and dwells so far.
    pub moves: u64,
    /// Number of blocks read, counted again in loops and subprograms, plus one for each 64
    /// bytes of parsed text.
    pub work: u64,
    /// Number of executed commands since the last move.
    pub motionless: u64,
    /// Simulated machine time so far, s.
    pub time_s: f64,
}
