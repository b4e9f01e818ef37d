//! Real-time commands: single characters that act at once, wherever the board is in its
//! lines, and that its receive buffer does not count.

/// Asks for a status report.
pub(super) const STATUS_QUERY: u8 = b'?';
/// Feed hold: the board brakes and keeps its position.
pub(super) const FEED_HOLD: u8 = b'!';
/// Goes on behind a hold; the link never sends it.
pub(super) const CYCLE_START: u8 = b'~';
/// Ctrl-X, soft reset: the board drops everything and starts anew.
pub(super) const SOFT_RESET: u8 = 0x18;
