//! Background work beside the window, each task in a separate thread.

use std::io;
use std::thread::{self, JoinHandle};

use crossbeam::channel::{Receiver, RecvError, RecvTimeoutError};
use gsk_core::preview::WorkBudget;
use web_time::{Duration, Instant};

/// Limit of a preview: unlimited on a computer, where the preview runs in a separate thread
/// and its caller limits the work.
pub const LARGEST_PREVIEW: WorkBudget = WorkBudget {
    moves: u64::MAX,
    work: u64::MAX,
    motionless: u64::MAX,
};

/// Handle of a task that takes turns in a thread.
#[derive(Debug)]
pub struct TaskHandle(JoinHandle<()>);

impl TaskHandle {
    /// Whether the task is still running.
    pub fn is_running(&self) -> bool {
        !self.0.is_finished()
    }

    /// Waits until the task has ended; returns false if it panicked.
    pub fn finish(self) -> bool {
        self.0.join().is_ok()
    }
}

/// Starts a task in a thread that calls `take_turn` until it returns `false`. The task waits
/// for its work in [`receive`].
///
/// # Errors
/// The system starts no thread.
pub fn start_task(
    name: &str,
    mut take_turn: impl FnMut() -> bool + Send + 'static,
) -> io::Result<TaskHandle> {
    let thread = thread::Builder::new().name(name.to_owned());
    let turns = move || while take_turn() {};
    thread.spawn(turns).map(TaskHandle)
}

/// Runs a job once in a separate thread.
///
/// # Errors
/// The system starts no thread.
pub fn run_in_background(name: &str, job: impl FnOnce() + Send + 'static) -> io::Result<()> {
    let thread = thread::Builder::new().name(name.to_owned());
    thread.spawn(job).map(drop)
}

/// Waits for the next item, at most until `until`; `None` waits without limit.
///
/// # Errors
/// No item has arrived, or every sender is gone.
pub fn receive<T>(from: &Receiver<T>, until: Option<Instant>) -> Result<T, RecvTimeoutError> {
    match until {
        Some(until) => from.recv_deadline(until),
        None => from
            .recv()
            .map_err(|RecvError| RecvTimeoutError::Disconnected),
    }
}

/// Waits between two turns of a task.
pub fn pause(time: Duration) {
    thread::sleep(time);
}

/// Waits for the answer of another task, at most `timeout`; `None` if it does not answer.
pub fn wait_for_answer<T>(from: &Receiver<T>, timeout: Duration) -> Option<T> {
    from.recv_timeout(timeout).ok()
}
