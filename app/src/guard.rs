//! The port of a board in the hands of a small process of its own, which stops the
//! board when the program is gone, however it went.
//!
//! ```text
//!   program: kernel, link ──► Guard ═══  tie   ═══ holder ──► port ──► board
//!   window, picture, files                         (the same binary, `hold-port`)
//! ```
//!
//! A library of the window may end the process without asking anybody, memory may run
//! out, somebody may kill it: nobody is left then who could stop the board. The holder
//! sees the tie break. It knows nothing of the board but the bytes that stop it,
//! which the link tells it ahead.

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

/// The hidden command of the holder.
pub const COMMAND: &str = "hold-port";

/// How long a read may wait for the first byte.
const READ_WAIT: Duration = Duration::from_millis(2);
/// A holder that has not answered by then never will.
const STARTS_WITHIN: Duration = Duration::from_secs(10);
/// A holder has stopped the board and ended by then.
const ENDS_WITHIN: Duration = Duration::from_secs(5);
/// Between two looks whether it has.
const LOOK: Duration = Duration::from_millis(2);
/// The holder stops the board when the program was silent for so long with slides or
/// spindle in motion. The lookahead is made by then.
const SILENT: Duration = Duration::from_secs(1);
/// The lease is renewed so often at least.
const RENEW: Duration = Duration::from_millis(100);
/// Bytes for the board may be under way to the holder for so long beyond the lookahead.
const ON_THE_WAY: Duration = Duration::from_millis(100);
/// What may wait for the holder before nothing more is taken.
const MOST_WAITING: usize = frame::MOST;

/// Now, by a clock that this process and the holder read, ms.
fn now_ms() -> u64 {
    platform::shared_time().as_millis() as u64
}

/// The board after its holder has ended before the program has.
#[derive(Debug)]
pub enum Orphan {
    /// The holder stopped it because the program was silent; what the board answered.
    Stopped(Vec<u8>),
    /// Another holder stops it; what the board answered comes out here.
    BeingStopped(Receiver<Vec<u8>>),
}

/// Why there is no port that another process holds.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub enum GuardError {
    /// There is no process.
    NotStarted {
        /// The port.
        port: String,
        /// What the system said.
        error: io::Error,
    },
    /// It has gone.
    Ended {
        /// The port.
        port: String,
    },
    /// The holder cannot open the port, and says why.
    Refused(Message),
    /// The holder is none.
    Strange {
        /// The port.
        port: String,
    },
    /// The holder says nothing.
    Silent {
        /// The port.
        port: String,
    },
}

impl GuardError {
    /// What is said of it.
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

/// A port that another process holds. Dropped without [`Guard::end`] it leaves a board
/// that was stopped.
pub struct Guard {
    child: Child,
    holder: ToHolder,
    reader: Reader,
    /// Frames the holder has not taken yet.
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
    /// Starts a holder of this port.
    ///
    /// # Errors
    /// A sentence that names the port, or says why there is no holder.
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

    /// The holder.
    pub fn process(&self) -> u32 {
        self.child.id()
    }

    /// What has arrived; empty when nothing did for 2 ms.
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

    /// Writes as much as the holder takes now. Of one that is gone the next read tells.
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

    /// To be called all the time. `moves`: slides or spindle are in motion, and a program
    /// that falls silent leaves a board that is stopped; bytes that come later than the
    /// lookahead are not written.
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

    /// What has become of the board after [`Guard::read`] has failed, if the port did not.
    pub const fn take_orphan(&mut self) -> Option<Orphan> {
        self.orphan.take()
    }

    /// From now on these bytes stop the board when the program is gone; none: nothing
    /// is to be stopped.
    pub fn stop_with(&mut self, bytes: &[u8]) {
        if self.stop != bytes {
            self.stop = bytes.to_vec();
            frame::put(&mut self.waiting, Kind::Stop, bytes);
            self.speak();
        }
    }

    /// All is said, the port is closed.
    pub fn end(mut self) {
        frame::put(&mut self.waiting, Kind::End, &[]);
        let begun = Instant::now();
        self.speak();
        while !self.waiting.is_empty() && begun.elapsed() < ENDS_WITHIN {
            thread::sleep(LOOK);
            self.speak();
        }
        // What is left is waited for when the value is dropped.
    }

    /// Reads what the holder says, when it says something within this time.
    fn hear(&mut self, within: Duration) -> io::Result<()> {
        self.reader.give(&self.holder.hear(within)?);
        Ok(())
    }

    /// Hands over what waits, as far as it is taken.
    fn speak(&mut self) {
        while !self.waiting.is_empty() {
            match self.holder.say(&self.waiting) {
                Ok(0) => return,
                Ok(count) => drop(self.waiting.drain(..count)),
                // Why, it may have said: that is read next.
                Err(_) => self.waiting.clear(),
            }
        }
    }

    /// Leaves the board to the holder, which stops it; what the board answers.
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

    /// The holder has ended by itself, and nobody holds the board: another one stops it.
    fn is_alone(&mut self) -> io::Error {
        let stop = core::mem::take(&mut self.stop);
        if !stop.is_empty() {
            let (program, port, baud) = (self.program.clone(), self.port.clone(), self.baud);
            let (answer, answered) = bounded(1);
            // The control does not wait for it.
            let stop_board = move || {
                if let Ok(mut guard) = Self::open(&program, &port, baud) {
                    guard.stop_with(&stop);
                    // Who asked may have gone.
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
        // Behind an End it changes nothing.
        self.holder.hang_up();
        let begun = Instant::now();
        while begun.elapsed() < ENDS_WITHIN {
            if !matches!(self.child.try_wait(), Ok(None)) {
                return;
            }
            // Whoever is heard does not wait with what he says.
            if self.hear(LOOK).is_err() {
                thread::sleep(LOOK);
            }
            self.reader = Reader::default();
        }
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The error of the port that the holder has told.
fn port_error(number: &[u8]) -> io::Error {
    let number: [u8; 4] = number.try_into().unwrap_or_default();
    match i32::from_le_bytes(number) {
        0 => ports::closed(),
        number => io::Error::from_raw_os_error(number),
    }
}
