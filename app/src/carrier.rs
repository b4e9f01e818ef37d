//! Bytes between a port and whoever speaks through it, and what was said.

use std::io;
use std::path::Path;
use std::thread;

use gsk_link::LinkConfig;
use web_time::{Duration, Instant};

use crate::guard::{Guard, GuardError, Orphan};
use crate::host_clock::HostClock;

/// How long the last bytes for a board may take.
const LAST_WORDS: Duration = Duration::from_millis(500);

/// Between two attempts to write them.
const AGAIN: Duration = Duration::from_millis(2);

/// One line of the traffic.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Line {
    /// Since the port was opened.
    pub at: Duration,
    /// From the PC to the board.
    pub outward: bool,
    /// What was said; bytes that are no text are shown as `\xNN`.
    pub text: String,
}

/// An open port. Dropped without [`Carrier::end`] it leaves a board that was stopped.
pub struct Carrier {
    /// None when it was closed.
    guard: Option<Guard>,
    clock: HostClock,
    /// When the port was looked at last.
    looked: Duration,
    lookahead: Duration,
    /// What is not whole yet, outward and inward.
    collected: [Vec<u8>; 2],
    /// The traffic since it was last taken; only while it is watched.
    pieces: Vec<(Duration, bool, Vec<u8>)>,
    watched: bool,
}

impl Carrier {
    /// Opens the port for itself alone; `program` is that of the process that holds it.
    ///
    /// # Errors
    /// A sentence that names the port.
    pub fn open(config: &LinkConfig, program: &Path) -> Result<Self, GuardError> {
        Ok(Self {
            guard: Some(Guard::open(program, &config.port, config.baud)?),
            clock: HostClock::start(),
            looked: Duration::ZERO,
            lookahead: config.lookahead(),
            collected: [Vec::new(), Vec::new()],
            pieces: Vec::new(),
            watched: false,
        })
    }

    /// From now on the traffic is kept for [`Carrier::traffic`], or no more.
    pub fn watch(&mut self, on: bool) {
        self.watched = on;
        if !on {
            self.pieces.clear();
        }
    }

    /// Time since the port was opened, sleep of the computer included.
    pub fn now(&self) -> Duration {
        self.clock.now()
    }

    /// Time that only the clock on the wall shows since the last call.
    pub fn take_jump(&mut self) -> Duration {
        self.clock.take_jump()
    }

    /// The process that holds the port.
    pub fn holder(&self) -> Option<u32> {
        self.guard.as_ref().map(Guard::process)
    }

    /// What has arrived; waits at most 2 ms.
    ///
    /// # Errors
    /// The port is gone.
    pub fn read(&mut self) -> io::Result<Vec<u8>> {
        let guard = self.guard.as_mut();
        let bytes = guard.map_or_else(|| Ok(Vec::new()), Guard::read)?;
        self.looked = self.clock.now();
        self.note(false, &bytes);
        Ok(bytes)
    }

    /// Writes as much as the port takes now; nothing where the port was not looked at for
    /// longer than the lookahead: the program was stopped or asleep since, the board has
    /// run dry, and what would move it again waits until that has been judged. Of a port
    /// that is gone the next read tells.
    pub fn write(&mut self, bytes: &[u8]) -> usize {
        if self.clock.now().saturating_sub(self.looked) > self.lookahead {
            return 0;
        }
        self.write_now(bytes)
    }

    fn write_now(&mut self, bytes: &[u8]) -> usize {
        let guard = self.guard.as_mut();
        let count = guard.map_or(bytes.len(), |guard| guard.write(bytes));
        self.note(true, &bytes[..count]);
        count
    }

    /// From now on these bytes stop the board when this program is gone; none: nothing
    /// is to be stopped.
    pub fn stop_with(&mut self, bytes: &[u8]) {
        if let Some(guard) = &mut self.guard {
            guard.stop_with(bytes);
        }
    }

    /// To be called all the time, `moves`: with slides or spindle in motion. A program that
    /// falls silent then leaves a board that is stopped.
    pub fn renew(&mut self, moves: bool) {
        if let Some(guard) = &mut self.guard {
            guard.renew(moves, self.lookahead);
        }
    }

    /// What has become of the board after [`Carrier::read`] has failed, if the port did
    /// not.
    pub fn take_orphan(&mut self) -> Option<Orphan> {
        self.guard.as_mut().and_then(Guard::take_orphan)
    }

    /// Writes all of it, or as much as is taken within half a second, and closes the
    /// port: the last bytes for the board stop it.
    pub fn end(&mut self, mut bytes: &[u8]) {
        let begun = Instant::now();
        while !bytes.is_empty() && begun.elapsed() < LAST_WORDS {
            let count = self.write_now(bytes);
            bytes = &bytes[count..];
            if count == 0 {
                thread::sleep(AGAIN);
            }
        }
        if let Some(guard) = self.guard.take() {
            guard.end();
        }
    }

    /// What was said since the last call, in the pieces that a link makes of it: its
    /// next text from the bytes of one direction.
    pub fn traffic(
        &mut self,
        mut next_text: impl FnMut(bool, &mut Vec<u8>) -> Option<String>,
    ) -> Vec<Line> {
        let mut lines = Vec::new();
        for (at, outward, bytes) in self.pieces.drain(..) {
            let collected = &mut self.collected[usize::from(!outward)];
            collected.extend(bytes);
            while let Some(text) = next_text(outward, collected) {
                lines.push(Line { at, outward, text });
            }
        }
        lines
    }

    fn note(&mut self, outward: bool, bytes: &[u8]) {
        if self.watched && !bytes.is_empty() {
            let at = self.clock.now();
            self.pieces.push((at, outward, bytes.to_vec()));
        }
    }
}
