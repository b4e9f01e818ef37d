//! A board at a port without a control: moves bytes and time between the port and the
//! link.

pub mod host_clock;
pub mod port_io;

use std::path::Path;
use std::time::Duration;

use gsk_core::linked::drives_from_parameters;
use gsk_core::memory::ControlParameters;
use gsk_link::{Link, LinkConfig, LinkEvent, LinkState, Protocol};

use gsk_messages::Message;

use crate::board::port_io::{PortIo, TrafficLine};
use crate::guard::GuardError;
use crate::ports;
use crate::termination::{SignalError, TerminationFlag};

/// Longest time that a board may take to become ready.
pub const READY_TIMEOUT: Duration = Duration::from_secs(30);

/// The reason why a board cannot be opened.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub enum BoardError {
    /// The signal handlers cannot be installed, so Ctrl-C could not stop the board.
    Signals(#[from] SignalError),
    /// The port cannot be opened.
    Port(#[from] GuardError),
}

impl BoardError {
    /// Returns the message for the operator about why the board cannot be opened.
    pub fn message(&self) -> Message {
        match self {
            Self::Signals(error) => error.message(),
            Self::Port(error) => error.message(),
        }
    }
}

/// A connection to a board. The board stops when this value is dropped, or when a termination
/// signal arrives.
pub struct BoardSession {
    /// The dialogue with the board: its state and its motion.
    pub link: Link,
    port_io: PortIo,
    termination: TerminationFlag,
    lookahead: Duration,
    /// True for boards that receive motion as text lines: such a board executes all motion it
    /// holds even if this program ends.
    is_line_protocol: bool,
}

impl Drop for BoardSession {
    fn drop(&mut self) {
        self.close();
    }
}

impl BoardSession {
    /// Opens the port and begins the dialogue; `program` is the executable file of the guard
    /// process, which holds the port.
    ///
    /// # Errors
    /// The port or the signal handlers fail; the message names the port.
    pub fn open(
        config: LinkConfig,
        parameters: &ControlParameters,
        program: &Path,
    ) -> Result<Self, BoardError> {
        let termination = TerminationFlag::install_signal_handlers()?;
        let port_io = PortIo::open(&config, program)?;
        Ok(Self {
            lookahead: config.lookahead(),
            is_line_protocol: config.protocol == Protocol::Line,
            link: Link::open(config, &drives_from_parameters(parameters), Duration::ZERO),
            port_io,
            termination,
        })
    }

    /// Stops motion, spindle and coolant, and closes the link.
    pub fn close(&mut self) {
        if self.link.state() != LinkState::Off {
            self.link.close();
            self.port_io.close(self.link.tx());
        }
    }

    /// Returns the id of the guard process that holds the port; `None` if no process does.
    pub fn holder_process_id(&self) -> Option<u32> {
        self.port_io.holder_process_id()
    }

    /// Records the lines of traffic from now on, for [`BoardSession::take_traffic`].
    pub fn record_traffic(&mut self) {
        self.port_io.set_recording(true);
    }

    /// Returns the time since the port was opened.
    pub fn now(&self) -> Duration {
        self.port_io.now()
    }

    /// Reads the bytes of the board (waits at most 2 ms for them), advances the link, writes
    /// its bytes and returns its events. Closes the link after a termination signal.
    pub fn pump(&mut self) -> Vec<LinkEvent> {
        if self.termination.is_requested() {
            self.close();
        }
        if self.link.state() == LinkState::Off {
            return self.link.events();
        }
        match self.port_io.read() {
            Ok(bytes) => self.link.rx(&bytes, self.port_io.now()),
            Err(error) => self.link.lost(ports::failure_message(&error)),
        }
        self.link.tick(self.port_io.now());
        let jump = self.port_io.take_jump();
        if jump >= self.lookahead {
            self.link.stop_after_absence();
        }
        let moves = matches!(self.link.state(), LinkState::Moving | LinkState::Homing);
        self.port_io.renew_lease(moves && self.is_line_protocol);
        self.port_io.set_stop_bytes(&self.link.stop_bytes());
        let count = self.port_io.write(self.link.tx());
        self.link.consumed(count);
        self.link.events()
    }

    /// Calls [`Self::pump`] until `until` is true, `limit` is over or the link is off; returns
    /// all events.
    pub fn pump_until(
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

    /// Calls [`Self::pump`] until the board is ready, refused or lost, at most
    /// [`READY_TIMEOUT`]; returns all events.
    pub fn wait_until_ready(&mut self) -> Vec<LinkEvent> {
        self.pump_until(READY_TIMEOUT, |link, events| {
            matches!(
                link.state(),
                LinkState::Locked | LinkState::Tripped | LinkState::Fault | LinkState::Lost
            ) || events
                .iter()
                .any(|event| matches!(event, LinkEvent::Differs(_)))
        })
    }

    /// Returns the lines of traffic recorded since the last call.
    pub fn take_traffic(&mut self) -> Vec<TrafficLine> {
        let link = &self.link;
        self.port_io
            .take_traffic(|outward, collected| link.next_text(outward, collected))
    }
}
