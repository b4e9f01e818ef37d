//! A move as it was executed, with the conditions under which it was made.

use serde::{Deserialize, Serialize};

use super::{Action, ControlCommand, Frame, SourcePosition, ThreadStart};
use crate::units::{Axis, Feed, PerAxis, Point};

/// The kind of an executed move: rapid, cut, thread or dwell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum MoveKind {
    /// The move is a rapid: G00 or a rapid of a cycle.
    Rapid,
    /// The move is a straight cut: G01 or a cut of a cycle.
    Feed,
    /// Clockwise arc, seen with +Z to the right and +X up.
    Clockwise,
    /// The move is a counter-clockwise arc.
    CounterClockwise,
    /// The move is a cut synchronised with the spindle angle.
    Thread,
    /// The move is the run-out that leaves a thread.
    RunOut,
    /// A dwell without motion of the axes.
    Dwell,
}

impl MoveKind {
    /// The direction of an arc, seen with +Z to the right and +X up.
    pub const fn arc(clockwise: bool) -> Self {
        if clockwise {
            Self::Clockwise
        } else {
            Self::CounterClockwise
        }
    }

    /// The name of the kind in the output of `--moves` and in the test cases.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Rapid => "rapid",
            Self::Feed => "feed",
            Self::Clockwise => "cw",
            Self::CounterClockwise => "ccw",
            Self::Thread => "thread",
            Self::RunOut => "runout",
            Self::Dwell => "dwell",
        }
    }

    /// Whether the move follows the spindle angle: a thread or its run-out.
    pub const fn is_thread(self) -> bool {
        matches!(self, Self::Thread | Self::RunOut)
    }
}

/// A move as it was executed, in *programmed* coordinates (mm, X as a radius, without tool
/// offset). The preview and the control report the same moves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ExecutedMove {
    /// The position of the block that makes the move.
    pub source: SourcePosition,
    /// The kind of the move: rapid, cut, thread or dwell.
    pub kind: MoveKind,
    /// Start point in programmed coordinates, mm.
    pub from: Point,
    /// End point in programmed coordinates, mm.
    pub to: Point,
    /// Centre of an arc; `None` for other moves.
    pub center: Option<Point>,
    /// Commanded feed of a cut, for a thread its lead per revolution; `None` for rapids and
    /// dwells.
    pub feed: Option<Feed>,
    /// Machine time at the start of the move, s.
    pub start_s: f64,
    /// Duration of the move, s.
    pub duration_s: f64,
    /// Tool, frame and spindle speed during the move.
    pub conditions: MoveConditions,
}

/// The conditions under which a move is made: tool, offset, frame and spindle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MoveConditions {
    /// Tool in the working position, 0 = none.
    pub tool: u8,
    /// Tool offset number in force; 0 for none.
    pub offset: u8,
    /// Coordinate frame in force during the move.
    pub frame: Frame,
    /// Spindle speed at the start of the move, r/min; 0 = standstill.
    pub rpm: f64,
    /// Spindle speed at the end of the move, r/min: another one under G96.
    #[serde(default)]
    pub end_rpm: f64,
    /// How the thread follows the spindle angle; `None` for moves that are no threads.
    pub thread: Option<ThreadPhase>,
    /// Axes whose coordinates have no known relation to the work.
    #[serde(default, skip_serializing_if = "Unplaced::is_none")]
    pub unplaced: Unplaced,
}

/// Axes whose coordinates have no known relation to the work, because the move leads to or
/// from a machine zero. The numbers of these axes say nothing about the part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Unplaced {
    /// Axes whose coordinate at the start point is not related to the work.
    pub from: PerAxis<bool>,
    /// Axes whose coordinate at the end point is not related to the work.
    pub to: PerAxis<bool>,
}

impl Unplaced {
    /// Whether all coordinates are related to the work.
    pub const fn is_none(&self) -> bool {
        !(self.from.x || self.from.z || self.to.x || self.to.z)
    }
}

/// Phase of a thread to the spindle: lead axis, angle and start.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ThreadPhase {
    /// Axis along which the lead is measured.
    #[serde(rename = "long")]
    pub lead_axis: Axis,
    /// Change of the lead, mm per revolution and revolution.
    pub increase: f64,
    /// Spindle angle at which the thread begins.
    pub start: ThreadStart,
}

impl MoveConditions {
    /// Takes tool, offset and thread from a command. `frame` and `rpm` are the coordinate
    /// frame and the spindle speed (r/min) at its start.
    #[inline]
    pub(crate) fn from_command(command: &ControlCommand, frame: &Frame, rpm: f64) -> Self {
        let thread = match command.action {
            Action::Thread {
                lead_axis: long,
                increase,
                start,
                ..
            } => Some(ThreadPhase {
                lead_axis: long,
                increase,
                start,
            }),
            _ => None,
        };
        Self {
            tool: command.modal.tool,
            offset: command.modal.offset,
            frame: *frame,
            rpm,
            end_rpm: rpm,
            thread,
            unplaced: Unplaced::default(),
        }
    }
}
