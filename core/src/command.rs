//! What the interpreter hands to the control: one [`Command`] for each thing
//! that happens, in machine coordinates, with the block it came from.

mod modal;

pub use modal::Modal;

use core::num::NonZeroU32;

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

use crate::units::{Axis, Feed, PerAxis, Point, round};

/// Which program a block stands in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ProgramId {
    /// A program of the program memory, by its O number.
    Stored(u16),
    /// The read-only program opened from a file outside the memory.
    External,
    /// The block keyed in on the MDI page.
    Mdi,
    /// The program that comes in through the serial line while it runs (DNC).
    Dnc,
}

/// The number N of a block. With none it takes no more room than alone: commands are
/// copied often.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "u32", into = "u32")]
pub struct BlockNumber(NonZeroU32);

impl From<u32> for BlockNumber {
    fn from(number: u32) -> Self {
        Self(NonZeroU32::MIN.saturating_add(number))
    }
}

impl From<BlockNumber> for u32 {
    fn from(number: BlockNumber) -> Self {
        number.0.get() - 1
    }
}

/// Where a command or an alarm comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Source {
    /// The program.
    pub program: ProgramId,
    /// Line of the file, from 1.
    pub line: u32,
    /// The last sequence number N met, if any.
    pub sequence: Option<BlockNumber>,
}

/// The coordinate frame in force: `machine = program + zero + offset`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// Machine coordinate of the work origin.
    pub zero: Point,
    /// Tool offset in force.
    pub offset: Point,
    /// How far zero offsets (G55 to G57 of the Huaxing lathes) have moved the origin, a
    /// part of `zero`.
    #[serde(default, skip_serializing_if = "ZeroOffset::is_none")]
    pub zero_offset: ZeroOffset,
}

/// A zero offset in half micrometres, X as a radius. Whole numbers, and small ones:
/// frames are copied with every command.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ZeroOffset {
    x: i32,
    z: i32,
}

impl ZeroOffset {
    /// Half micrometres in a millimetre.
    const PER_MM: f64 = 2000.0;

    /// The nearest one.
    pub fn from_point(point: Point) -> Self {
        let whole = |mm: f64| round(mm * Self::PER_MM) as i32;
        Self {
            x: whole(point.x),
            z: whole(point.z),
        }
    }

    /// In mm, X as a radius.
    pub fn point(self) -> Point {
        Point::new(
            f64::from(self.x) / Self::PER_MM,
            f64::from(self.z) / Self::PER_MM,
        )
    }

    /// None of an axis from here on.
    pub(crate) const fn clear(&mut self, axis: Axis) {
        match axis {
            Axis::X => self.x = 0,
            Axis::Z => self.z = 0,
        }
    }

    fn is_none(&self) -> bool {
        *self == Self::default()
    }
}

impl Frame {
    /// Machine coordinate of a programmed point.
    pub fn machine(&self, program: Point) -> Point {
        program + self.zero + self.offset
    }

    /// Programmed (absolute) coordinate of a machine position.
    pub fn program(&self, machine: Point) -> Point {
        machine - self.zero - self.offset
    }
}

/// One step of a program, as the control carries it out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Command {
    /// The block it comes from.
    pub source: Source,
    /// What to do.
    pub action: Action,
    /// The modal state its block left; what the pages show while it runs.
    pub modal: Modal,
    /// Whether it is the last command of its block.
    pub block_end: bool,
    /// Whether single block stops after it (ends of blocks that stop, and the
    /// moves of cycles, manual I-3.1.13).
    pub stop_point: bool,
    /// Whether feed hold waits for its end: the moves of G70 to G75.
    pub whole: bool,
    /// The programmed X of a move that nose radius compensation has changed;
    /// only under G96, whose speed follows it.
    pub programmed_x: Option<Box<ProgrammedX>>,
}

/// The programmed X while the tip goes along its compensated path, machine
/// coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum ProgrammedX {
    /// It changes evenly along a straight move.
    Even {
        /// At the start.
        from: f64,
        /// At the end.
        to: f64,
    },
    /// Tip and programmed point go round their centres together.
    Round {
        /// X of the centre of the tip's arc.
        tip_center: f64,
        /// X of the programmed centre.
        center: f64,
        /// Programmed radius over that of the tip's arc.
        ratio: f64,
        /// At the end.
        to: f64,
    },
}

impl ProgrammedX {
    /// When the tip has got so far on its way from one point to another.
    pub fn at(&self, tip: Point, from: Point, target: Point) -> f64 {
        match *self {
            Self::Even { from: first, to } => {
                let whole = (target - from).length();
                let part = if whole > 0.0 {
                    ((tip - from).length() / whole).min(1.0)
                } else {
                    1.0
                };
                first + (to - first) * part
            }
            Self::Round {
                tip_center,
                center,
                ratio,
                ..
            } => center + (tip.x - tip_center) * ratio,
        }
    }

    /// At the end of the move.
    pub const fn end(&self) -> f64 {
        match *self {
            Self::Even { to, .. } | Self::Round { to, .. } => to,
        }
    }
}

/// What a command does. Positions are machine coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Action {
    /// Both axes to the target at their own rapid rates; not a straight line.
    Rapid {
        /// End point.
        to: Point,
    },
    /// Straight cut.
    Line {
        /// End point.
        to: Point,
        /// Rate along the path.
        feed: Feed,
    },
    /// Circular cut.
    Arc {
        /// End point; equal to the start for a full circle.
        to: Point,
        /// Centre.
        center: Point,
        /// Direction seen with +Z to the right and +X up.
        clockwise: bool,
        /// Rate along the path.
        feed: Feed,
    },
    /// Straight cut tied to the angle of the spindle (G32, G34, G92, G76).
    Thread {
        /// End point.
        to: Point,
        /// The axis the lead counts on; X as a radius.
        long: Axis,
        /// mm per revolution at the start.
        lead: f64,
        /// mm per revolution and revolution (G34); 0 otherwise.
        increase: f64,
        /// Where on the turn it begins.
        start: ThreadStart,
        /// Whether it is the tail that leaves the thread.
        run_out: bool,
    },
    /// A cycle of threads begins (G92, G76): before its infeed the spindle must
    /// turn, and no faster than the axes can follow.
    ThreadCycle {
        /// How far each axis goes a revolution in its cuts, mm.
        per_revolution: Point,
        /// What makes a cut more than one straight pass.
        beyond: Option<BeyondPass>,
    },
    /// Tapping in Z (G33): in, spindle stop, reverse, out. It ends where it began,
    /// with the spindle stopped.
    Tap {
        /// Bottom of the hole.
        to: Point,
        /// mm per revolution.
        lead: f64,
        /// Angle after the one-turn signal at which it begins.
        start_degrees: f64,
    },
    /// G04; zero is an exact stop.
    Dwell {
        /// Milliseconds.
        ms: u32,
    },
    /// The reference point of axes that have none yet is sought as by hand (G28):
    /// switch, zero signal; the others of these axes stand on theirs already.
    ZeroReturn {
        /// X takes part.
        x: bool,
        /// Z takes part.
        z: bool,
    },
    /// The axes have come back to the reference point (after the rapid of G28):
    /// the zero lamps light.
    Referenced {
        /// X took part.
        x: bool,
        /// Z took part.
        z: bool,
    },
    /// A new coordinate frame is in force from here on (G50, T).
    Frame {
        /// The frame.
        frame: Frame,
        /// Whether this is a G50, which defines the program zero point.
        program_zero: Option<Point>,
        /// Whether the relative coordinates follow the absolute ones (005.1 PPD).
        relative: bool,
    },
    /// M function given to the PLC: begins together with what follows it in its block,
    /// which ends when both are finished.
    Miscellaneous {
        /// M number.
        code: u8,
    },
    /// Outputs that a program switches by itself (NC-B08: M10, M11, M21 and on): Y0 in
    /// bit 0, which is F54.0 for the ladder; there are 24.
    Outputs {
        /// Those that go on.
        on: u32,
        /// Those that go off.
        off: u32,
        /// After so many milliseconds those that went on go off again; 0 = never.
        ms: u32,
    },
    /// The program waits for an input (M01 of the NC-B08): X0 is X0.0, X8 is X1.0.
    InputWait {
        /// Its number, 0–23.
        input: u8,
        /// The level that it must have for 30 ms.
        high: bool,
    },
    /// S function: spindle speed.
    Spindle(SpindleCommand),
    /// T function: tool change and offset number.
    Tool {
        /// Tool number, 0 = none.
        tool: u8,
        /// Offset number, 0 = cancelled.
        offset: u8,
        /// Nothing that takes time follows it in its block.
        is_last: bool,
    },
    /// M00: stop after everything before it is finished.
    ProgramStop,
    /// M30, or the end of the text.
    End {
        /// Whether the part counter counts it (M30, main-program M99).
        counts: bool,
        /// Whether M30 was programmed (its decode signals go to the PLC), or M02 on models
        /// that have it.
        m30: bool,
        /// It was M02.
        #[serde(default, skip_serializing_if = "core::ops::Not::not")]
        m02: bool,
    },
    /// M99 in the main program: the part counter counts, the run goes on.
    Repeat,
    /// An operation on variables (G65) was done when its block was read; it takes a
    /// millisecond.
    Macro,
    /// A block without any effect on the machine (only N, G modal words…): it
    /// moves the block cursor and is a place where single block stops.
    Nothing,
}

impl Action {
    /// Whether it is motion of the slides by itself, one move.
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

    /// The same motion at another place; what does not move stays as it is.
    pub(crate) fn translated(mut self, by: Point) -> Self {
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

/// Where on the turn of the spindle a thread begins.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum ThreadStart {
    /// So many degrees after the one-turn signal, which is waited for; the starts
    /// of a multi-start thread differ in it.
    AtIndex {
        /// Degrees, 0…360.
        degrees: f64,
    },
    /// It goes on in phase from the thread before.
    Continued,
}

/// What makes a thread more than one straight pass of one lead that begins with the
/// one-turn signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum BeyondPass {
    /// The lead changes (G34).
    LeadChange,
    /// A tail leaves it (J, K, No.019).
    RunOut,
    /// Another thread goes on from it without a stop.
    GoesOn,
    /// It begins at another angle (L).
    Start,
}

impl BeyondPass {
    /// In words, with what helps.
    pub fn text(self) -> Message {
        match self {
            Self::LeadChange => say::pass_lead_changes(),
            Self::RunOut => say::pass_run_out(),
            Self::GoesOn => say::pass_goes_on(),
            Self::Start => say::pass_start_beside_index(),
        }
    }
}

/// What an S word (with G96, G97, G50) asks of the spindle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum SpindleCommand {
    /// Stepped speed output S00–S04 (001.4 = 0), with the PLC handshake.
    Step(u8),
    /// Constant rotational speed, r/min (G97).
    Speed(f64),
    /// Constant surface speed, m/min (G96); radius from the programmed X.
    Surface(f64),
    /// Highest speed under G96, r/min (G50 S); zero stops.
    Limit(f64),
}

/// What kind of motion a piece of path was.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum MoveKind {
    /// Rapid.
    Rapid,
    /// Straight cut.
    Feed,
    /// Clockwise arc, seen with +Z to the right and +X up.
    Clockwise,
    /// Counter-clockwise arc.
    CounterClockwise,
    /// Cut tied to the angle of the spindle.
    Thread,
    /// The tail that leaves a thread.
    RunOut,
    /// A wait without motion.
    Dwell,
}

impl MoveKind {
    /// The kind of an arc, seen with +Z to the right and +X up.
    pub const fn arc(clockwise: bool) -> Self {
        if clockwise {
            Self::Clockwise
        } else {
            Self::CounterClockwise
        }
    }

    /// Its name in `--moves` and in the cases.
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

    /// Whether the spindle angle drives it.
    pub const fn is_thread(self) -> bool {
        matches!(self, Self::Thread | Self::RunOut)
    }
}

/// A piece of motion as it was carried out, in the *program's* coordinates
/// (radius, without tool offset). Interpreted by the preview, executed by the
/// control: both report the same.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ExecutedMove {
    /// The block it comes from.
    pub source: Source,
    /// Kind of motion.
    pub kind: MoveKind,
    /// Start point.
    pub from: Point,
    /// End point.
    pub to: Point,
    /// Centre of an arc.
    pub center: Option<Point>,
    /// Commanded feed of a cut.
    pub feed: Option<Feed>,
    /// Machine time when it began, s.
    pub start_s: f64,
    /// How long it took, s.
    pub duration_s: f64,
    /// What held while it was made.
    pub conditions: Conditions,
}

/// What holds while a move is made, besides its path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Conditions {
    /// Tool in the working position, 0 = none.
    pub tool: u8,
    /// Offset number in force, 0 = none.
    pub offset: u8,
    /// The coordinate frame.
    pub frame: Frame,
    /// Speed of the spindle when it begins, r/min; 0 = it stands.
    pub rpm: f64,
    /// How a thread follows the angle of the spindle.
    pub thread: Option<ThreadPhase>,
    /// Which of its coordinates are not known.
    #[serde(default, skip_serializing_if = "Unplaced::is_none")]
    pub unplaced: Unplaced,
}

/// Coordinates of a move that lead to or from a machine zero whose position to the work
/// is unknown: numbers are computed for them, but they say nothing about the part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Unplaced {
    /// Axes of the start point.
    pub from: PerAxis<bool>,
    /// Axes of the end point.
    pub to: PerAxis<bool>,
}

impl Unplaced {
    /// Whether all coordinates are known.
    pub const fn is_none(&self) -> bool {
        !(self.from.x || self.from.z || self.to.x || self.to.z)
    }
}

/// How a thread follows the angle of the spindle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ThreadPhase {
    /// The axis its lead counts on.
    pub long: Axis,
    /// mm per revolution and revolution.
    pub increase: f64,
    /// Where on the turn it begins.
    pub start: ThreadStart,
}

impl Conditions {
    /// Of a command in a frame, with the spindle at a speed.
    #[inline]
    pub(crate) fn of(command: &Command, frame: &Frame, rpm: f64) -> Self {
        let thread = match command.action {
            Action::Thread {
                long,
                increase,
                start,
                ..
            } => Some(ThreadPhase {
                long,
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
            thread,
            unplaced: Unplaced::default(),
        }
    }
}
