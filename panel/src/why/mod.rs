//! Explains why a bit, a lamp, a key, an axis or an alarm is as it is: the chain of rungs,
//! contacts, interlocks and parameters that decides it.
//!
//! ```text
//!   Y5.3 is 0 <- rung 31 does not conduct <- R12.4 is 0 <- rung 8 <- X20.1 is 0: key
//! ```

mod bit_log;
mod chain;
mod ladder_cause;
mod subject;

pub use bit_log::BitLog;
pub use chain::{CauseChain, CauseLink, CauseFact};
pub use subject::CauseSubject;

use crate::emulator::Emulator;

/// Explains the present state of a subject. `log` knows when bits have changed.
pub fn explain(emulator: &Emulator, subject: CauseSubject, log: &BitLog) -> CauseChain {
    subject::explain(emulator, subject, log)
}
