//! Guards the port of a board: a small separate process holds the port and stops the board
//! when the program is gone for any reason.
//!
//! ```text
//!   program: kernel, link ──► Guard ═══  tie   ═══ holder ──► port ──► board
//!   window, picture, files                         (the same binary, `hold-port`)
//! ```
//!
//! A library of the window may end the process, memory may run out, a user may kill it: no
//! thread is left then to stop the board. The holder sees the connection break. It knows
//! only the bytes that stop the board; the link sends them in advance.

pub mod frame;
pub mod holder;

use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::process::{Child, Command};
use std::thread;

use crossbeam::channel::{Receiver, bounded};
use gsk_messages::{Message, say};
use web_time::{Duration, Instant};

use frame::{Kind, Lease, Reader};

use crate::platform::{self, ToHolder};
use crate::ports;

/// The hidden command that starts a holder.
pub const COMMAND: &str = "hold-port";

/// How long a read waits for the first byte.
const READ_WAIT: Duration = Duration::from_millis(2);
/// Longest time for a holder to answer after its start.
const STARTS_WITHIN: Duration = Duration::from_secs(10);
/// Longest time for a holder to stop the board and end.
const ENDS_WITHIN: Duration = Duration::from_secs(5);
/// Time between two checks whether the holder has ended.
const LOOK: Duration = Duration::from_millis(2);
/// The holder stops the board when the program was silent for this time with slides or
/// spindle in motion. The board has made its lookahead by then.
const SILENT: Duration = Duration::from_secs(1);
/// Longest time between two renewals of the lease.
const RENEW: Duration = Duration::from_millis(100);
/// How long bytes for the board may take to the holder beyond the lookahead.
const ON_THE_WAY: Duration = Duration::from_millis(100);
/// Limit of the bytes that wait for the holder.
const MOST_WAITING: usize = frame::MOST;

/// Returns the time of the clock that this process and the holder share, ms.
fn now_ms() -> u64 {
    platform::shared_time().as_millis() as u64
}

/// The board after its holder has ended before the program.
#[derive(Debug)]
pub enum Orphan {
    /// The holder has stopped the board because the program was silent; the board's
    /// answer.
    Stopped(Vec<u8>),
    /// Another holder is stopping the board; the channel receives the board's answer.
    BeingStopped(Receiver<Vec<u8>>),
}

/// Why no holder could open the port.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub enum GuardError {
    /// The holder process cannot be started.
    NotStarted {
        /// The port.
        port: String,
        /// Error of the system.
        error: io::Error,
    },
    /// The holder process has ended.
    Ended {
        /// The port.
        port: String,
    },
    /// The holder cannot open the port; its reason.
    Refused(Message),
    /// The process sends no frames: it is not a holder.
    Strange {
        /// The port.
        port: String,
    },
    /// The holder does not answer in time.
    Silent {
        /// The port.
        port: String,
    },
}

impl GuardError {
    /// Returns the message for the operator.
    pub fn message(&self) -> Message {
        match self {
            Self::NotStarted { port, error } => say::port_holder_not_started(port, error),
            Self::Ended { port } => say::port_holder_ended(port),
            Self::Refused(said) => said.clone(),
            Self::Strange { port } => say::port_holder_strange(port),
            Self::Silent { port } => say::port_holder_silent(port),
        }
    }
}

/// A port that another process holds. Dropping it without [`Guard::end`] stops the board.
pub struct Guard {
    child: Child,
    holder: ToHolder,
    reader: Reader,
    /// Frames that the holder has not taken yet.
    waiting: Vec<u8>,
    stop: Vec<u8>,
    lease: Lease,
    renewed: Instant,
    orphan: Option<Orphan>,
    program: PathBuf,
    port: String,
    baud: u32,
}

impl Guard {
    /// Starts a holder of this port; `program` is its executable.
    ///
    /// # Errors
    /// The holder does not start, or cannot open the port; the message names the port.
    pub fn open(program: &Path, port: &str, baud: u32) -> Result<Self, GuardError> {
        let cannot = |error| GuardError::NotStarted {
            port: port.to_owned(),
            error,
        };
        let mut command = Command::new(program);
        command.args([COMMAND, "--baud", &baud.to_string(), "--", port]);
        let (child, holder) = ToHolder::start(command).map_err(cannot)?;
        let mut guard = Self {
            child,
            holder,
            reader: Reader::default(),
            waiting: Vec::new(),
            stop: Vec::new(),
            lease: Lease::default(),
            renewed: Instant::now(),
            orphan: None,
            program: program.to_owned(),
            port: port.to_owned(),
            baud,
        };
        guard.is_open()?;
        Ok(guard)
    }

    /// Waits until the holder has opened the port.
    fn is_open(&mut self) -> Result<(), GuardError> {
        let port = self.port.clone();
        let begun = Instant::now();
        while begun.elapsed() < STARTS_WITHIN {
            let heard = self.hear(LOOK);
            match self.reader.take() {
                Ok(Some((Kind::Open, _))) => return Ok(()),
                Ok(Some((Kind::Refused, said))) => {
                    return Err(match serde_json::from_slice(&said) {
                        Ok(said) => GuardError::Refused(said),
                        Err(_) => GuardError::Strange { port },
                    });
                }
                Ok(None) if heard.is_err() => return Err(GuardError::Ended { port }),
                Ok(None) => {}
                Ok(Some(_)) | Err(frame::Strange) => {
                    return Err(GuardError::Strange { port });
                }
            }
        }
        Err(GuardError::Silent { port })
    }

    /// Returns the process id of the holder.
    pub fn process(&self) -> u32 {
        self.child.id()
    }

    /// Reads the bytes that have arrived; waits 2 ms for the first one and returns none
    /// after it.
    ///
    /// # Errors
    /// The port is gone, or its holder is.
    pub fn read(&mut self) -> io::Result<Vec<u8>> {
        let heard = self.hear(READ_WAIT);
        let mut bytes = Vec::new();
        loop {
            match self.reader.take() {
                Ok(Some((Kind::Data, more))) => bytes.extend(more),
                Ok(Some((Kind::Gone, number))) => return Err(port_error(&number)),
                Ok(Some((Kind::Stopped, answered))) => {
                    self.orphan = Some(Orphan::Stopped(answered));
                    return Err(ErrorKind::TimedOut.into());
                }
                Ok(None) if bytes.is_empty() => {
                    return heard.map(|()| bytes).map_err(|_| self.is_alone());
                }
                Ok(None) => return Ok(bytes),
                Ok(Some(_)) | Err(frame::Strange) => return Err(self.is_alone()),
            }
        }
    }

    /// Writes as many bytes as the holder takes now; returns their number. If the holder
    /// is gone, the next read reports it.
    pub fn write(&mut self, bytes: &[u8]) -> usize {
        self.speak();
        if bytes.is_empty() || self.waiting.len() > MOST_WAITING {
            return 0;
        }
        let count = bytes.len().min(frame::MOST_DATED);
        frame::put_dated(&mut self.waiting, now_ms(), &bytes[..count]);
        self.renewed = Instant::now();
        self.speak();
        count
    }

    /// Renews the lease; called at every turn. With `moves` slides or spindle are in
    /// motion: the holder then stops the board if the program falls silent, and drops
    /// bytes that arrive later than the lookahead.
    pub fn renew(&mut self, moves: bool, lookahead: Duration) {
        let lease = match moves {
            true => Lease {
                silent_ms: SILENT.as_millis() as u32,
                stale_ms: (lookahead + ON_THE_WAY).as_millis() as u32,
            },
            false => Lease::default(),
        };
        let due = moves && self.renewed.elapsed() >= RENEW;
        if (due || lease != self.lease) && self.waiting.len() <= MOST_WAITING {
            self.lease = lease;
            self.renewed = Instant::now();
            frame::put(&mut self.waiting, Kind::Lease, &lease.to_bytes());
            self.speak();
        }
    }

    /// Takes what has happened to the board after [`Guard::read`] has failed; `None` if
    /// the port has failed.
    pub const fn take_orphan(&mut self) -> Option<Orphan> {
        self.orphan.take()
    }

    /// Sets the bytes that stop the board when the program is gone; none: do not stop it.
    pub fn stop_with(&mut self, bytes: &[u8]) {
        if self.stop != bytes {
            self.stop = bytes.to_vec();
            frame::put(&mut self.waiting, Kind::Stop, bytes);
            self.speak();
        }
    }

    /// Sends the remaining bytes and closes the port.
    pub fn end(mut self) {
        frame::put(&mut self.waiting, Kind::End, &[]);
        let begun = Instant::now();
        self.speak();
        while !self.waiting.is_empty() && begun.elapsed() < ENDS_WITHIN {
            thread::sleep(LOOK);
            self.speak();
        }
        // Dropping the value waits for the rest.
    }

    /// Reads the bytes of the holder that arrive within this time.
    fn hear(&mut self, within: Duration) -> io::Result<()> {
        self.reader.give(&self.holder.hear(within)?);
        Ok(())
    }

    /// Sends the waiting frames, as far as the holder takes them.
    fn speak(&mut self) {
        while !self.waiting.is_empty() {
            match self.holder.say(&self.waiting) {
                Ok(0) => return,
                Ok(count) => drop(self.waiting.drain(..count)),
                // The holder may have reported why: the next read shows it.
                Err(_) => self.waiting.clear(),
            }
        }
    }

    /// Leaves the board to the holder, which stops it; returns the board's answer.
    fn leave(mut self) -> Vec<u8> {
        self.holder.hang_up();
        let begun = Instant::now();
        let mut answered = Vec::new();
        while begun.elapsed() < ENDS_WITHIN && self.hear(READ_WAIT).is_ok() {
            while let Ok(Some((kind, bytes))) = self.reader.take() {
                if kind == Kind::Data {
                    answered.extend(bytes);
                }
            }
        }
        answered
    }

    /// Starts another holder that stops the board, after the first one has ended
    /// unexpectedly.
    fn is_alone(&mut self) -> io::Error {
        let stop = core::mem::take(&mut self.stop);
        if !stop.is_empty() {
            let (program, port, baud) = (self.program.clone(), self.port.clone(), self.baud);
            let (answer, answered) = bounded(1);
            // The control does not wait for it.
            let stop_board = move || {
                if let Ok(mut guard) = Self::open(&program, &port, baud) {
                    guard.stop_with(&stop);
                    // The receiver may be gone.
                    let _ = answer.try_send(guard.leave());
                }
            };
            let _ = thread::Builder::new().spawn(stop_board);
            self.orphan = Some(Orphan::BeingStopped(answered));
        }
        io::Error::new(
            ErrorKind::ConnectionAborted,
            "the process that holds the port has ended",
        )
    }
}

impl Drop for Guard {
    fn drop(&mut self) {
        // No effect after [`Guard::end`].
        self.holder.hang_up();
        let begun = Instant::now();
        while begun.elapsed() < ENDS_WITHIN {
            if !matches!(self.child.try_wait(), Ok(None)) {
                return;
            }
            // A holder whose bytes are read does not block in its writes.
            if self.hear(LOOK).is_err() {
                thread::sleep(LOOK);
            }
            self.reader = Reader::default();
        }
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Decodes the error of the port that the holder has reported.
fn port_error(number: &[u8]) -> io::Error {
    let number: [u8; 4] = number.try_into().unwrap_or_default();
    match i32::from_le_bytes(number) {
        0 => ports::closed(),
        number => io::Error::from_raw_os_error(number),
    }
}
