//! Serial ports and pseudo terminals.

use std::collections::BTreeMap;
use std::io::{self, Read, Write};
use std::path::PathBuf;
use std::time::Duration;

use serialport::{ClearBuffer, SerialPort, SerialPortBuilder, TTYPort};

/// Numbers of the system's errors when the device behind a port is no more: EIO, ENXIO
/// and ENODEV.
pub const PULLED: [i32; 3] = [5, 6, 19];

/// An open port; closed when dropped.
pub struct Serial(TTYPort);

impl Serial {
    /// Opens a port for itself alone.
    ///
    /// # Errors
    /// It cannot be opened.
    pub fn open(builder: SerialPortBuilder) -> serialport::Result<Self> {
        builder.open_native().map(Self)
    }

    /// The same port for another thread.
    ///
    /// # Errors
    /// The system gives none.
    pub fn try_clone(&self) -> serialport::Result<Self> {
        self.0.try_clone_native().map(Self)
    }

    /// From now on a read waits so long for the first byte, and a write for room.
    ///
    /// # Errors
    /// The port does not take it.
    pub fn wait_so_long(&mut self, wait: Duration) -> serialport::Result<()> {
        self.0.set_timeout(wait)
    }

    /// What has arrived and was not read is thrown away; a port that keeps it is used
    /// all the same.
    pub fn forget_arrived(&self) {
        let _ = self.0.clear(ClearBuffer::Input);
    }

    /// Its name in the file system.
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

/// Whether there can be ports.
pub const fn has_ports() -> bool {
    true
}

/// Both ends of a pseudo terminal; none on a system that knows no such thing.
pub fn pseudo_terminal() -> Option<serialport::Result<(Serial, Serial)>> {
    let ends = TTYPort::pair();
    Some(ends.map(|(near, far)| (Serial(near), Serial(far))))
}

/// Ports and the unchanging names that point to them.
pub fn unchanging_names() -> BTreeMap<PathBuf, PathBuf> {
    let Ok(entries) = std::fs::read_dir("/dev/serial/by-id") else {
        return BTreeMap::new();
    };
    entries
        .flatten()
        .filter_map(|entry| Some((entry.path().canonicalize().ok()?, entry.path())))
        .collect()
}
