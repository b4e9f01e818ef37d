//! What a block gives out at a time.

use crate::command::Action;

/// One action of a block.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Emission {
    pub(crate) action: Action,
    /// Single block stops after it, even inside the block.
    pub(crate) stops: bool,
}

impl Emission {
    /// An action after which single block stops.
    pub(crate) const fn stopping(action: Action) -> Self {
        Self {
            action,
            stops: true,
        }
    }

    /// An action inside its block.
    pub(crate) const fn passing(action: Action) -> Self {
        Self {
            action,
            stops: false,
        }
    }
}
