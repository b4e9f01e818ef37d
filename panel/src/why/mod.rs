//! Explains why a bit, a lamp, a key, an axis or an alarm is in its present state: the chain of
//! rungs, contacts, parameters and key presses that decides it.
//!
//! ```text
//! G8.5 = 0 <- rung 2 does not conduct <- X24.7 = 1: contact of the key [暂停]
//! ```

mod bit_log;
mod chain;
mod ladder_cause;
mod named_places;
mod subject;

pub use bit_log::BitLog;
pub use chain::{CauseChain, CauseLink, CauseTarget};
pub use subject::{CauseSubject, explain};
