//! Serial ports and pseudo terminals, without waiting longer than asked.

use std::collections::BTreeMap;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

use gsk_messages::{Message, say};
use serialport::{ClearBuffer, FlowControl, SerialPort, TTYPort};

/// How long a read may wait for the first byte, and a write for room.
const WAIT: Duration = Duration::from_millis(2);
/// Between two attempts to open a port that is in use.
const BETWEEN: Duration = Duration::from_millis(20);

/// Why a port cannot be used.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub enum PortError {
    /// It may not be used by this user.
    Forbidden {
        /// The port.
        path: String,
        /// What the system said.
        error: serialport::Error,
    },
    /// There is none of this name.
    NotFound {
        /// The port.
        path: String,
        /// What the system said.
        error: serialport::Error,
    },
    /// There is no device behind it, or another program has it.
    NoDevice {
        /// The port.
        path: String,
        /// What the system said.
        error: serialport::Error,
    },
    /// For another reason.
    Refused {
        /// The port.
        path: String,
        /// What the system said.
        error: serialport::Error,
    },
    /// An open port cannot be used twice.
    Clone(serialport::Error),
    /// The system gives no pseudo terminal.
    NoTerminal(serialport::Error),
    /// Nobody could open the other end.
    NoName,
    /// A pseudo terminal does not take its settings.
    Terminal(serialport::Error),
    /// The system does not tell its ports.
    Unknown(serialport::Error),
}

impl PortError {
    /// What is said of it.
    pub fn message(&self) -> Message {
        match self {
            Self::Forbidden { path, error } => say::port_forbidden(path, error),
            Self::NotFound { path, error } => say::port_not_found(path, error),
            Self::NoDevice { path, error } => say::port_no_device(path, error),
            Self::Refused { path, error } => say::port_refused(path, error),
            Self::Clone(error) => say::port_not_shared(error),
            Self::NoTerminal(error) => say::port_terminal_refused(error),
            Self::NoName => say::port_terminal_nameless(),
            Self::Terminal(error) => say::port_terminal(error),
            Self::Unknown(error) => say::as_written(error),
        }
    }

    fn opening(path: &str, error: serialport::Error) -> Self {
        let path = path.to_owned();
        match error.kind() {
            serialport::ErrorKind::Io(io::ErrorKind::PermissionDenied) => {
                Self::Forbidden { path, error }
            }
            serialport::ErrorKind::Io(io::ErrorKind::NotFound) => Self::NotFound { path, error },
            serialport::ErrorKind::NoDevice => Self::NoDevice { path, error },
            _ => Self::Refused { path, error },
        }
    }
}

/// An open port; closed when dropped.
pub struct Port(TTYPort);

impl Port {
    /// Opens a device for itself alone. One that is in use is waited for so long.
    ///
    /// # Errors
    /// It cannot be opened: names the port and what to do.
    pub fn open_within(path: &str, baud: u32, patience: Duration) -> Result<Self, PortError> {
        let begun = Instant::now();
        loop {
            match serialport::new(path, baud).timeout(WAIT).open_native() {
                Ok(port) => {
                    // What was said to somebody else; a port that keeps it is used all the same.
                    let _ = port.clear(ClearBuffer::Input);
                    return Ok(Self(port));
                }
                Err(error)
                    if error.kind() == serialport::ErrorKind::NoDevice
                        && begun.elapsed() < patience =>
                {
                    thread::sleep(BETWEEN);
                }
                Err(error) => return Err(PortError::opening(path, error)),
            }
        }
    }

    /// The same port for somebody who reads, and waits so long for the first byte.
    ///
    /// # Errors
    /// The system gives none.
    pub fn reading(&self, wait: Duration) -> Result<Self, PortError> {
        let clone = || {
            let mut port = self.0.try_clone_native()?;
            port.set_timeout(wait)?;
            Ok(Self(port))
        };
        clone().map_err(PortError::Clone)
    }

    /// Opens a device whose partner is stopped by XOFF when nobody reads.
    ///
    /// # Errors
    /// It cannot be opened: names the port and what to do.
    pub fn open_with_handshake(path: &str, baud: u32) -> Result<Self, PortError> {
        serialport::new(path, baud)
            .timeout(WAIT)
            .flow_control(FlowControl::Software)
            .open_native()
            .map(Self)
            .map_err(|error| PortError::opening(path, error))
    }

    /// A pseudo terminal: our end, and the name of the other.
    ///
    /// # Errors
    /// The system gives none.
    pub fn pair() -> Result<(Self, TTYPort, String), PortError> {
        let (mut near, far) = TTYPort::pair().map_err(PortError::NoTerminal)?;
        let name = far.name().ok_or(PortError::NoName)?;
        near.set_timeout(WAIT).map_err(PortError::Terminal)?;
        Ok((Self(near), far, name))
    }

    /// What has arrived; empty when nothing did for 2 ms, or for the time of
    /// [`Port::reading`].
    ///
    /// # Errors
    /// The port is gone.
    pub fn read(&mut self) -> io::Result<Vec<u8>> {
        let mut buffer = [0; 4096];
        match self.0.read(&mut buffer) {
            Ok(0) => Err(closed()),
            Ok(count) => Ok(buffer[..count].to_vec()),
            Err(error) if passes(&error) => Ok(Vec::new()),
            Err(error) => Err(error),
        }
    }

    /// Writes as much as the port takes now.
    ///
    /// # Errors
    /// The port is gone.
    pub fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if bytes.is_empty() {
            return Ok(0);
        }
        match self.0.write(bytes) {
            Err(error) if passes(&error) => Ok(0),
            result => result,
        }
    }
}

/// Whether the port is only busy, not gone.
fn passes(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::TimedOut | io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted
    )
}

/// Nobody is at the other end.
pub fn closed() -> io::Error {
    io::Error::new(io::ErrorKind::BrokenPipe, say::port_closed().to_string())
}

/// What an open port's failure means.
pub fn gone(error: &io::Error) -> Message {
    if error.kind() == io::ErrorKind::ConnectionAborted {
        return say::port_holder_gone();
    }
    // EIO, ENXIO and ENODEV: the device behind the name is no more.
    let pulled = error.kind() == io::ErrorKind::BrokenPipe
        || matches!(error.raw_os_error(), Some(5 | 6 | 19));
    if pulled {
        say::port_gone()
    } else {
        say::port_failed(error)
    }
}

/// A port of this computer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Found {
    /// Device.
    pub path: String,
    /// Its unchanging name, where the system has one.
    pub by_id: Option<PathBuf>,
}

/// The serial ports with something behind them.
///
/// # Errors
/// The system does not tell.
pub fn list() -> Result<Vec<Found>, PortError> {
    let ports = serialport::available_ports().map_err(PortError::Unknown)?;
    let names = by_id(Path::new("/dev/serial/by-id"));
    Ok(ports
        .into_iter()
        .map(|port| Found {
            by_id: names.get(Path::new(&port.port_name)).cloned(),
            path: port.port_name,
        })
        .collect())
}

/// Devices and the unchanging names that point to them.
fn by_id(folder: &Path) -> BTreeMap<PathBuf, PathBuf> {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return BTreeMap::new();
    };
    entries
        .flatten()
        .filter_map(|entry| Some((entry.path().canonicalize().ok()?, entry.path())))
        .collect()
}
