//! Reads the answers of an operator at the terminal who confirms each step of a real
//! machine.

use std::io::{self, BufRead, IsTerminal};
use std::thread;

use crossbeam::channel::{Receiver, TryRecvError, bounded};
use gsk_runner::board::{Answer, Operator};

/// Capacity of the queue of typed lines. Further lines are dropped until the queue is read.
const LINES: usize = 16;

/// An operator at the terminal. A separate thread reads standard input.
#[derive(Debug)]
pub struct Person {
    /// One entry for each typed line: true if it was empty (Enter alone).
    lines: Receiver<bool>,
}

impl Person {
    /// Starts to read standard input; `None` if it is not a terminal or the thread does not
    /// start.
    pub fn at_terminal() -> Option<Self> {
        if !io::stdin().is_terminal() {
            return None;
        }
        let (send, lines) = bounded(LINES);
        let listen = move || {
            let mut input = io::stdin().lock();
            let mut line = Vec::new();
            while input
                .read_until(b'\n', &mut line)
                .is_ok_and(|read| read > 0)
            {
                // The queue is full: these lines answer no question.
                let _ = send.try_send(line.trim_ascii().is_empty());
                line.clear();
            }
        };
        let thread = thread::Builder::new().name("terminal".to_owned());
        thread.spawn(listen).ok()?;
        Some(Self { lines })
    }
}

impl Operator for Person {
    fn forget(&self) {
        while self.lines.try_recv().is_ok() {}
    }

    fn answer(&self) -> Answer {
        match self.lines.try_recv() {
            Ok(true) => Answer::Enter,
            Ok(false) => Answer::Other,
            Err(TryRecvError::Empty) => Answer::None,
            Err(TryRecvError::Disconnected) => Answer::Gone,
        }
    }
}
