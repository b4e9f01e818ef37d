//! Programs: opening files, breakpoints, watches, the start point, and what a running program waits for.

pub(super) mod breakpoints;
pub(super) mod opening;
pub(super) mod start;
pub(super) mod wait;
pub(super) mod watches;
