//! How the switches of a reference return are wired to a board.

/// Inputs of one axis at the board that a reference return can use.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ZeroWiring {
    /// Whether the deceleration switch is wired.
    pub has_deceleration_switch: bool,
    /// Whether the zero signal of the drive is wired.
    pub has_zero_signal: bool,
    /// Whether the limit switch is wired.
    pub has_limit_switch: bool,
    /// Whether the limit switch is operated now.
    pub is_on_limit: bool,
    /// Distance past the switch edge before the axis reverses, or off the limit switch, mm.
    pub pull_off_mm: f64,
    /// Machine coordinate at that position when the limit switch is the reference, mm.
    pub home_mm: f64,
}
