//! How the switches of a machine zero are wired to a board.

/// What an axis has at the board to return to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ZeroWiring {
    /// Deceleration switch, zero signal, limit switch.
    pub switch: bool,
    pub signal: bool,
    pub limit: bool,
    /// The limit switch is operated.
    pub on_limit: bool,
    /// How far it goes past the edge before it turns, or off the limit switch, mm.
    pub off: f64,
    /// Machine coordinate there, when the limit switch is the reference.
    pub at: f64,
}
