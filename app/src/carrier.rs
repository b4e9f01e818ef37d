//! Bytes between a port and whoever speaks through it, and what was said.

use std::io;
use std::time::{Duration, Instant};

use gsk_core::machine::link::LinkConfig;

use crate::ports::Port;

/// How long the last bytes for a board may take.
const LAST_WORDS: Duration = Duration::from_millis(500);

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

/// An open port.
pub struct Carrier {
    port: Port,
    opened: Instant,
    /// What is not whole yet, outward and inward.
    collected: [Vec<u8>; 2],
    /// The traffic since it was last taken; only while it is watched.
    pieces: Vec<(Duration, bool, Vec<u8>)>,
    watched: bool,
}

impl Carrier {
    /// Opens the port for itself alone.
    ///
    /// # Errors
    /// A sentence that names the port.
    pub fn open(config: &LinkConfig) -> Result<Self, String> {
        Ok(Self {
            port: Port::open(&config.port, config.baud)?,
            opened: Instant::now(),
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

    /// Time since the port was opened.
    pub fn now(&self) -> Duration {
        self.opened.elapsed()
    }

    /// What has arrived; waits at most 2 ms.
    ///
    /// # Errors
    /// The port is gone.
    pub fn read(&mut self) -> io::Result<Vec<u8>> {
        let bytes = self.port.read()?;
        self.note(false, &bytes);
        Ok(bytes)
    }

    /// Writes as much as the port takes now.
    ///
    /// # Errors
    /// The port is gone.
    pub fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.port.write(bytes)?;
        self.note(true, &bytes[..count]);
        Ok(count)
    }

    /// Writes all of it, or as much as the port takes within [`LAST_WORDS`]: the last
    /// bytes for the board stop it.
    pub fn write_last(&mut self, mut bytes: &[u8]) {
        let begun = Instant::now();
        while !bytes.is_empty() && begun.elapsed() < LAST_WORDS {
            match self.write(bytes) {
                Ok(count) => bytes = &bytes[count..],
                // A port that fails now has nothing more to say.
                Err(_) => return,
            }
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
            let at = self.opened.elapsed();
            self.pieces.push((at, outward, bytes.to_vec()));
        }
    }
}
