//! Serial ports, pseudo terminals and TCP connections, with bounded waiting times.

pub mod dnc;
pub mod tcp;

use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::thread;

use gsk_messages::{Message, say};
use serialport::FlowControl;
use web_time::{Duration, Instant};

use crate::message_format::{describe_io_error, describe_port_error};
use crate::platform::{self, Serial};

/// Time for which a read waits for its first byte, and a write for space.
const IO_TIMEOUT: Duration = Duration::from_millis(2);
/// Address of a virtual board on a system without pseudo terminals. With port 0 the system
/// chooses the port number.
const LOOPBACK_ADDRESS: &str = "127.0.0.1:0";
/// Time between two attempts to open a serial port that is in use.
const RETRY_INTERVAL: Duration = Duration::from_millis(20);

/// The reason why a port cannot be used.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub enum PortError {
    /// The user has no permission for the port.
    Forbidden {
        /// Name of the port.
        path: String,
        /// Error of the operating system.
        error: serialport::Error,
    },
    /// No port has this name.
    NotFound {
        /// Name of the port.
        path: String,
        /// Error of the operating system.
        error: serialport::Error,
    },
    /// The port has no device, or another program uses it.
    NoDevice {
        /// Name of the port.
        path: String,
        /// Error of the operating system.
        error: serialport::Error,
    },
    /// The system refuses the port for another reason.
    Refused {
        /// Name of the port.
        path: String,
        /// Error of the operating system.
        error: serialport::Error,
    },
    /// No program listens at this network address.
    Unreachable {
        /// Name of the port.
        path: String,
        /// Error of the operating system.
        error: io::Error,
    },
    /// The program cannot listen at a network address.
    NotOffered {
        /// Network address, `HOST:PORT`.
        address: String,
        /// Error of the operating system.
        error: io::Error,
    },
    /// The operating system cannot open a second handle of an open port, for this reason.
    Clone(serialport::Error),
    /// The system cannot open a pseudo terminal, for this reason.
    NoTerminal(serialport::Error),
    /// The other end of the pseudo terminal has no name, so no program could open it.
    NoName,
    /// The pseudo terminal does not accept its settings, for this reason.
    Terminal(serialport::Error),
    /// The operating system cannot list its ports, for this reason.
    Unknown(serialport::Error),
}

impl PortError {
    /// Returns the message for the operator: which port cannot be used, why, and the remedy.
    pub fn message(&self) -> Message {
        match self {
            Self::Forbidden { path, error } => {
                say::port_forbidden(path, describe_port_error(error))
            }
            Self::NotFound { path, error } => say::port_not_found(path, describe_port_error(error)),
            Self::NoDevice { path, error } => say::port_no_device(path, describe_port_error(error)),
            Self::Refused { path, error } => say::port_refused(path, describe_port_error(error)),
            Self::Unreachable { path, error } => {
                say::port_unreachable(path, describe_io_error(error))
            }
            Self::NotOffered { address, error } => {
                say::port_not_offered(address, describe_io_error(error))
            }
            Self::Clone(error) => say::port_not_shared(error),
            Self::NoTerminal(error) => say::port_terminal_refused(error),
            Self::NoName => say::port_terminal_nameless(),
            Self::Terminal(error) => say::port_terminal(error),
            Self::Unknown(error) => say::as_written(error),
        }
    }

    fn from_open_error(path: &str, error: serialport::Error) -> Self {
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

/// An open port, a serial device or a network connection; closed when dropped.
pub struct Port(PortDevice);

enum PortDevice {
    Serial(Serial),
    Tcp(tcp::TcpConnection),
}

impl Port {
    /// Opens the serial device `path` exclusively at `baud`, bit/s, or connects with
    /// `tcp:HOST:PORT`. Retries a device that is in use until `timeout` has passed.
    ///
    /// # Errors
    /// The port cannot be opened; the error names the port and the remedy.
    pub fn open_with_retry(path: &str, baud: u32, timeout: Duration) -> Result<Self, PortError> {
        if let Some(address) = path.strip_prefix(tcp::PREFIX) {
            return match tcp::TcpConnection::open(address) {
                Ok(connection) => Ok(Self(PortDevice::Tcp(connection))),
                Err(error) => Err(PortError::Unreachable {
                    path: path.to_owned(),
                    error,
                }),
            };
        }
        let begun = Instant::now();
        loop {
            match Serial::open(serialport::new(path, baud).timeout(IO_TIMEOUT)) {
                Ok(port) => {
                    // Bytes sent to an earlier program.
                    port.discard_received();
                    return Ok(Self(PortDevice::Serial(port)));
                }
                Err(error)
                    if error.kind() == serialport::ErrorKind::NoDevice
                        && begun.elapsed() < timeout =>
                {
                    thread::sleep(RETRY_INTERVAL);
                }
                Err(error) => return Err(PortError::from_open_error(path, error)),
            }
        }
    }

    /// Returns another handle of the same port, for a reader that waits for the time `wait` for the
    /// first byte.
    ///
    /// # Errors
    /// The operating system refuses it.
    pub fn clone_for_reading(&self, wait: Duration) -> Result<Self, PortError> {
        let again = match &self.0 {
            PortDevice::Serial(port) => port.try_clone().and_then(|mut port| {
                port.set_timeout(wait)?;
                Ok(PortDevice::Serial(port))
            }),
            PortDevice::Tcp(connection) => connection
                .clone_for_reading(wait)
                .map(PortDevice::Tcp)
                .map_err(serialport::Error::from),
        };
        again.map(Self).map_err(PortError::Clone)
    }

    /// Opens the serial device `path` at `baud`, bit/s, with software flow control: XOFF stops the
    /// sender while the program does not read.
    ///
    /// # Errors
    /// The port cannot be opened; the error names the port and the remedy.
    pub fn open_with_handshake(path: &str, baud: u32) -> Result<Self, PortError> {
        let port = serialport::new(path, baud)
            .timeout(IO_TIMEOUT)
            .flow_control(FlowControl::Software);
        Serial::open(port)
            .map(|port| Self(PortDevice::Serial(port)))
            .map_err(|error| PortError::from_open_error(path, error))
    }

    /// Returns the bytes that have arrived. Waits 2 ms for the first one, or the time given to
    /// [`Port::clone_for_reading`]; returns an empty vector if none arrives.
    ///
    /// # Errors
    /// The port is gone.
    pub fn read(&mut self) -> io::Result<Vec<u8>> {
        let mut buffer = [0; 4096];
        match self.0.read(&mut buffer) {
            Ok(0) => Err(closed_error()),
            Ok(count) => Ok(buffer[..count].to_vec()),
            Err(error) if is_transient(&error) => Ok(Vec::new()),
            Err(error) => Err(error),
        }
    }

    /// Writes as many bytes as the port accepts now; returns their number.
    ///
    /// # Errors
    /// The port is gone.
    pub fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if bytes.is_empty() {
            return Ok(0);
        }
        match self.0.write(bytes) {
            Err(error) if is_transient(&error) => Ok(0),
            result => result,
        }
    }
}

impl PortDevice {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::Serial(port) => port.read(buffer),
            Self::Tcp(connection) => connection.read(buffer),
        }
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Serial(port) => port.write(bytes),
            Self::Tcp(connection) => connection.write(bytes),
        }
    }
}

/// The end of a port that the program offers to another one as a virtual board.
pub enum OfferedPort {
    /// A pseudo terminal. Its other end is kept open, too, because the program that uses it
    /// may close and open it again.
    Terminal {
        /// The end of the pseudo terminal that this program uses.
        near: Port,
        /// The end of the pseudo terminal that the other program opens.
        far: Serial,
    },
    /// The port is a network address at which the program listens.
    Tcp(tcp::TcpOffer),
}

impl OfferedPort {
    /// Listens at the network address `HOST:PORT`; with `None` opens a pseudo terminal. On a system
    /// without pseudo terminals, listens at an address that only this computer can reach.
    ///
    /// # Errors
    /// The operating system refuses it.
    pub fn open(address: Option<&str>) -> Result<Self, PortError> {
        let listen = |address: &str| {
            let listening = tcp::TcpOffer::listen(address).map(Self::Tcp);
            listening.map_err(|error| PortError::NotOffered {
                address: address.to_owned(),
                error,
            })
        };
        match address {
            Some(address) => listen(address),
            None => platform::pseudo_terminal().map_or_else(
                || listen(LOOPBACK_ADDRESS),
                |ends| {
                    let (mut near, far) = ends.map_err(PortError::NoTerminal)?;
                    near.set_timeout(IO_TIMEOUT).map_err(PortError::Terminal)?;
                    let near = Port(PortDevice::Serial(near));
                    Ok(Self::Terminal { near, far })
                },
            ),
        }
    }

    /// Returns the name under which another program opens the other end of the port.
    ///
    /// # Errors
    /// The operating system does not report the name.
    pub fn name(&self) -> Result<String, PortError> {
        match self {
            Self::Terminal { far, .. } => far.name(),
            Self::Tcp(offer) => offer.name().ok(),
        }
        .ok_or(PortError::NoName)
    }

    /// Returns the bytes of the other end that have arrived; waits 2 ms for the first one and
    /// returns an empty vector without one.
    ///
    /// # Errors
    /// The other end can never come back.
    pub fn read(&mut self) -> io::Result<Vec<u8>> {
        match self {
            Self::Terminal { near, .. } => near.read(),
            Self::Tcp(offer) => offer.read(),
        }
    }

    /// Writes as many bytes to the other end as it accepts now; returns their number. Without a
    /// connection all bytes are lost, as on an open line.
    ///
    /// # Errors
    /// The other end can never come back.
    pub fn write_some(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Terminal { near, .. } => near.write(bytes),
            Self::Tcp(offer) => {
                offer.write(bytes);
                Ok(bytes.len())
            }
        }
    }

    /// Writes all bytes to the other end and waits until it has accepted them.
    ///
    /// # Errors
    /// The other end can never come back.
    pub fn write(&mut self, mut bytes: &[u8]) -> io::Result<()> {
        match self {
            Self::Terminal { near, .. } => {
                while !bytes.is_empty() {
                    bytes = &bytes[near.write(bytes)?..];
                }
            }
            Self::Tcp(offer) => offer.write(bytes),
        }
        Ok(())
    }
}

/// Whether an error only means that the port is busy, so that the caller may retry.
fn is_transient(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::TimedOut | io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted
    )
}

/// Returns the error that reports a closed connection.
pub fn closed_error() -> io::Error {
    io::Error::new(io::ErrorKind::BrokenPipe, say::port_closed().to_string())
}

/// Returns the message for the operator about the failure of an open port with this error.
pub fn failure_message(error: &io::Error) -> Message {
    if error.kind() == io::ErrorKind::ConnectionAborted {
        return say::port_holder_gone();
    }
    if error.kind() == io::ErrorKind::TimedOut && error.raw_os_error().is_none() {
        return say::port_holder_stopped();
    }
    let pulled = error.kind() == io::ErrorKind::BrokenPipe
        || error
            .raw_os_error()
            .is_some_and(|number| platform::UNPLUGGED_ERRORS.contains(&number));
    if pulled {
        say::port_gone()
    } else {
        say::port_failed(describe_io_error(error))
    }
}

/// A serial port of this computer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PortInfo {
    /// Path of the device, for example `/dev/ttyUSB0` or `COM3`.
    pub path: String,
    /// The path of the device that does not change when it is plugged in again; `None` where the
    /// system has none.
    pub by_id: Option<PathBuf>,
}

/// Lists the serial ports that have a device.
///
/// # Errors
/// The system does not list its ports.
pub fn list_ports() -> Result<Vec<PortInfo>, PortError> {
    let ports = serialport::available_ports().map_err(PortError::Unknown)?;
    let names = platform::persistent_names();
    Ok(ports
        .into_iter()
        .map(|port| PortInfo {
            by_id: names.get(Path::new(&port.port_name)).cloned(),
            path: port.port_name,
        })
        .collect())
}
