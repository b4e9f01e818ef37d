//! Drives real axes through a pulse board on a serial line.
//!
//! ```text
//!   kernel ──samples──► link ──bytes──► board ──pulses──► drives
//!   kernel ◄──events─── link ◄──bytes── board ◄─switches─
//! ```
//!
//! The link reads no clock and opens no port: the caller passes bytes and the host time,
//! the link returns bytes and events. The kernel's interpolator plans all motion; the
//! board repeats it with a delay. The board never holds more motion than the lookahead:
//! this bounds the delay of each stop. The link queries what the board has executed and
//! assumes nothing.

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
pub mod uf2;
mod wires;

use core::time::Duration;

use gsk_messages::{Message, say};
use gsk_units::{Axis, PerAxis, Pulses, alarm};

pub use backend::{Backend, Link};
pub use board::{
    BoardInfo, BoardOutputs, EncoderReading, MissingForThreads, Pins, PulseRates, SpindleDirection,
    SpindleView, TapCapability, ThreadCapability, Traffic,
};
pub use config::{FaultyLinkConfig, HomeConfig, LineConfig, LinkConfig, LinkConfigError, Protocol};
pub use drives::{AxisRates, Drives};
pub use position::Uncertainty;
pub use wires::{AxisEncoderConfig, LinkAxis, LinkIo};

/// Monotonic time of the host since an arbitrary start.
pub type HostTime = Duration;

/// Time of commanded motion since the link was opened: the kernel's time axis.
pub type RunTime = Duration;

/// The state of the connection to the board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LinkState {
    /// No port is open; there is no connection to a board.
    Off,
    /// The port is open, no byte has been received.
    Opening,
    /// The link queries the firmware of the board.
    Identify,
    /// The link reads the settings of the board and compares them.
    Configure,
    /// The board is ready, but the position of the slides is unknown.
    Locked,
    /// The position is known and no motion is queued.
    Ready,
    /// Motion is queued or being executed.
    Moving,
    /// The board is homing with its own switches.
    Homing,
    /// The link stops the axes and then reads the board's count.
    Verify,
    /// A limit switch, a drive alarm or the emergency stop stopped the board.
    Tripped,
    /// The board or the protocol failed.
    Fault,
    /// The board no longer answers, or the port has failed.
    Lost,
}

impl LinkState {
    /// Whether the link accepts motion with a known position in this state.
    pub const fn takes_motion(self) -> bool {
        matches!(self, Self::Ready | Self::Moving)
    }

    /// Returns the English name of the state, for the link page.
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

/// The commanded position of the axes at the end of a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    /// Time at which the axes reach the position.
    pub end: RunTime,
    /// Commanded position, in whole command pulses.
    pub pulses: PerAxis<Pulses>,
    /// The position before rounding, in units of 1/[`FINE`] pulse. Rounded to whole pulses it gives
    /// `pulses`.
    pub fine: PerAxis<i64>,
}

/// Number of fine units per pulse. A board with timed steps gets the time of each pulse from
/// the fine position.
pub const FINE: i64 = 65_536;

impl Sample {
    /// Creates a sample whose position is exactly at whole pulses; the board then spaces the pulses
    /// of the tick evenly.
    pub const fn new(end: RunTime, pulses: PerAxis<Pulses>) -> Self {
        Self {
            end,
            pulses,
            fine: PerAxis::new(pulses.x.0 * FINE, pulses.z.0 * FINE),
        }
    }
}

/// How the link stops a board immediately.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// Stops the axes, drops the queued motion and keeps the position.
    Flush,
    /// Dead stop: ends all steps at once; the position is lost.
    Kill,
}

/// An input of a board that the control uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Input {
    /// Input of the limit switches of X.
    LimitX,
    /// Input of the limit switches of Z.
    LimitZ,
    /// Input that senses the emergency stop chain.
    EmergencyStop,
    /// Input for the alarm output of the drives.
    DriveAlarm,
    /// Input of the deceleration switch of X.
    DecelerationX,
    /// Input of the deceleration switch of Z.
    DecelerationZ,
    /// Input for the zero signal (one-turn signal) of the X drive.
    ZeroX,
    /// Input for the zero signal (one-turn signal) of the Z drive.
    ZeroZ,
    /// Input for a contact of the control, X0.0 to X3.7.
    Contact {
        /// Byte of the X address, 0 to 3.
        byte: u8,
        /// Bit of the X address, 0 to 7.
        bit: u8,
    },
}

impl Input {
    /// Returns the axis that the input belongs to; `None` for inputs of the whole machine.
    pub const fn axis(self) -> Option<Axis> {
        match self {
            Self::LimitX | Self::DecelerationX | Self::ZeroX => Some(Axis::X),
            Self::LimitZ | Self::DecelerationZ | Self::ZeroZ => Some(Axis::Z),
            Self::EmergencyStop | Self::DriveAlarm | Self::Contact { .. } => None,
        }
    }
}

/// The state of an awaited input at which the board stops the axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputCondition {
    /// The board stops the axes when the input is operated.
    Operated,
    /// The board stops the axes when the input is released.
    Free,
    /// The level of the input has changed, in either direction, since the link armed the input.
    Changed,
}

/// An input that the board watches: when its condition is met the board stops both axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AwaitedInput {
    /// The watched input; it must belong to an axis.
    pub input: Input,
    /// The state of the input at which the board stops the axes.
    pub until: InputCondition,
    /// Speed of the search, pulses per second. This speed determines the sampling rate: the
    /// board stops before the next pulse.
    pub rate: f64,
}

/// An output of a board, switched in step with the motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Output {
    /// Output that enables the drives, 0 or 1; only the link switches it.
    Enable,
    /// Output that turns the spindle clockwise (M03), 0 or 1.
    SpindleForward,
    /// Output that turns the spindle counterclockwise (M04), 0 or 1.
    SpindleReverse,
    /// Analog output of the spindle speed, 0–10 000 mV.
    SpindleSpeed,
    /// Output that switches the coolant, 0 or 1.
    Coolant,
}

/// An event that the link reports to the kernel.
#[derive(Clone, Debug, PartialEq)]
pub enum LinkEvent {
    /// The link has changed to this state.
    State(LinkState),
    /// The board has executed all motion, and its count agrees with the kernel's.
    Drained,
    /// The axes are being stopped; the rest of the motion is dropped. The next
    /// [`LinkEvent::Position`] reports the position of the stop.
    Halting {
        /// Whether an awaited input of an axis caused the stop.
        reached: bool,
    },
    /// The count of the board at standstill, in the kernel's pulses.
    Position(PerAxis<Pulses>),
    /// The board has finished homing the axes that are `true`.
    Homed(PerAxis<bool>),
    /// This awaited input stopped the axes at this position, in the kernel's pulses.
    Reached(Input, PerAxis<Pulses>),
    /// The operator has turned the handwheel at the board by this number of graduations.
    WheelTurned(i32),
    /// The link reports an alarm for the operator.
    Alarm {
        /// Number in the alarm table, 601–622.
        number: u16,
        /// Message with the cause of the alarm.
        detail: Message,
    },
    /// The dictionary of a board with timed steps was read. To save the time of reading it
    /// again, pass `packed` to [`Backend::add_dictionaries`] at the next opening.
    Learned {
        /// Name of the dictionary: processor and firmware version.
        name: String,
        /// The compressed dictionary, as received.
        packed: Vec<u8>,
    },
    /// This setting of the board differs from the required one.
    Differs(SettingDifference),
}

/// A setting of the board that differs from the required one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SettingDifference {
    /// Grbl's number of the setting, also for boards that use names. Numbers from 1000 on
    /// are settings that Grbl does not have.
    pub number: u16,
    /// Name of the setting in the board's firmware.
    pub name: String,
    /// Value of the setting in the board; `None` if the board does not have the setting.
    pub board: Option<String>,
    /// Value that the setting must have in the board.
    pub wanted: String,
}

/// A straight thread pass of constant lead that the board synchronizes with its spindle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThreadPass {
    /// The start point, in the kernel's pulses: the current position.
    pub from: PerAxis<Pulses>,
    /// The end point, in the kernel's pulses.
    pub end: PerAxis<Pulses>,
    /// Distance along the path per turn of the spindle, mm.
    pub lead: f64,
}

/// A tap that the board makes on the angle of the spindle: Z in to the depth, through the stop and
/// reversal of the spindle, and back to the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TapOrder {
    /// The start point, in the kernel's pulses: the current position.
    pub start: PerAxis<Pulses>,
    /// Distance of Z from the start to the programmed depth, pulses, with the sign of the motion.
    pub depth: f64,
    /// Distance of Z from the start at which the board shuts down, pulses.
    pub bound: f64,
    /// Lead: pulses of Z per turn of the spindle.
    pub lead: f64,
    /// Spindle angle after the index at which the tap begins, degrees.
    pub start_degrees: f64,
    /// Turns of the spindle in which Z reaches the lead.
    pub lead_in_turns: f64,
    /// Share of the lead with which Z begins, 0 to 1.
    pub first_share: f64,
}

/// How the motion of the kernel's next tick depends on the angle of the spindle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThreadPlan {
    /// Spindle speed for which the kernel plans the thread, r/min; 0 if it does not know one.
    pub rpm: f64,
    /// Whether the thread waits for its start angle.
    pub waits: bool,
}

/// Why the link refuses a thread pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PassError {
    /// A pass is refused because the axes are not at standstill.
    NotReady,
    /// A pass is refused because the board does not report the spindle speed.
    Unseen,
    /// A pass is refused because the spindle speed is not constant yet.
    Unsteady,
    /// A pass is refused because the spindle is stopped.
    Standing,
    /// A pass is refused because the spindle is too slow: its one-turn signals come after the
    /// board's time limit.
    Slow {
        /// Current spindle speed, r/min.
        rpm: f64,
        /// Least spindle speed for a pass, r/min.
        least: f64,
    },
    /// A pass is refused because it is too fast: the motors would have to start without
    /// acceleration.
    Fast {
        /// Speed along the pass, mm/min.
        speed: f64,
        /// Greatest speed at which the motors start without acceleration, mm/min.
        most: f64,
    },
    /// A pass is refused because the limit switch of this axis is operated.
    Limit(Axis),
    /// A pass is refused because it is shorter than its acceleration and deceleration together.
    Short {
        /// Length of the pass, mm.
        length: f64,
        /// Length of the acceleration and deceleration together, mm.
        ramps: f64,
    },
    /// A tap is refused because the encoder counts against M03 or M04.
    EncoderReversed,
    /// A tap is refused because Z needs more pulses for its lead than the board can make.
    TapLead,
}

impl PassError {
    /// Returns the alarm number, the cause, and the time for which the kernel retries before
    /// the alarm.
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
            Self::EncoderReversed => (alarm::SPINDLE_ENCODER, say::encoder_counts_backwards(), 1),
            Self::TapLead => (alarm::BOARD_CANNOT, say::tap_pulses_too_many(), 0),
        };
        (number, text, Duration::from_secs(seconds))
    }
}

const fn limit_alarm(axis: Axis) -> u16 {
    match axis {
        Axis::X => alarm::X_BOARD_LIMIT,
        Axis::Z => alarm::Z_BOARD_LIMIT,
    }
}

/// The reason for which the link refuses motion or a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotionRefused {
    /// The link accepts no motion or command in its current state.
    NotReady,
    /// Motion is refused because it needs more pulses per second than the board can make.
    TooFast,
    /// The limit switch of this axis is operated, and the motion leads farther onto the switch,
    /// towards the mechanical end.
    TowardLimit(Axis),
    /// The limit switch of this axis is operated at an unknown end. The axis has moved as far
    /// as it may before the operator checks its position with RESET.
    OnLimit(Axis),
    /// A command is refused because the board has no such input or output.
    NotWired,
    /// The spindle encoder counts against the direction in which the spindle was switched on.
    EncoderReversed,
}

impl MotionRefused {
    /// Returns the alarm number and the cause.
    pub fn to_alarm(self) -> (u16, Message) {
        match self {
            Self::TooFast => (alarm::BOARD_CANNOT, say::board_pulses_too_many()),
            Self::TowardLimit(axis) => (limit_alarm(axis), say::limit_switch_ahead()),
            Self::EncoderReversed => (alarm::SPINDLE_ENCODER, say::encoder_counts_backwards()),
            Self::OnLimit(axis) => (limit_alarm(axis), say::limit_switch_of_unknown_end()),
            Self::NotReady | Self::NotWired => (alarm::LINK_PROTOCOL, say::board_takes_no_motion()),
        }
    }
}
