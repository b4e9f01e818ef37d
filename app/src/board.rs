//! A board at a port without a control: moves bytes and time between the port and the
//! link.

use std::path::Path;
use std::time::Duration;

use gsk_core::linked::drives;
use gsk_core::memory::Parameters;
use gsk_link::{Link, LinkConfig, LinkEvent, LinkState, Protocol};

use gsk_messages::Message;

use crate::carrier::{Carrier, Line};
use crate::ending::{Ending, SignalError};
use crate::guard::GuardError;
use crate::ports;

/// Longest time for a board to become ready.
pub const GET_KNOWN: Duration = Duration::from_secs(30);

/// Why a board cannot be opened.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub enum BoardError {
    /// The signal handlers cannot be installed, so Ctrl-C could not stop the board.
    Signals(#[from] SignalError),
    /// The port cannot be opened.
    Port(#[from] GuardError),
}

impl BoardError {
    /// Returns the message for the operator.
    pub fn message(&self) -> Message {
        match self {
            Self::Signals(error) => error.message(),
            Self::Port(error) => error.message(),
        }
    }
}

/// A board and its link. The board stops when this value is dropped, and when the end of
/// the program is requested.
pub struct Board {
    /// The link.
    pub link: Link,
    carrier: Carrier,
    ending: Ending,
    lookahead: Duration,
    /// The board makes all motion it holds even if this program ends: protocol of text
    /// lines.
    by_lines: bool,
}

impl Drop for Board {
    fn drop(&mut self) {
        self.close();
    }
}

impl Board {
    /// Opens the port and begins the dialogue; `program` is the executable of the process
    /// that holds the port.
    ///
    /// # Errors
    /// The port or the signal handlers fail; the message names the port.
    pub fn open(
        config: LinkConfig,
        parameters: &Parameters,
        program: &Path,
    ) -> Result<Self, BoardError> {
        let ending = Ending::heard()?;
        let carrier = Carrier::open(&config, program)?;
        Ok(Self {
            lookahead: config.lookahead(),
            by_lines: config.protocol == Protocol::Line,
            link: Link::open(config, &drives(parameters), Duration::ZERO),
            carrier,
            ending,
        })
    }

    /// Stops motion, spindle and coolant, and closes the link.
    pub fn close(&mut self) {
        if self.link.state() != LinkState::Off {
            self.link.close();
            self.carrier.end(self.link.tx());
        }
    }

    /// Returns the id of the process that holds the port.
    pub fn holder(&self) -> Option<u32> {
        self.carrier.holder()
    }

    /// Keeps the traffic from now on, for [`Board::traffic`].
    pub fn watch(&mut self) {
        self.carrier.watch(true);
    }

    /// Returns the time since the port was opened.
    pub fn now(&self) -> Duration {
        self.carrier.now()
    }

    /// Reads, ticks and writes once; waits at most 2 ms for bytes. Closes the link once
    /// the end of the program is requested.
    pub fn pump(&mut self) -> Vec<LinkEvent> {
        if self.ending.is_asked() {
            self.close();
        }
        if self.link.state() == LinkState::Off {
            return self.link.events();
        }
        match self.carrier.read() {
            Ok(bytes) => self.link.rx(&bytes, self.carrier.now()),
            Err(error) => self.link.lost(ports::gone(&error)),
        }
        self.link.tick(self.carrier.now());
        let jump = self.carrier.take_jump();
        if jump >= self.lookahead {
            self.link.stop_after_absence();
        }
        let moves = matches!(self.link.state(), LinkState::Moving | LinkState::Homing);
        self.carrier.renew(moves && self.by_lines);
        self.carrier.stop_with(&self.link.stop_bytes());
        let count = self.carrier.write(self.link.tx());
        self.link.consumed(count);
        self.link.events()
    }

    /// Pumps until a condition holds or the time is up; returns the events meanwhile.
    pub fn wait(
        &mut self,
        limit: Duration,
        until: impl Fn(&Link, &[LinkEvent]) -> bool,
    ) -> Vec<LinkEvent> {
        let end = self.now() + limit;
        let mut events = Vec::new();
        while self.now() < end && self.link.state() != LinkState::Off && !until(&self.link, &events)
        {
            events.extend(self.pump());
        }
        events
    }

    /// Pumps until the board is ready, refused or lost, at most [`GET_KNOWN`]; returns the
    /// events meanwhile.
    pub fn get_known(&mut self) -> Vec<LinkEvent> {
        self.wait(GET_KNOWN, |link, events| {
            matches!(
                link.state(),
                LinkState::Locked | LinkState::Tripped | LinkState::Fault | LinkState::Lost
            ) || events
                .iter()
                .any(|event| matches!(event, LinkEvent::Differs(_)))
        })
    }

    /// Returns the lines of traffic since the last call.
    pub fn traffic(&mut self) -> Vec<Line> {
        let link = &self.link;
        self.carrier
            .traffic(|outward, collected| link.next_text(outward, collected))
    }
}
