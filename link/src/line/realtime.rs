//! Real-time commands: single characters that the board executes immediately. They do not
//! count against its receive buffer.

/// Requests a status report.
pub(super) const STATUS_QUERY: u8 = b'?';
/// Feed hold: the board decelerates and keeps its position.
pub(super) const FEED_HOLD: u8 = b'!';
/// Resumes after a feed hold; the link never sends it.
pub(super) const CYCLE_START: u8 = b'~';
/// Ctrl-X, soft reset: the board drops all motion and restarts.
pub(super) const SOFT_RESET: u8 = 0x18;
