//! The spindle that a board sees by its index.

use super::BoardDrives;
use crate::alarm::{Alarm, number};
use crate::spindle::SpindleTurn;
use gsk_link::{MissingForThreads, ThreadCapability};
use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

/// The spindle in a tick, at the moment at which the board makes its motion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct BoardSpindle {
    /// Speed, r/min; negative in reverse.
    pub rpm: f64,
    /// Angle around the tick.
    pub turn: SpindleTurn,
    /// The index comes by in the tick.
    pub passed: bool,
    /// M03 or M04 is in force.
    pub commanded: bool,
    /// Greatest difference of its periods of late, a part of their mean.
    pub variation: Option<f64>,
    /// What has gone wrong in a thread.
    pub trouble: Option<SpindleTrouble>,
}

/// Why a thread is not what it should be.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum SpindleTrouble {
    /// An index came so far from where the axes were, turns.
    Deviates(f64),
    /// The speed has changed by more than No.106 allows, to so many r/min.
    Fluctuates(f64),
    /// No index comes any more.
    Lost,
}

impl SpindleTrouble {
    pub(crate) fn alarm(self) -> Alarm {
        Alarm::new(number::SPEED_FLUCTUATES).because(match self {
            Self::Deviates(turns) => say::index_beside_thread(turns * 100.0),
            Self::Fluctuates(rpm) => say::spindle_at_speed(rpm),
            Self::Lost => say::index_gone(),
        })
    }
}

/// What needs the spindle's angle or speed, and what is missing for that.
pub(crate) fn needs_spindle(board: &BoardDrives, tapping: bool) -> Message {
    let what = if tapping {
        say::tapping()
    } else {
        say::cannot_feed_per_revolution()
    };
    match board.threads {
        ThreadCapability::None(MissingForThreads { index: true, .. }) => {
            say::needs_spindle_index_unwired(what)
        }
        ThreadCapability::Followed if tapping => say::needs_spindle_braking(what),
        _ => say::needs_spindle(what),
    }
}
