//! The position of the slides: why it may be uncertain, and the alignment of the kernel's
//! count with the board's.

use gsk_messages::{Message, say};

use crate::session::LinkSession;
use crate::{MotionRefused, RunTime};
use gsk_units::{PerAxis, Pulses};

/// The functions of a backend that confirm, invalidate and forget its position. Callers
/// use [`Backend`](crate::Backend) instead.
pub trait Positioned {
    /// Returns state, time and events of the connection.
    fn session(&self) -> &LinkSession;

    /// Returns state, time and events of the connection, mutable.
    fn session_mut(&mut self) -> &mut LinkSession;

    /// Aligns the board's current count with the kernel's count `kernel`, in pulses, at the kernel
    /// time `at`.
    ///
    /// # Errors
    /// The board moves, is locked or shut down, or has not reported its position.
    fn align(&mut self, kernel: PerAxis<Pulses>, at: RunTime) -> Result<(), MotionRefused>;

    /// Marks the position as uncertain for this reason; an earlier reason is kept.
    fn lose_position(&mut self, uncertainty: Uncertainty) {
        self.session_mut().lose_position(uncertainty);
    }

    /// Discards the alignment of the board's count with the kernel's.
    fn forget_count(&mut self);
}

/// The reason for which the position of the slides is uncertain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Uncertainty {
    /// The position is uncertain because an axis has not made its reference return.
    #[default]
    Unreferenced,
    /// The position is uncertain because the axes were stopped dead during motion.
    StoppedDead,
    /// The position is uncertain because the axes were stopped from a speed at which the motors may
    /// lose steps.
    TooFast,
    /// The position is uncertain because the drives have lost power.
    Powerless,
    /// The position is uncertain because the board stopped off the commanded path.
    OffPath,
    /// The position is uncertain because the board's count differs from the commanded position.
    Differs,
    /// The position is uncertain because of a protocol error: the board may have misread commands.
    Misunderstood,
    /// The position is uncertain because the board was reset and its count has not been read since.
    Reset,
    /// The position is uncertain because the board shut down and its count has not been read since.
    ShutDown,
    /// The position is uncertain because the board no longer answers.
    Unheard,
    /// The position is uncertain because the axes stopped while backlash compensation was possibly
    /// not complete.
    Play,
}

impl Uncertainty {
    /// Returns the reason after an emergency stop: `in_motion` if the axes move, otherwise
    /// [`Uncertainty::Powerless`], because the emergency stop chain cuts the power of the drives at
    /// standstill, too.
    pub(crate) const fn killed(moves: bool, in_motion: Self) -> Self {
        if moves { in_motion } else { Self::Powerless }
    }

    /// Whether the uncertain position was counted by the board; after a shutdown it is an estimate
    /// of the link.
    pub const fn is_counted(self) -> bool {
        !matches!(self, Self::ShutDown)
    }

    /// Returns the text for the operator that explains why the position is uncertain.
    pub fn text(self) -> Message {
        match self {
            Self::Unreferenced => say::position_unreferenced(),
            Self::StoppedDead => say::position_stopped_dead(),
            Self::TooFast => say::position_stopped_fast(),
            Self::Powerless => say::position_powerless(),
            Self::OffPath => say::position_off_path(),
            Self::Differs => say::position_differs(),
            Self::Misunderstood => say::position_misunderstood(),
            Self::Reset => say::position_before_reset(),
            Self::ShutDown => say::position_shut_down(),
            Self::Unheard => say::position_unheard(),
            Self::Play => say::position_play(),
        }
    }
}
