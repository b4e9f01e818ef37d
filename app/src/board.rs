//! A board at a port without a control: carries bytes and time between the port and
//! its link.

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

/// A board is known by then, or hardly ever.
pub const GET_KNOWN: Duration = Duration::from_secs(30);

/// Why a board is not spoken to.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub enum BoardError {
    /// Nobody could end it with Ctrl-C.
    Signals(#[from] SignalError),
    /// Its port is not held.
    Port(#[from] GuardError),
}

impl BoardError {
    /// What is said of it.
    pub fn message(&self) -> Message {
        match self {
            Self::Signals(error) => error.message(),
            Self::Port(error) => error.message(),
        }
    }
}

/// A board and its link. It is stopped when this value is dropped, and when the end of
/// the program is asked for.
pub struct Board {
    /// The link.
    pub link: Link,
    carrier: Carrier,
    ending: Ending,
    lookahead: Duration,
    /// It makes what it holds, whatever becomes of this program.
    by_lines: bool,
}

impl Drop for Board {
    fn drop(&mut self) {
        self.close();
    }
}

impl Board {
    /// Opens the port and begins the dialogue; `program` is that of the process that
    /// holds the port.
    ///
    /// # Errors
    /// A sentence that names the port.
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

    /// Motion, spindle and coolant stop, and the link is over.
    pub fn close(&mut self) {
        if self.link.state() != LinkState::Off {
            self.link.close();
            self.carrier.end(self.link.tx());
        }
    }

    /// The process that holds the port.
    pub fn holder(&self) -> Option<u32> {
        self.carrier.holder()
    }

    /// From now on the traffic is kept for [`Board::traffic`].
    pub fn watch(&mut self) {
        self.carrier.watch(true);
    }

    /// Time since the port was opened.
    pub fn now(&self) -> Duration {
        self.carrier.now()
    }

    /// Reads, ticks and writes once; waits at most 2 ms for bytes. The link is over once
    /// the end is asked for.
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

    /// Pumps until a condition holds or the time is up; what happened meanwhile.
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

    /// Pumps until the board is known, refused or lost, [`GET_KNOWN`] at most.
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

    /// The lines since the last call.
    pub fn traffic(&mut self) -> Vec<Line> {
        let link = &self.link;
        self.carrier
            .traffic(|outward, collected| link.next_text(outward, collected))
    }
}
