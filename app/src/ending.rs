//! Handles termination signals (Ctrl-C, `kill`, end of the session): the thread that
//! drives a board stops it before the process exits.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use gsk_messages::{Message, say};

use crate::platform;

/// Exit code after a termination signal.
pub const ENDED: u8 = 130;

/// The signal handlers cannot be installed.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub struct SignalError(io::Error);

impl SignalError {
    /// Returns the message for the operator.
    pub fn message(&self) -> Message {
        say::signals_unheard(&self.0)
    }
}

/// Shared flag: the end of the program is requested.
#[derive(Clone, Debug, Default)]
pub struct Ending(Arc<AtomicBool>);

impl Ending {
    /// Installs the signal handlers. A second signal ends the program at once.
    ///
    /// # Errors
    /// The system refuses the handlers.
    pub fn heard() -> Result<Self, SignalError> {
        let ending = Self::default();
        platform::hear_ending(&ending.0, ENDED).map_err(SignalError)?;
        Ok(ending)
    }

    /// Requests the end of the program: the window cannot be used any more.
    pub fn ask(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether the end of the program is requested.
    pub fn is_asked(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
