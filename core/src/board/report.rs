//! What happens at the board, as the control is told of it.

use crate::alarm::Alarm;
use crate::units::{Axis, PerAxis, Point, Pulses};
use gsk_link::Uncertainty;

/// Something that has happened; the control reacts at the begin of its next tick.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum BoardReport {
    /// All motion ends here and now.
    Halted,
    /// The same, and a running program ends, too; which alarm says so comes later.
    Stopped,
    /// The board has stopped the axes at a switch that was waited for: where, is to come.
    Paused,
    /// The slides came to stand at this count, which may not be where the control is.
    StandsAt(PerAxis<Pulses>),
    /// The motion of the last tick was not taken: the slides stand here, where they were.
    NotTaken(PerAxis<Pulses>),
    /// A fault. That of a pass of a thread names the block which was begun last.
    Alarm {
        /// It goes on to say where the slides stand.
        alarm: Alarm,
        /// A pass of a thread was under way.
        in_pass: bool,
    },
    /// A fault that stays whatever RESET does, until [`CauseGone`](Self::CauseGone).
    Standing(Alarm),
    /// Whether the cause of the standing alarm is still there is asked anew.
    CauseGone,
    /// The board is there, is the right one and is set as it must be: nothing begins by
    /// itself, and what was wrong with it is forgotten.
    Opened,
    /// Nobody knows any more where the slides stand.
    ReferenceLost {
        /// Where the axes could have moved on: an alarm says so.
        told: bool,
    },
    /// An axis stands where its switch was met.
    Reached(Axis),
    /// The board stands off the switches of these axes.
    Returned {
        /// The axes.
        axes: PerAxis<bool>,
        /// Their machine coordinates there.
        at: Point,
    },
    /// A fault that has nothing to do with where the slides stand.
    Failed(Alarm),
    /// The returns under way end; the alarm says why.
    ReturnsAbandoned,
    /// It cannot take the pass that waits.
    PassRefused(Alarm),
    /// It has taken the pass that waited for it.
    PassBegan,
    /// It stands at the end of its pass.
    PassEnded(PerAxis<Pulses>),
}

/// What is known of a standstill.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Settled {
    /// The board has reported a position since it was opened.
    pub reported: bool,
    /// Why the position is not certain.
    pub uncertainty: Option<Uncertainty>,
}
