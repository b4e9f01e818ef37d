//! Where the slides stand, how sure that is, and how the kernel's count and the board's
//! are put together.

use gsk_messages::{Message, say};

use crate::session::LinkSession;
use crate::{MotionRefused, RunTime};
use gsk_units::{PerAxis, Pulses};

/// What a back end needs so that its position can be confirmed, doubted and forgotten; no
/// business of who uses it.
pub trait Positioned {
    /// State, time and events.
    fn session(&self) -> &LinkSession;

    /// The same, to be changed.
    fn session_mut(&mut self) -> &mut LinkSession;

    /// From here on the board's count and the kernel's go together.
    ///
    /// # Errors
    /// The board moves, is locked or shut down, or has not said where it stands.
    fn align(&mut self, kernel: PerAxis<Pulses>, at: RunTime) -> Result<(), MotionRefused>;

    /// Nobody knows any more where the slides stand.
    fn lose_position(&mut self, uncertainty: Uncertainty) {
        self.session_mut().lose_position(uncertainty);
    }

    /// The kernel has forgotten its count: the board's says nothing any more.
    fn forget_count(&mut self);
}

/// Why the position of the slides is not certain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Uncertainty {
    /// Not both axes have made their reference return.
    #[default]
    Unreferenced,
    /// The motors were stopped dead in motion.
    StoppedDead,
    /// They were stopped faster than they keep their steps.
    TooFast,
    /// The drives were without power.
    Powerless,
    /// The count is not one of the commanded path.
    OffPath,
    /// The board's count is not the commanded one.
    Differs,
    /// What the board understood of its orders is not certain.
    Misunderstood,
    /// The board was reset: nobody has read its count since.
    Reset,
    /// The board shut down: nobody has read its count since.
    ShutDown,
    /// Nothing was received from the board since.
    Unheard,
    /// Whether the play of the screws was made up for is not known.
    Play,
}

impl Uncertainty {
    /// Behind the emergency stop of the control: its chain cuts the supply of axes that
    /// stand, too.
    pub(crate) const fn killed(moves: bool, in_motion: Self) -> Self {
        if moves { in_motion } else { Self::Powerless }
    }

    /// Whether the board has counted the position, and said so.
    pub const fn is_counted(self) -> bool {
        !matches!(self, Self::ShutDown)
    }

    /// In words.
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
