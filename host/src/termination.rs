//! Handles termination signals (Ctrl-C, `kill`, end of the session): the thread that
//! drives a board stops it before the process exits.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use gsk_messages::{Message, say};

use crate::platform;

/// Exit code of the program after a termination signal.
pub const TERMINATED_EXIT_CODE: u8 = 130;

/// The error for signal handlers that cannot be installed.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub struct SignalError(io::Error);

impl SignalError {
    /// Returns the message for the operator: the signal handlers cannot be installed.
    pub fn message(&self) -> Message {
        say::signals_unheard(&self.0)
    }
}

/// A shared flag that requests the end of the program.
#[derive(Clone, Debug, Default)]
pub struct TerminationFlag {
    is_requested: Arc<AtomicBool>,
    has_crashed: Arc<AtomicBool>,
}

impl TerminationFlag {
    /// Installs the signal handlers. A second signal ends the program at once.
    ///
    /// # Errors
    /// The system refuses the handlers.
    pub fn install_signal_handlers() -> Result<Self, SignalError> {
        let flag = Self::default();
        platform::register_termination_flag(&flag.is_requested, TERMINATED_EXIT_CODE)
            .map_err(SignalError)?;
        Ok(flag)
    }

    /// Requests the end of the program, because the window cannot be used any more.
    pub fn request(&self) {
        self.is_requested.store(true, Ordering::Relaxed);
    }

    /// Requests the end of the program after a panic: its recording remains without an end.
    pub fn report_crash(&self) {
        self.has_crashed.store(true, Ordering::Relaxed);
        self.request();
    }

    /// Returns whether the program ends because of a panic.
    pub fn has_crashed(&self) -> bool {
        self.has_crashed.load(Ordering::Relaxed)
    }

    /// Returns whether the end of the program is requested.
    pub fn is_requested(&self) -> bool {
        self.is_requested.load(Ordering::Relaxed)
    }
}
