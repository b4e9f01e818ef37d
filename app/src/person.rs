//! Somebody at the terminal, who is asked before a real machine goes on.

use std::io::{self, BufRead, IsTerminal};
use std::thread;

use crossbeam::channel::{Receiver, TryRecvError, bounded};
use gsk_runner::board::{Answer, Operator};

/// Lines that wait to be looked at; what is typed behind them says nothing.
const LINES: usize = 16;

/// Somebody at the terminal.
#[derive(Debug)]
pub struct Person {
    /// Whether each line typed was an Enter alone.
    lines: Receiver<bool>,
}

impl Person {
    /// Whoever sits at standard input; none if that is no terminal.
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
                // A full channel: nobody has asked for it.
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
