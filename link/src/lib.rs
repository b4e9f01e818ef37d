//! Real drives behind a pulse board on a serial line.
//!
//! ```text
//!   kernel ──samples──► link ──bytes──► board ──pulses──► drives
//!   kernel ◄──events─── link ◄──bytes── board ◄─switches─
//! ```
//!
//! The link reads no clock and opens no port: bytes and the host's time are handed
//! in, bytes and events come out. The kernel's interpolator makes all motion; the
//! board only repeats it a little later, and is never given more than the lookahead,
//! so that every stop has a bound. What the board *has done* is asked, not assumed.

mod backend;
mod board;
mod config;
mod contacts;
mod drives;
mod limits;
pub mod line;
mod pin;
mod position;
mod session;
pub mod step_queue;

use core::time::Duration;

use gsk_messages::{Message, say};
use gsk_units::{Axis, PerAxis, Pulses, alarm};

pub use backend::{Backend, Link};
pub use board::{
    BoardInfo, BoardOutputs, MissingForThreads, Pins, PulseRates, SpindleDirection, SpindleView,
    ThreadCapability, Traffic,
};
pub use config::{
    FaultyLinkConfig, HomeConfig, LineConfig, LinkAxis, LinkConfig, LinkConfigError, LinkIo,
    Protocol,
};
pub use drives::{AxisRates, Drives};
pub use position::Uncertainty;

/// Monotonic time of the host.
pub type HostTime = Duration;

/// Time of commanded motion since the link was opened: the kernel's time axis.
pub type RunTime = Duration;

/// Where the link stands with its board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LinkState {
    /// No port.
    Off,
    /// The port is open, nothing was heard yet.
    Opening,
    /// The board is asked who it is.
    Identify,
    /// Its settings are read and compared.
    Configure,
    /// All is well but nobody knows where the slides stand.
    Locked,
    /// Position known, nothing queued.
    Ready,
    /// Motion is queued or being made.
    Moving,
    /// The board seeks its switches by itself.
    Homing,
    /// The board stands; its count is compared.
    Verify,
    /// A limit or the emergency stop stopped the board.
    Tripped,
    /// The board or the protocol failed.
    Fault,
    /// The board does not answer any more.
    Lost,
}

impl LinkState {
    /// Whether motion may be handed over.
    pub const fn takes_motion(self) -> bool {
        matches!(self, Self::Ready | Self::Moving)
    }

    /// Name on the link page, in English.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Off => "off",
            Self::Opening => "opening",
            Self::Identify => "identify",
            Self::Configure => "configure",
            Self::Locked => "locked",
            Self::Ready => "ready",
            Self::Moving => "moving",
            Self::Homing => "homing",
            Self::Verify => "verify",
            Self::Tripped => "tripped",
            Self::Fault => "fault",
            Self::Lost => "lost",
        }
    }
}

/// The position the axes were commanded to at the end of a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    /// When the axes are to be there.
    pub end: RunTime,
    /// Command pulses, absolute.
    pub pulses: PerAxis<Pulses>,
    /// The same position before it was made whole pulses, in [`FINE`] parts of a
    /// pulse; the count changes half way between two pulses.
    pub fine: PerAxis<i64>,
}

/// Parts of a pulse that tell a board of timed steps when each pulse is due.
pub const FINE: i64 = 65_536;

impl Sample {
    /// Whole pulses only: those of a tick come evenly spaced.
    pub const fn new(end: RunTime, pulses: PerAxis<Pulses>) -> Self {
        Self {
            end,
            pulses,
            fine: PerAxis::new(pulses.x.0 * FINE, pulses.z.0 * FINE),
        }
    }
}

/// How a board is stopped at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// Brake, drop what is queued, keep the position.
    Flush,
    /// Stop dead; the position is lost.
    Kill,
}

/// A switch at a board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Input {
    /// Limit of X.
    LimitX,
    /// Limit of Z.
    LimitZ,
    /// Sense of the emergency stop chain.
    EmergencyStop,
    /// Alarm of the drives.
    DriveAlarm,
    /// Deceleration switch of X.
    DecelerationX,
    /// Deceleration switch of Z.
    DecelerationZ,
    /// Zero signal of X.
    ZeroX,
    /// Zero signal of Z.
    ZeroZ,
    /// A contact of the control, X0.0 to X3.7.
    Contact {
        /// Byte of X.
        byte: u8,
        /// Bit.
        bit: u8,
    },
}

impl Input {
    /// The axis at whose return to the machine zero it may be met.
    pub const fn axis(self) -> Option<Axis> {
        match self {
            Self::LimitX | Self::DecelerationX | Self::ZeroX => Some(Axis::X),
            Self::LimitZ | Self::DecelerationZ | Self::ZeroZ => Some(Axis::Z),
            Self::EmergencyStop | Self::DriveAlarm | Self::Contact { .. } => None,
        }
    }
}

/// What an input has to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputCondition {
    /// Be operated.
    Operated,
    /// Be free.
    Free,
    /// Be another than it was: either edge counts.
    Changed,
}

/// What stops both axes in the board, as soon as the board sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AwaitedInput {
    /// The input; it is one of an axis.
    pub input: Input,
    /// What it has to do.
    pub until: InputCondition,
    /// Pulses a second at which it is sought: no pulse more is made.
    pub rate: f64,
}

/// An output of a board that switches with the motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Output {
    /// Enable of the drives; the link's own.
    Enable,
    /// Spindle clockwise, 0 or 1.
    SpindleForward,
    /// Spindle counterclockwise, 0 or 1.
    SpindleReverse,
    /// Spindle speed, 0–10 000 mV.
    SpindleSpeed,
    /// Coolant, 0 or 1.
    Coolant,
}

/// Something the kernel must hear about.
#[derive(Clone, Debug, PartialEq)]
pub enum LinkEvent {
    /// The state changed.
    State(LinkState),
    /// All motion handed over has been made, and the board's count agrees.
    Drained,
    /// The axes are being stopped at once: nothing that was handed over is made any
    /// more, and the next [`Event::Position`] reports where they stand.
    Halting {
        /// By an input that was waited for.
        reached: bool,
    },
    /// The board's count at a standstill.
    Position(PerAxis<Pulses>),
    /// A board that returns by itself stands off the switches of these axes.
    Homed(PerAxis<bool>),
    /// The input that was waited for stopped the axes in the board, there.
    Reached(Input, PerAxis<Pulses>),
    /// An alarm, with what happened.
    Alarm {
        /// Number in the alarm table, 601–622.
        number: u16,
        /// The cause.
        detail: Message,
    },
    /// What a board of timed steps says it understands was read: it need not be read
    /// again when it is handed in at the next opening.
    Learned {
        /// Processor and version.
        name: String,
        /// As it goes over the wire.
        packed: Vec<u8>,
    },
    /// A setting of the board is not what it has to be.
    Differs(SettingDifference),
}

/// A setting of the board that is not what it has to be.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SettingDifference {
    /// Its number among the settings of Grbl, also where the board calls it otherwise;
    /// from 1000 on what no number of Grbl stands for.
    pub number: u16,
    /// What the board calls it.
    pub name: String,
    /// What the board says, if it has it at all.
    pub board: Option<String>,
    /// What it has to be.
    pub wanted: String,
}

/// A straight cut of one lead that a board makes by itself behind its spindle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThreadPass {
    /// Where it begins: where the axes stand.
    pub from: PerAxis<Pulses>,
    /// Where it ends.
    pub end: PerAxis<Pulses>,
    /// Way along the path a turn of the spindle, mm.
    pub lead: f64,
}

/// Why a pass is not taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PassError {
    /// The axes do not stand yet.
    NotReady,
    /// The board does not report the speed of its spindle.
    Unseen,
    /// Its speed still changes.
    Unsteady,
    /// It stands.
    Standing,
    /// Too slow for the time the board waits, r/min.
    Slow {
        /// Its speed.
        rpm: f64,
        /// What is needed.
        least: f64,
    },
    /// The motors would have to start faster than they can without a ramp, mm/min.
    Fast {
        /// Speed along the pass.
        speed: f64,
        /// What they can.
        most: f64,
    },
    /// A limit switch is operated.
    Limit(Axis),
    /// It ends before it has come to its speed, mm.
    Short {
        /// Length of the pass.
        length: f64,
        /// What coming to the speed and standing again need.
        ramps: f64,
    },
}

impl PassError {
    /// Alarm, cause, and how long it is waited whether it goes.
    pub fn to_alarm(self) -> (u16, Message, Duration) {
        let (number, text, seconds) = match self {
            Self::NotReady => (alarm::LINK_PROTOCOL, say::pass_board_moves(), 20),
            Self::Unseen => (alarm::BOARD_CANNOT, say::pass_spindle_unseen(), 2),
            Self::Unsteady => (alarm::THREAD_SPEED, say::pass_spindle_unsteady(), 20),
            Self::Standing => (alarm::THREAD_SPEED, say::pass_spindle_stands(), 5),
            Self::Slow { rpm, least } => {
                (alarm::THREAD_SPEED, say::pass_spindle_slow(rpm, least), 5)
            }
            Self::Fast { speed, most } => (alarm::BOARD_CANNOT, say::pass_too_fast(speed, most), 0),
            Self::Limit(axis) => (limit_alarm(axis), say::limit_switch_operated(), 0),
            Self::Short { length, ramps } => {
                (alarm::BOARD_CANNOT, say::pass_too_short(length, ramps), 0)
            }
        };
        (number, text, Duration::from_secs(seconds))
    }
}

/// Number of the alarm of a limit switch at the board.
const fn limit_alarm(axis: Axis) -> u16 {
    match axis {
        Axis::X => alarm::X_BOARD_LIMIT,
        Axis::Z => alarm::Z_BOARD_LIMIT,
    }
}

/// Why motion was not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotionRefused {
    /// The state does not allow it.
    NotReady,
    /// The axis would need more pulses a second than the board makes.
    TooFast,
    /// The limit switch of the axis is operated and that way lies its stop.
    TowardLimit(Axis),
    /// The limit switch of the axis is operated, nobody knows on which end, and the piece
    /// is made after which somebody has to look.
    OnLimit(Axis),
    /// The board has no such input or output.
    NotWired,
}

impl MotionRefused {
    /// Alarm and cause.
    pub fn to_alarm(self) -> (u16, Message) {
        match self {
            Self::TooFast => (alarm::BOARD_CANNOT, say::board_pulses_too_many()),
            Self::TowardLimit(axis) => (limit_alarm(axis), say::limit_switch_ahead()),
            Self::OnLimit(axis) => (limit_alarm(axis), say::limit_switch_of_unknown_end()),
            Self::NotReady | Self::NotWired => (alarm::LINK_PROTOCOL, say::board_takes_no_motion()),
        }
    }
}
