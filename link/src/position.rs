//! Where the slides stand, how sure that is, and how the kernel's count and the board's
//! are put together.

use crate::session::Session;
use crate::{Refused, RunTime};
use gsk_units::{PerAxis, Pulses};

/// What a back end needs so that its position can be confirmed, doubted and forgotten; no
/// business of who uses it.
pub trait Positioned {
    /// State, time and events.
    fn session(&self) -> &Session;

    /// The same, to be changed.
    fn session_mut(&mut self) -> &mut Session;

    /// From here on the board's count and the kernel's go together.
    ///
    /// # Errors
    /// The board moves, is locked or shut down, or has not said where it stands.
    fn align(&mut self, kernel: PerAxis<Pulses>, at: RunTime) -> Result<(), Refused>;

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
    pub const fn text(self) -> &'static str {
        match self {
            Self::Unreferenced => "not both axes have made their reference return",
            Self::StoppedDead => "the motors were stopped dead and may have lost steps",
            Self::TooFast => "stopped faster than flush_keep_speed the motors may have lost steps",
            Self::Powerless => "the drives were without power",
            Self::OffPath => "that is not on the commanded path",
            Self::Differs => "the board counts another place than was commanded",
            Self::Misunderstood => "the board may have misunderstood its orders",
            Self::Reset => "its last count before it was reset",
            Self::ShutDown => "as it was when the board shut down, which nobody has read",
            Self::Unheard => "the board may have made more since it was heard last",
            Self::Play => "the play of the screws (034, 035) may not be made up for there",
        }
    }
}
