//! The end that is asked for from outside the program: Ctrl-C, `kill`, the end of the
//! session. Whoever has a board in his hands stops it before he goes.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use gsk_messages::{Message, say};

use crate::platform;

/// Exit code of a program that was ended so.
pub const ENDED: u8 = 130;

/// Signals cannot be heard.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub struct SignalError(io::Error);

impl SignalError {
    /// What is said of it.
    pub fn message(&self) -> Message {
        say::signals_unheard(&self.0)
    }
}

/// Whether the end has been asked for.
#[derive(Clone, Debug, Default)]
pub struct Ending(Arc<AtomicBool>);

impl Ending {
    /// From now on such signals are heard here. Who cannot wait sends a second one: it
    /// ends the program at once.
    ///
    /// # Errors
    /// The system does not let them be heard.
    pub fn heard() -> Result<Self, SignalError> {
        let ending = Self::default();
        platform::hear_ending(&ending.0, ENDED).map_err(SignalError)?;
        Ok(ending)
    }

    /// Asks for the end: the window cannot be used any more.
    pub fn ask(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether the end has been asked for.
    pub fn is_asked(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
