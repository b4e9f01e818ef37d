//! Serial ports and pseudo terminals.

use std::collections::BTreeMap;
use std::io::{self, Read, Write};
use std::path::PathBuf;
use std::time::Duration;

use serialport::{ClearBuffer, SerialPort, SerialPortBuilder, TTYPort};

/// Error numbers of a port whose device was unplugged: EIO, ENXIO and ENODEV.
pub const UNPLUGGED_ERRORS: [i32; 3] = [5, 6, 19];

/// An open serial port; it is closed when dropped.
pub struct Serial(TTYPort);

impl Serial {
    /// Opens a port exclusively.
    ///
    /// # Errors
    /// The port cannot be opened.
    pub fn open(builder: SerialPortBuilder) -> serialport::Result<Self> {
        builder.open_native().map(Self)
    }

    /// Returns another handle of the same port, for another thread.
    ///
    /// # Errors
    /// The system refuses.
    pub fn try_clone(&self) -> serialport::Result<Self> {
        self.0.try_clone_native().map(Self)
    }

    /// Sets the time for which a read waits for its first byte and a write for space.
    ///
    /// # Errors
    /// The port refuses it.
    pub fn set_timeout(&mut self, wait: Duration) -> serialport::Result<()> {
        self.0.set_timeout(wait)
    }

    /// Discards the bytes that have arrived and were not read; a failure is ignored.
    pub fn discard_received(&self) {
        let _ = self.0.clear(ClearBuffer::Input);
    }

    /// Returns the path of the port in the file system; `None` if it has none.
    pub fn name(&self) -> Option<String> {
        self.0.name()
    }
}

impl Read for Serial {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.0.read(buffer)
    }
}

impl Write for Serial {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

/// Returns whether the system can have serial ports.
pub const fn has_ports() -> bool {
    true
}

/// Opens both ends of a pseudo terminal; `None` on a system without them.
pub fn pseudo_terminal() -> Option<serialport::Result<(Serial, Serial)>> {
    let ends = TTYPort::pair();
    Some(ends.map(|(near, far)| (Serial(near), Serial(far))))
}

/// Lists the persistent names of the ports, by device path.
pub fn persistent_names() -> BTreeMap<PathBuf, PathBuf> {
    let Ok(entries) = std::fs::read_dir("/dev/serial/by-id") else {
        return BTreeMap::new();
    };
    entries
        .flatten()
        .filter_map(|entry| Some((entry.path().canonicalize().ok()?, entry.path())))
        .collect()
}
