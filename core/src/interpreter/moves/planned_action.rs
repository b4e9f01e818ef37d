//! The actions of a block, one at a time.

use crate::command::Action;

/// An action of a block, and whether single block stops after it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PlannedAction {
    pub(crate) action: Action,
    /// Whether single block stops after the action, even inside the block.
    pub(crate) is_stop: bool,
}

impl PlannedAction {
    /// An action with a stop of single block after it.
    pub(crate) const fn with_stop(action: Action) -> Self {
        Self {
            action,
            is_stop: true,
        }
    }

    /// An action without a stop of single block after it.
    pub(crate) const fn without_stop(action: Action) -> Self {
        Self {
            action,
            is_stop: false,
        }
    }
}
