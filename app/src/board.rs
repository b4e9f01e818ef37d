//! A board at a port: carries bytes and time between the port and its link.

use std::time::{Duration, Instant};

use gsk_core::machine::link::{Event, Link, LinkConfig, LinkState};
use gsk_core::memory::Parameters;

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

/// A board and its link.
pub struct Board {
    /// The link.
    pub link: Link,
    port: Port,
    opened: Instant,
    /// Lines being collected, outward and inward.
    collected: [Vec<u8>; 2],
    /// The traffic since it was last taken; only while it is watched.
    lines: Vec<Line>,
    watched: bool,
}

impl Board {
    /// Opens the port and begins the dialogue.
    ///
    /// # Errors
    /// A sentence that names the port.
    pub fn open(config: LinkConfig, parameters: &Parameters) -> Result<Self, String> {
        let port = Port::open(&config.port, config.baud)?;
        Ok(Self {
            link: Link::open(config, parameters, Duration::ZERO),
            port,
            opened: Instant::now(),
            collected: [Vec::new(), Vec::new()],
            lines: Vec::new(),
            watched: false,
        })
    }

    /// From now on the traffic is kept for [`Board::traffic`].
    pub fn watch(&mut self) {
        self.watched = true;
    }

    /// Time since the port was opened.
    pub fn now(&self) -> Duration {
        self.opened.elapsed()
    }

    /// Reads, ticks and writes once; waits at most 2 ms for bytes.
    pub fn pump(&mut self) -> Vec<Event> {
        match self.port.read() {
            Ok(bytes) => {
                self.note(false, &bytes);
                self.link.rx(&bytes, self.opened.elapsed());
            }
            Err(error) => self.link.lost(&format!("the port failed: {error}")),
        }
        self.link.tick(self.opened.elapsed());
        let bytes = self.link.tx().to_vec();
        match self.port.write(&bytes) {
            Ok(count) => {
                self.note(true, &bytes[..count]);
                self.link.consumed(count);
            }
            Err(error) => self.link.lost(&format!("the port failed: {error}")),
        }
        self.link.events()
    }

    /// Pumps until a condition holds or the time is up; what happened meanwhile.
    pub fn wait(&mut self, limit: Duration, until: impl Fn(&Link, &[Event]) -> bool) -> Vec<Event> {
        let end = self.now() + limit;
        let mut events = Vec::new();
        while self.now() < end && !until(&self.link, &events) {
            events.extend(self.pump());
        }
        events
    }

    /// Pumps until the board is known, refused or lost.
    pub fn get_known(&mut self) -> Vec<Event> {
        self.wait(Duration::from_secs(15), |link, events| {
            matches!(
                link.state(),
                LinkState::Locked | LinkState::Fault | LinkState::Lost
            ) || events
                .iter()
                .any(|event| matches!(event, Event::Differs { .. }))
        })
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
