//! Real-time commands: single characters that the board executes immediately. They do not
//! count against its receive buffer.

/// Real-time character that requests a status report.
pub(super) const STATUS_QUERY: u8 = b'?';
/// Real-time character for feed hold: the board decelerates and keeps its position.
pub(super) const FEED_HOLD: u8 = b'!';
/// Real-time character that resumes after a feed hold; the link never sends it.
pub(super) const CYCLE_START: u8 = b'~';
/// Real-time character for a soft reset (Ctrl-X): the board drops all motion and restarts.
pub(super) const SOFT_RESET: u8 = 0x18;
