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

use frame::{FrameKind, GuardFrameReader, Lease};

use crate::platform::{self, HolderConnection};
use crate::ports;

/// The hidden command of this program that starts a holder process.
pub const HOLDER_COMMAND: &str = "hold-port";

/// Time for which a read waits for the first byte.
const READ_WAIT: Duration = Duration::from_millis(2);
/// Longest time for a holder to answer after its start.
const START_TIMEOUT: Duration = Duration::from_secs(10);
/// Longest time for a holder to stop the board and end.
const END_TIMEOUT: Duration = Duration::from_secs(5);
/// Time between two checks whether the holder has ended or answered.
const POLL_INTERVAL: Duration = Duration::from_millis(2);
/// The holder stops the board when the program was silent for this time with slides or
/// spindle in motion. The board has made its lookahead by then.
const MAX_SILENCE: Duration = Duration::from_secs(1);
/// Longest time between two renewals of the holder's time limit (lease).
const RENEW_INTERVAL: Duration = Duration::from_millis(100);
/// Greatest time that bytes for the board may take to reach the holder, in addition to the
/// lookahead.
const TRANSIT_TIME: Duration = Duration::from_millis(100);
/// Greatest number of bytes that may wait for the holder process.
const MAX_WAITING_BYTES: usize = frame::MAX_CONTENT;

/// Returns the time of the clock that this process and the holder share, ms.
fn now_ms() -> u64 {
    platform::shared_time().as_millis() as u64
}

/// The state in which a board is left after its holder process has ended before the program.
#[derive(Debug)]
pub enum Orphan {
    /// The holder has stopped the board because the program was silent; the board's
    /// answer.
    Stopped(Vec<u8>),
    /// Another holder is stopping the board; the channel receives the board's answer.
    BeingStopped(Receiver<Vec<u8>>),
}

/// The reason why no holder process could open the port.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub enum GuardError {
    /// The holder process cannot be started.
    NotStarted {
        /// Name of the port that could not be opened.
        port: String,
        /// Error of the operating system.
        error: io::Error,
    },
    /// The holder process ended before it had opened the port.
    Ended {
        /// Name of the port that could not be opened.
        port: String,
    },
    /// The holder cannot open the port; the payload is its reason.
    Refused(Message),
    /// The started process sends no frames: it is not a holder.
    Strange {
        /// Name of the port that could not be opened.
        port: String,
    },
    /// The holder process did not answer within `START_TIMEOUT`.
    Silent {
        /// Name of the port that could not be opened.
        port: String,
    },
}

impl GuardError {
    /// Returns the message for the operator: why the port cannot be held.
    pub fn message(&self) -> Message {
        match self {
            Self::NotStarted { port, error } => say::port_holder_not_started(port, error),
            Self::Ended { port } => say::port_holder_ended(port),
            Self::Refused(message) => message.clone(),
            Self::Strange { port } => say::port_holder_strange(port),
            Self::Silent { port } => say::port_holder_silent(port),
        }
    }
}

/// A port that a holder process keeps open. Dropping it without [`PortGuard::close`] stops the
/// board.
pub struct PortGuard {
    child: Child,
    holder: HolderConnection,
    reader: GuardFrameReader,
    /// Bytes of frames that the holder process has not received yet.
    unsent: Vec<u8>,
    stop_bytes: Vec<u8>,
    lease: Lease,
    last_renewal: Instant,
    orphan: Option<Orphan>,
    program: PathBuf,
    port: String,
    baud: u32,
}

impl PortGuard {
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
        command.args([HOLDER_COMMAND, "--baud", &baud.to_string(), "--", port]);
        let (child, holder) = HolderConnection::start(command).map_err(cannot)?;
        let mut guard = Self {
            child,
            holder,
            reader: GuardFrameReader::default(),
            unsent: Vec::new(),
            stop_bytes: Vec::new(),
            lease: Lease::default(),
            last_renewal: Instant::now(),
            orphan: None,
            program: program.to_owned(),
            port: port.to_owned(),
            baud,
        };
        guard.wait_until_open()?;
        Ok(guard)
    }

    /// Waits until the holder has opened the port. Returns an error if the holder cannot open it or
    /// does not answer.
    fn wait_until_open(&mut self) -> Result<(), GuardError> {
        let port = self.port.clone();
        let begun = Instant::now();
        while begun.elapsed() < START_TIMEOUT {
            let received = self.receive(POLL_INTERVAL);
            match self.reader.take_frame() {
                Ok(Some((FrameKind::Open, _))) => return Ok(()),
                Ok(Some((FrameKind::Refused, content))) => {
                    return Err(match serde_json::from_slice(&content) {
                        Ok(message) => GuardError::Refused(message),
                        Err(_) => GuardError::Strange { port },
                    });
                }
                Ok(None) if received.is_err() => return Err(GuardError::Ended { port }),
                Ok(None) => {}
                Ok(Some(_)) | Err(frame::InvalidFrame) => {
                    return Err(GuardError::Strange { port });
                }
            }
        }
        Err(GuardError::Silent { port })
    }

    /// Returns the process id of the holder process.
    pub fn process_id(&self) -> u32 {
        self.child.id()
    }

    /// Returns the bytes of the board that have arrived; waits up to 2 ms for the first one
    /// and returns an empty vector without one.
    ///
    /// # Errors
    /// The port is gone, or its holder is.
    pub fn read(&mut self) -> io::Result<Vec<u8>> {
        let received = self.receive(READ_WAIT);
        let mut bytes = Vec::new();
        loop {
            match self.reader.take_frame() {
                Ok(Some((FrameKind::Data, more))) => bytes.extend(more),
                Ok(Some((FrameKind::Gone, number))) => return Err(decode_port_error(&number)),
                Ok(Some((FrameKind::Stopped, answered))) => {
                    self.orphan = Some(Orphan::Stopped(answered));
                    return Err(ErrorKind::TimedOut.into());
                }
                Ok(None) if bytes.is_empty() => {
                    return received.map(|()| bytes).map_err(|_| self.replace_holder());
                }
                Ok(None) => return Ok(bytes),
                Ok(Some(_)) | Err(frame::InvalidFrame) => return Err(self.replace_holder()),
            }
        }
    }

    /// Writes as many bytes as the holder takes now; returns their number. If the holder
    /// is gone, the next read reports it.
    pub fn write(&mut self, bytes: &[u8]) -> usize {
        self.send_waiting();
        if bytes.is_empty() || self.unsent.len() > MAX_WAITING_BYTES {
            return 0;
        }
        let count = bytes.len().min(frame::MAX_DATED);
        frame::append_dated(&mut self.unsent, now_ms(), &bytes[..count]);
        self.last_renewal = Instant::now();
        self.send_waiting();
        count
    }

    /// Renews the lease at every turn of the caller. `is_moving`: slides or spindle are in
    /// motion; the holder then stops the board if the program falls silent, and drops bytes
    /// that arrive later than `lookahead`.
    pub fn renew_lease(&mut self, is_moving: bool, lookahead: Duration) {
        let lease = match is_moving {
            true => Lease {
                silent_ms: MAX_SILENCE.as_millis() as u32,
                stale_ms: (lookahead + TRANSIT_TIME).as_millis() as u32,
            },
            false => Lease::default(),
        };
        let due = is_moving && self.last_renewal.elapsed() >= RENEW_INTERVAL;
        if (due || lease != self.lease) && self.unsent.len() <= MAX_WAITING_BYTES {
            self.lease = lease;
            self.last_renewal = Instant::now();
            frame::append_frame(&mut self.unsent, FrameKind::Lease, &lease.to_bytes());
            self.send_waiting();
        }
    }

    /// Returns and removes the state in which the board was left, after [`PortGuard::read`] has
    /// failed; `None` if the port has failed.
    pub const fn take_orphan(&mut self) -> Option<Orphan> {
        self.orphan.take()
    }

    /// Sets the bytes that the holder sends to stop the board when the program is gone; empty:
    /// the holder does not stop the board.
    pub fn set_stop_bytes(&mut self, bytes: &[u8]) {
        if self.stop_bytes != bytes {
            self.stop_bytes = bytes.to_vec();
            frame::append_frame(&mut self.unsent, FrameKind::Stop, bytes);
            self.send_waiting();
        }
    }

    /// Sends the remaining bytes and closes the port.
    pub fn close(mut self) {
        frame::append_frame(&mut self.unsent, FrameKind::End, &[]);
        let begun = Instant::now();
        self.send_waiting();
        while !self.unsent.is_empty() && begun.elapsed() < END_TIMEOUT {
            thread::sleep(POLL_INTERVAL);
            self.send_waiting();
        }
        // Dropping the value waits for the rest.
    }

    /// Reads the bytes of the holder that arrive within the time `within` into the frame reader.
    /// Returns an error if the holder has ended.
    fn receive(&mut self, within: Duration) -> io::Result<()> {
        self.reader.push_bytes(&self.holder.receive(within)?);
        Ok(())
    }

    /// Sends the waiting frames until the holder accepts no more bytes.
    fn send_waiting(&mut self) {
        while !self.unsent.is_empty() {
            match self.holder.send(&self.unsent) {
                Ok(0) => return,
                Ok(count) => drop(self.unsent.drain(..count)),
                // The holder may have reported why: the next read shows it.
                Err(_) => self.unsent.clear(),
            }
        }
    }

    /// Closes the connection, so that the holder stops the board; returns the board's answer.
    fn let_holder_stop(mut self) -> Vec<u8> {
        self.holder.end_sending();
        let begun = Instant::now();
        let mut answered = Vec::new();
        while begun.elapsed() < END_TIMEOUT && self.receive(READ_WAIT).is_ok() {
            while let Ok(Some((kind, bytes))) = self.reader.take_frame() {
                if kind == FrameKind::Data {
                    answered.extend(bytes);
                }
            }
        }
        answered
    }

    /// Starts another holder that stops the board, after the first one has ended unexpectedly.
    /// Returns the error for the caller of the read.
    fn replace_holder(&mut self) -> io::Error {
        let stop = core::mem::take(&mut self.stop_bytes);
        if !stop.is_empty() {
            let (program, port, baud) = (self.program.clone(), self.port.clone(), self.baud);
            let (answer, answered) = bounded(1);
            // The control does not wait for it.
            let stop_board = move || {
                if let Ok(mut guard) = Self::open(&program, &port, baud) {
                    guard.set_stop_bytes(&stop);
                    // The receiver may be gone.
                    let _ = answer.try_send(guard.let_holder_stop());
                }
            };
            let _ = thread::Builder::new().spawn(stop_board);
            self.orphan = Some(Orphan::BeingStopped(answered));
        }
        io::Error::new(ErrorKind::ConnectionAborted, "the port guard has ended")
    }
}

impl Drop for PortGuard {
    fn drop(&mut self) {
        // No effect after [`PortGuard::close`].
        self.holder.end_sending();
        let begun = Instant::now();
        while begun.elapsed() < END_TIMEOUT {
            if !matches!(self.child.try_wait(), Ok(None)) {
                return;
            }
            // A holder whose bytes are read does not block in its writes.
            if self.receive(POLL_INTERVAL).is_err() {
                thread::sleep(POLL_INTERVAL);
            }
            self.reader = GuardFrameReader::default();
        }
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Decodes the system error of the port that the holder has reported as four bytes.
fn decode_port_error(number: &[u8]) -> io::Error {
    let number: [u8; 4] = number.try_into().unwrap_or_default();
    match i32::from_le_bytes(number) {
        0 => ports::closed_error(),
        number => io::Error::from_raw_os_error(number),
    }
}
