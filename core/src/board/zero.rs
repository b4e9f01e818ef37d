//! How the switches of a reference return are wired to a board.

/// Inputs of one axis at the board that a reference return can use.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ZeroWiring {
    /// Whether the deceleration switch is wired.
    pub switch: bool,
    /// Whether the zero signal of the drive is wired.
    pub signal: bool,
    /// Whether the limit switch is wired.
    pub limit: bool,
    /// Whether the limit switch is operated now.
    pub on_limit: bool,
    /// Distance past the switch edge before the axis reverses, or off the limit switch, mm.
    pub off: f64,
    /// Machine coordinate at that position when the limit switch is the reference, mm.
    pub at: f64,
}
