//! Serial ports and pseudo terminals, without waiting longer than asked.

use std::collections::BTreeMap;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use serialport::{SerialPort, TTYPort};

/// How long a read may wait for the first byte.
const READ_WAIT: Duration = Duration::from_millis(2);

/// An open port; closed when dropped.
pub struct Port(TTYPort);

impl Port {
    /// Opens a device for itself alone.
    ///
    /// # Errors
    /// A sentence that names the port and what to do.
    pub fn open(path: &str, baud: u32) -> Result<Self, String> {
        serialport::new(path, baud)
            .timeout(READ_WAIT)
            .open_native()
            .map(Self)
            .map_err(|error| explain(path, &error))
    }

    /// A pseudo terminal: our end, and the name of the other.
    ///
    /// # Errors
    /// The system gives none.
    pub fn pair() -> Result<(Self, TTYPort, String), String> {
        let (mut near, far) =
            TTYPort::pair().map_err(|error| format!("no pseudo terminal: {error}"))?;
        let name = far.name().ok_or("the pseudo terminal has no name")?;
        near.set_timeout(READ_WAIT)
            .map_err(|error| format!("the pseudo terminal: {error}"))?;
        Ok((Self(near), far, name))
    }

    /// What has arrived; empty when nothing did for 2 ms.
    ///
    /// # Errors
    /// The port is gone.
    pub fn read(&mut self) -> io::Result<Vec<u8>> {
        let mut buffer = [0; 4096];
        match self.0.read(&mut buffer) {
            Ok(0) => Err(io::Error::new(
                io::ErrorKind::BrokenPipe,
                "the port was closed",
            )),
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

/// What an open port's failure means.
pub fn gone(error: &io::Error) -> String {
    // EIO, ENXIO and ENODEV: the device behind the name is no more.
    let pulled = error.kind() == io::ErrorKind::BrokenPipe
        || matches!(error.raw_os_error(), Some(5 | 6 | 19));
    if pulled {
        "the port is gone: was the cable pulled, or the board switched off?".to_owned()
    } else {
        format!("the port failed: {error}")
    }
}

fn explain(path: &str, error: &serialport::Error) -> String {
    match error.kind() {
        serialport::ErrorKind::Io(io::ErrorKind::PermissionDenied) => format!(
            "{path} cannot be opened: {error}; you may not use it: become a member of the group \
             that owns it (often dialout)"
        ),
        serialport::ErrorKind::Io(io::ErrorKind::NotFound) => format!(
            "{path} cannot be opened: {error}; is it plugged in? `gsk980td link list` shows the \
             ports"
        ),
        serialport::ErrorKind::NoDevice => format!(
            "{path} cannot be opened: {error}; there is no such device, or another program has \
             it: `gsk980td link list` shows the ports"
        ),
        _ => format!("{path} cannot be opened: {error}"),
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
pub fn list() -> Result<Vec<Found>, String> {
    let ports = serialport::available_ports().map_err(|error| error.to_string())?;
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
