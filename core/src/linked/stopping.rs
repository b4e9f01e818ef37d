//! The kind of stop under way at the board.

/// What the link waits for until the board reports the position at which it stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum StopInProgress {
    /// No stop is under way.
    None,
    /// The control stops the board and continues from the position where it stops.
    Flushing,
    /// The board stops the axes on its own.
    ByBoard,
    /// The board stops the axes at a switch that the control waits for.
    AtSwitch,
}

impl StopInProgress {
    /// Whether no stop is under way.
    pub(super) fn is_none(self) -> bool {
        self == Self::None
    }

    /// Notes that the control stops the board.
    pub(super) const fn flush(&mut self) {
        if matches!(self, Self::None) {
            *self = Self::Flushing;
        }
    }

    /// Ends the wait for a stop by the control. A stop that the board began stays.
    pub(super) const fn end_flush(&mut self) {
        if matches!(self, Self::Flushing) {
            *self = Self::None;
        }
    }

    /// Notes that the board stops the axes on its own; `reached`: at a switch that the
    /// control waits for. Returns whether that switch is the only reason.
    pub(super) fn halt(&mut self, reached: bool) -> bool {
        let at_switch = reached && self.is_none();
        *self = if at_switch {
            Self::AtSwitch
        } else {
            Self::ByBoard
        };
        at_switch
    }

    /// Ends the stop and returns its kind: the board has stopped.
    pub(super) const fn take(&mut self) -> Self {
        core::mem::replace(self, Self::None)
    }
}
