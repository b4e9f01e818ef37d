//! The spindle as a board measures it by its index signal.

use super::BoardDrives;
use crate::alarm::{Alarm, number};
use crate::spindle::SpindleTurn;
use gsk_link::{MissingForThreads, TapCapability, ThreadCapability};
use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

/// The measured spindle during a tick, at the time at which the board executes the tick's
/// motion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct BoardSpindle {
    /// Measured spindle speed, r/min; negative in reverse.
    pub rpm: f64,
    /// Spindle angle before and after the tick.
    pub turn: SpindleTurn,
    /// Whether the index signal comes during the tick.
    pub index_passed: bool,
    /// Whether M03 or M04 is commanded.
    pub is_commanded: bool,
    /// Greatest difference between recent revolutions of the spindle, as a fraction of
    /// their mean; `None` if unknown.
    pub variation: Option<f64>,
    /// Fault of the spindle during a thread; `None` without one.
    pub fault: Option<SpindleFault>,
}

/// A fault of the spindle that makes a thread invalid.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum SpindleFault {
    /// The index signal came this many turns away from the angle that the thread requires.
    Deviates(f64),
    /// The speed changed by more than No.106 allows, to this value in r/min.
    Fluctuates(f64),
    /// The index signal no longer arrives.
    Lost,
}

impl SpindleFault {
    pub(crate) fn to_alarm(self) -> Alarm {
        Alarm::new(number::SPEED_FLUCTUATES).with_detail(match self {
            Self::Deviates(turns) => say::index_beside_thread(turns * 100.0),
            Self::Fluctuates(rpm) => say::spindle_at_speed(rpm),
            Self::Lost => say::index_gone(),
        })
    }
}

/// Returns the message that tapping (`tapping`) or feed per revolution needs a spindle with an
/// index signal, and what the board lacks.
pub(crate) fn spindle_required_message(board: &BoardDrives, tapping: bool) -> Message {
    let needed = if tapping {
        say::tapping()
    } else {
        say::cannot_feed_per_revolution()
    };
    if tapping && board.taps == TapCapability::OldFirmware {
        return say::needs_newer_firmware(needed);
    }
    match board.threads {
        ThreadCapability::None(MissingForThreads { index: true, .. }) => {
            say::needs_spindle_index_unwired(needed)
        }
        ThreadCapability::Followed if tapping => say::needs_spindle_braking(needed),
        _ => say::needs_spindle(needed),
    }
}
