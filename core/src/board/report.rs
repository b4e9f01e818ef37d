//! Events at the board, as the control receives them.

use crate::alarm::Alarm;
use crate::units::{Axis, PerAxis, Point, Pulses};
use gsk_link::Uncertainty;

/// An event at the board; the control handles it at the start of its next tick.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum BoardReport {
    /// All motion ended at the current position.
    MotionEnded,
    /// All motion ended and the program stops. The alarm that names the reason follows.
    RunStopped,
    /// The board stopped the axes at a switch that the control waits for. The position
    /// follows.
    StoppedAtSwitch,
    /// The slides stopped at this count, which may differ from the control's.
    StoppedAt(PerAxis<Pulses>),
    /// The board rejected the motion of the last tick: the slides are still at this count.
    MotionRejected(PerAxis<Pulses>),
    /// A fault. If a thread pass was under way, the alarm names the block that began last.
    Alarm {
        /// The alarm; its detail later also names the position of the slides.
        alarm: Alarm,
        /// Whether a thread pass was under way.
        in_pass: bool,
    },
    /// A fault that RESET does not clear, until [`CauseRecheck`](Self::CauseRecheck).
    PersistentAlarm(Alarm),
    /// The control checks again whether the cause of the persistent alarm is gone.
    CauseRecheck,
    /// The board is connected, identified and configured. Earlier faults are cleared, and
    /// no motion starts automatically.
    BoardReady,
    /// The position of the slides is unknown from now on.
    ReferenceLost {
        /// Whether an alarm reports it to the operator, because the axes could have
        /// continued.
        raise_alarm: bool,
    },
    /// An axis stopped at its switch.
    SwitchReached(Axis),
    /// The board has homed and moved off the switches of these axes.
    Homed {
        /// Axes that have homed.
        axes: PerAxis<bool>,
        /// Machine coordinates of the axes after homing.
        at: Point,
    },
    /// A fault that does not concern the position of the slides.
    PositionlessFault(Alarm),
    /// The reference returns under way end; an alarm names the reason.
    ReturnsAbandoned,
    /// The board cannot cut the pass that waits for it.
    PassRefused(Alarm),
    /// The board has started the pass that waited for it.
    PassStarted,
    /// The board has stopped at the end of its pass, at this count.
    PassEnded(PerAxis<Pulses>),
}

/// What the board knows about the position at a standstill.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Standstill {
    /// Whether the board has reported a position since the connection was opened.
    pub position_reported: bool,
    /// Why the position is uncertain; `None`: it is certain.
    pub uncertainty: Option<Uncertainty>,
}
