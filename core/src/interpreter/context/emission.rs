//! The actions of a block, one at a time.

use crate::command::Action;

/// An action of a block, with its stop of single block.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Emission {
    pub(crate) action: Action,
    /// Whether single block stops after the action, even inside the block.
    pub(crate) stops: bool,
}

impl Emission {
    /// An action with a stop of single block after it.
    pub(crate) const fn stopping(action: Action) -> Self {
        Self {
            action,
            stops: true,
        }
    }

    /// An action without a stop of single block after it.
    pub(crate) const fn passing(action: Action) -> Self {
        Self {
            action,
            stops: false,
        }
    }
}
