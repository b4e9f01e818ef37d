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

use gsk_messages::{Message, say};
use web_time::{Duration, Instant};

use frame::{Kind, Reader};

use crate::platform::ToHolder;
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
/// What may wait for the holder before nothing more is taken.
const MOST_WAITING: usize = frame::MOST;

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
        let count = bytes.len().min(frame::MOST);
        frame::put(&mut self.waiting, Kind::Data, &bytes[..count]);
        self.speak();
        count
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

    /// The holder has ended by itself, and nobody holds the board: another one stops it.
    fn is_alone(&mut self) -> io::Error {
        let stop = core::mem::take(&mut self.stop);
        if !stop.is_empty() {
            let (program, port, baud) = (self.program.clone(), self.port.clone(), self.baud);
            // Dropped, it stops the board; the control does not wait for that.
            let stop_board = move || {
                if let Ok(mut guard) = Self::open(&program, &port, baud) {
                    guard.stop_with(&stop);
                }
            };
            let _ = thread::Builder::new().spawn(stop_board);
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
