//! Bytes between a port and whoever speaks through it, and what was said.

use std::io;
use std::time::{Duration, Instant};

use gsk_core::machine::link::LinkConfig;

use crate::ports::Port;

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
    /// Lines being collected, outward and inward.
    collected: [Vec<u8>; 2],
    /// The traffic since it was last taken; only while it is watched.
    lines: Vec<Line>,
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
            lines: Vec::new(),
            watched: false,
        })
    }

    /// From now on the traffic is kept for [`Carrier::traffic`], or no more.
    pub fn watch(&mut self, on: bool) {
        self.watched = on;
        if !on {
            self.lines.clear();
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

    /// The lines since the last call.
    pub fn traffic(&mut self) -> Vec<Line> {
        core::mem::take(&mut self.lines)
    }

    fn note(&mut self, outward: bool, bytes: &[u8]) {
        if !self.watched {
            return;
        }
        let at = self.opened.elapsed();
        for &byte in bytes {
            let collected = &mut self.collected[usize::from(!outward)];
            // Characters that act at once stand for themselves.
            let alone = outward && matches!(byte, b'?' | b'!' | b'~' | 0x18);
            if alone {
                let text = printable(&[byte]);
                self.lines.push(Line { at, outward, text });
            } else if byte == b'\n' {
                let text = printable(&core::mem::take(collected));
                self.lines.push(Line { at, outward, text });
            } else if byte != b'\r' {
                collected.push(byte);
            }
        }
    }
}

fn printable(bytes: &[u8]) -> String {
    bytes
        .iter()
        .map(|&byte| match byte {
            b' '..=b'~' => char::from(byte).to_string(),
            _ => format!("\\x{byte:02X}"),
        })
        .collect()
}
