//! Programs: opening files, the start point, and what a running program waits for.

pub(super) mod opening;
pub(super) mod start;
pub(super) mod wait;
