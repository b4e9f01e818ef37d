//! Tests the link with a board of timed steps against the board's twin, in virtual time:
//! nothing moves without a command, every stop is known, the counts agree to the pulse.

mod bench;
mod dialogue;
mod faults;
pub mod lathe;
mod lines;
mod linked;
pub mod machine;
mod motion;
pub mod restart;
mod returns;
mod shutdowns;
mod speeds;
mod stops;
mod threads;
mod trips;
