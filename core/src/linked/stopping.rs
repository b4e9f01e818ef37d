//! A stop of the board that is under way.

/// What is being waited for until the board says where it has come to stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stopping {
    /// Nothing.
    None,
    /// The control stops the board, and goes on from where that comes to stand.
    Flushing,
    /// The board stops the axes by itself.
    Halting,
    /// It stops them at a switch that was waited for.
    Reaching,
}

impl Stopping {
    /// Whether nothing is being stopped.
    pub(super) fn is_none(self) -> bool {
        self == Self::None
    }

    /// The control stops the board.
    pub(super) const fn flush(&mut self) {
        if matches!(self, Self::None) {
            *self = Self::Flushing;
        }
    }

    /// It waits for that no more; what the board does by itself goes on.
    pub(super) const fn end_flush(&mut self) {
        if matches!(self, Self::Flushing) {
            *self = Self::None;
        }
    }

    /// The board stops the axes by itself, `reached`: at a switch that was waited for.
    /// Whether nothing else stops them.
    pub(super) fn halt(&mut self, reached: bool) -> bool {
        let reaching = reached && self.is_none();
        *self = if reaching {
            Self::Reaching
        } else {
            Self::Halting
        };
        reaching
    }

    /// The board has come to stand: what it was stopped for.
    pub(super) const fn take(&mut self) -> Self {
        core::mem::replace(self, Self::None)
    }
}
