//! Events at the board, as the control receives them.

use crate::alarm::Alarm;
use crate::units::{Axis, PerAxis, Point, Pulses};
use gsk_link::Uncertainty;

/// An event at the board; the control handles it at the start of its next tick.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum BoardReport {
    /// All motion ended at the current position of the slides.
    MotionEnded,
    /// All motion ended and the program stops. The report of the alarm with the reason
    /// follows.
    RunStopped,
    /// The board stopped the axes at a switch that the control waits for. The report of
    /// their position follows.
    StoppedAtSwitch,
    /// The slides stopped at this count, which may differ from the control's.
    StoppedAt(PerAxis<Pulses>),
    /// The board rejected the motion of the last tick. The slides are still at this pulse
    /// count.
    MotionRejected(PerAxis<Pulses>),
    /// A fault at the board that raises an alarm.
    Alarm {
        /// The alarm; its detail later also names the position of the slides.
        alarm: Alarm,
        /// Whether a thread pass was being executed; the alarm then names the block that began
        /// last.
        in_pass: bool,
    },
    /// A fault whose alarm stays in force after RESET, until
    /// [`CauseRecheck`](Self::CauseRecheck).
    PersistentAlarm(Alarm),
    /// Drops the persistent alarm: the control checks again whether its cause is gone.
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
    /// This axis stopped at the switch that its return waited for.
    SwitchReached(Axis),
    /// The board has homed and moved off the switches of these axes.
    Homed {
        /// Axes that the board has homed.
        axes: PerAxis<bool>,
        /// Machine coordinates of both axes after homing, mm, X as a radius.
        at: Point,
    },
    /// A fault that does not concern the position of the slides.
    PositionlessFault(Alarm),
    /// All reference returns in progress are abandoned; another report gives the alarm.
    ReturnsAbandoned,
    /// The board cannot cut the pass or make the tap that waits for it, for the reason in this alarm.
    PassRefused(Alarm),
    /// The board has started the pass that waited for it.
    PassStarted,
    /// The board has stopped at the end of its pass, at this pulse count.
    PassEnded(PerAxis<Pulses>),
    /// The board has started the tap that waited for it.
    TapStarted,
    /// The board is back at the start of its tap, at this pulse count.
    TapEnded(PerAxis<Pulses>),
}

/// What the board knows about the position of the slides at a standstill.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Standstill {
    /// Whether the board has reported a position since the connection was opened.
    pub position_reported: bool,
    /// The reason why the position is uncertain; `None` if it is certain.
    pub uncertainty: Option<Uncertainty>,
}
