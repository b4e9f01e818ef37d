//! What goes on beside the window, each in a thread of its own.

use std::io;
use std::thread::{self, JoinHandle};

use crossbeam::channel::{Receiver, RecvError, RecvTimeoutError};
use gsk_core::preview::WorkBudget;
use web_time::{Duration, Instant};

/// A thread of its own looks a program through: the caller alone limits its work.
pub const LARGEST_LOOK: WorkBudget = WorkBudget {
    moves: u64::MAX,
    work: u64::MAX,
    motionless: u64::MAX,
};

/// Something that takes its turns until it is over.
#[derive(Debug)]
pub struct Turning(JoinHandle<()>);

impl Turning {
    /// Whether it is not over yet.
    pub fn goes_on(&self) -> bool {
        !self.0.is_finished()
    }

    /// Waits until it is over; whether it ended well.
    pub fn finish(self) -> bool {
        self.0.join().is_ok()
    }
}

/// Lets something take its turns in a thread of its own: one after the other, as long
/// as they return `true`. It waits for its work inside, in [`receive`].
///
/// # Errors
/// The system gives no thread.
pub fn turn(name: &str, mut one: impl FnMut() -> bool + Send + 'static) -> io::Result<Turning> {
    let thread = thread::Builder::new().name(name.to_owned());
    let turns = move || while one() {};
    thread.spawn(turns).map(Turning)
}

/// Does something once in a thread of its own.
///
/// # Errors
/// The system gives no thread.
pub fn beside(name: &str, job: impl FnOnce() + Send + 'static) -> io::Result<()> {
    let thread = thread::Builder::new().name(name.to_owned());
    thread.spawn(job).map(drop)
}

/// Waits within a turn for the next piece of work; `until`: no longer than so.
///
/// # Errors
/// None has come; or none can come any more.
pub fn receive<T>(from: &Receiver<T>, until: Option<Instant>) -> Result<T, RecvTimeoutError> {
    match until {
        Some(until) => from.recv_deadline(until),
        None => from
            .recv()
            .map_err(|RecvError| RecvTimeoutError::Disconnected),
    }
}

/// Waits for what somebody else answers in his turn, no longer than so.
pub fn answer<T>(from: &Receiver<T>, longest: Duration) -> Option<T> {
    from.recv_timeout(longest).ok()
}
