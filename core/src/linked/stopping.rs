//! The kind of stop under way at the board.

/// The stop that is being executed, until the board reports the position at which it stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum StopInProgress {
    /// No stop is being executed.
    None,
    /// The control stops the board and continues from the position where it stops.
    Flushing,
    /// The board stops the axes without an order of the control.
    ByBoard,
    /// The board stops the axes at a switch that the control waits for.
    AtSwitch,
}

impl StopInProgress {
    /// Whether no stop is being executed.
    pub(super) fn is_none(self) -> bool {
        self == Self::None
    }

    /// Records that the control stops the board, unless another stop is being executed.
    pub(super) const fn flush(&mut self) {
        if matches!(self, Self::None) {
            *self = Self::Flushing;
        }
    }

    /// Ends a stop by the control; a stop that the board began is kept.
    pub(super) const fn end_flush(&mut self) {
        if matches!(self, Self::Flushing) {
            *self = Self::None;
        }
    }

    /// Records that the board stops the axes without an order; `reached`: at a switch that
    /// the control waits for. Returns whether that switch is the only reason.
    pub(super) fn halt(&mut self, reached: bool) -> bool {
        let at_switch = reached && self.is_none();
        *self = if at_switch {
            Self::AtSwitch
        } else {
            Self::ByBoard
        };
        at_switch
    }

    /// Returns the kind of stop and ends it; call it when the board has stopped.
    pub(super) const fn take(&mut self) -> Self {
        core::mem::replace(self, Self::None)
    }
}
