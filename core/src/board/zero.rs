//! How the switches of a reference return are wired to a board.

/// Switches of one axis that are wired to the board for a reference return.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ZeroWiring {
    /// Whether a deceleration switch is wired to the board.
    pub has_deceleration_switch: bool,
    /// Whether the zero signal of the drive is wired.
    pub has_zero_signal: bool,
    /// Whether a limit switch is wired to the board.
    pub has_limit_switch: bool,
    /// Whether the limit switch is currently pressed.
    pub is_on_limit: bool,
    /// Distance that the axis moves past the edge of its switch, or off its limit switch,
    /// mm.
    pub pull_off_mm: f64,
    /// Machine coordinate after the return when the limit switch is the reference, mm, X as
    /// a radius.
    pub home_mm: f64,
}
