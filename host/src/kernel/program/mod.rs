//! Programs: opening files, breakpoints, the start point, and what a running program waits for.

pub(super) mod breakpoints;
pub(super) mod opening;
pub(super) mod start;
pub(super) mod wait;
