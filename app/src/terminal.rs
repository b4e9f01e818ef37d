//! Reads the answers of an operator at the terminal who confirms each step of a real
//! machine.

use std::io::{self, BufRead, IsTerminal};
use std::thread;

use crossbeam::channel::{Receiver, TryRecvError, bounded};
use gsk_runner::board::{OperatorAnswer, TerminalOperator};

/// Capacity of the queue of typed lines. Further lines are dropped until the queue is read.
const QUEUED_LINES: usize = 16;

/// An operator at the terminal. A separate thread reads standard input.
#[derive(Debug)]
pub struct StdinOperator {
    /// One entry for each typed line: true if it was empty (Enter alone).
    empty_lines: Receiver<bool>,
}

impl StdinOperator {
    /// Starts to read standard input; `None` if it is not a terminal or the thread does not
    /// start.
    pub fn open() -> Option<Self> {
        if !io::stdin().is_terminal() {
            return None;
        }
        let (send, lines) = bounded(QUEUED_LINES);
        let read_lines = move || {
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
        thread.spawn(read_lines).ok()?;
        Some(Self { empty_lines: lines })
    }
}

impl TerminalOperator for StdinOperator {
    fn discard_input(&self) {
        while self.empty_lines.try_recv().is_ok() {}
    }

    fn read_answer(&self) -> OperatorAnswer {
        match self.empty_lines.try_recv() {
            Ok(true) => OperatorAnswer::Enter,
            Ok(false) => OperatorAnswer::Other,
            Err(TryRecvError::Empty) => OperatorAnswer::None,
            Err(TryRecvError::Disconnected) => OperatorAnswer::EndOfInput,
        }
    }
}
