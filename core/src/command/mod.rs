//! Commands of the interpreter to the control: one [`ControlCommand`] for each action, in machine
//! coordinates, with its source block.

mod executed_move;
mod frame;
mod modal;
mod motion_code;

pub use executed_move::{ExecutedMove, MoveConditions, MoveKind, ThreadPhase, Unplaced};
pub use frame::{Frame, ZeroOffset};
pub use modal::ModalState;
pub use motion_code::MotionCode;

use core::num::NonZeroU32;

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

use crate::units::{Axis, Feed, Point};

/// Identifies the program that a block belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ProgramId {
    /// The program of the program memory with this O number.
    Stored(u16),
    /// The read-only program opened from a file outside the memory.
    External,
    /// The block keyed in on the MDI page.
    Mdi,
    /// The program that the serial line delivers while it runs (DNC).
    Dnc,
}

/// Sequence number of a block (N word). An `Option` of this type needs no extra memory,
/// because commands are copied often.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "u32", into = "u32")]
pub struct SequenceNumber(NonZeroU32);

impl From<u32> for SequenceNumber {
    fn from(number: u32) -> Self {
        Self(NonZeroU32::MIN.saturating_add(number))
    }
}

impl From<SequenceNumber> for u32 {
    fn from(number: SequenceNumber) -> Self {
        number.0.get() - 1
    }
}

/// Source position of a command or an alarm: program, line and sequence number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SourcePosition {
    /// The program that contains the block.
    pub program: ProgramId,
    /// Line number in the program text, from 1.
    pub line: u32,
    /// The last sequence number N before or in the block; `None` before the first one.
    pub sequence: Option<SequenceNumber>,
}

/// One step of a program as the control executes it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ControlCommand {
    /// The position of the block that makes the command.
    pub source: SourcePosition,
    /// The action that the control executes.
    pub action: Action,
    /// Modal state after the block; the pages show it while the command runs.
    pub modal: ModalState,
    /// Whether this is the last command of its block.
    pub block_end: bool,
    /// Whether the run stops after this command under single block (ends of blocks that
    /// stop, and the moves of cycles, manual I-3.1.13).
    pub stop_point: bool,
    /// Whether feed hold waits for the end of this command: true for the moves of G70 to
    /// G75.
    #[serde(rename = "whole")]
    pub defers_feed_hold: bool,
    /// Programmed X of a move that nose radius compensation has changed. Set only under
    /// G96, whose surface speed follows the programmed X; otherwise `None`.
    pub programmed_x: Option<Box<ProgrammedX>>,
}

/// Programmed X as a function of the tip's position on its compensated path, machine
/// coordinates in mm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum ProgrammedX {
    /// Programmed X changes linearly along a straight move.
    #[serde(rename = "Even")]
    Linear {
        /// Programmed X at the start of the move, mm.
        from: f64,
        /// Programmed X at the end of the move, mm.
        to: f64,
    },
    /// Tip and programmed point move on arcs at the same angle.
    #[serde(rename = "Round")]
    Circular {
        /// X of the centre of the tip's arc, mm.
        tip_center: f64,
        /// X of the centre of the programmed arc, mm.
        center: f64,
        /// Programmed radius divided by the radius of the tip's arc.
        ratio: f64,
        /// Programmed X at the end of the move, mm.
        to: f64,
    },
}

impl ProgrammedX {
    /// Programmed X while the tip moves from `from` to `target` and is at `tip`.
    pub fn x_at(&self, tip: Point, from: Point, target: Point) -> f64 {
        match *self {
            Self::Linear { from: first, to } => {
                let total = (target - from).length();
                let fraction = if total > 0.0 {
                    ((tip - from).length() / total).min(1.0)
                } else {
                    1.0
                };
                first + (to - first) * fraction
            }
            Self::Circular {
                tip_center,
                center,
                ratio,
                ..
            } => center + (tip.x - tip_center) * ratio,
        }
    }

    /// Programmed X at the end of the move, mm.
    pub const fn x_at_end(&self) -> f64 {
        match *self {
            Self::Linear { to, .. } | Self::Circular { to, .. } => to,
        }
    }
}

/// The action of a command. Positions are machine coordinates in mm, X as a radius.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Action {
    /// G00: each axis moves at its own rapid rate, so the path is not straight.
    Rapid {
        /// End point of the rapid, machine coordinates, mm.
        to: Point,
    },
    /// Straight cut (G01) to a point.
    Line {
        /// End point of the cut, machine coordinates, mm.
        to: Point,
        /// Feed of the cut along its path.
        feed: Feed,
    },
    /// Circular cut (G02, G03) to a point.
    Arc {
        /// End point; equal to the start for a full circle.
        to: Point,
        /// Centre of the arc, machine coordinates, mm.
        center: Point,
        /// Whether the arc is clockwise, as seen with +Z to the right and +X up.
        clockwise: bool,
        /// Feed along the arc.
        feed: Feed,
    },
    /// Straight cut synchronised with the spindle angle (G32, G34, G92, G76).
    Thread {
        /// End point of the thread, machine coordinates, mm.
        to: Point,
        /// Axis that the lead is measured along; a lead along X is a radius.
        #[serde(rename = "long")]
        lead_axis: Axis,
        /// Lead at the start of the thread, mm per revolution.
        lead: f64,
        /// Change of the lead, mm per revolution and revolution (G34); otherwise 0.
        increase: f64,
        /// Spindle angle at which the thread begins.
        start: ThreadStart,
        /// Whether this is the run-out that leaves the thread.
        run_out: bool,
    },
    /// A thread cycle (G92, G76) begins. The spindle must turn before the first infeed, at
    /// a speed that the axes can follow.
    ThreadCycle {
        /// Travel of each axis per revolution in the cuts, mm.
        per_revolution: Point,
        /// The feature that a board cannot cut as one straight pass; `None`: all cuts are such
        /// passes.
        #[serde(rename = "beyond")]
        extra_feature: Option<ThreadPassFeature>,
    },
    /// Tapping in Z (G33): feed in, stop the spindle, reverse it, feed out. The tap ends at
    /// its start point with the spindle stopped.
    Tap {
        /// Bottom of the hole, machine coordinates, mm.
        to: Point,
        /// Lead of the tap, mm per revolution.
        lead: f64,
        /// Spindle angle after the one-turn signal at which the tap begins, degrees.
        start_degrees: f64,
    },
    /// G04: waits for a time; a time of zero is an exact stop.
    Dwell {
        /// Duration of the dwell, ms.
        ms: u32,
    },
    /// G28: axes without a reference point seek it as in manual mode, by deceleration
    /// switch and zero signal. The other axes of the block are already at their reference
    /// point.
    ZeroReturn {
        /// Whether X returns to its reference point.
        x: bool,
        /// Whether Z returns to its reference point.
        z: bool,
    },
    /// The axes have reached the reference point (after the rapid of G28): the zero lamps
    /// light.
    Referenced {
        /// Whether X has reached its reference point.
        x: bool,
        /// Whether Z has reached its reference point.
        z: bool,
    },
    /// Puts a new coordinate frame into force (G50, T).
    Frame {
        /// The new coordinate frame: work zero and tool offset.
        frame: Frame,
        /// The point that a G50 sets as program zero; `None` for other frames.
        program_zero: Option<Point>,
        /// Whether the relative coordinates take the values of the absolute ones when the
        /// work zero moves (005.1 PPD); otherwise they keep their values.
        relative: bool,
    },
    /// M function for the PLC. It begins together with the motion and the other functions
    /// of its block; the block ends when all are finished.
    Miscellaneous {
        /// Number of the M code, such as 3 for M03.
        code: u8,
    },
    /// Outputs that a program switches directly (NC-B08: M10, M11, M21 and up). Bits 0–23
    /// are Y0–Y23; Y0 is F54.0 for the ladder.
    Outputs {
        /// Bit mask of the outputs to switch on.
        on: u32,
        /// Bit mask of the outputs to switch off.
        off: u32,
        /// Duration after which the outputs in `on` switch off again, ms; 0 = never.
        ms: u32,
    },
    /// The program waits for a level of an input (M01 of the NC-B08). Input 0 is X0.0,
    /// input 8 is X1.0.
    InputWait {
        /// Number of the input, 0–23.
        input: u8,
        /// The level that the input must keep for 30 ms: true = on.
        high: bool,
    },
    /// S function: speed of the spindle, or its limit.
    Spindle(SpindleCommand),
    /// T function: changes the tool and puts an offset number into force.
    Tool {
        /// Tool number; 0 for no tool change.
        tool: u8,
        /// Offset number; 0 cancels the offset.
        offset: u8,
        /// Whether neither a motion nor a stop or end of the program follows in the block.
        is_last: bool,
    },
    /// M00: stops the run after all previous commands have finished.
    ProgramStop,
    /// End of the program: M30, M02, or the end of the text.
    End {
        /// Whether the part counter counts this end (M30, main-program M99).
        counts: bool,
        /// Whether M30 was programmed, or M02 on models that have it: its decode signals go
        /// to the PLC.
        m30: bool,
        /// Whether M02 was programmed; `m30` is then true too.
        #[serde(default, skip_serializing_if = "core::ops::Not::not")]
        m02: bool,
    },
    /// M99 in the main program: the part counter counts and the program starts again.
    Repeat,
    /// A G65 operation on variables. The interpreter executed it when it read the block;
    /// for the control it is a wait of 1 ms.
    Macro,
    /// A block without effect on the machine (only N, modal G codes…). The control moves
    /// the block cursor to it, and single block stops after it.
    Nothing,
}

impl Action {
    /// Whether the action moves the slides in one move.
    pub(crate) const fn is_motion(&self) -> bool {
        matches!(
            self,
            Self::Rapid { .. }
                | Self::Line { .. }
                | Self::Arc { .. }
                | Self::Thread { .. }
                | Self::Tap { .. }
        )
    }

    /// Moves the end point and the arc centre by a distance; other actions stay the same.
    pub(crate) fn shifted(mut self, by: Point) -> Self {
        match &mut self {
            Self::Rapid { to }
            | Self::Line { to, .. }
            | Self::Thread { to, .. }
            | Self::Tap { to, .. } => *to = *to + by,
            Self::Arc { to, center, .. } => {
                *to = *to + by;
                *center = *center + by;
            }
            _ => {}
        }
        self
    }
}

/// The condition of the spindle angle at which a thread begins.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum ThreadStart {
    /// The thread waits for the one-turn signal and begins at this angle after it. Starts of a
    /// multi-start thread differ in this angle.
    AtIndex {
        /// Spindle angle after the one-turn signal, degrees, 0–360.
        degrees: f64,
    },
    /// The thread continues from the previous thread without a change of phase.
    Continued,
}

/// A feature of a thread that is not one straight pass of constant lead from the
/// one-turn signal. A board that cuts passes itself cannot make such a thread.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ThreadPassFeature {
    /// The lead changes along the thread (G34).
    LeadChange,
    /// A run-out leaves the thread (J, K, No.019).
    RunOut,
    /// Another thread continues from this one without a stop.
    #[serde(rename = "GoesOn")]
    Continued,
    /// The thread begins at another angle than the one-turn signal (L).
    #[serde(rename = "Start")]
    StartAngle,
}

impl ThreadPassFeature {
    /// Returns the message that names the feature and advises what to program instead.
    pub fn to_message(self) -> Message {
        match self {
            Self::LeadChange => say::pass_lead_changes(),
            Self::RunOut => say::pass_run_out(),
            Self::Continued => say::pass_continues(),
            Self::StartAngle => say::pass_start_beside_index(),
        }
    }
}

/// Spindle command of an S word (with G96, G97, G50).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum SpindleCommand {
    /// Stepped speed output S00–S04 (001.4 = 0), with the PLC handshake.
    Step(u8),
    /// Speed that the spindle keeps, r/min (G97).
    Speed(f64),
    /// Constant surface speed, m/min (G96), at the programmed X as the radius.
    Surface(f64),
    /// Highest speed under G96, r/min (G50 S); 0 stops the spindle.
    Limit(f64),
}
